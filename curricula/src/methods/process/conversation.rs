//! A program at the other end of three pipes: said to, listened to, and ended.
//!
//! Nothing here waits for ever. Pipes are never blocked on, and every answer has a deadline; one that is
//! missed, or an answer that is none, ends the program.
//!
//! Nor does a program outlive its conversation. It leads a process group of its own, with all that it starts,
//! and the whole group is killed at the end. If goalbench itself is killed, [`Watch`] does that. Only what
//! leaves the group on purpose (`setsid`) is out of reach.

use std::io::{self, ErrorKind, Read, Write};
use std::os::fd::AsFd;
use std::os::unix::process::CommandExt;
use std::process::{Child, ChildStderr, ChildStdin, ChildStdout, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::ioctl_fionbio;
use rustix::process::{Pid, Signal, WaitId, WaitIdOptions, kill_process_group, waitid};

use super::error::{LastWords, ProcessError};
use super::wire::{Answer, Message};

/// The longest answer, in bytes: the weights of a pool of a million goals have room in it.
const LONGEST: usize = 64 << 20;
/// Bytes of standard error that are kept for errors.
const KEPT: usize = 4 << 10;
/// Characters of an answer that errors show.
const SHOWN: usize = 100;
/// Time between two looks at whether the program still lives, while its pipes are silent.
const LOOK: Duration = Duration::from_millis(100);
/// How long a program may take to end by itself once its standard input is closed.
const GRACE: Duration = Duration::from_secs(2);
/// Time between two looks at whether it has.
const PAUSE: Duration = Duration::from_millis(2);

/// A program that runs.
pub(super) struct Conversation {
    child: Child,
    stdin: Option<ChildStdin>,
    stdout: ChildStdout,
    stderr: Option<ChildStderr>,
    /// What it said on standard output and nobody took yet.
    heard: Vec<u8>,
    /// The end of what it said on standard error.
    complaints: Vec<u8>,
    watch: Watch,
    ended: Option<ExitStatus>,
    /// How long an answer may take.
    timeout: Duration,
}

impl Conversation {
    /// Starts the program, which may take `timeout` for an answer.
    ///
    /// # Errors
    /// [`ProcessError::Start`].
    pub(super) fn begin(words: &[String], timeout: Duration) -> Result<Self, ProcessError> {
        let (program, arguments) = words.split_first().expect("a command was checked");
        let cannot_start = |source| ProcessError::Start { program: program.clone(), source };
        let mut command = Command::new(program);
        command.args(arguments).process_group(0);
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        // Python visits sets of strings in an order that otherwise differs from start to start.
        command.env("PYTHONHASHSEED", "0");
        // Runs go side by side, one thread each.
        if std::env::var_os("OMP_NUM_THREADS").is_none() {
            command.env("OMP_NUM_THREADS", "1");
        }
        let mut child = command.spawn().map_err(cannot_start)?;
        let (stdin, stdout, stderr) = (child.stdin.take(), child.stdout.take(), child.stderr.take());
        let stdout = stdout.expect("standard output is piped");
        let watch = Watch::over(&child);
        let (heard, complaints) = (Vec::new(), Vec::new());
        let watched = watch.map_err(|source| {
            end_group(&child);
            drop(child.wait());
            ProcessError::Talk(source)
        });
        let conversation =
            Self { watch: watched?, child, stdin, stdout, stderr, heard, complaints, ended: None, timeout };
        conversation.unblock().map_err(ProcessError::Talk)?;
        Ok(conversation)
    }

    fn unblock(&self) -> io::Result<()> {
        ioctl_fionbio(&self.stdout, true)?;
        self.stdin.iter().try_for_each(|pipe| ioctl_fionbio(pipe, true))?;
        self.stderr.iter().try_for_each(|pipe| ioctl_fionbio(pipe, true))?;
        Ok(())
    }

    /// When an answer to what is said now is overdue.
    pub(super) fn deadline(&self) -> Instant {
        Instant::now() + self.timeout
    }

    /// Says `message` and waits for the answer, until `deadline` at most.
    ///
    /// # Errors
    /// [`ProcessError`] if there is no answer, or none that is one. The program is ended then.
    pub(super) fn exchange(
        &mut self,
        message: &Message<'_>,
        deadline: Instant,
    ) -> Result<Answer, ProcessError> {
        let result = self.talk(message, deadline);
        if result.is_err() {
            self.end();
        }
        result
    }

    fn talk(&mut self, message: &Message<'_>, deadline: Instant) -> Result<Answer, ProcessError> {
        let mut line = serde_json::to_vec(message).expect("a message is plain data");
        line.push(b'\n');
        // What is left to say, and how much of what was heard holds no end of a line.
        let (mut pending, mut searched) = (line.as_slice(), 0);
        self.listen().map_err(ProcessError::Talk)?;
        if !self.heard.is_empty() {
            return Err(ProcessError::Unasked { said: shown(&self.heard) });
        }
        loop {
            pending = self.say(pending).map_err(ProcessError::Talk)?;
            let goes_on = self.listen().map_err(ProcessError::Talk)?;
            self.overhear();
            if let Some(end) = self.heard[searched..].iter().position(|&byte| byte == b'\n') {
                let rest = self.heard.split_off(searched + end + 1);
                let answer = std::mem::take(&mut self.heard);
                // A line that is no message says more than what came after it.
                let understood = understand(message.name(), &answer)?;
                return match () {
                    () if !rest.is_empty() => Err(ProcessError::Unasked { said: shown(&rest) }),
                    () if !pending.is_empty() => Err(ProcessError::Unasked { said: shown(&answer) }),
                    () => Ok(understood),
                };
            }
            searched = self.heard.len();
            if searched > LONGEST {
                return Err(ProcessError::TooLong { message: message.name(), most: LONGEST });
            }
            if !goes_on || self.is_over() {
                return Err(self.farewell(message.name()));
            }
            if !self.wait(deadline, !pending.is_empty()).map_err(ProcessError::Talk)? {
                self.overhear();
                let seconds = self.timeout.as_secs_f64();
                let words = LastWords::of(&self.complaints);
                return Err(ProcessError::Silent { message: message.name(), seconds, words });
            }
        }
    }

    /// The error for an answer to `message` that is well formed and yet not what was asked; it ends the
    /// program.
    pub(super) fn unexpected(&mut self, message: &Message<'_>, answer: &Answer) -> ProcessError {
        self.wrong(message, format!("a message of type `{}` is no answer to it", answer.name()))
    }

    /// The same for what an answer says.
    pub(super) fn wrong(&mut self, message: &Message<'_>, reason: String) -> ProcessError {
        self.end();
        ProcessError::Wrong { message: message.name(), reason }
    }

    /// Waits until a pipe is ready or it is time to look again; `false` once the deadline is over.
    fn wait(&self, deadline: Instant, is_writing: bool) -> io::Result<bool> {
        let left = deadline.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Ok(false);
        }
        let mut pipes = vec![PollFd::from_borrowed_fd(self.stdout.as_fd(), PollFlags::IN)];
        if let Some(stderr) = &self.stderr {
            pipes.push(PollFd::from_borrowed_fd(stderr.as_fd(), PollFlags::IN));
        }
        if let (Some(stdin), true) = (&self.stdin, is_writing) {
            pipes.push(PollFd::from_borrowed_fd(stdin.as_fd(), PollFlags::OUT));
        }
        let time = Timespec::try_from(left.min(LOOK)).map_err(io::Error::other)?;
        match poll(&mut pipes, Some(&time)) {
            Ok(_) | Err(rustix::io::Errno::INTR) => Ok(true),
            Err(error) => Err(error.into()),
        }
    }

    /// Writes as much as the pipe takes; what is left. A program that does not listen any more is told
    /// nothing: what it says, or its end, tells the rest.
    fn say<'a>(&mut self, mut bytes: &'a [u8]) -> io::Result<&'a [u8]> {
        let Some(stdin) = &mut self.stdin else { return Ok(&[]) };
        while !bytes.is_empty() {
            match stdin.write(bytes) {
                Ok(written) => bytes = &bytes[written..],
                Err(error) if error.kind() == ErrorKind::WouldBlock => break,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) if error.kind() == ErrorKind::BrokenPipe => {
                    self.stdin = None;
                    return Ok(&[]);
                }
                Err(error) => return Err(error),
            }
        }
        Ok(bytes)
    }

    /// Takes in what is there of standard output; `false` once it is closed.
    fn listen(&mut self) -> io::Result<bool> {
        read(&mut self.stdout, |bytes| self.heard.extend_from_slice(bytes), LONGEST)
    }

    /// Takes in what is there of standard error, and passes it on to goalbench's own, which the run's folder
    /// keeps.
    fn overhear(&mut self) {
        let Some(stderr) = &mut self.stderr else { return };
        let complaints = &mut self.complaints;
        let keep = |bytes: &[u8]| {
            drop(io::stderr().write_all(bytes));
            complaints.extend_from_slice(bytes);
            let more = complaints.len().saturating_sub(KEPT);
            complaints.drain(..more);
        };
        if !read(stderr, keep, KEPT).unwrap_or(false) {
            self.stderr = None;
        }
    }

    /// Whether the program has ended, whoever else may hold its pipes.
    fn is_over(&self) -> bool {
        let options = WaitIdOptions::EXITED | WaitIdOptions::NOHANG | WaitIdOptions::NOWAIT;
        // It stays to be waited for, so that nobody else gets its id before its group is killed.
        self.ended.is_some() || !matches!(waitid(WaitId::Pid(id(&self.child)), options), Ok(None))
    }

    /// Waits a little for the program to end by itself.
    fn await_end(&self) -> bool {
        let begun = Instant::now();
        while !self.is_over() {
            if begun.elapsed() > GRACE {
                return false;
            }
            std::thread::sleep(PAUSE);
        }
        true
    }

    /// Why there is no answer to `message` any more.
    fn farewell(&mut self, message: &'static str) -> ProcessError {
        let ended = self.await_end();
        self.overhear();
        self.end();
        let words = LastWords::of(&self.complaints);
        match self.ended {
            Some(status) if ended => ProcessError::Ended { status, message, words },
            _ => ProcessError::Closed { message, words },
        }
    }

    /// Ends the program now, with all that it started.
    fn end(&mut self) {
        if self.ended.is_none() {
            self.stdin = None;
            self.watch.dismiss();
            end_group(&self.child);
            self.ended = self.child.wait().ok();
        }
    }
}

impl Drop for Conversation {
    fn drop(&mut self) {
        // The end of its input is the sign to go.
        self.stdin = None;
        self.await_end();
        self.overhear();
        self.end();
    }
}

/// Reads what is there, up to about `most` bytes; `false` at the end.
fn read(pipe: &mut impl Read, mut take: impl FnMut(&[u8]), most: usize) -> io::Result<bool> {
    let (mut buffer, mut total) = ([0; 64 << 10], 0);
    while total <= most {
        match pipe.read(&mut buffer) {
            Ok(0) => return Ok(false),
            Ok(count) => {
                take(&buffer[..count]);
                total += count;
            }
            Err(error) if error.kind() == ErrorKind::WouldBlock => break,
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(true)
}

/// The answer to `message` that a line is.
fn understand(message: &'static str, line: &[u8]) -> Result<Answer, ProcessError> {
    serde_json::from_slice(line).map_err(|source| {
        let text = String::from_utf8_lossy(line);
        let hint = match () {
            () if ["NaN", "Infinity"].iter().any(|word| text.contains(word)) => {
                " (JSON has neither NaN nor Infinity: every number of a goal must be finite)"
            }
            () if !text.trim_start().starts_with('{') => {
                " (standard output is for answers alone; everything else belongs on standard error)"
            }
            () => "",
        };
        ProcessError::NoMessage { message, said: shown(line), hint, source }
    })
}

/// The beginning of what was said, for people.
fn shown(said: &[u8]) -> String {
    let text = String::from_utf8_lossy(said);
    let mut start: String = text.trim_end().chars().take(SHOWN).collect();
    if start.len() < text.trim_end().len() {
        start += "...";
    }
    let plain = |c: char| if c.is_control() { c.escape_debug().to_string() } else { c.to_string() };
    format!("`{}`", start.chars().map(plain).collect::<String>())
}

fn id(child: &Child) -> Pid {
    let id = i32::try_from(child.id()).ok().and_then(Pid::from_raw);
    id.expect("ids of processes are positive")
}

/// Kills the group that `child` leads. That there is none any more is fine.
fn end_group(child: &Child) {
    let _ = kill_process_group(id(child), Signal::KILL);
}

/// A shell that waits for goalbench to be gone: a pipe to it closes then, whatever way goalbench ended.
struct Watch(Child);

impl Watch {
    /// Kills the group of `child` when goalbench is no more.
    fn over(child: &Child) -> io::Result<Self> {
        let script = "read -r _; kill -s KILL -- \"-$1\"";
        let mut command = Command::new("/bin/sh");
        command.args(["-c", script, "goalbench-watch"]).arg(child.id().to_string());
        command.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::null());
        command.process_group(0).spawn().map(Self)
    }

    /// Ends the watch without harm to anybody.
    fn dismiss(&mut self) {
        drop(self.0.kill());
        drop(self.0.wait());
    }
}
