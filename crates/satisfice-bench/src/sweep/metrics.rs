//! Metrics of one run: hits at fixed evaluations and times, the cost of a recall, the area under the curve, duplicates.

use serde::{Deserialize, Serialize};

use satisfice_catalogue::RunReport;
use satisfice_catalogue::report::{FoundSolution, recall};

/// Evaluations, seconds and hits at a moment of a run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Moment(pub u64, pub f64, pub u64);

/// The recalls whose cost is reported.
pub const RECALLS: [f64; 3] = [0.5, 0.9, 0.99];

/// The greatest number of hits that are points of a curve.
const CURVE_HITS: usize = 200;

/// Metrics of one run. Without a reference count, those that need it are `None`; where the run shared the machine with
/// others, so are those that need a clock.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Metrics {
    /// The cost of the first hit.
    pub first_hit: Option<Cost>,
    /// The cost of each of [`RECALLS`], `None` if it was not reached.
    pub to_recall: Vec<Option<Cost>>,
    /// Hits at the row's `at_evaluations`.
    pub at_evaluations: Vec<u64>,
    /// Hits at the row's `at_seconds`.
    pub at_seconds: Vec<u64>,
    /// The paper's r(t) = |C(t)| / |C(end)| at the row's `at_seconds`; it rewards engines that stop finding.
    pub r: Vec<f64>,
    /// Mean recall over the evaluations of the budget: the area under the curve, from 0 to 1.
    pub area_evaluations: Option<f64>,
    /// Mean recall over the time of the budget, from 0 to 1.
    pub area_seconds: Option<f64>,
    /// The share of the evaluations whose solution was in the archive already.
    pub duplicates: f64,
    /// Distinct hits per call of the fitness.
    pub precision: f64,
}

/// The cost of reaching something.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Cost {
    /// Evaluations.
    pub evaluations: u64,
    /// Seconds; `None` if the run shared the machine.
    pub seconds: Option<f64>,
}

impl Metrics {
    /// Metrics of a report with its reference count. Cost: O(hits).
    #[must_use]
    #[expect(clippy::cast_precision_loss, reason = "shares")]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a rank among the hits"
    )]
    pub fn of(report: &RunReport, at_evaluations: &[u64], at_seconds: &[f64], alone: bool) -> Self {
        let found = &report.solutions;
        let cost = |hit: &FoundSolution| Cost {
            evaluations: hit.evaluation,
            seconds: alone.then_some(hit.seconds),
        };
        let rank = |share: f64| {
            report
                .reference_hits
                .map(|all| (share * all as f64).ceil().max(1.0) as usize)
        };
        let by_second = |seconds: f64| found.partition_point(|hit| hit.seconds <= seconds) as u64;
        let at_seconds: Vec<u64> = if alone {
            at_seconds.iter().map(|&seconds| by_second(seconds)).collect()
        } else {
            Vec::new()
        };
        let evaluations = report
            .counts
            .evaluations
            .max(report.spec.budget.evaluations.unwrap_or(0)) as f64;
        let seconds = report
            .spec
            .budget
            .time
            .map_or(0.0, |time| time.as_secs_f64())
            .max(report.elapsed_seconds);
        let area = |cost: &dyn Fn(&FoundSolution) -> f64, whole: f64| {
            let all = report.reference_hits.filter(|&all| all > 0 && whole > 0.0)? as f64;
            // `sum` of nothing is -0.0.
            let sum = found
                .iter()
                .fold(0.0, |sum, hit| sum + (1.0 - cost(hit) / whole).max(0.0));
            Some(sum / all)
        };
        Self {
            first_hit: found.first().map(cost),
            to_recall: RECALLS
                .iter()
                .map(|&share| rank(share).and_then(|rank| found.get(rank - 1)).map(cost))
                .collect(),
            at_evaluations: at_evaluations
                .iter()
                .map(|&evaluations| found.partition_point(|hit| hit.evaluation <= evaluations) as u64)
                .collect(),
            r: at_seconds
                .iter()
                .map(|&hits| recall(hits, report.hits).unwrap_or(0.0))
                .collect(),
            at_seconds,
            area_evaluations: area(&|hit| hit.evaluation as f64, evaluations),
            area_seconds: alone.then(|| area(&|hit| hit.seconds, seconds)).flatten(),
            duplicates: report.counts.duplicates as f64 / report.counts.evaluations.max(1) as f64,
            precision: report.hits as f64 / report.counts.fitness_calls.max(1) as f64,
        }
    }
}

/// The points of the trace, and hits at equal distances in their number.
pub(super) fn curve(report: &RunReport) -> Vec<Moment> {
    let mut curve: Vec<Moment> = report
        .trace
        .iter()
        .map(|point| Moment(point.evaluations, point.elapsed_seconds, point.hits))
        .collect();
    let found = &report.solutions;
    let shown = found.len().min(CURVE_HITS);
    curve.extend((1..=shown).map(|k| {
        let rank = k * found.len() / shown;
        Moment(found[rank - 1].evaluation, found[rank - 1].seconds, rank as u64)
    }));
    curve.push(Moment(
        report.counts.evaluations,
        report.elapsed_seconds,
        report.hits,
    ));
    // Several hits may share an evaluation: the last of them counts. The order in time is that in evaluations.
    curve.sort_by_key(|moment| (moment.0, moment.2));
    let (mut seconds, mut hits) = (0.0_f64, 0);
    for moment in &mut curve {
        seconds = seconds.max(moment.1);
        hits = hits.max(moment.2);
        (moment.1, moment.2) = (seconds, hits);
    }
    curve.reverse();
    curve.dedup_by_key(|moment| moment.0);
    curve.reverse();
    curve
}

#[cfg(test)]
mod tests {
    use super::*;
    use satisfice_catalogue::{RunControl, RunSpec, catalogue};

    /// Against the definitions, counted hit by hit in another way.
    #[test]
    fn metrics_are_what_they_are_called() {
        let problem = catalogue::find("islands").unwrap().build([]).unwrap();
        let mut report = problem
            .run(
                &RunSpec::new("random").evaluations(20_000).seed(3),
                RunControl::default(),
            )
            .unwrap();
        let hits = report.hits;
        assert!(hits > 20, "{hits}");
        report.set_reference(Some(2 * hits));
        let metrics = Metrics::of(&report, &[100, 20_000], &[1e9], true);
        let early = report
            .solutions
            .iter()
            .filter(|hit| hit.evaluation <= 100)
            .count() as u64;
        assert_eq!(metrics.at_evaluations, [early, hits]);
        assert_eq!(
            (metrics.at_seconds.as_slice(), metrics.r.as_slice()),
            ([hits].as_slice(), [1.0].as_slice())
        );
        let last = report.solutions.last().unwrap();
        assert_eq!(metrics.to_recall[0].unwrap().evaluations, last.evaluation);
        assert_eq!(metrics.to_recall[1], None);
        let mean = (1..=20_000_u64)
            .map(|e| report.solutions.iter().filter(|hit| hit.evaluation <= e).count() as f64)
            .sum::<f64>()
            / (20_000.0 * 2.0 * hits as f64);
        approx::assert_abs_diff_eq!(metrics.area_evaluations.unwrap(), mean, epsilon = 1e-4);
        assert!(Metrics::of(&report, &[], &[1e9], false).at_seconds.is_empty());

        // Without a hit it is 0, not -0, which tables would show with its sign.
        let mut none = report.clone();
        none.solutions.clear();
        none.hits = 0;
        let area = Metrics::of(&none, &[], &[], false).area_evaluations.unwrap();
        assert!(area == 0.0 && area.is_sign_positive());

        let curve = curve(&report);
        for Moment(evaluations, _, count) in &curve {
            let exact = report
                .solutions
                .iter()
                .filter(|hit| hit.evaluation <= *evaluations)
                .count() as u64;
            assert_eq!(*count, exact, "at {evaluations}");
        }
        assert!(curve.is_sorted_by(|a, b| a.0 < b.0 && a.1 <= b.1 && a.2 <= b.2));
    }
}
