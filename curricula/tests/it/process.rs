//! A curriculum that is a program: it keeps the contract, and programs that misbehave are told apart, ended,
//! and leave nobody behind.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use curricula::testing::{Class, contract_with};
use curricula::{CurriculumError, ProposedGoal};
use tempfile::TempDir;

use crate::support::entry;

/// Where the helper lies.
const HELPER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/python");

/// A program in Python, in a folder of its own beside the helper.
struct Program {
    folder: TempDir,
}

impl Program {
    /// A program of these lines; `serve` and `Curriculum` are imported.
    fn with_helper(text: &str) -> Self {
        let import = "from goalbench_curriculum import NATIVE, Curriculum, Proposal, serve\n";
        let program = Self::raw(&format!("import os, sys, time, math, subprocess\n{import}{text}"));
        let helper = Path::new(HELPER).join("goalbench_curriculum.py");
        std::fs::copy(helper, program.folder.path().join("goalbench_curriculum.py")).expect("a copy");
        program
    }

    /// A program that speaks for itself.
    fn raw(text: &str) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        std::fs::write(folder.path().join("teacher.py"), text).expect("it can be written");
        Self { folder }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// The config that starts it. Programs that are not silent get all the time that a busy machine needs.
    fn config(&self, timeout: f64) -> String {
        let command = format!("python3 {}", self.path("teacher.py").display());
        format!("command = {command:?}\ntimeout = {timeout:?}")
    }

    fn class(&self) -> Result<Class, CurriculumError> {
        Class::with(entry("process"), &self.config(60.0), 12, |_, _| -1.0)
    }

    /// What it says that goes wrong, in one episode at most.
    fn failure(&self, timeout: f64) -> String {
        let begun = Class::with(entry("process"), &self.config(timeout), 12, |_, _| -1.0);
        let error = begun.and_then(|mut class| class.propose()).expect_err("it must not go well");
        chain(&error)
    }
}

fn chain(error: &dyn std::error::Error) -> String {
    match error.source() {
        Some(source) => format!("{error}: {}", chain(source)),
        None => error.to_string(),
    }
}

/// Teaches with all that there is: it weighs, asks and remembers.
const ALL_THERE_IS: &str = r#"
class All(Curriculum):
    def begin(self):
        self.seen = []
        self.weights = [1 / len(self.pool)] * len(self.pool)
        self.statistics = {"mean_confidence": math.nan, "episodes": 0}

    def propose(self, lesson):
        values = lesson.confidence()
        tries, successes = lesson.history()
        assert sum(tries) == len(self.seen) and sum(successes) == sum(success for _, success in self.seen)
        fresh, states = lesson.fresh_goals(3), lesson.replay_states(4)
        few = lesson.confidence(goals=fresh, states=[lesson.state], network="target")
        assert len(values) == len(self.pool) and len(few) == 3 and len(lesson.replay_achieved(2)) in (0, 2)
        weights = [1 + tried + abs(fresh[0][0]) + len(states) * i for i, tried in enumerate(tries)]
        self.weights = [weight / sum(weights) for weight in weights]
        self.statistics = {"mean_confidence": sum(values) / len(values), "episodes": len(self.seen)}
        index = self.random.draw(self.weights)
        return Proposal(index, score=values[index] + self.random.gauss(0, 1), rank=(index, len(self.pool)))

    def observe(self, episode):
        assert episode.goal == self.pool[episode.index] and len(episode.achieved) == self.spec["goal"]
        assert -self.spec["horizon"] <= episode.total_reward <= 0
        self.seen.append((episode.index, episode.success))

serve(All)
"#;

#[test]
fn a_program_that_uses_all_there_is_keeps_the_contract() {
    let program = Program::with_helper(ALL_THERE_IS);
    contract_with(entry("process"), &program.config(60.0));
}

/// Comes back, with every second goal, to what it said when it began: a resumed run has to hear of it again.
#[test]
fn a_program_that_returns_to_its_first_weights_keeps_the_contract() {
    let text = "
class Turns(Curriculum):
    def begin(self):
        self.turn = 0
        self.tell()
    def tell(self):
        more = self.turn % 2
        self.weights = [(1 + (i == more)) / (len(self.pool) + 1) for i in range(len(self.pool))]
        self.statistics = {'more': more}
    def propose(self, lesson):
        self.turn += 1
        self.tell()
        return self.random.draw(self.weights)
serve(Turns)";
    contract_with(entry("process"), &Program::with_helper(text).config(60.0));
}

#[test]
fn goals_of_its_own_and_of_the_environment_are_taken_over() {
    let text = "
class Own(Curriculum):
    def begin(self):
        self.count = 0
    def propose(self, lesson):
        self.count += 1
        return NATIVE if self.count % 2 else [0.25, -0.5]
serve(Own)";
    let mut class = Program::with_helper(text).class().unwrap();
    let goals: Vec<ProposedGoal> = (0..3).map(|_| class.propose().unwrap().goal).collect();
    let own = ProposedGoal::Other(vec![0.25, -0.5]);
    assert_eq!(goals, [ProposedGoal::Native, own, ProposedGoal::Native]);
    assert_eq!(class.teacher.summary().weights, None);
}

/// Ways of going wrong in `propose`, and what the error must say.
#[test]
fn answers_that_do_not_fit_are_told_apart() {
    let cases = [
        ("return [math.nan, 0.0]", "number 0 of the goal is nan; every number must be finite"),
        ("return [0.0, 0.0, 0.0]", "the goal has 3 numbers; goals of this task have 2"),
        ("return 12", "the goal is 12; the pool has the goals 0 to 11"),
        ("return -1", "the goal is -1; the pool has the goals 0 to 11"),
        ("return 1.5", "the goal is 1.5; the pool has the goals 0 to 11"),
        ("return [1e39, 0.0]", "number 0 of the goal is 1e+39"),
        ("return 'any'", "the goal is \"any\"; an index into the pool, \"native\""),
        ("return None", "propose returned None"),
        ("return ['a', 0.0]", "number 0 of the goal is a"),
        ("raise KeyError('mine')", "ended (exit status: 1) when it was to answer `propose`"),
        ("raise KeyError('mine')", "KeyError: 'mine'"),
        ("os.kill(os.getpid(), 9)", "ended (signal: 9 (SIGKILL)) when it was to answer `propose`"),
        ("sys.exit(0)", "ended (exit status: 0) when it was to answer `propose`"),
        ("self.weights = [1.0]; return 0", "it told no weights when it began"),
        ("self.statistics = {'new': 1}; return 0", "its numbers are [new]; when it began they were []"),
        ("self.statistics = {'new': 1e39}; return 0", "the number `new` is 1e+39; at most 3.4"),
        ("return Proposal(0, rank=(3, 3))", "rank [3, 3]"),
        ("lesson.confidence(goals=[[1.0]])", "goals of 1 numbers; this task's have 2"),
        ("lesson.confidence(goals=[])", "it asks for the confidence in no goals"),
        ("lesson.fresh_goals(10**9)", "it asks for 1000000000 rows"),
        ("print('hello'); raise SystemExit('gone')", "it had said: hello | gone"),
    ];
    for (line, expected) in cases {
        let text =
            format!("class Bad(Curriculum):\n    def propose(self, lesson):\n        {line}\nserve(Bad)");
        let said = Program::with_helper(&text).failure(60.0);
        assert!(said.contains(expected), "{line}: {said}");
    }
}

/// A program without the helper that says `ready` and then does this.
fn raw(then: &str) -> Program {
    let ready = r#"print('{"type": "ready", "protocol": 1}', flush=True)"#;
    Program::raw(&format!("import os, sys, time\nsys.stdin.readline()\n{ready}\n{then}\n"))
}

#[test]
fn programs_that_do_not_speak_the_protocol_are_told_apart() {
    let cases = [
        ("sys.stdin.readline(); print('hello', flush=True); time.sleep(60)", "`hello`, which is no message"),
        ("sys.stdin.readline(); print('hello', flush=True); time.sleep(60)", "belongs on standard error"),
        // In one piece with a good answer.
        (
            r#"sys.stdin.readline(); os.write(1, b'debug\n{"type": "goal", "goal": 0}\n'); time.sleep(60)"#,
            "`debug`, which is no message",
        ),
        // Too early or as an answer, as it happens to come; it is repeated either way.
        ("print('{}', flush=True); time.sleep(60)", "`{}`"),
        (
            r#"sys.stdin.readline(); print('{"type": "goal", "goal": [NaN, 0]}', flush=True); time.sleep(60)"#,
            "JSON has neither NaN nor Infinity",
        ),
        (
            r#"sys.stdin.readline(); print('{"type": "heard"}', flush=True); time.sleep(60)"#,
            "a message of type `heard` is no answer to it",
        ),
        (
            r#"sys.stdin.readline(); print('{"type": "goal", "goal": 0, "gaol": 1}', flush=True); time.sleep(60)"#,
            "unknown field `gaol`",
        ),
        ("sys.stdin.readline(); os.write(1, b'\\xff\\x00\\n'); time.sleep(60)", "which is no message"),
        ("os.close(1); time.sleep(60)", "closed its standard output before it answered `propose`"),
        ("sys.stderr.write('bye'); sys.exit(3)", "ended (exit status: 3)"),
        ("sys.stderr.write('bye'); sys.exit(3)", "it had said: bye"),
    ];
    for (then, expected) in cases {
        let said = raw(then).failure(60.0);
        assert!(said.contains(expected), "{then}: {said}");
    }
    let other = Program::raw(
        "import time\nprint('{\"type\": \"ready\", \"protocol\": 2}', flush=True)\ntime.sleep(60)",
    );
    assert!(other.failure(60.0).contains("speaks protocol 2; this goalbench speaks 1"));
}

#[test]
fn a_silent_program_is_given_up_whether_it_listens_or_not() {
    let begun = Instant::now();
    let said = raw("sys.stdin.readline(); print('thinking', file=sys.stderr, flush=True); time.sleep(600)")
        .failure(5.0);
    assert!(said.contains("no answer to `propose` within 5 s (curriculum.process.timeout)"), "{said}");
    assert!(said.contains("it had said: thinking"), "{said}");
    // A pool that no pipe holds, and a program that never reads.
    let deaf = Program::raw("import time\ntime.sleep(600)");
    let result = Class::with(entry("process"), &deaf.config(2.0), 20_000, |_, _| -1.0).map(drop);
    let said = chain(&result.expect_err("it never answers"));
    assert!(said.contains("no answer to `hello` within 2 s"), "{said}");
    // One that asks for ever is silent, too.
    let text = "
class Curious(Curriculum):
    def propose(self, lesson):
        while True:
            lesson.history()
serve(Curious)";
    let said = Program::with_helper(text).failure(5.0);
    assert!(said.contains("no answer to `"), "{said}");
    assert!(begun.elapsed() < Duration::from_secs(60), "{:?}", begun.elapsed());
}

#[test]
fn a_command_that_cannot_be_started_is_refused_by_name() {
    let refusal =
        |config: &str| chain(&Class::with(entry("process"), config, 3, |_, _| 0.0).map(drop).unwrap_err());
    let said = refusal("command = \"no-such-program --x\"");
    assert!(said.contains("program `no-such-program` cannot be started: No such file"), "{said}");
    assert!(refusal("").contains("command: must be a command such as"), "{}", refusal(""));
    assert!(refusal("command = \"python 'x\"").contains("quotes that close"));
    assert!(refusal("command = \"python x.py\"\ntimeout = 0.0").contains("timeout: must be above 0"));
    assert!(refusal("command = \"python x.py\"\ntitle = \"a\\nb\"").contains("title: must be a line"));
}

/// Whether the process with the id in `file` lives; it is written soon.
fn lives(file: &Path) -> bool {
    let begun = Instant::now();
    let id = loop {
        match std::fs::read_to_string(file) {
            Ok(text) if text.ends_with('\n') => break text.trim().to_owned(),
            _ => assert!(begun.elapsed() < Duration::from_secs(60), "no {}", file.display()),
        }
        std::thread::sleep(Duration::from_millis(5));
    };
    // A zombie is dead, whether or not somebody waits for it.
    let stat = std::fs::read_to_string(format!("/proc/{id}/stat")).unwrap_or_default();
    stat.rsplit(')').next().is_some_and(|rest| !rest.is_empty() && !rest.trim_start().starts_with('Z'))
}

/// Waits until nobody lives any more.
fn assert_gone(files: &[PathBuf]) {
    let begun = Instant::now();
    while files.iter().any(|file| lives(file)) {
        assert!(begun.elapsed() < Duration::from_secs(20), "an orphan is left");
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// Writes its own id and that of a child, both of which ignore every hint to go.
const FAMILY: &str = r#"
import signal
here = os.path.dirname(os.path.abspath(__file__))
def stay(name):
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    with open(os.path.join(here, name), "w") as file:
        file.write(f"{os.getpid()}\n")
if os.fork() == 0:
    stay("child")
    time.sleep(600)
stay("parent")
child = os.path.join(here, "child")
while not (os.path.exists(child) and os.path.getsize(child)):
    time.sleep(0.01)
"#;

#[test]
fn nobody_outlives_a_teacher_not_even_who_forks_and_stays() {
    for then in [
        "sys.stdin.readline(); print('noise', flush=True); time.sleep(600)",
        "time.sleep(600)",
        "sys.exit(1)",
    ] {
        let program = raw(&format!("{FAMILY}\n{then}"));
        drop(program.failure(2.0));
        assert_gone(&[program.path("parent"), program.path("child")]);
    }
    // Also where nothing went wrong.
    let program = raw(&format!("{FAMILY}\ntime.sleep(600)"));
    drop(program.class().unwrap());
    assert_gone(&[program.path("parent"), program.path("child")]);
}

#[test]
fn what_the_files_of_a_command_say_is_part_of_its_version() {
    let program = Program::raw("first");
    let version = |program: &Program| {
        (entry("process").configure)(program.config(1.0).parse().unwrap()).unwrap().version()
    };
    let first = version(&program);
    assert!(first.starts_with("1, teacher.py a7937b64b8ca"), "{first}");
    std::fs::write(program.path("teacher.py"), "second").unwrap();
    assert_ne!(version(&program), first);
    assert_eq!((entry("teach").configure)(toml::Table::new()).unwrap().version(), entry("teach").version);
}
