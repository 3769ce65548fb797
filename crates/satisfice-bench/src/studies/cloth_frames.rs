//! Experiment II over many frames: the cost of detection compared with a plain grid and the simulation step, whether it misses
//! contacts, whether the cloth passes through itself, and how much the last frame's hits help an engine.

use std::hint::black_box;
use std::time::Instant;

use satisfice::{Budget, Cancel, SatisficingProblem, Search};
use satisfice_cloth::{Response, Settings, Simulation};
use satisfice_collision::distance::{Point, Threshold};
use satisfice_collision::{VertexPairs, oracle};

use crate::error::Error;
use crate::finding::Figure;
use crate::finding::Finding;
use crate::plain_grid;
use crate::statistics::{Estimate, median};
use satisfice_catalogue::quantity::shown;
use satisfice_draw::plot::{Chart, Curve, Panel};
use satisfice_picture::{Picture, View, strip};

/// Engines whose recall is measured from frame to frame.
const ENGINES: [&str; 6] = [
    "latest-hit-qpso",
    "niching-pso-dbscan",
    "bounded-swarms",
    "walk",
    "descent-flood",
    "portfolio",
];
/// Their evaluations per frame.
const BUDGETS: [u64; 2] = [20_000, 100_000];

struct Size {
    columns: u32,
    frames: usize,
    /// Frames between two checks of crossings and brute force.
    every: usize,
    /// The frames, at the end, on which engines are tried.
    searched: usize,
}

pub(super) fn run(seeds: u64, cancel: &Cancel, tell: &mut dyn FnMut(&str)) -> Result<Option<Finding>, Error> {
    study(
        &Size {
            columns: 128,
            frames: 60,
            every: 10,
            searched: 8,
        },
        seeds.min(4),
        cancel,
        tell,
    )
}

pub(super) fn smoke(_: u64, cancel: &Cancel, tell: &mut dyn FnMut(&str)) -> Result<Option<Finding>, Error> {
    study(
        &Size {
            columns: 20,
            frames: 30,
            every: 10,
            searched: 2,
        },
        1,
        cancel,
        tell,
    )
}

/// The median of the times of a frame's steps: other work on the machine disturbs some of them.
fn typical(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    median(&times).unwrap_or(0.0)
}

/// Seconds of one frame, the median step as often as there are steps, and what was found in its last step.
struct Measured {
    frame: usize,
    detection: f64,
    plain: f64,
    simulation: f64,
    within: usize,
    sphere: usize,
}

/// The results of the checks at intervals of several frames.
struct Sampled {
    frame: usize,
    missed: usize,
    wrong: usize,
    with: usize,
    without: usize,
    inside: usize,
}

#[expect(
    clippy::disallowed_methods,
    reason = "what is measured is time; no result depends on it"
)]
fn timed<T>(what: impl FnOnce() -> T) -> (T, f64) {
    let start = Instant::now();
    let value = what();
    (value, start.elapsed().as_secs_f64())
}

#[expect(clippy::needless_pass_by_value, reason = "for `map_err`")]
fn told(error: satisfice_collision::Error) -> Error {
    Error::Suite {
        place: "cloth-frames".to_owned(),
        what: error.to_string(),
    }
}

fn study(
    size: &Size,
    seeds: u64,
    cancel: &Cancel,
    tell: &mut dyn FnMut(&str),
) -> Result<Option<Finding>, Error> {
    let settings = Settings {
        columns: size.columns,
        ..Settings::default()
    };
    let mut cloth = Simulation::new(&settings).map_err(told)?;
    let mut loose = Simulation::new(&Settings {
        response: Response::Sphere,
        ..settings
    })
    .map_err(told)?;
    let excluded = cloth.mesh().map_err(told)?.adjacency().rings(1);
    let threshold = Threshold::new(settings.delta()).map_err(told)?;
    let sphere = single(cloth.sphere().vertices());
    let (mut measured, mut sampled, mut pictures, mut shapes) =
        (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for frame in 1..=size.frames {
        if cancel.is_cancelled() {
            return Ok(None);
        }
        tell(&format!("frame {frame} of {}", size.frames));
        let mut of_frame = Measured {
            frame,
            detection: 0.0,
            plain: 0.0,
            simulation: 0.0,
            within: 0,
            sphere: 0,
        };
        let mut times = [Vec::new(), Vec::new(), Vec::new()];
        for _ in 0..cloth.steps() {
            let (detected, seconds) = timed(|| cloth.detect());
            detected.map_err(told)?;
            times[0].push(seconds);
            // The baseline converts to single precision outside the clock, and does not exclude vertices joined by an edge.
            let points = single(cloth.points());
            #[expect(
                clippy::cast_possible_truncation,
                reason = "the baseline works in single precision"
            )]
            let r = settings.delta() as f32;
            times[1].push(
                timed(|| {
                    black_box((
                        plain_grid::within(&points, r),
                        plain_grid::between(&points, &sphere, r),
                    ))
                })
                .1,
            );
            (of_frame.within, of_frame.sphere) =
                (cloth.contacts().within.len(), cloth.contacts().sphere.len());
            times[2].push(timed(|| cloth.advance()).1);
        }
        [of_frame.detection, of_frame.plain, of_frame.simulation] =
            times.map(|times| f64::from(cloth.steps()) * typical(times));
        measured.push(of_frame);
        loose.frame().map_err(told)?;
        if frame + size.searched > size.frames {
            shapes.push(cloth.mesh().map_err(told)?);
        }
        if frame % size.every == 0 {
            cloth.detect().map_err(told)?;
            let truth = [
                oracle::pairs_within(cloth.points(), &excluded, threshold),
                oracle::pairs_between(cloth.points(), cloth.sphere().vertices(), threshold),
            ];
            let found = [&cloth.contacts().within, &cloth.contacts().sphere];
            let both = || truth.iter().zip(found);
            let missed = both().map(|(truth, found)| {
                truth
                    .iter()
                    .filter(|&&[i, j]| found.binary_search(&(i, j)).is_err())
                    .count()
            });
            let wrong = both().map(|(truth, found)| {
                found
                    .iter()
                    .filter(|&&(i, j)| truth.binary_search(&[i, j]).is_err())
                    .count()
            });
            let with = cloth.crossings().map_err(told)?;
            sampled.push(Sampled {
                frame,
                missed: missed.sum(),
                wrong: wrong.sum(),
                with: with.triangles,
                without: loose.crossings().map_err(told)?.triangles,
                inside: with.inside,
            });
            pictures.push(picture(&cloth)?);
        }
    }
    let mut finding = report(&settings, &measured, &sampled);
    finding.pictures.push((
        format!(
            "The cloth every {} frames of a sixtieth of a second; contacts with itself in vermilion.",
            size.every
        ),
        "cloth".to_owned(),
        strip(&pictures, 3)?,
    ));
    let Some((rows, figure)) = warm_and_cold(&shapes, &settings, seeds, cancel, tell)? else {
        return Ok(None);
    };
    finding.tables.push((
        format!(
            "Mean recall of the self-contacts over the last {} frames, median of {seeds} seeds: every frame by itself (cold), and \
             from the hits of the frame before by the engine's own rule (warm).",
            shapes.len().saturating_sub(1)
        ),
        rows,
    ));
    finding.figures.push(figure);
    Ok(Some(finding))
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "the baseline works in single precision"
)]
fn single(points: &[Point]) -> Vec<[f32; 3]> {
    points.iter().map(|p| p.map(|c| c as f32)).collect()
}

fn picture(cloth: &Simulation) -> Result<Vec<u8>, Error> {
    let mesh = cloth.mesh().map_err(told)?;
    let mut picture = Picture::new(
        480,
        400,
        View {
            azimuth: -50.0,
            elevation: 18.0,
            ..View::default()
        },
    );
    picture.body(&mesh);
    picture.body(cloth.sphere());
    for &(i, j) in &cloth.contacts().within {
        picture.pair(mesh.vertex(i), mesh.vertex(j), true);
    }
    Ok(picture.png()?)
}

#[expect(clippy::cast_precision_loss, reason = "small counts")]
fn report(settings: &Settings, measured: &[Measured], sampled: &[Sampled]) -> Finding {
    let total = |of: &dyn Fn(&Measured) -> f64| measured.iter().map(of).sum::<f64>();
    let steps = f64::from(settings.columns.div_ceil(16).max(2));
    let each = |seconds: f64| shown::seconds(seconds / steps);
    let ratio = |frame: &Measured| frame.detection / frame.plain;
    let text = vec![
        format!(
            "{} particles, {} m wide, on a sphere of {} m; contacts closer than {} spacings ({:.1} mm), detected {} times a \
             frame of a sixtieth of a second, every time exactly and of the cloth with itself and with the sphere. All times on \
             one thread.",
            shown::count(u64::from(settings.columns).pow(2)),
            settings.width,
            settings.radius,
            settings.reach,
            1e3 * settings.delta(),
            steps
        ),
        format!(
            "Over all frames a detection takes {}, building and joining the plain grid {} ({:.2} of it), the simulation step {}.",
            each(total(&|frame| frame.detection) / measured.len() as f64),
            each(total(&|frame| frame.plain) / measured.len() as f64),
            total(&|frame| frame.detection) / total(&|frame| frame.plain),
            each(total(&|frame| frame.simulation) / measured.len() as f64),
        ),
    ];
    let head = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect::<Vec<_>>();
    let stride = measured.len().div_ceil(12).max(1);
    let mut times = vec![head(&[
        "frame",
        "self",
        "sphere",
        "detection",
        "plain grid",
        "ratio",
        "simulation step",
    ])];
    times.extend(
        measured
            .iter()
            .filter(|frame| frame.frame % stride == 0)
            .map(|frame| {
                vec![
                    frame.frame.to_string(),
                    frame.within.to_string(),
                    frame.sphere.to_string(),
                    each(frame.detection),
                    each(frame.plain),
                    format!("{:.2}", ratio(frame)),
                    each(frame.simulation),
                ]
            }),
    );
    let mut crossings = vec![head(&[
        "frame",
        "missed",
        "wrong",
        "crossings with contacts",
        "crossings without",
        "particles in the sphere",
    ])];
    crossings.extend(sampled.iter().map(|at| {
        [at.frame, at.missed, at.wrong, at.with, at.without, at.inside]
            .map(|count| count.to_string())
            .to_vec()
    }));
    let curve = |label: &str, of: &dyn Fn(&Measured) -> f64| Curve {
        label: Some(label.to_owned()),
        points: measured
            .iter()
            .map(|frame| (frame.frame as f64, 1e3 * of(frame) / steps))
            .collect(),
        ..Curve::default()
    };
    Finding {
        title: "The cloth, frame by frame".to_owned(),
        text,
        tables: vec![
            ("Contacts at the end of a frame, and the median times of its steps.".to_owned(), times),
            (
                "Against brute force, and pairs of the cloth's triangles that pass through each other: with its contacts with \
                 itself pushing back, and without."
                    .to_owned(),
                crossings,
            ),
        ],
        figures: vec![Figure {
            name: "cloth-times",
            caption: "Median time of a step: detecting all contacts, the same by the plain grid, and the simulation.".to_owned(),
            chart: Chart {
                title: "Detection and simulation of the cloth".to_owned(),
                panels: vec![Panel {
                    x_label: "frame".to_owned(),
                    y_label: "ms a step".to_owned(),
                    curves: vec![
                        curve("detection", &|frame| frame.detection),
                        curve("plain grid", &|frame| frame.plain),
                        curve("simulation", &|frame| frame.simulation),
                    ],
                    ..Panel::default()
                }],
            },
        }],
        pictures: Vec::new(),
    }
}

type Table = Vec<Vec<String>>;

/// Recall of the self-contacts over consecutive frames; the first one only gives the hits to start from.
#[expect(clippy::cast_precision_loss, reason = "a share")]
fn warm_and_cold(
    shapes: &[satisfice_collision::Mesh],
    settings: &Settings,
    seeds: u64,
    cancel: &Cancel,
    tell: &mut dyn FnMut(&str),
) -> Result<Option<(Table, Figure)>, Error> {
    let mut problems = Vec::new();
    for shape in shapes {
        let mut problem = VertexPairs::within(&shapes[0], settings.delta(), 1).map_err(told)?;
        problem.move_a(shape).map_err(told)?;
        let hits = problem.reference_pairs().len().max(1) as f64;
        problems.push((problem, hits));
    }
    let mut rows = vec![vec!["engine".to_owned()]];
    for budget in BUDGETS {
        rows[0].extend([
            format!("cold, {}", shown::count(budget)),
            format!("warm, {}", shown::count(budget)),
        ]);
    }
    let mut curves = Vec::new();
    for name in ENGINES {
        tell(&format!("{name}, cold and warm"));
        let mut row = vec![name.to_owned()];
        for budget in BUDGETS {
            for warm in [false, true] {
                let mut means = Vec::new();
                let mut by_frame = vec![Vec::new(); problems.len()];
                for seed in 0..seeds {
                    if cancel.is_cancelled() {
                        return Ok(None);
                    }
                    let recalls = recalls(name, &problems, budget, warm, seed)?;
                    means.push(recalls[1..].iter().sum::<f64>() / recalls[1..].len().max(1) as f64);
                    by_frame
                        .iter_mut()
                        .zip(recalls)
                        .for_each(|(all, recall)| all.push(recall));
                }
                row.push(
                    Estimate::of(&means).map_or_else(|| "-".to_owned(), |mean| format!("{:.3}", mean.median)),
                );
                if budget == BUDGETS[1] {
                    let median = |all: &Vec<f64>| Estimate::of(all).map_or(0.0, |recall| recall.median);
                    curves.push(Curve {
                        label: Some(format!("{name}, {}", if warm { "warm" } else { "cold" })),
                        points: by_frame
                            .iter()
                            .enumerate()
                            .map(|(frame, all)| (frame as f64, median(all)))
                            .collect(),
                        ..Curve::default()
                    });
                }
            }
        }
        rows.push(row);
    }
    let figure = Figure {
        name: "cloth-warm",
        caption: format!(
            "Recall of the self-contacts frame by frame at {} evaluations each, cold and from the hits of the frame before.",
            shown::count(BUDGETS[1])
        ),
        chart: Chart {
            title: "Warm starts on the falling cloth".to_owned(),
            panels: vec![Panel {
                x_label: "frame, from the first that was searched".to_owned(),
                y_label: "recall".to_owned(),
                curves,
                ..Panel::default()
            }],
        },
    };
    Ok(Some((rows, figure)))
}

#[expect(clippy::cast_precision_loss, reason = "a share")]
fn recalls(
    name: &str,
    problems: &[(VertexPairs, f64)],
    budget: u64,
    warm: bool,
    seed: u64,
) -> Result<Vec<f64>, Error> {
    let fresh = |frame: u64| -> Result<Search<VertexPairs>, Error> {
        Ok(Search::named(name)?.seed(seed.wrapping_mul(1000).wrapping_add(frame)))
    };
    let mut search = fresh(0)?;
    let mut recalls = Vec::new();
    for (frame, (problem, hits)) in (0..).zip(problems) {
        debug_assert!(problem.threshold() > 0.0);
        if !warm {
            search = fresh(frame)?;
        }
        let report = search.run(problem, &Budget::evaluations(budget))?;
        recalls.push(report.hit_count() as f64 / hits);
    }
    Ok(recalls)
}
