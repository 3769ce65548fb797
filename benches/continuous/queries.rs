//! Single queries: generated, with known answers, and public ones with exact answers.

use std::hint::black_box;

use cpu_time::ThreadTime;
use satisfice_collision::continuous::DecidedBy;

use crate::Report;
use crate::families::{Query, SCALES, Source};

/// Processor time of this thread: other work on the machine does not count.
fn microseconds<R>(run: impl FnOnce() -> R) -> f64 {
    let start = ThreadTime::now();
    black_box(run());
    start.elapsed().as_secs_f64() * 1e6
}

/// Mean time a query, and that of the slowest, each query at the least of three runs where it is slow.
fn time<R>(queries: &[(Query, bool)], ask: impl Fn(&Query) -> R) -> [f64; 2] {
    let mut means: Vec<f64> = (0..3)
        .map(|_| {
            let all = microseconds(|| queries.iter().for_each(|(query, _)| drop(black_box(ask(query)))));
            all / queries.len() as f64
        })
        .collect();
    means.sort_by(f64::total_cmp);
    let mut each: Vec<(f64, usize)> = queries
        .iter()
        .enumerate()
        .map(|(at, (query, _))| (microseconds(|| ask(query)), at))
        .collect();
    each.sort_by(|a, b| b.0.total_cmp(&a.0));
    let again = |&(first, at): &(f64, usize)| {
        (0..4).fold(first, |least, _| least.min(microseconds(|| ask(&queries[at].0))))
    };
    let largest = each.iter().take(50).map(again).fold(0.0, f64::max);
    [means[0], largest]
}

/// How many queries of a row are timed, and asked for their impact.
const TIMED: usize = 10_000;

fn row(report: &mut Report, name: &str, queries: &[(Query, bool)]) {
    let decided: Vec<_> = queries.iter().map(|(query, _)| query.decide()).collect();
    let every = queries.len().div_ceil(TIMED).max(1);
    let timed: Vec<(Query, bool)> = queries.iter().copied().step_by(every).collect();
    let wrong_decisions = queries
        .iter()
        .zip(&decided)
        .filter(|((_, truth), decided)| decided.within != *truth)
        .count();
    let wrong_impacts = timed
        .iter()
        .filter(|(query, truth)| query.impact().is_some() != *truth)
        .count();
    let integers = decided
        .iter()
        .filter(|decided| decided.by == DecidedBy::Exact)
        .count();
    let touching = queries.iter().filter(|(_, truth)| *truth).count();
    let [mean, largest] = time(&timed, Query::decide);
    let [impact, largest_impact] = time(&timed, Query::impact);
    report.line(&format!(
        "| {name} | {touching} / {} | {} | {integers} | {mean:.2} | {largest:.0} | {impact:.2} | {largest_impact:.0} |",
        queries.len(),
        wrong_decisions + wrong_impacts,
    ));
}

pub(crate) fn run(report: &mut Report) {
    report.heading("Single queries, touching");
    report.line(
        "\"Decision\" is `decide`, \"impact\" its time within 1e-6. The families have known answers; each has an equal number of queries at \
         each of 25 scales from 2^-498 to 2^498. All are decided; of each row at most 10,000, evenly spread, are timed and asked for their \
         impact.\n",
    );
    report.line(
        "| queries | touching / all | wrong | integers | decision, us | largest | impact, us | largest |",
    );
    report.line("|---|---|---|---|---|---|---|---|");
    let count = if report.full { 10_000 } else { 20 };
    let mut source = Source::new(1);
    let touches = SCALES.iter().flat_map(|&exponent| vec![exponent; count]);
    let touches: Vec<_> = touches.map(|exponent| (source.touch(exponent), true)).collect();
    row(report, "exact touches", &touches);
    let beside = SCALES.iter().flat_map(|&exponent| vec![exponent; count]);
    let beside: Vec<_> = beside.map(|exponent| source.near_miss(exponent)).collect();
    row(
        report,
        "on a corner or an end, and one step of a double beside it",
        &beside,
    );
    if report.full {
        for (name, queries) in crate::data::sets() {
            row(report, &name, &queries);
        }
    }
}
