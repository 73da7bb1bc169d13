//! What is said of wrong input: the path, what was given, what is accepted, and no word of programmers.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]

mod support;

use support::{goalbench, refused, stderr, stdout, write_protocol as write};

const HEAD: &str = "name = 'x'\nenvironments = ['Point']\ncurricula = ['teach']\nseeds = [0]\n";

/// Names of types and other words of programmers, which must not reach a user.
const JARGON: [&str; 14] = [
    "usize",
    "u64",
    "u32",
    "f64",
    "i64",
    "invalid type: ",
    "invalid value: ",
    "expected",
    "enum",
    "struct",
    "identifier",
    "sequence",
    "invalid digit",
    "'-- -",
];

fn refused_plainly(args: &[&str], expected: &[&str]) {
    refused(args, expected);
    let message = stderr(&goalbench(args));
    for word in JARGON {
        assert!(!message.contains(word), "{args:?}: {word:?} in\n{message}");
    }
}

#[test]
fn a_value_of_a_wrong_type_is_answered_with_path_value_and_what_is_accepted() {
    for (assignment, reason) in [
        ("student.batch=2.5", "student.batch: is 2.5; must be \"auto\" or a whole number from 1 to 1000000"),
        ("student.batch=-1", "student.batch: is -1; must be \"auto\" or a whole number from 1 to 1000000"),
        ("student.batch=", "student.batch: is \"\"; must be"),
        ("student.batch=many", "student.batch: is \"many\"; must be"),
        ("student.batch=[1]", "student.batch: is a list; must be"),
        ("student.batch={ a = 1 }", "student.batch: is a table; must be"),
        ("student.batch=1979-05-27", "student.batch: is the date 1979-05-27; must be"),
        ("student.batch=inf", "student.batch: is inf; must be"),
        ("student.her_k=1.5", "student.her_k: is 1.5; must be a whole number from 0 to 1000000"),
        ("student.her_k=99999999999", "student.her_k: "),
        ("student.gamma=nan", "student.gamma: NaN given, a number in [0, 1) accepted"),
        ("student.gamma=x", "student.gamma: is \"x\"; must be \"auto\" or a number from 0 to below 1"),
        ("student.actor_lr=abc", "student.actor_lr: is \"abc\"; must be a number above 0"),
        ("student.noise=3", "student.noise: is 3; must be a table with the key `kind`"),
        ("student.noise.kind=3", "student.noise.kind: is 3; must be one of gaussian, ornstein-uhlenbeck"),
        (
            "student.noise.kind=gausian",
            "student.noise.kind: unknown value `gausian`; did you mean `gaussian`?",
        ),
        ("student.noise.std=x", "student.noise.std: is \"x\"; must be a number of at least 0"),
        ("student.normalizer=3", "student.normalizer: is 3; must be a table with the keys `std_floor`"),
        ("student.normalizer.feed_episodes=x", "student.normalizer.feed_episodes: is \"x\"; must be"),
        ("student.agent=3", "student.agent: is 3; must be a text"),
        (
            "student.device=gpu",
            "student.device: unknown value `gpu`; did you mean `cpu`? (accepted: cpu, cuda)",
        ),
        ("student=x", "student: is \"x\"; must be a table with the keys `agent`"),
        ("budget.steps=99999999999999999999", "budget.steps: is 99999999999999999999; must be"),
        (
            "budget.steps=1e308",
            "budget.steps: is 1e308; must be \"auto\" or a whole number from 1 to 1000000000",
        ),
        ("student.actor_lr=1e999", "student.actor_lr: is 1e999; must be a number above 0"),
        (
            "seed.pool=18446744073709551615",
            "is 18446744073709551615; must be \"auto\" or a whole number of at least 0, and at most 9223372036854775807",
        ),
        ("curriculum.teach.window=1e30", "is 1e30; must be a whole number of at least 2, and at most 92233"),
        ("evaluation.goals=3", "evaluation.goals: is 3; must be one of environment, pool"),
        ("evaluation=x", "evaluation: is \"x\"; must be a table with the keys `every`, `episodes`, `goals`"),
        ("physics.native_ccd=1", "physics.native_ccd: is 1; must be true or false"),
        ("pool=x", "pool: is \"x\"; must be a table with the key `size`"),
        ("pool.size=x", "pool.size: is \"x\"; must be a whole number from 1 to 1000000"),
        ("seed.pool=x", "seed.pool: is \"x\"; must be \"auto\" or a whole number of at least 0"),
        ("curriculum=1", "curriculum: is 1; must be a table with the keys `teach`"),
        ("curriculum.teach=3", "curriculum.teach: is 3; must be a table with the keys `window`"),
        (
            "curriculum.teach.window=1.5",
            "curriculum.teach.window: is 1.5; must be a whole number of at least 2",
        ),
        ("curriculum.teach.window=-1", "curriculum.teach.window: is -1; must be"),
        (
            "curriculum.teach.states=3",
            "curriculum.teach.states: is 3; must be one of reference, replay, initial",
        ),
        ("curriculum.teach.states=replya", "did you mean `replay`?"),
        (
            "curriculum.vds.batch=x",
            "curriculum.vds.batch: is \"x\"; must be \"auto\" or a whole number from 1 to 65536",
        ),
        ("curriculum.vds.members=99", "curriculum.vds.members: must be 2 to 64, got 99"),
        ("curriculum.her-iid.window=3", "curriculum.her-iid.window: unknown key `window`"),
    ] {
        let set = format!("--set {assignment}: ");
        refused_plainly(
            &["run", "--env", "Point", "--curriculum", "teach", "--dry-run", "--set", assignment],
            &[&set, reason],
        );
    }
}

#[test]
fn what_does_not_fit_in_a_protocol_is_named_with_its_path() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let names = |rest: &str| format!("name = 'x'\nenvironments = ['Point']\ncurricula = ['teach']\n{rest}");
    for (text, line, reason) in [
        ("name = 3\n".to_owned(), 1, "name: is 3; must be a text"),
        (
            "name = 'x'\nenvironments = 'Point'\n".to_owned(),
            2,
            "environments: is \"Point\"; must be a list of names",
        ),
        ("name = 'x'\nenvironments = [1]\n".to_owned(), 2, "environments[0]: is 1; must be a text"),
        (
            names("seeds = 3\n"),
            4,
            "seeds: is 3; must be a list of seeds such as [0, 3], or a range such as \"0..7\"",
        ),
        (names("seeds = [0, -1]\n"), 4, "seeds[1]: is -1; must be a whole number of at least 0"),
        (names("seeds = [1.5]\n"), 4, "seeds[0]: is 1.5; must be a whole number"),
        (format!("{HEAD}variant = 3\n"), 5, "variant: is 3; must be a list of tables"),
        (format!("{HEAD}[variant]\nlabel = 'a'\n"), 5, "variant: is a table; must be a list of tables"),
        (format!("{HEAD}[[variant]]\nset = {{}}\n"), 5, "variant[0]: `label` is missing; must be a text"),
        (format!("{HEAD}[[variant]]\nlabel = 3\n"), 6, "variant[0].label: is 3; must be a text"),
        (format!("{HEAD}[[variant]]\nlabel = 'a'\nset = 3\n"), 7, "variant[0].set: is 3; must be a table"),
        (
            format!("{HEAD}[[variant]]\nlabel = 'a'\nsets = {{}}\n"),
            7,
            "variant[0].sets: unknown key `sets`; did you mean `set`?",
        ),
        (
            format!("{HEAD}[[override]]\nenvironments = ['Point']\n"),
            5,
            "override[0]: `set` is missing; must be a table",
        ),
        (format!("{HEAD}[student]\nbatch = 1\nbatch = 2\n"), 7, "`batch` is given twice"),
        (format!("{HEAD}student = 3\n"), 5, "student: is 3; must be a table"),
        (format!("{HEAD}[student.noise]\nstd = 'x'\n"), 6, "student.noise.std: is \"x\"; must be"),
        (format!("{HEAD}[curriculum]\nteach = 3\n"), 6, "curriculum.teach: is 3; must be a table"),
    ] {
        let path = write(folder.path(), &text);
        refused_plainly(&["run", &path, "--dry-run"], &[&format!("{path}:{line}: {reason}")]);
    }
    let path = write(folder.path(), "");
    refused_plainly(&["run", &path], &["`name` is missing; must be a text"]);
}

#[test]
fn counts_can_be_written_as_people_write_them() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let printed = |args: &[&str]| {
        let output = goalbench(&[args, &["--print-config"]].concat());
        assert!(output.status.success(), "{args:?}: {}", stderr(&output));
        stdout(&output)
    };
    let with = ["run", "--env", "Point", "--curriculum", "teach"];
    for count in ["1e5", "100k", "0.1M", "100_000"] {
        assert!(printed(&[&with[..], &["--steps", count]].concat()).contains("steps = 100000\n"), "{count}");
        let set = format!("budget.steps={count}");
        assert!(printed(&[&with[..], &["--set", &set]].concat()).contains("steps = 100000\n"), "{count}");
        let path = write(folder.path(), &format!("{HEAD}[budget]\nsteps = '{count}'\n"));
        assert!(printed(&["run", &path]).contains("steps = 100000\n"), "{count}");
    }
    let path = write(folder.path(), &format!("{HEAD}[budget]\nsteps = 1e5\n[evaluation]\nepisodes = 1e2\n"));
    assert!(printed(&["run", &path]).contains("episodes = 100\n"));
    for (args, count) in [
        (["run", "--steps"], "1e-5"),
        (["run", "--steps"], "1.5"),
        (["run", "--steps"], "many"),
        (["evaluate", "--episodes"], "1e9"),
        (["render", "--episodes"], "x"),
    ] {
        refused_plainly(&[args[0], "x", args[1], count], &[args[1], count]);
    }
    refused_plainly(&["run", "--steps", "x"], &["a whole number such as 100000, 1e5 or 100k"]);
}

#[test]
fn advice_about_values_that_look_like_options_can_be_followed() {
    let with = |more: &[&'static str]| [&["run", "--env", "Point", "--curriculum", "teach"], more].concat();
    refused_plainly(&with(&["--steps", "-1"]), &["-1", "1e5"]);
    refused_plainly(&with(&["--seeds", "-1"]), &["`-1` is not a seed"]);
    refused_plainly(&with(&["--jobs", "-1"]), &["--jobs"]);
    refused_plainly(&with(&["--jobs", "x"]), &["--jobs", "a whole number from 1 to 65535 is accepted"]);
    refused_plainly(&with(&["--retries", "-1"]), &["--retries"]);
    refused_plainly(&["evaluate", "x", "--seed", "-3"], &["--seed"]);
    refused_plainly(&["regress", "check", "--baseline", "x", "--alpha", "-0.5"], &["x"]);
    refused(&with(&["--out", "-x"]), &["'--out=-x'"]);
    refused(&with(&["--seeds", "-1..3"]), &["'--seeds=-1..3'"]);
}

#[test]
fn paths_values_and_files_without_end_are_refused() {
    let deep = ["a"; 20_000].join(".") + "=1";
    let list = format!("a={}{}", "[".repeat(20_000), "]".repeat(20_000));
    let tables = format!("a={}1{}", "{a.a.a.a=".repeat(60), "}".repeat(60));
    let key = format!("student.{}=1", "x".repeat(100_000));
    for assignment in [&deep, &list, &tables, &key] {
        let args = ["run", "--env", "Point", "--curriculum", "teach", "--set", assignment];
        refused(&args, &["--set"]);
        let message = stderr(&goalbench(&args));
        assert!(message.len() < 1000, "{} bytes", message.len());
    }
    let mut many = vec!["run", "--env", "Point", "--curriculum", "teach", "--print-config"];
    many.extend(["--set", "student.batch=3"].repeat(5_000));
    assert!(goalbench(&many).status.success());
}

#[test]
fn what_is_repeated_of_the_command_line_is_short_and_harmless() {
    let long = "a".repeat(100_000);
    let odd = "\u{1b}[31mred\nand\u{202e}more";
    let run = |more: &[&str]| {
        let args: Vec<String> = ["run", "--env", "Point", "--curriculum", "teach"]
            .iter()
            .chain(more)
            .map(|&arg| arg.to_owned())
            .collect();
        args
    };
    let alone = |args: &[&str]| args.iter().map(|&arg| arg.to_owned()).collect::<Vec<_>>();
    for word in [long.as_str(), odd] {
        let option = format!("--{word}");
        for args in [
            run(&["--steps", word]),
            run(&["--jobs", word]),
            run(&["--retries", word]),
            run(&["--executor", word]),
            run(&["--device", word, "--dry-run"]),
            run(&["--set", word]),
            run(&[&option]),
            run(&[&option[1..]]),
            run(&["one.toml", word]),
            run(&["--seeds", word]),
            run(&["--preset", word]),
            run(&["--out", &format!("-{word}")]),
            alone(&[word]),
            alone(&["help", word]),
            alone(&["list", word]),
            alone(&["report", "x", "--failures", word]),
            alone(&["report", "x", "--confidence", word]),
            alone(&["report", "x", "--title", &format!("{word}\n")]),
            alone(&["evaluate", "x", "--seed", word]),
            alone(&["render", "--env", word, "--out", "x.gif"]),
            alone(&["profile", "--env", "Point", "--curriculum", word]),
            alone(&["regress", "check", "--baseline", "x", "--alpha", word]),
            alone(&["status", word]),
            alone(&["verify", word]),
            alone(&["run", word]),
        ] {
            let args: Vec<&str> = args.iter().map(String::as_str).collect();
            let output = goalbench(&args);
            let message = stderr(&output);
            let what = args.iter().map(|arg| &arg[..arg.len().min(20)]).collect::<Vec<_>>();
            assert_eq!(output.status.code(), Some(2), "{what:?}: {message:.300}");
            assert!(message.len() < 1500, "{what:?}: {} bytes", message.len());
            assert!(!message.contains(['\u{1b}', '\u{202e}']), "{what:?}: {message:?}");
            // Clap takes escapes out where it may not colour: what is left must still tell what was typed.
            assert!(
                word != odd || !message.contains("red") || message.contains("u001b"),
                "{what:?}: {message:?}"
            );
        }
    }
}

#[test]
fn blanks_around_numbers_and_names_do_no_harm() {
    let printed = |args: &[&str]| {
        let output = goalbench(&[args, &["--print-config"]].concat());
        assert!(output.status.success(), "{args:?}: {}", stderr(&output));
        stdout(&output)
    };
    let text = printed(&["run", "--env", " Point, MazeA", "--curriculum", "teach , vds", "--steps", " 2k "]);
    for cell in ["Point/teach", "MazeA/vds"] {
        assert!(text.contains(cell), "{text}");
    }
    let with = ["run", "--env", "Point", "--curriculum", "teach"];
    for number in [" 3", "3 ", "1_0", "1e1"] {
        for option in ["--jobs", "--retries", "--steps", "--seeds"] {
            printed(&[&with[..], &[option, number]].concat());
        }
    }
}

#[test]
fn what_an_option_broke_is_told_of_that_option() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = write(
        folder.path(),
        &format!("{HEAD}[curriculum.teach]\nrenewal = 200\n[evaluation]\nevery = 100\n"),
    );
    for (assignment, field) in [
        ("curriculum.teach.window=1e8", "curriculum.teach.renewal: must be at least"),
        ("student.episodes_per_cycle=1000", "evaluation.every: is "),
    ] {
        for start in [&["run", "--env", "Point", "--curriculum", "teach"][..], &["run", &path]] {
            let args = [start, &["--dry-run", "--set", assignment]].concat();
            refused_plainly(&args, &[&format!("goalbench: --set {assignment}: {field}")]);
        }
    }
    let path = write(folder.path(), &format!("{HEAD}[curriculum.teach]\nwindow = 1000\n"));
    refused_plainly(&["run", &path, "--dry-run"], &[&format!("{path}:6: curriculum.teach.renewal: must be")]);
}

#[test]
fn what_changes_nothing_is_said() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let warned = |args: &[&str], expected: &[&str]| {
        let output = goalbench(&[args, &["--print-config"]].concat());
        assert!(output.status.success(), "{args:?}: {}", stderr(&output));
        let message = stderr(&output);
        for part in expected {
            assert!(message.contains(part), "{args:?}: expected {part:?} in\n{message}");
        }
        assert_eq!(message.lines().count(), expected.len(), "{args:?}: {message}");
    };
    let head = HEAD.replace("['teach']", "['teach', 'her-iid']");
    let of = |text: &str| write(folder.path(), &format!("{head}{text}"));
    let variants = "[[variant]]\nlabel = 'n3'\nset = { curriculum.teach.window = 3 }\n\
                    [[variant]]\nlabel = 'n5'\nset = { curriculum.teach.window = 5 }\n";
    warned(&["run", &of(variants)], &["the variants n3, n5 are the same for her-iid on Point"]);
    let option = ["run", &of(variants), "--curriculum", "teach", "--set", "curriculum.teach.window=4"];
    warned(&option, &["the variants n3, n5 are the same for teach on Point"]);
    let path = of("[[override]]\nenvironments = ['MazeA']\nset = { student.batch = 3 }\n");
    warned(&["run", &path], &[":7: this override changes nothing: no run has the environment MazeA"]);
    let path = of("[[override]]\ncurricula = ['vds']\nset = { student.batch = 3 }\n");
    warned(&["run", &path], &["this override changes nothing: no run has the curriculum vds"]);
    let path = of("[[override]]\nset = { curriculum.vds.members = 4 }\n");
    warned(&["run", &path], &["it sets options of vds, which is the curriculum of none of its runs"]);
    warned(&["run", &of("[curriculum.vds]\nmembers = 4\n")], &["curriculum.vds changes nothing"]);
    let alone = ["run", "--env", "Point", "--curriculum", "her-iid", "--set", "curriculum.teach.window=4"];
    warned(&alone, &["--set curriculum.teach.window=4: changes nothing: no run has the curriculum teach"]);
    // What the command line leaves out is no mistake of the document, nor is anything in a preset.
    let path = of("[[override]]\ncurricula = ['her-iid']\nset = { student.batch = 3 }\n");
    warned(&["run", &path, "--curriculum", "teach"], &[]);
    for preset in
        ["smoke", "quickstart", "reduced", "ambiguity", "ablation-window", "ablation-polyak", "paper"]
    {
        warned(&["run", "--preset", preset], &[]);
    }
}
