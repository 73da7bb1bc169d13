//! Which runs are carried out together: a worker trains the runs of a cohort in lockstep.

use reports::wording::counted;

use super::job::Job;

/// The cohorts of `jobs`, each as indices of its runs, in the order in which they are started. At most
/// `lanes` runs share a worker; they are of one environment and their students' gradient steps are alike
/// ([`agents::StudentConfig::in_lockstep`]). Curricula, variants, seeds and budgets may differ. A run that
/// has ended is by itself.
pub fn cohorts(jobs: &[Job], lanes: usize) -> Vec<Vec<usize>> {
    let mut cohorts: Vec<Vec<usize>> = Vec::new();
    for (index, job) in jobs.iter().enumerate() {
        let fits = |cohort: &&mut Vec<usize>| {
            let first = &jobs[cohort[0]];
            cohort.len() < lanes && job.is_open() && first.is_open() && keep_step(first, job)
        };
        match cohorts.iter_mut().find(fits) {
            Some(cohort) => cohort.push(index),
            None => cohorts.push(vec![index]),
        }
    }
    cohorts
}

/// What is to be said where no cohort of the `open` runs can have as many lanes as were asked for.
pub fn fewer_than<'a>(lanes: usize, open: impl Iterator<Item = &'a Job>) -> Option<String> {
    let open: Vec<Job> = open.cloned().collect();
    let most = cohorts(&open, lanes).iter().map(Vec::len).max()?;
    let runs = counted(open.len(), "run");
    match most {
        _ if most >= lanes => None,
        _ if most == open.len() => Some(format!("--lanes {lanes}: there are only {runs} to do")),
        _ => Some(format!(
            "--lanes {lanes}: no more than {most} of the {runs} to do can share a cohort, whose runs are of one \
             environment and whose students' gradient steps are alike"
        )),
    }
}

/// Whether two runs can be lanes of one cohort.
pub(super) fn keep_step(one: &Job, other: &Job) -> bool {
    one.run().environment == other.run().environment
        && one.config.student.in_lockstep() == other.config.student.in_lockstep()
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use reports::schema::Outcome;

    use super::*;
    use crate::Registry;
    use crate::protocol::Protocol;
    use crate::protocol::plan::Plan;
    use crate::run::folder::State;
    use crate::sweep::{Reopen, Sweep};

    const TEXT: &str = "
        name = 'a-test'
        environments = ['Point', 'MazeA']
        curricula = ['teach', 'her-iid']
        seeds = [0, 1]
        [[variant]]
        label = 'plain'
        [[variant]]
        label = 'noisy'
        set = { student = { her_k = 2 }, curriculum = { teach = { window = 3 } } }
        [[variant]]
        label = 'fast'
        set = { student = { actor_lr = 0.01 } }
    ";

    fn jobs() -> Vec<Job> {
        let registry = Registry::builtin();
        let protocol = Protocol::parse("a test", TEXT, &registry).expect("a protocol");
        let plan = Plan::new(&protocol, &registry).expect("a plan");
        let sweep = Sweep::survey(&plan, Path::new("/nonexistent/results"), Reopen::default())
            .expect("nothing there");
        sweep.jobs().to_vec()
    }

    #[test]
    fn lanes_that_nobody_can_fill_are_told_of() {
        let jobs = jobs();
        // 8 runs of each environment keep step.
        assert_eq!(fewer_than(8, jobs.iter()), None);
        let said = fewer_than(9, jobs.iter()).expect("too many");
        assert!(said.starts_with("--lanes 9: no more than 8 of the 24 runs to do"), "{said}");
        let two = &jobs[..2];
        let most = cohorts(two, 2).iter().map(Vec::len).max();
        let said = fewer_than(3, two.iter()).expect("too many");
        assert_eq!(said.contains("there are only 2 runs to do"), most == Some(2), "{said}");
        assert_eq!(fewer_than(3, [].iter()), None);
    }

    #[test]
    fn runs_that_keep_step_come_together_whatever_their_curricula_and_seeds() {
        let mut jobs = jobs();
        jobs[3].state = State::Ended(Outcome::Finished { step: 1 });
        assert_eq!(cohorts(&jobs, 1), (0..jobs.len()).map(|index| vec![index]).collect::<Vec<_>>());
        let all = cohorts(&jobs, 100);
        let mut seen: Vec<usize> = all.concat();
        seen.sort_unstable();
        assert_eq!(seen, (0..jobs.len()).collect::<Vec<_>>(), "every run once");
        let kinds: Vec<_> = all
            .iter()
            .map(|cohort| {
                let run = jobs[cohort[0]].run();
                (run.environment.as_str(), run.variant == "fast", cohort.len())
            })
            .collect();
        // 'noisy' may keep step with 'plain', 'fast' may not: 8 and 4 runs per environment. The fourth run of
        // the plan has ended.
        assert_eq!(kinds.iter().map(|kind| kind.2).sum::<usize>(), 24);
        assert_eq!(all.len(), 5, "{kinds:?}");
        assert!(all.contains(&vec![3]), "{all:?}");
        for cohort in cohorts(&jobs, 3) {
            assert!(cohort.len() <= 3 && cohort.is_sorted(), "{cohort:?}");
            assert!(cohort.iter().all(|&index| keep_step(&jobs[cohort[0]], &jobs[index])), "{cohort:?}");
        }
    }
}
