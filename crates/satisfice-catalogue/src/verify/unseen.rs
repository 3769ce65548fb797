//! The estimate of hits not seen: it needs the problem and the probes to be made again, but has to agree with what is listed of them.

use satisfice::{Completeness, Method};

use super::{Mismatch, shown};
use crate::report::RunReport;

pub(super) fn check(report: &RunReport, wrong: &mut Vec<Mismatch>) {
    let interval = report.unseen_interval.map_or_else(
        || "null".to_owned(),
        |(low, high)| format!("[{low}, {}]", shown(high)),
    );
    let found = format!("{} in {interval}", shown(report.unseen_estimate));
    let mut refuse = |expected: &str| wrong.push(Mismatch::new("unseen_estimate", &found, expected));
    let (confidence, method) = (report.unseen_confidence, report.unseen_method);
    if report.completeness == Completeness::Proved {
        if report.unseen_estimate != Some(0.0) || report.unseen_interval != Some((0.0, Some(0.0))) {
            refuse("0 in [0, 0], since completeness is proved");
        }
        if confidence != Some(1.0) || method != Some(Method::Proved) {
            let found = format!("{} by {method:?}", shown(confidence));
            wrong.push(Mismatch::new(
                "unseen_confidence",
                found,
                "1 by Proved, since completeness is proved",
            ));
        }
        return;
    }
    let (Some(estimate), Some((low, high))) = (report.unseen_estimate, report.unseen_interval) else {
        if report.unseen_estimate.is_some() || report.unseen_interval.is_some() {
            refuse("both or none");
        }
        return;
    };
    if !(low >= 0.0 && low <= estimate && high.is_none_or(|high| estimate <= high)) {
        refuse("a number within its interval");
    }
    let Some((recaptures, fresh)) = report.probe_hits else {
        return;
    };
    // Without a hit that the engine has missed nothing speaks for more, but for rounding.
    if fresh == 0 && (low > 0.0 || estimate > 1e-6 * (1.0 + report.hits as f64)) {
        refuse("0, since no probe hit what the engine has not found");
    }
    let probes = report.counts.probes;
    if recaptures.checked_add(fresh).is_none_or(|hits| hits > probes) {
        let expected = format!("no more than the {probes} probes together");
        wrong.push(Mismatch::new(
            "probe_hits",
            format!("[{recaptures}, {fresh}]"),
            expected,
        ));
    }
}
