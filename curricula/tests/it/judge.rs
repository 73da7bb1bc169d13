//! What teachers tell of their beliefs is what they teach by.

use curricula::Judgement;
use curricula::testing::Class;

fn close(found: Option<Vec<Option<f64>>>, expected: &[f64]) {
    let found = found.into_iter().flatten().collect::<Option<Vec<f64>>>().expect("a belief of every goal");
    assert_eq!(found.len(), expected.len());
    assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?} is not {expected:?}");
}

#[test]
fn teach_tells_its_confidence_and_its_variance() {
    let config = "window = 2\nstates = \"initial\"";
    let mut class = Class::new("teach", config, 3, |goal, steps| -((goal as u64 * steps) as f64));
    assert_eq!(class.teacher.judge(&class.student), Judgement::default(), "it has asked nobody yet");
    class.cycles(2);
    // Confidence 0, 0, 0 and then 0, −1, −2, where no return is below −50.
    let Judgement { success, scores } = class.teacher.judge(&class.student);
    close(success, &[1.0, 0.98, 0.96]);
    close(scores, &[0.0, 0.25, 1.0]);
}

#[test]
fn procurl_tells_p_and_p_times_1_minus_p() {
    let script = |goal: usize, _| -10.0 - 20.0 * goal as f64;
    let mut class = Class::new("procurl", "", 3, script);
    class.cycles(1);
    let Judgement { success, scores } = class.teacher.judge(&class.student);
    close(success, &[0.8, 0.4, 0.0]);
    close(scores, &[0.16, 0.24, 0.0]);
    // Adaptive bounds are −50 and −10.
    let mut class = Class::new("procurl", "bounds = \"adaptive\"", 3, script);
    class.cycles(1);
    let Judgement { success, scores } = class.teacher.judge(&class.student);
    close(success, &[1.0, 0.5, 0.0]);
    close(scores, &[0.0, 0.25, 0.0]);
}

#[test]
fn space_tells_the_scores_of_all_goals_at_its_last_update() {
    let config = "update_steps = 1\nstates = \"initial\"";
    let script = |goal: usize, steps: u64| -10.0 + (goal as u64 * steps) as f64;
    let mut class = Class::new("space", config, 3, script);
    class.cycles(1);
    assert_eq!(class.teacher.judge(&class.student), Judgement::default(), "no update yet");
    // The first update compares −10, −9, −8 with 0.
    class.cycles(1);
    let Judgement { success, scores } = class.teacher.judge(&class.student);
    close(success, &[0.8, 0.82, 0.84]);
    close(scores, &[-10.0, -9.0, -8.0]);
    // The next one compares −10, −8, −6 with those.
    let proposal = class.propose().expect("a goal");
    let Judgement { success, scores } = class.teacher.judge(&class.student);
    close(success, &[0.8, 0.84, 0.88]);
    assert_eq!(proposal.score, Some(2.0));
    close(scores, &[0.0, 1.0, 2.0]);
}

#[test]
fn lp_tells_the_progress_of_regions() {
    // A region for each goal; successes come and go.
    let mut class = Class::new("lp", "regions = 3\nwindow = 1", 3, |_, _| -10.0);
    class.mastery = |_, steps| if steps % 2 == 0 { 1.0 } else { 0.0 };
    let mut told = 0.0_f64;
    for _ in 0..20 {
        class.cycles(1);
        let Judgement { success, scores } = class.teacher.judge(&class.student);
        let scores = scores.expect("a score for every goal");
        assert_eq!((success, scores.len()), (None, 3));
        let mean = scores.iter().flatten().sum::<f64>() / 3.0;
        assert!((mean - class.statistic("progress_mean")).abs() < 1e-12, "{scores:?}");
        told = told.max(mean);
    }
    assert!(told > 0.0, "nothing was learned");
}

#[test]
fn plr_tells_the_scores_of_goals_that_were_learned_from() {
    let mut class = Class::new("plr", "schedule = \"fixed\"\nreplay = 0.0", 3, |_, _| -10.0);
    class.student.surprise = |_, _| 0.5;
    assert_eq!(class.teacher.judge(&class.student), Judgement::default(), "no episode yet");
    let goal = class.propose_index();
    assert_eq!(class.teacher.judge(&class.student), Judgement::default(), "not learned from yet");
    class.learn();
    let mut expected = vec![None; 3];
    expected[goal] = Some(0.5);
    let scores = Some(expected);
    assert_eq!(class.teacher.judge(&class.student), Judgement { success: None, scores });
}

#[test]
fn goid_tells_the_success_of_regions_that_were_tried() {
    // A region for each goal; the first try of one is a success, the second a failure.
    let mut class = Class::new("goid", "goals_per_region = 1", 2, |_, _| -10.0);
    assert_eq!(class.teacher.judge(&class.student), Judgement::default(), "nothing was tried yet");
    class.mastery = |_, _| 1.0;
    let goal = class.propose_index();
    let told = |goal: usize, value: f64| {
        let mut list = vec![None; 2];
        list[goal] = Some(value);
        Some(list)
    };
    let expected = Judgement { success: told(goal, 1.0), scores: told(goal, 0.0) };
    assert_eq!(class.teacher.judge(&class.student), expected);
    class.mastery = |_, _| 0.0;
    while class.propose_index() != goal {}
    let Judgement { success, scores } = class.teacher.judge(&class.student);
    let of_goal = |list: Option<Vec<Option<f64>>>| list.and_then(|list| list[goal]);
    assert_eq!((of_goal(success), of_goal(scores)), (Some(0.5), Some(0.25)));
}
