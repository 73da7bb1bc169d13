//! What a search draws.

use super::support::{goalbench, stderr, stdout, write_protocol};
use super::{SEARCH, TOY};

#[test]
fn a_curriculum_more_or_a_trial_more_changes_no_draw() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let configs = |text: &str| -> toml::Table {
        let path = write_protocol(folder.path(), text);
        let output = goalbench(&["run", &path, "--print-config"]);
        assert!(output.status.success(), "{}", stderr(&output));
        stdout(&output).parse().expect("TOML")
    };
    let small = configs(&format!("{TOY}{SEARCH}"));
    let larger = format!("{TOY}{SEARCH}")
        .replace("trials = 2", "trials = 5")
        .replace("['teach', 'her-iid', 'plr']", "['vds', 'teach', 'plr', 'lp']");
    let larger = larger.replace("curricula = ['teach', 'plr']", "");
    let large = configs(&format!(
        "{larger}[[search.range]]\nfield = 'curriculum.teach.interplay'\nlow = 1\nhigh = 9\n"
    ));
    for kind in ["Point/teach/trial-01", "Point/teach/trial-02", "Point/plr/trial-01", "Point/plr/trial-02"] {
        let lr = |table: &toml::Table| table[kind]["student"]["critic_lr"].clone();
        assert_eq!(lr(&small), lr(&large), "{kind}");
    }
    let window = |table: &toml::Table| table["Point/teach/trial-02"]["curriculum"]["teach"]["window"].clone();
    assert_eq!(window(&small), window(&large));
    assert!(large.contains_key("Point/lp/trial-05") && !small.contains_key("Point/teach/trial-03"));
}

/// Results can be compared and searches extended only as long as no draw changes.
#[test]
fn draws_stay_what_they_are_and_fill_their_ranges() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let ranges = "
[[search.range]]
field = 'curriculum.teach.window'
values = [3, 5, 10, 20]
[[search.range]]
field = 'curriculum.teach.interplay'
low = 1
high = 9
[[search.range]]
field = 'student.critic_lr'
low = 1e-4
high = 1e-2
log = true
";
    let drawn = |seed: u64, curriculum: &str, trials: usize| -> Vec<(i64, i64, f64)> {
        let head = format!("[search]\ntrials = {trials}\nseed = {seed}\nseeds = [100]");
        let path = write_protocol(folder.path(), &format!("{TOY}{head}{ranges}"));
        let output = goalbench(&["run", &path, "--print-config", "--curriculum", curriculum]);
        assert!(output.status.success(), "{}", stderr(&output));
        let configs: toml::Table = stdout(&output).parse().expect("TOML");
        let of = |number: usize| {
            let config = &configs[&format!("Point/{curriculum}/trial-{number:02}")];
            let own = &config["curriculum"][curriculum];
            let count = |name: &str| own.get(name).and_then(toml::Value::as_integer).unwrap_or(0);
            let rate = config["student"]["critic_lr"].as_float().expect("a number");
            (count("window"), count("interplay"), rate)
        };
        (1..=trials).map(of).collect()
    };
    let many = drawn(0, "teach", 1_000);
    assert_eq!(many[..4], [(3, 3, 0.000_151_8), (5, 1, 0.000_789), (5, 2, 0.000_179), (20, 1, 0.000_880_2)]);
    assert_eq!(drawn(1, "teach", 1), [(10, 3, 0.000_218_3)]);
    let rates: Vec<f64> = drawn(0, "vds", 2).iter().map(|one| one.2).collect();
    assert_eq!(rates, [0.007_802, 0.000_131_2]);
    // Of 1,000 draws each of four values has 250, with a standard deviation of 14; each of nine 111, with 10.
    for value in [3, 5, 10, 20] {
        let count = many.iter().filter(|one| one.0 == value).count();
        assert!((195..305).contains(&count), "{value}: {count}");
    }
    for value in 1..=9 {
        let count = many.iter().filter(|one| one.1 == value).count();
        assert!((71..151).contains(&count), "{value}: {count}");
    }
    assert!(many.iter().all(|one| (1e-4..=1e-2).contains(&one.2)));
    // Even in the logarithm: half of them below the geometric mean.
    let below = many.iter().filter(|one| one.2 < 1e-3).count();
    assert!((437..563).contains(&below), "{below}");
}
