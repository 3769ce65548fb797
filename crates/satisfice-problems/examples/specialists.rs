//! What the best specialised method needs for the problems of the suite `generalisation`: bounds, backtracking, closed forms,
//! enumeration. Its figures stand beside those of the engines.
//!
//! `cargo run --release -p satisfice-problems --example specialists`: about a minute. Times are medians of five runs; every method
//! has to find the reference count. Vincent's functions have a specialist of their own, a multistart: `--example cec2013`.

#![expect(clippy::disallowed_methods, reason = "what is measured is time")]

use std::error::Error;
use std::time::Instant;

use satisfice::catalogue::{Catalogued, Params};
use satisfice::{Budget, Completeness, SatisficingProblem, Search, engine};
use satisfice_problems::{
    Arm, Cec2006, Costas, DiscPacking, Extendable, Falsification, GraphColouring, Himmelblau, Islands,
    Langford, LatinSquare, MagicSquare, Needles, Puma, Queens, Rastrigin, Roots, SallenKey, Sat, SevenJoints,
    Shell, Transmission, backtrack, count_hits,
};

const ROUNDS: usize = 5;
/// More than any of these problems has.
const UNLIMITED: u64 = 1_000_000_000;

type Fallible<T = ()> = Result<T, Box<dyn Error>>;

fn main() -> Fallible {
    println!("| problem | hits | specialised method | work | milliseconds |");
    println!("|---|---|---|---|---|");
    bounds::<Rastrigin>(&[])?;
    bounds::<Rastrigin>(&[("dimension", "6")])?;
    bounds::<Shell>(&[])?;
    bounds::<Islands>(&[])?;
    enumeration::<Needles>(&[])?;
    backtracking::<DiscPacking>()?;
    enumeration::<Cec2006>(&[])?;
    arm(&[])?;
    arm(&[("links", "5")])?;
    enumeration::<SevenJoints>(&[])?;
    puma()?;
    sallen_key()?;
    falsification()?;
    enumeration::<Transmission>(&[])?;
    backtracking::<Queens>()?;
    backtracking::<GraphColouring>()?;
    backtracking::<Costas>()?;
    backtracking::<MagicSquare>()?;
    backtracking::<LatinSquare>()?;
    backtracking::<Langford>()?;
    backtracking::<Sat>()?;
    bounds::<Roots>(&[])?;
    bounds::<Himmelblau>(&[])?;
    Ok(())
}

fn make<P: Catalogued<Scalar = f64>>(settings: &[(&str, &str)]) -> Fallible<P> {
    Ok(P::from_params(&Params::with(
        P::PARAMETERS,
        P::NAME,
        settings.iter().copied(),
    )?)?)
}

/// Runs a method that returns its hits and what it had to do, and prints its row.
fn row<P: Catalogued<Scalar = f64>>(
    problem: &P,
    settings: &[(&str, &str)],
    method: &str,
    run: impl Fn() -> Fallible<(u64, String)>,
) -> Fallible {
    let mut times = Vec::new();
    let mut result = (0, String::new());
    for _ in 0..ROUNDS {
        let start = Instant::now();
        result = run()?;
        times.push(1e3 * start.elapsed().as_secs_f64());
    }
    times.sort_by(f64::total_cmp);
    let (hits, work) = result;
    let name: String = std::iter::once(P::NAME.to_owned())
        .chain(settings.iter().map(|(name, value)| format!(" {name}={value}")))
        .collect();
    println!(
        "| {name} | {hits} | {method} | {work} | {:.3} |",
        times[ROUNDS / 2]
    );
    if Some(hits) != problem.reference_hits() {
        return Err(format!("{name} has {:?} hits", problem.reference_hits()).into());
    }
    Ok(())
}

/// Best-first branch and bound on the problem's lower bounds, which ends with a proof.
fn bounds<P>(settings: &[(&str, &str)]) -> Fallible
where
    P: Catalogued<Scalar = f64> + Sync,
    P::Solution: Send + Sync + Clone,
{
    let problem: P = make(settings)?;
    row(&problem, settings, "branch and bound, proved", || {
        let report =
            Search::with(engine::BranchAndBound::default()).run(&problem, &Budget::evaluations(UNLIMITED))?;
        if report.completeness != Completeness::Proved {
            return Err("not proved".into());
        }
        let counts = report.counts;
        Ok((
            report.hits().len() as u64,
            format!(
                "{} evaluations and bounds",
                counts.evaluations + counts.bound_calls
            ),
        ))
    })
}

fn backtracking<P: Catalogued<Scalar = f64> + Extendable>() -> Fallible {
    let problem: P = make(&[])?;
    row(&problem, &[], "backtracking, proved", || {
        let all = backtrack(&problem, UNLIMITED, &mut |_| ());
        Ok((all.solutions, format!("{} nodes", all.nodes)))
    })
}

/// For problems without a method of their own.
fn enumeration<P: Catalogued<Scalar = f64>>(settings: &[(&str, &str)]) -> Fallible {
    let problem: P = make(settings)?;
    let points = problem.space().cardinality().unwrap_or(f64::INFINITY);
    row(&problem, settings, "enumeration, proved", || {
        let hits = count_hits(&problem, 1e10).ok_or("too many points")?;
        Ok((hits, format!("{points} evaluations")))
    })
}

/// All links but the last as long as the goal can still be reached, then the cells of the last one around the goal's direction.
fn arm(settings: &[(&str, &str)]) -> Fallible {
    struct Reach<'a> {
        problem: &'a Arm,
        cells: u32,
        length: f64,
        nodes: u64,
        hits: u64,
    }
    impl Reach<'_> {
        /// `angle` in units of pi / m, as of the cells' centres.
        fn extend(&mut self, chosen: &mut Vec<u32>, links: usize, angle: u32, [x, y]: [f64; 2]) {
            self.nodes += 1;
            let goal = self.problem.goal();
            let (dx, dy) = (goal[0] - x, goal[1] - y);
            let rest = links - chosen.len();
            let reach = rest as f64 * self.length + self.problem.threshold();
            if dx * dx + dy * dy > reach * reach * (1.0 + 1e-9) {
                return;
            }
            let unit = std::f64::consts::PI / f64::from(self.cells);
            let cells = self.cells;
            let turned = |cell: u32| (angle + 2 * cell + 1 + cells) % (2 * cells);
            if rest > 1 {
                for cell in 0..self.cells {
                    let next = turned(cell);
                    let (sin, cos) = (f64::from(next) * unit).sin_cos();
                    chosen.push(cell);
                    self.extend(
                        chosen,
                        links,
                        next,
                        [x + cos * self.length, y + sin * self.length],
                    );
                    chosen.pop();
                }
                return;
            }
            // The tip is on a circle: its distance from the goal grows with the angle between the two directions.
            let wanted = dy.atan2(dx) / unit;
            let nearest =
                ((wanted - f64::from(angle + self.cells) - 1.0) / 2.0).rem_euclid(f64::from(self.cells));
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "in 0..cells"
            )]
            let nearest = nearest.round() as u32;
            let mut is_hit = |aside: u32| {
                chosen.push((nearest + aside) % cells);
                let is_hit = self.problem.fitness(chosen) < self.problem.threshold();
                chosen.pop();
                self.nodes += 1;
                self.hits += u64::from(is_hit);
                is_hit
            };
            if is_hit(0) {
                let _ = (1..cells / 2).take_while(|&aside| is_hit(aside)).count();
                let _ = (1..cells / 2).take_while(|&aside| is_hit(cells - aside)).count();
            }
        }
    }
    let problem: Arm = make(settings)?;
    let axes = problem.space().axes();
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a few hundred cells"
    )]
    let (links, cells) = (axes.len(), axes[0].width() as u32);
    row(
        &problem,
        settings,
        "closed form of the last joint, proved",
        || {
            let mut reach = Reach {
                problem: &problem,
                cells,
                length: 1.0 / links as f64,
                nodes: 0,
                hits: 0,
            };
            reach.extend(&mut Vec::new(), links, 0, [0.0; 2]);
            Ok((reach.hits, format!("{} nodes", reach.nodes)))
        },
    )
}

/// Three loops, and the second capacitor by division: those a cell around it are tried.
fn sallen_key() -> Fallible {
    let problem: SallenKey = make(&[])?;
    let counts: Vec<u32> = {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "dozens of parts"
        )]
        let count = |axis: &satisfice::Axis<f64>| axis.width() as u32;
        problem.space().axes().iter().map(count).collect()
    };
    let window = satisfice_problems::Window::default();
    row(&problem, &[], "three loops and a division, proved", || {
        let parts = |cells: [u32; 4]| problem.parts(&cells).ok_or("a cell out of range");
        let capacitors = (0..counts[3])
            .map(|cell| parts([0, 0, 0, cell]).map(|parts| parts.capacitances[1]))
            .collect::<Result<Vec<f64>, _>>()?;
        let (mut hits, mut tried) = (0, 0_u64);
        for r1 in 0..counts[0] {
            for r2 in 0..counts[1] {
                for c1 in 0..counts[2] {
                    let parts = parts([r1, r2, c1, 0])?;
                    let product = parts.resistances[0] * parts.resistances[1] * parts.capacitances[0];
                    let whole = 1.0 / (std::f64::consts::TAU * window.frequency);
                    let wanted = whole * whole / product;
                    // f0 goes with 1 / sqrt(C2); a little more, for what is rounded
                    let aside = (2.0 * window.frequency_tolerance).exp() * (1.0 + 1e-9);
                    let from = capacitors.partition_point(|&c| c < wanted / aside);
                    for (c2, _) in (0..)
                        .zip(&capacitors)
                        .skip(from)
                        .take_while(|(_, c)| **c <= wanted * aside)
                    {
                        tried += 1;
                        let fitness = problem.fitness(&vec![r1, r2, c1, c2]);
                        hits += u64::from(fitness < problem.threshold());
                    }
                }
            }
        }
        Ok((hits, format!("{tried} evaluations")))
    })
}

/// The system is linear: trajectories are sums of the responses to its inputs, and for given first ones the last input that is
/// too large follows by division.
fn falsification() -> Fallible {
    const INPUTS: usize = 5;
    let problem: Falsification = make(&[])?;
    let limit = Params::with(Falsification::PARAMETERS, Falsification::NAME, [])?.real("limit");
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "twenty levels"
    )]
    let levels = problem.space().axes()[0].width() as u32;
    row(&problem, &[], "superposition and a division, proved", || {
        let level = |cell: u32| 2.0 * (f64::from(cell) + 0.5) / f64::from(levels) - 1.0;
        // Two trajectories that differ in one input give its response, four of the lowest level the rest.
        let lowest = problem.trajectory(&[0; INPUTS]);
        let steps = lowest.len() / INPUTS;
        let responses: Vec<Vec<f64>> = (0..INPUTS)
            .map(|input| {
                let mut cells = [0; INPUTS];
                cells[input] = levels - 1;
                let other = problem.trajectory(&cells);
                let width = level(levels - 1) - level(0);
                other.iter().zip(&lowest).map(|(a, b)| (a - b) / width).collect()
            })
            .collect();
        let (mut hits, mut prefixes) = (0, 0_u64);
        let mut sums = vec![vec![0.0; lowest.len()]; INPUTS];
        let mut chosen = [0_u32; INPUTS];
        let mut depth = 0;
        loop {
            // All trajectories under the inputs before the last one, and whether they are beyond the limit before it acts.
            while depth + 1 < INPUTS {
                let (done, rest) = sums.split_at_mut(depth + 1);
                let from = steps * depth;
                for t in from..lowest.len() {
                    rest[0][t] = done[depth][t] + level(chosen[depth]) * responses[depth][t];
                }
                depth += 1;
            }
            prefixes += 1;
            let base = &sums[INPUTS - 1];
            let beyond = (0..INPUTS - 1).any(|input| {
                // The part of `input` is final once its own response is added.
                sums[input + 1][steps * input..steps * (input + 1)]
                    .iter()
                    .any(|x| x.abs() > limit)
            });
            if beyond {
                hits += u64::from(levels);
            } else {
                let last = &responses[INPUTS - 1];
                let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
                for t in steps * (INPUTS - 1)..lowest.len() {
                    if last[t] != 0.0 {
                        let (up, down) = ((limit - base[t]) / last[t], (-limit - base[t]) / last[t]);
                        least = least.min(up.max(down));
                        most = most.max(up.min(down));
                    } else if base[t].abs() > limit {
                        least = f64::NEG_INFINITY;
                    }
                }
                hits += (0..levels)
                    .filter(|&cell| level(cell) > least || level(cell) < most)
                    .count() as u64;
            }
            // The next inputs before the last one.
            depth = INPUTS - 2;
            while chosen[depth] + 1 == levels {
                if depth == 0 {
                    return Ok((hits, format!("{prefixes} prefixes of four inputs")));
                }
                chosen[depth] = 0;
                depth -= 1;
            }
            chosen[depth] += 1;
        }
    })
}

/// A rotation, row by row, and a place.
type Pose = ([[f64; 3]; 3], [f64; 3]);

/// Shoulder, elbow and wrist have two angles each that reach the pose (Pieper 1968; for this arm Lee 1982).
fn puma() -> Fallible {
    /// Denavit-Hartenberg parameters a, d in metres and the twist alpha in quarter turns.
    const LINKS: [(f64, f64, i32); 6] = [
        (0.0, 0.0, 1),
        (0.4318, 0.0, 0),
        (0.0203, 0.15005, -1),
        (0.0, 0.4318, 1),
        (0.0, 0.0, -1),
        (0.0, 0.0, 0),
    ];
    const POSTURE: [f64; 6] = [0.4, 0.6, -0.5, 0.9, 0.8, -0.6];
    let product = |a: &[[f64; 3]; 3], b: &[[f64; 3]; 3]| -> [[f64; 3]; 3] {
        std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
    };
    let chain = |angles: &[f64]| -> Pose {
        let mut rotation = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let mut place = [0.0; 3];
        for (angle, (a, d, twist)) in angles.iter().zip(LINKS) {
            let ((s, c), (sin, cos)) = (angle.sin_cos(), (f64::from(twist), f64::from(1 - twist.abs())));
            let moved = [a * c, a * s, d];
            place =
                std::array::from_fn(|i| place[i] + (0..3).map(|k| rotation[i][k] * moved[k]).sum::<f64>());
            rotation = product(
                &rotation,
                &[[c, -s * cos, s * sin], [s, c * cos, -c * sin], [0.0, sin, cos]],
            );
        }
        (rotation, place)
    };
    let problem: Puma = make(&[])?;
    let signs = [1.0, -1.0];
    row(&problem, &[], "closed form, proved", || {
        let (rotation, [x, y, z]) = chain(&POSTURE);
        let (upper, offset, fore) = (LINKS[1].0, LINKS[2].1, LINKS[2].0.hypot(LINKS[3].1));
        let bend = LINKS[3].1.atan2(LINKS[2].0);
        let mut postures: Vec<[f64; 6]> = Vec::new();
        for shoulder in signs {
            let aside = (offset / x.hypot(y)).asin();
            let lean = if shoulder > 0.0 {
                aside
            } else {
                std::f64::consts::PI - aside
            };
            let first = y.atan2(x) + lean;
            let along = x * first.cos() + y * first.sin();
            for elbow in signs {
                let cos = (along * along + z * z - upper * upper - fore * fore) / (2.0 * upper * fore);
                let opening = elbow * cos.acos();
                let second = z.atan2(along) - (fore * opening.sin()).atan2(upper + fore * opening.cos());
                let third = opening - bend;
                let (arm, _) = chain(&[first, second, third]);
                let back = std::array::from_fn(|i| std::array::from_fn(|j| arm[j][i]));
                let hand = product(&back, &rotation);
                for wrist in signs {
                    let sin = wrist * hand[0][2].hypot(hand[1][2]);
                    postures.push([
                        first,
                        second,
                        third,
                        (hand[1][2] / sin).atan2(hand[0][2] / sin),
                        -sin.atan2(hand[2][2]),
                        (hand[2][1] / sin).atan2(-hand[2][0] / sin),
                    ]);
                }
            }
        }
        let reached = postures.iter().filter(|posture| {
            let (turned, place) = chain(&posture[..]);
            let off = (0..3).map(|i| {
                let turned = (0..3).map(|j| (turned[i][j] - rotation[i][j]).abs()).sum::<f64>();
                turned + (place[i] - [x, y, z][i]).abs()
            });
            off.sum::<f64>() < 1e-12 && problem.fitness(&problem.decode(&posture[..])) < problem.threshold()
        });
        Ok((reached.count() as u64, "8 postures".to_owned()))
    })
}
