//! What a deadline leaves of the pairs of triangles of a cloth with itself, the clock starting after the boxes have culled.
#![expect(clippy::disallowed_methods, reason = "a bench asks the time")]

use std::time::{Duration, Instant};

use satisfice_collision::distance::{Threshold, Triangle, TriangleBatch, triangle_triangle};

use crate::table::{Pairs, Report};
use crate::{scenes, triangles};

/// Decisions between two looks at the clock.
const LOOK: usize = 64;
/// Upper ends of the bands of likelihood: distances of centres, in units of the farthest at which the triangles can be within
/// delta.
const BANDS: [f32; 5] = [0.2, 0.28, 0.4, 0.55, f32::INFINITY];

/// Candidates whose likelihood is examined together.
const BLOCK: usize = 2048;

/// What is there when the clock starts.
struct Culled {
    triangles: Vec<Triangle>,
    candidates: Pairs,
    /// For each candidate the squared distance of the two centres, in units of the farthest at which the triangles can still be
    /// within delta. Whoever culls has both boxes available, and leaves this behind.
    apart: Vec<f32>,
    threshold: Threshold,
}

/// A clock that is read now and then.
struct Clock {
    end: Instant,
    steps: usize,
}

impl Clock {
    fn start(time: Duration) -> Self {
        Self {
            end: Instant::now() + time,
            steps: 0,
        }
    }

    fn is_over(&mut self) -> bool {
        self.steps += 1;
        self.steps.is_multiple_of(LOOK) && Instant::now() >= self.end
    }
}

impl Culled {
    fn of(mesh: &satisfice_collision::Mesh, delta: f64) -> Self {
        let triangles: Vec<Triangle> = (0..mesh.triangles().len()).map(|t| mesh.triangle(t)).collect();
        let centre = |t: &Triangle| {
            let centre: [f64; 3] = std::array::from_fn(|k| (t[0][k] + t[1][k] + t[2][k]) / 3.0);
            let square = |p: &[f64; 3]| (0..3).map(|k| (p[k] - centre[k]).powi(2)).sum::<f64>();
            (centre, t.iter().map(square).fold(0.0, f64::max).sqrt())
        };
        let centres: Vec<_> = triangles.iter().map(centre).collect();
        let candidates = triangles::culled(mesh, None, delta);
        let apart = |&(i, j): &(u32, u32)| {
            let [(p, reach_p), (q, reach_q)] = [i, j].map(|t| centres[t as usize]);
            let square = (0..3).map(|k| (p[k] - q[k]).powi(2)).sum::<f64>();
            (square / (reach_p + reach_q + delta).powi(2)) as f32
        };
        Self {
            apart: candidates.iter().map(apart).collect(),
            triangles,
            candidates,
            threshold: Threshold::new(delta).expect("a positive threshold"),
        }
    }

    fn is_hit(&self, (i, j): (u32, u32)) -> bool {
        let [a, b] = [i, j].map(|t| &self.triangles[t as usize]);
        triangle_triangle::within(a, b, self.threshold)
    }

    /// One by one in the order of `pairs`.
    fn one_by_one(&self, pairs: &[(u32, u32)], time: Duration) -> Pairs {
        let mut clock = Clock::start(time);
        let mut found = Pairs::new();
        for &pair in pairs {
            if self.is_hit(pair) {
                found.push(pair);
            }
            if clock.is_over() {
                break;
            }
        }
        found
    }

    /// Eight at once, in index order.
    fn batched(&self, time: Duration) -> Pairs {
        let mut clock = Clock::start(time);
        let mut found = Pairs::new();
        let mut batch = TriangleBatch::new(self.threshold);
        for &pair in &self.candidates {
            self.push(&mut batch, pair, &mut found);
            if clock.is_over() {
                break;
            }
        }
        batch.finish(|pair, decision| found.extend(decision.within.then_some(pair)));
        found
    }

    /// Eight at once, those first whose centres are close to each other: band by band. To read the distances again for each
    /// band takes a millisecond, less than to put candidates aside.
    fn likely_first(&self, time: Duration) -> Pairs {
        let mut clock = Clock::start(time);
        let mut found = Pairs::new();
        let mut batch = TriangleBatch::new(self.threshold);
        let mut start = f32::NEG_INFINITY;
        'bands: for end in BANDS {
            let (low, high) = (start, end * end);
            for (block, apart) in self.apart.chunks(BLOCK).enumerate() {
                // always written, kept by moving the end: which of them are wanted cannot be foreseen
                let (mut wanted, mut count) = ([0_u32; BLOCK], 0);
                for (at, &apart) in apart.iter().enumerate() {
                    wanted[count] = at as u32;
                    count += usize::from((apart > low) & (apart <= high));
                }
                for &at in &wanted[..count] {
                    let pair = self.candidates[block * BLOCK + at as usize];
                    self.push(&mut batch, pair, &mut found);
                    if clock.is_over() {
                        break 'bands;
                    }
                }
            }
            start = high;
        }
        batch.finish(|pair, decision| found.extend(decision.within.then_some(pair)));
        found
    }

    fn push(&self, batch: &mut TriangleBatch<(u32, u32)>, pair: (u32, u32), found: &mut Pairs) {
        let [a, b] = [pair.0, pair.1].map(|t| &self.triangles[t as usize]);
        batch.push(a, b, pair, |pair, decision| {
            found.extend(decision.within.then_some(pair));
        });
    }
}

type Way<'a> = (&'a str, Box<dyn Fn(Duration) -> Pairs + 'a>);

pub(crate) fn run(report: &mut Report) {
    report.heading("Pairs of triangles under a deadline");
    let (name, mesh, delta) = match scenes::data("cloth_ball92.ply").filter(|_| report.full) {
        Some(cloth) => ("cloth-ball frame 92 with itself", cloth, 0.01),
        None => {
            report.line("The cloth-ball is not at hand (SATISFICE_DATA); a folded sheet stands in for it.");
            report.line("");
            let side = if report.full { 120 } else { 12 };
            ("folded sheet with itself", scenes::sheet(side, 0.0), 0.02)
        }
    };
    let culled = Culled::of(&mesh, delta);
    let all = culled
        .candidates
        .iter()
        .copied()
        .filter(|&pair| culled.is_hit(pair));
    let truth: Pairs = all.collect();
    report.line(&format!(
        "**{name}, r = {delta}**: {} pairs among {} candidates, {:.1} %. The clock starts when the candidates are known, with the distance of their centres; share of the \
         pairs found, in %, medians of 16 runs of each in turn. A perfect order knows the pairs beforehand. Wanted: the smaller of \
         three times the index order and 80 % of the perfect one.",
        truth.len(),
        culled.candidates.len(),
        100.0 * truth.len() as f64 / culled.candidates.len().max(1) as f64
    ));
    report.line("");
    report.line("| deadline | one by one, index order | eight at once, index order | eight at once, likely first | one by one, perfect order | wanted |");
    report.line("|---|---|---|---|---|---|");
    let ways: [Way<'_>; 4] = [
        (
            "index",
            Box::new(|time| culled.one_by_one(&culled.candidates, time)),
        ),
        ("eight", Box::new(|time| culled.batched(time))),
        ("likely", Box::new(|time| culled.likely_first(time))),
        ("perfect", Box::new(|time| culled.one_by_one(&truth, time))),
    ];
    for milliseconds in [10, 100] {
        let time = Duration::from_millis(milliseconds);
        let mut shares: [Vec<f64>; 4] = Default::default();
        for _ in 0..if report.full { 16 } else { 1 } {
            for ((name, way), shares) in ways.iter().zip(&mut shares) {
                let mut found = way(time);
                found.sort_unstable();
                assert!(
                    found.iter().all(|pair| truth.binary_search(pair).is_ok()),
                    "{name}: what is no pair"
                );
                shares.push(100.0 * found.len() as f64 / truth.len().max(1) as f64);
            }
        }
        let [index, eight, likely, perfect] = shares.map(|mut shares| {
            shares.sort_by(f64::total_cmp);
            shares[shares.len() / 2]
        });
        let wanted = (3.0 * index).min(0.8 * perfect);
        report.line(&format!(
            "| {milliseconds} ms | {index:.1} | {eight:.1} | {likely:.1} | {perfect:.1} | {wanted:.1} |"
        ));
    }
    report.line("");
}
