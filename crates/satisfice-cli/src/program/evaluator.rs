//! One evaluation: by a program that is started for it, or by a worker that answers line by line.

use std::io::Write;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Deserializer};

use super::process::{Heard, Process, now};
use super::space::SpaceFile;
use super::template::Template;

/// A worker that ends so often before it has answered anything is given up.
const STILLBORN: u32 = 3;
/// The number of characters of a line that a message shows.
const SHOWN: usize = 200;

/// How evaluations are made.
#[derive(Debug, Clone)]
pub(super) enum Way {
    /// A program is started for each of them.
    Program(Template),
    /// Processes answer one after the other: the words of their command line.
    Worker(Vec<String>),
}

/// Why there is no value.
pub(super) enum Failure {
    /// This evaluation failed.
    Evaluation(String),
    /// So will all others.
    Fatal(String),
    /// Nobody wants the value any more.
    Unwanted,
}

/// What all evaluators have in common.
pub(super) struct Task {
    pub(super) way: Way,
    pub(super) space: SpaceFile,
    pub(super) timeout: Option<Duration>,
    pub(super) retries: u32,
    /// Raised when the search is over.
    pub(super) unwanted: AtomicBool,
}

/// Makes one evaluation after the other.
pub(super) struct Evaluator {
    task: Arc<Task>,
    worker: Option<Process>,
    /// How many workers in a row ended before they had answered anything.
    stillborn: u32,
    has_answered: bool,
}

/// An answer of a worker.
#[derive(Deserialize)]
#[serde(expecting = "an object with a ticket and a value")]
struct Reply {
    ticket: u64,
    /// `null`, which is no number, is not the same as no value.
    #[serde(default, deserialize_with = "present")]
    value: Option<serde_json::Value>,
    #[serde(default)]
    error: Option<String>,
}

fn present<'de, D: Deserializer<'de>>(from: D) -> Result<Option<serde_json::Value>, D::Error> {
    serde_json::Value::deserialize(from).map(Some)
}

impl Evaluator {
    pub(super) fn new(task: Arc<Task>) -> Self {
        Self {
            task,
            worker: None,
            stillborn: 0,
            has_answered: false,
        }
    }

    /// The value at a point, tried again after failures as often as allowed.
    pub(super) fn evaluate(&mut self, ticket: u64, point: &[f64]) -> Result<f64, Failure> {
        let task = Arc::clone(&self.task);
        let mut tries = 0;
        loop {
            let deadline = task.timeout.and_then(|timeout| now().checked_add(timeout));
            let result = match &task.way {
                Way::Program(template) => task.run_program(&template.words(point, &task.space), deadline),
                Way::Worker(words) => self.ask_worker(words, ticket, point, deadline),
            };
            match result {
                Err(Failure::Evaluation(_)) if tries < task.retries => tries += 1,
                other => return other,
            }
        }
    }

    fn ask_worker(
        &mut self,
        words: &[String],
        ticket: u64,
        point: &[f64],
        deadline: Option<Instant>,
    ) -> Result<f64, Failure> {
        let mut worker = match self.worker.take() {
            Some(worker) => worker,
            None => {
                self.has_answered = false;
                Process::start(words, true).map_err(Failure::Fatal)?
            }
        };
        let line = format!("{}\n", serde_json::json!({"ticket": ticket, "x": point}));
        let written = worker
            .stdin
            .as_mut()
            .map(|stdin| stdin.write_all(line.as_bytes()).and_then(|()| stdin.flush()));
        if !matches!(written, Some(Ok(()))) {
            return Err(self.died(worker, deadline));
        }
        loop {
            match worker.line(deadline, &self.task.unwanted) {
                Heard::Line(line) if line.trim().is_empty() => {}
                Heard::Line(line) => match answer(&line, ticket) {
                    Ok(None) => {} // of an earlier evaluation that was given up
                    Ok(Some(value)) => {
                        (self.has_answered, self.stillborn) = (true, 0);
                        self.worker = Some(worker);
                        return value.map_err(Failure::Evaluation);
                    }
                    // Out of step: a new worker takes its place.
                    Err(says) => return Err(Failure::Evaluation(says)),
                },
                Heard::End => return Err(self.died(worker, deadline)),
                Heard::Timeout => return Err(self.task.late()),
                Heard::Unwanted => return Err(Failure::Unwanted),
            }
        }
    }

    fn died(&mut self, mut worker: Process, deadline: Option<Instant>) -> Failure {
        if self.task.unwanted.load(Ordering::Relaxed) {
            return Failure::Unwanted;
        }
        worker.stdin = None;
        let status = worker.status(deadline, &self.task.unwanted);
        let status = status.map_or_else(|| "it closed its output".to_owned(), |status| status.to_string());
        let says = format!("the worker ended before it answered ({status})");
        self.stillborn += u32::from(!self.has_answered);
        if self.stillborn >= STILLBORN {
            return Failure::Fatal(format!(
                "{says}, {STILLBORN} times in a row at its first evaluation"
            ));
        }
        Failure::Evaluation(says)
    }
}

impl Task {
    fn late(&self) -> Failure {
        let limit = self.timeout.unwrap_or_default();
        Failure::Evaluation(format!("no answer within {limit:?}"))
    }

    /// Runs a program and reads the last line that it writes.
    fn run_program(&self, words: &[String], deadline: Option<Instant>) -> Result<f64, Failure> {
        let mut process = Process::start(words, false).map_err(Failure::Fatal)?;
        let mut last = None;
        loop {
            match process.line(deadline, &self.unwanted) {
                Heard::Line(line) if line.trim().is_empty() => {}
                Heard::Line(line) => last = Some(line),
                Heard::End => break,
                Heard::Timeout => return Err(self.late()),
                Heard::Unwanted => return Err(Failure::Unwanted),
            }
        }
        match process.status(deadline, &self.unwanted) {
            Some(status) if !status.success() => {
                return Err(Failure::Evaluation(format!("the program failed ({status})")));
            }
            None if self.unwanted.load(Ordering::Relaxed) => return Err(Failure::Unwanted),
            None => return Err(self.late()),
            Some(_) => {}
        }
        let Some(line) = last else {
            return Err(Failure::Evaluation(
                "the program wrote nothing: it has to write a number".to_owned(),
            ));
        };
        printed(&line).map_err(Failure::Evaluation)
    }
}

/// A value that a program wrote: a number, or an object with a `value`.
fn printed(line: &str) -> Result<f64, String> {
    if let Ok(number) = line.trim().parse::<f64>() {
        return Ok(number);
    }
    let parsed: Result<serde_json::Value, _> = read(line);
    let value = parsed.ok().and_then(|json| number(json.get("value")?));
    value.ok_or_else(|| {
        format!(
            "the program's last line is neither a number nor {{\"value\": number}}: `{}`",
            short(line)
        )
    })
}

/// What a line says about a ticket: nothing if it answers an earlier one, a value, or why there is none; an error if it is no
/// answer.
fn answer(line: &str, ticket: u64) -> Result<Option<Result<f64, String>>, String> {
    let shown = || format!("`{}`", short(line));
    let answer: Reply = read(line).map_err(|error| {
        format!("the worker wrote a line that is no answer such as {{\"ticket\": {ticket}, \"value\": 0.5}}: {}: {error}", shown())
    })?;
    if answer.ticket < ticket {
        return Ok(None);
    }
    if answer.ticket > ticket {
        return Err(format!(
            "the worker answered a ticket that it was not asked: {}, not {ticket}: {}",
            answer.ticket,
            shown()
        ));
    }
    Ok(Some(match (answer.error, answer.value) {
        (Some(error), _) => Err(format!("the worker says: {error}")),
        (None, Some(value)) => {
            number(&value).ok_or_else(|| format!("the worker's value is no number: {}", shown()))
        }
        (None, None) => Err(format!(
            "the worker's answer has no value: {}; answer {{\"ticket\": {ticket}, \"value\": 0.5}}, or null as the value or \
             {{\"ticket\": {ticket}, \"error\": \"why\"}} where there is none",
            shown()
        )),
    }))
}

/// The words of Python's `json` and others for numbers that JSON has not.
const NOT_FINITE: [&str; 3] = ["-Infinity", "Infinity", "NaN"];

/// Reads a line of JSON in which values may also be [`NOT_FINITE`], as [`number`] takes them.
fn read<T: DeserializeOwned>(line: &str) -> serde_json::Result<T> {
    serde_json::from_str(line).or_else(|error| serde_json::from_str(&with_words(line).ok_or(error)?))
}

/// A line of JSON with quotes around numbers that JSON has not; nothing if there are none.
fn with_words(line: &str) -> Option<String> {
    let (mut quoted, mut rest, mut found) = (String::new(), line, false);
    let (mut in_text, mut is_value) = (false, false);
    while let Some(c) = rest.chars().next() {
        let word = NOT_FINITE
            .iter()
            .find(|word| is_value && rest.starts_with(**word));
        let taken = match word {
            Some(word) => {
                found = true;
                quoted.extend(["\"", word, "\""]);
                word.len()
            }
            // What is escaped ends no text.
            None if in_text && c == '\\' => {
                let taken = rest.char_indices().nth(2).map_or(rest.len(), |(next, _)| next);
                quoted.push_str(&rest[..taken]);
                taken
            }
            None => {
                in_text ^= c == '"';
                quoted.push(c);
                c.len_utf8()
            }
        };
        is_value = !in_text && (matches!(c, ':' | ',' | '[') || (is_value && c.is_whitespace()));
        rest = &rest[taken..];
    }
    found.then_some(quoted)
}

/// A number of JSON. `null` is NaN, which JSON has not, and so are the words for it.
fn number(value: &serde_json::Value) -> Option<f64> {
    match value {
        serde_json::Value::Null => Some(f64::NAN),
        serde_json::Value::String(text) => text.parse().ok(),
        other => other.as_f64(),
    }
}

/// The beginning of a line.
fn short(line: &str) -> String {
    match line.char_indices().nth(SHOWN) {
        Some((end, _)) => format!("{}…", &line[..end]),
        None => line.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_programs_write() {
        for (line, value) in [
            ("0.25", 0.25),
            (" -1e3 ", -1000.0),
            (r#"{"value": 3, "time": 1}"#, 3.0),
            ("inf", f64::INFINITY),
        ] {
            assert_eq!(printed(line), Ok(value), "{line}");
        }
        assert_eq!(printed(r#"{"value": -Infinity}"#), Ok(f64::NEG_INFINITY));
        assert!(printed("nan").unwrap().is_nan() && printed(r#"{"value": null}"#).unwrap().is_nan());
        for line in ["", "done", "{}", "[1]", r#"{"value": "high"}"#] {
            assert!(printed(line).unwrap_err().contains(line), "{line}");
        }
    }

    #[test]
    fn what_workers_write() {
        assert_eq!(answer(r#"{"ticket":7,"value":0.3}"#, 7), Ok(Some(Ok(0.3))));
        assert_eq!(answer(r#"{"ticket":6,"value":0.3}"#, 7), Ok(None));
        let null = answer(r#"{"ticket":7,"value":null}"#, 7);
        assert!(null.unwrap().unwrap().unwrap().is_nan());
        for line in [r#"{"ticket":7}"#, r#"{"ticket":7,"values":1}"#] {
            let says = answer(line, 7).unwrap().unwrap().unwrap_err();
            assert!(
                says.contains(line) && says.contains(r#"answer {"ticket": 7, "value": 0.5}"#),
                "{says}"
            );
        }
        // As Python's `json.dumps` writes them.
        for (word, value) in [("Infinity", f64::INFINITY), ("-Infinity", f64::NEG_INFINITY)] {
            let line = format!(r#"{{"note": "no \" NaN", "time": NaN, "ticket": 7, "value": {word}}}"#);
            assert_eq!(answer(&line, 7), Ok(Some(Ok(value))));
        }
        let nan = answer(r#"{"ticket":7,"value":NaN}"#, 7);
        assert!(nan.unwrap().unwrap().unwrap().is_nan());
        for line in [
            r#"{"ticket":NaN,"value":1}"#,
            r#"{"ticket":7,"value":nan}"#,
            r#"{"ticket":7,"value":1NaN}"#,
            r#"{"ticket":7,"value":NaNs}"#,
            r#"{"ticket":7,"value":+Infinity}"#,
            r#"{NaN:7,"ticket":7,"value":1}"#,
            r#"{"ticket":7,"value":"NaN}"#,
        ] {
            assert!(answer(line, 7).unwrap_err().contains(line), "{line}");
        }
        for line in ["0.5", "NaN", "[]"] {
            let says = answer(line, 7).unwrap_err();
            let expects = r#"such as {"ticket": 7, "value": 0.5}"#;
            assert!(says.contains(expects) && !says.contains("Reply"), "{says}");
        }
        let error = answer(r#"{"ticket":7,"error":"diverged"}"#, 7).unwrap().unwrap();
        assert_eq!(error, Err("the worker says: diverged".to_owned()));
        assert!(
            answer(r#"{"ticket":8,"value":1}"#, 7)
                .unwrap_err()
                .contains("not asked")
        );
        assert!(
            answer("loading model", 7)
                .unwrap_err()
                .contains("`loading model`")
        );
        let long = "x".repeat(1000);
        assert!(answer(&long, 7).unwrap_err().len() < 500);
    }
}
