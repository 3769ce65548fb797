//! Processes that are started, watched and ended.

use std::io::{BufRead, BufReader};
use std::process::{Child, ChildStdin, Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::{Duration, Instant};

/// How often a thread that waits for a process looks whether it is still wanted.
const LOOK_EVERY: Duration = Duration::from_millis(20);
/// The longest line that is read: a number and a ticket fit many times.
const LONGEST: usize = 1 << 20;

/// What a process wrote, or why it did not.
pub(super) enum Heard {
    /// A line without its end.
    Line(String),
    /// It wrote no more lines.
    End,
    /// The time was up.
    Timeout,
    /// Nobody waits for it any more.
    Unwanted,
}

/// A running process whose lines are read by a thread.
pub(super) struct Process {
    child: Child,
    pub(super) stdin: Option<ChildStdin>,
    lines: Receiver<String>,
}

impl Process {
    /// Starts a program in a process group of its own, so that all of it can be ended. It inherits stderr.
    pub(super) fn start(words: &[String], talks: bool) -> Result<Self, String> {
        let mut command = Command::new(&words[0]);
        command
            .args(&words[1..])
            .stdin(if talks { Stdio::piped() } else { Stdio::null() })
            .stdout(Stdio::piped());
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        let mut child = command
            .spawn()
            .map_err(|error| format!("cannot start `{}`: {error}", words[0]))?;
        let (sender, lines) = channel();
        let stdin = child.stdin.take();
        if let Some(stdout) = child.stdout.take() {
            // The thread ends with the output, or when nobody listens.
            std::thread::Builder::new()
                .name("output".to_owned())
                .spawn(move || {
                    let mut reader = BufReader::new(stdout);
                    let mut line = Vec::new();
                    while matches!(read_line(&mut reader, &mut line), Ok(true)) {
                        if sender
                            .send(String::from_utf8_lossy(&line).trim_end().to_owned())
                            .is_err()
                        {
                            break;
                        }
                        line.clear();
                    }
                })
                .map_err(|error| format!("cannot start a thread: {error}"))?;
        }
        Ok(Self { child, stdin, lines })
    }

    /// The next line, until `deadline`, or until `unwanted`.
    pub(super) fn line(&self, deadline: Option<Instant>, unwanted: &AtomicBool) -> Heard {
        loop {
            if unwanted.load(Ordering::Relaxed) {
                return Heard::Unwanted;
            }
            let left = deadline.map_or(LOOK_EVERY, |deadline| deadline.saturating_duration_since(now()));
            if left.is_zero() {
                return Heard::Timeout;
            }
            match self.lines.recv_timeout(left.min(LOOK_EVERY)) {
                Ok(line) => return Heard::Line(line),
                Err(RecvTimeoutError::Disconnected) => return Heard::End,
                Err(RecvTimeoutError::Timeout) => {}
            }
        }
    }

    /// Waits for the end of a process that has closed its output; `None` if it does not come in time.
    pub(super) fn status(&mut self, deadline: Option<Instant>, unwanted: &AtomicBool) -> Option<ExitStatus> {
        loop {
            match self.child.try_wait() {
                Ok(Some(status)) => return Some(status),
                Ok(None) => {}
                Err(_) => return None,
            }
            let is_late = deadline.is_some_and(|deadline| now() >= deadline);
            if is_late || unwanted.load(Ordering::Relaxed) {
                return None;
            }
            std::thread::sleep(Duration::from_micros(200));
        }
    }
}

/// Ends the process and what it has started.
impl Drop for Process {
    fn drop(&mut self) {
        self.stdin = None;
        #[cfg(unix)]
        if let Some(group) = i32::try_from(self.child.id())
            .ok()
            .and_then(rustix::process::Pid::from_raw)
            && matches!(self.child.try_wait(), Ok(None))
        {
            // It may have ended since.
            let _ = rustix::process::kill_process_group(group, rustix::process::Signal::KILL);
        }
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Reads a line into an empty buffer, of at most [`LONGEST`] bytes; `false` at the end.
fn read_line(reader: &mut impl BufRead, line: &mut Vec<u8>) -> std::io::Result<bool> {
    loop {
        let bytes = reader.fill_buf()?;
        if bytes.is_empty() {
            return Ok(!line.is_empty());
        }
        let (taken, ends) = match bytes.iter().position(|&byte| byte == b'\n') {
            Some(end) => (end + 1, true),
            None => (bytes.len(), false),
        };
        let room = LONGEST.saturating_sub(line.len()).min(taken);
        line.extend_from_slice(&bytes[..room]);
        reader.consume(taken);
        if ends {
            return Ok(true);
        }
    }
}

/// Now, for limits of evaluations, which are not part of a result.
#[expect(clippy::disallowed_methods, reason = "decides when a process is given up")]
pub(super) fn now() -> Instant {
    Instant::now()
}
