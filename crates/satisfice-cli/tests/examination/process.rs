//! The command as a process with limits, and what it must never do.

use std::io::Read;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use serde_json::Value;

/// Longest time that a process may take on a damaged file.
const PATIENCE: Duration = Duration::from_secs(10);
/// When a process is interrupted: a damaged budget may ask for hours. Twice as late if it has not come to take interrupts by then.
const INTERRUPT: Duration = Duration::from_millis(400);
/// The signal of an interrupt.
const SIGINT: i32 = 2;
/// Limit of the address space, in kB. Threads reserve some of it without using it.
const MEMORY_KB: u64 = 1_500_000;
/// Longest error line, in bytes.
const LONGEST_LINE: usize = 2_000;

/// What a process did.
#[derive(Debug)]
pub(crate) struct Outcome {
    /// Its exit code; `None` if a signal ended it.
    pub(crate) code: Option<i32>,
    pub(crate) stdout: Vec<u8>,
    pub(crate) stderr: String,
    /// Whether it went on after [`PATIENCE`] and was killed.
    pub(crate) hung: bool,
}

/// The command with these arguments, in this folder.
pub(crate) fn command(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_satisfice"));
    command.args(arguments).current_dir(folder).stdin(Stdio::null());
    command
}

/// The command under a shell prefix such as `ulimit -f 8;`.
pub(crate) fn limited(folder: &Path, prefix: &str, arguments: &[&str]) -> Command {
    let mut command = Command::new("sh");
    command
        .arg("-c")
        .arg(format!("{prefix} exec \"$0\" \"$@\""))
        .arg(env!("CARGO_BIN_EXE_satisfice"))
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::null());
    command
}

/// Runs the command with a limit of memory and of time. A long run is interrupted, as a user would.
///
/// On a busy machine the interrupt may come before the process can take it: it has done nothing then, and is run again.
pub(crate) fn run(folder: &Path, arguments: &[&str]) -> Outcome {
    let mut interrupt = INTERRUPT;
    loop {
        let (outcome, signal) = run_once(folder, arguments, interrupt);
        if signal != Some(SIGINT) || interrupt > PATIENCE {
            return outcome;
        }
        interrupt *= 2;
    }
}

/// Runs the command once; also returns the signal that ended it.
fn run_once(folder: &Path, arguments: &[&str], interrupt: Duration) -> (Outcome, Option<i32>) {
    let prefix = format!("ulimit -v {MEMORY_KB};");
    let mut child = limited(folder, &prefix, arguments)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let (mut out, mut err) = (child.stdout.take().unwrap(), child.stderr.take().unwrap());
    let stdout = thread::spawn(move || {
        let mut bytes = Vec::new();
        out.read_to_end(&mut bytes).unwrap();
        bytes
    });
    let stderr = thread::spawn(move || {
        let mut bytes = Vec::new();
        err.read_to_end(&mut bytes).unwrap();
        String::from_utf8_lossy(&bytes).into_owned()
    });
    let hung = !ends_within(&mut child, PATIENCE, Some(interrupt));
    let status = child.wait().unwrap();
    let outcome = Outcome {
        code: status.code(),
        stdout: stdout.join().unwrap(),
        stderr: stderr.join().unwrap(),
        hung,
    };
    (outcome, status.signal())
}

/// Waits for the end; interrupts after a while if given, and kills at the end of the time.
#[expect(clippy::disallowed_methods, reason = "a process is watched from outside")]
pub(crate) fn ends_within(child: &mut Child, patience: Duration, mut interrupt: Option<Duration>) -> bool {
    let begun = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if begun.elapsed() > patience {
            child.kill().unwrap();
            return false;
        }
        if interrupt.take_if(|after| begun.elapsed() > *after).is_some() {
            signal(child, "INT");
        }
        thread::sleep(Duration::from_millis(2));
    }
    true
}

/// Sends a signal by its name.
pub(crate) fn signal(child: &Child, name: &str) {
    let sent = Command::new("kill")
        .args([format!("-{name}"), child.id().to_string()])
        .stderr(Stdio::null())
        .status();
    drop(sent); // a process that has ended meanwhile is fine
}

impl Outcome {
    /// What the process did that it must not do, on any input.
    pub(crate) fn fault(&self) -> Option<String> {
        let shown = || self.stderr.chars().take(400).collect::<String>();
        if self.hung {
            return Some(format!("it went on after {PATIENCE:?}: {}", shown()));
        }
        if self.stderr.contains("panicked") {
            return Some(format!("it panicked: {}", shown()));
        }
        match self.code {
            None => Some(format!("a signal ended it: {}", shown())),
            Some(0 | 1) => None,
            Some(2) => {
                let line = self.stderr.strip_suffix('\n').unwrap_or(&self.stderr);
                let last = line.lines().next_back().unwrap_or_default();
                let errors = line.lines().filter(|line| line.starts_with("error: ")).count();
                if errors != 1 || !last.starts_with("error: ") {
                    Some(format!("not one error line: {}", shown()))
                } else if last.len() > LONGEST_LINE {
                    Some(format!("an error line of {} bytes: {}", last.len(), shown()))
                } else if last.chars().any(char::is_control) {
                    Some(format!(
                        "control characters in an error line: {}",
                        shown().escape_debug()
                    ))
                } else {
                    None
                }
            }
            Some(code) => Some(format!("exit code {code}: {}", shown())),
        }
    }
}

/// A report without its times.
pub(crate) fn without_times(mut report: Value) -> Value {
    fn visit(value: &mut Value) {
        match value {
            Value::Object(map) => {
                map.retain(|key, _| !key.ends_with("seconds"));
                map.values_mut().for_each(visit);
            }
            Value::Array(list) => list.iter_mut().for_each(visit),
            _ => {}
        }
    }
    visit(&mut report);
    report
}
