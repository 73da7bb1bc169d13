//! Questions to a process of this program's own: whatever happens to that process, and however long it takes,
//! harms nothing.

use std::io::{BufRead, BufReader, Write};
use std::process::{Command, ExitStatus, Stdio};
use std::sync::mpsc;
use std::time::{Duration, Instant};

use rustix::process::{Signal, set_parent_process_death_signal};
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::local::this_program;
use crate::error::HarnessError;

/// What came of an errand.
pub(crate) struct Errand<A> {
    /// The answers, in the order in which they came.
    pub(crate) answers: Vec<A>,
    /// How the process ended; `None` if it was ended because the time was over.
    pub(crate) end: Option<ExitStatus>,
}

/// Starts this program with `arguments`, writes `questions` to it, a JSON line each, and takes its answers, a
/// JSON line each, until it ends or `patience` does.
///
/// # Errors
/// [`HarnessError::Io`] if it cannot be started.
pub(crate) fn ask<A: DeserializeOwned + Send + 'static>(
    arguments: &[String],
    questions: &[impl Serialize],
    patience: Duration,
) -> Result<Errand<A>, HarnessError> {
    let mut input = Vec::new();
    for question in questions {
        serde_json::to_writer(&mut input, question).expect("a question is plain data");
        input.push(b'\n');
    }
    let program = this_program()?;
    let mut child = Command::new(program)
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .map_err(HarnessError::io(program, "run this program"))?;
    let mut stdin = child.stdin.take().expect("stdin is piped");
    // If the process is gone, its end tells.
    let writer = std::thread::spawn(move || drop(stdin.write_all(&input)));
    let lines = BufReader::new(child.stdout.take().expect("stdout is piped")).lines();
    let (sender, receiver) = mpsc::channel();
    let reader = std::thread::spawn(move || {
        let answers = lines.map_while(|line| serde_json::from_str::<A>(&line.ok()?).ok());
        // Nobody listens any more once the time is over.
        let _ = answers.map(|answer| sender.send(answer)).take_while(Result::is_ok).count();
    });
    let begun = Instant::now();
    let mut answers = Vec::new();
    let is_over = loop {
        match receiver.recv_timeout(patience.saturating_sub(begun.elapsed())) {
            Ok(answer) => answers.push(answer),
            Err(mpsc::RecvTimeoutError::Disconnected) => break false,
            Err(mpsc::RecvTimeoutError::Timeout) => break true,
        }
    };
    if is_over {
        // If it has just ended, there is nothing to end.
        let _ = child.kill();
    }
    let end = child.wait().map_err(HarnessError::io(program, "wait for this program"))?;
    let _ = (writer.join(), reader.join());
    Ok(Errand { answers, end: (!is_over).then_some(end) })
}

/// What a process that was asked does first: without the one that asked, nobody needs its answers.
///
/// # Errors
/// [`HarnessError::System`].
pub(crate) fn end_with_asker() -> Result<(), HarnessError> {
    set_parent_process_death_signal(Some(Signal::KILL))
        .map_err(|error| HarnessError::system("listen for the parent's death")(std::io::Error::from(error)))
}

/// The questions, as they come.
///
/// # Errors
/// [`HarnessError::System`] if one cannot be read.
pub(crate) fn questions<Q: DeserializeOwned>() -> impl Iterator<Item = Result<Q, HarnessError>> {
    let broken = || HarnessError::system("read what was asked");
    std::io::stdin().lines().map(move |line| {
        serde_json::from_str(&line.map_err(broken())?).map_err(|error| broken()(error.into()))
    })
}

/// Writes an answer.
///
/// # Errors
/// [`HarnessError::System`] if nobody listens.
pub(crate) fn answer(answer: &impl Serialize) -> Result<(), HarnessError> {
    let mut text = serde_json::to_vec(answer).expect("an answer is plain data");
    text.push(b'\n');
    let mut out = std::io::stdout().lock();
    out.write_all(&text).and_then(|()| out.flush()).map_err(HarnessError::system("answer"))
}
