//! Interleaved timing, errors against the truth, and the printed and written report.
#![expect(clippy::disallowed_methods, reason = "a bench asks the time")]

use std::time::Instant;

/// Turns of a method running.
const TURNS: usize = 3;

/// Pairs by number.
pub(crate) type Pairs = Vec<(u32, u32)>;

/// A way to find the pairs, run again and again.
pub(crate) struct Method<'a> {
    pub(crate) name: &'static str,
    run: Box<dyn FnMut(Frame) -> Pairs + 'a>,
    moves: bool,
}

/// What a method that follows a motion is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Frame {
    /// The frame before, which is not timed.
    Before,
    /// The frame that is timed.
    Timed,
}

impl<'a> Method<'a> {
    pub(crate) fn new(name: &'static str, mut run: impl FnMut() -> Pairs + 'a) -> Self {
        Self {
            name,
            run: Box::new(move |_| run()),
            moves: false,
        }
    }

    /// One that goes from frame to frame: back to the frame before, untimed, after every turn.
    pub(crate) fn moving(name: &'static str, run: impl FnMut(Frame) -> Pairs + 'a) -> Self {
        Self {
            name,
            run: Box::new(run),
            moves: true,
        }
    }

    fn step_back(&mut self) {
        if self.moves {
            std::hint::black_box((self.run)(Frame::Before));
        }
    }
}

/// Times of a method, in milliseconds.
#[derive(Clone, Copy)]
pub(crate) struct Times {
    /// Median of the turns after the first of a round.
    pub(crate) warm: f64,
    /// Median of the first turns.
    pub(crate) cold: f64,
    pub(crate) least: f64,
}

impl Times {
    /// How many times as long it takes as another.
    pub(crate) fn ratios(self, to: Self) -> Ratios {
        Ratios {
            warm: self.warm / to.warm,
            cold: self.cold / to.cold,
        }
    }
}

/// A ratio of times, and the same of first turns.
#[derive(Clone, Copy)]
pub(crate) struct Ratios {
    pub(crate) warm: f64,
    cold: f64,
}

impl std::fmt::Display for Ratios {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:.2} (after others {:.2})", self.warm, self.cold)
    }
}

/// Whichever is the less.
pub(crate) fn least(one: Ratios, two: Ratios) -> Ratios {
    if one.warm < two.warm { one } else { two }
}

/// The report of one run.
pub(crate) struct Report {
    /// Whether this is a bench and not a test.
    pub(crate) full: bool,
    text: String,
}

impl Report {
    pub(crate) fn new(full: bool) -> Self {
        let mut report = Self {
            full,
            text: String::new(),
        };
        report.line("# Collision: time against error");
        report.line("");
        report.line(&crate::machine::line());
        report.line("");
        report.line(
            "Times are medians in milliseconds, one thread unless a name says otherwise, results included. In a round every \
             method has three turns running, and rounds follow each other: the first turn finds in the cache what another \
             method left there (column *after others*), the other two what itself left there (*ms*, and *least*). Ratio is *ms* \
             divided by that of the first row. Error is (missed + wrong pairs) / true pairs; the truth is what two exact methods \
             agree on. Written by `cargo bench --bench collision`.",
        );
        report
    }

    /// Prints and keeps a line.
    pub(crate) fn line(&mut self, line: &str) {
        println!("{line}");
        self.text.push_str(line);
        self.text.push('\n');
    }

    pub(crate) fn heading(&mut self, heading: &str) {
        self.line("");
        self.line(&format!("## {heading}"));
        self.line("");
    }

    /// Times the methods of one scene; `truth` is sorted. A test asks each method once.
    pub(crate) fn compare(
        &mut self,
        scene: &str,
        truth: &[(u32, u32)],
        mut methods: Vec<Method<'_>>,
    ) -> Vec<Times> {
        self.line(&format!("**{scene}**, {} pairs", truth.len()));
        self.line("");
        self.line("| method | ms | ratio | after others | least | missed | wrong | error |");
        self.line("|---|---|---|---|---|---|---|---|");
        let mut errors = Vec::new();
        let mut slowest = 0.0_f64;
        for method in &mut methods {
            method.step_back();
            let start = Instant::now();
            let mut found = (method.run)(Frame::Timed);
            slowest = slowest.max(start.elapsed().as_secs_f64());
            method.step_back();
            found.sort_unstable();
            let missed = truth
                .iter()
                .filter(|pair| found.binary_search(pair).is_err())
                .count();
            let wrong = found
                .iter()
                .filter(|pair| truth.binary_search(pair).is_err())
                .count();
            errors.push((missed, wrong));
        }
        let rounds = if self.full {
            ((1.0 / slowest) as usize).clamp(4, 61)
        } else {
            1
        };
        let mut times = vec![[const { Vec::new() }; 2]; methods.len()];
        for _ in 0..rounds {
            for (method, [warm, cold]) in methods.iter_mut().zip(&mut times) {
                for turn in 0..TURNS {
                    let (ms, _) = time(|| std::hint::black_box((method.run)(Frame::Timed)));
                    method.step_back();
                    if turn == 0 { &mut *cold } else { &mut *warm }.push(ms);
                }
            }
        }
        let times: Vec<Times> = times
            .into_iter()
            .map(|[mut warm, mut cold]| {
                warm.sort_by(f64::total_cmp);
                cold.sort_by(f64::total_cmp);
                Times {
                    warm: warm[warm.len() / 2],
                    cold: cold[cold.len() / 2],
                    least: warm[0].min(cold[0]),
                }
            })
            .collect();
        for ((method, times_of), (missed, wrong)) in methods.iter().zip(&times).zip(errors) {
            let Times { warm, cold, least } = times_of;
            let error = (missed + wrong) as f64 / truth.len().max(1) as f64;
            self.line(&format!(
                "| {} | {warm:.4} | {:.2} | {cold:.4} | {least:.4} | {missed} | {wrong} | {error:.2e} |",
                method.name,
                warm / times[0].warm
            ));
            if method.name.starts_with("ours") {
                assert_eq!((missed, wrong), (0, 0), "{}: {}", scene, method.name);
            }
        }
        self.line("");
        times
    }

    /// Writes the report.
    pub(crate) fn save(&self) {
        crate::page::save("collision.md", &self.text);
    }
}

/// As many threads as the machine has.
pub(crate) fn all_threads() -> rayon::ThreadPool {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .expect("threads")
}

/// Runs once and returns the time in milliseconds.
pub(crate) fn time<R>(run: impl FnOnce() -> R) -> (f64, R) {
    let start = Instant::now();
    let result = run();
    (start.elapsed().as_secs_f64() * 1e3, result)
}

/// A stop that comes true after so many milliseconds.
pub(crate) fn deadline(milliseconds: f64) -> impl FnMut(usize) -> bool {
    let start = Instant::now();
    move |_| start.elapsed().as_secs_f64() * 1e3 >= milliseconds
}
