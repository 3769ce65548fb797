//! Whole frames and first impacts.
#![expect(clippy::disallowed_methods, reason = "a bench asks the time")]

use std::time::Instant;

use cpu_time::ThreadTime;
use satisfice_collision::continuous::{Separation, Step};
use satisfice_collision::distance::PairKind;
use satisfice_collision::{Mesh, Placement, generate};

use crate::{Report, data};

const KINDS: [PairKind; 2] = [PairKind::EdgeEdge, PairKind::VertexTriangle];

/// A scene: its name, and how it is made anew, without trees.
pub(crate) struct Scene {
    pub(crate) name: &'static str,
    parts: Vec<(Mesh, Vec<[f64; 3]>, bool)>,
}

impl Scene {
    pub(crate) fn step(&self) -> Step {
        let mut step = Step::new();
        for (mesh, to, is_rigid) in &self.parts {
            let added = match is_rigid {
                true => step.add_rigid(mesh, to),
                false => step.add_deforming(mesh, to),
            };
            added.expect("two frames of one mesh");
        }
        step
    }

    /// A step at rest where this one starts, its trees ready: what a simulation has before it knows the motion.
    fn resting(&self) -> Step {
        let mut step = self.step();
        for (body, (mesh, ..)) in self.parts.iter().enumerate() {
            let from = mesh.vertices();
            step.set_motion(body, from, from).expect("frames of this mesh");
        }
        for kind in KINDS {
            step.build_trees(kind, Separation::TOUCHING)
                .expect("a kind in motion");
        }
        step
    }

    /// Gives a step of this scene its motion.
    fn set_motion(&self, step: &mut Step) {
        for (body, (mesh, to, _)) in self.parts.iter().enumerate() {
            step.set_motion(body, mesh.vertices(), to)
                .expect("frames of this mesh");
        }
    }

    pub(crate) fn mesh(&self) -> &(Mesh, Vec<[f64; 3]>, bool) {
        &self.parts[0]
    }
}

/// A pleated cloth whose waves run on.
pub(crate) fn pleats(full: bool) -> Scene {
    let (m, n) = if full { (241, 81) } else { (25, 9) };
    let from = generate::pleats(m, n, 5, 0.05, 0.0).expect("a cloth");
    let to = generate::pleats(m, n, 5, 0.05, 0.2).expect("a cloth");
    Scene {
        name: "pleats",
        parts: vec![(from, to.vertices().to_vec(), false)],
    }
}

/// A ball that passes through a sheet.
fn bullet(full: bool) -> Scene {
    let n = if full { 101 } else { 11 };
    let sheet = generate::cloth(2.0, 2.0, n, n).expect("a cloth");
    let ball = generate::icosphere(0.05, 3).expect("a ball");
    let place = |z: f64| {
        let placement = Placement::from_translation([0.1, 0.2, z]).expect("finite");
        placement.place(&ball).expect("finite")
    };
    let resting = sheet.vertices().to_vec();
    Scene {
        name: "bullet",
        parts: vec![
            (place(1.0), place(-1.0).vertices().to_vec(), true),
            (sheet, resting, false),
        ],
    }
}

/// The step of a cloth over a ball, if its frames are there.
pub(crate) fn cloth_ball() -> Option<Scene> {
    let (mesh, to) = data::step("cloth_ball92.ply", "cloth_ball93.ply")?;
    Some(Scene {
        name: "cloth-ball",
        parts: vec![(mesh, to, false)],
    })
}

fn cloth_funnel() -> Option<Scene> {
    let (mesh, to) = data::step("ccd/cloth-funnel/227.ply", "ccd/cloth-funnel/228.ply")?;
    Some(Scene {
        name: "cloth-funnel",
        parts: vec![(mesh, to, false)],
    })
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Processor time of this thread in milliseconds, and what came out.
fn processor_ms<R>(run: impl FnOnce() -> R) -> (f64, R) {
    let start = ThreadTime::now();
    let result = run();
    (start.elapsed().as_secs_f64() * 1e3, result)
}

fn wall_ms<R>(run: impl FnOnce() -> R) -> (f64, R) {
    let start = Instant::now();
    let result = run();
    (start.elapsed().as_secs_f64() * 1e3, result)
}

fn pool(threads: usize) -> rayon::ThreadPool {
    let builder = rayon::ThreadPoolBuilder::new().num_threads(threads);
    builder.build().expect("threads")
}

pub(crate) fn run(report: &mut Report) {
    let mut scenes = vec![pleats(report.full), bullet(report.full)];
    if report.full {
        scenes.extend([cloth_ball(), cloth_funnel()].into_iter().flatten());
    }
    all_pairs(report, &scenes);
    first_impacts(report, &scenes);
}

fn all_pairs(report: &mut Report, scenes: &[Scene]) {
    report.heading("Whole frames");
    report.line(
        "All pairs that touch; candidates are never stored. Processor time of one thread, trees built anew and trees ready. Two threads: wall \
         time of one thread divided by that of two, trees ready, in turns.\n",
    );
    report.line("| step | kind | touching | candidates | by integers | ms, trees included | trees ready | two threads |");
    report.line("|---|---|---|---|---|---|---|---|");
    let rounds = if report.full { 5 } else { 1 };
    let pools = [pool(1), pool(2)];
    for scene in scenes {
        for kind in KINDS {
            let ask = |step: &Step| step.hits(kind, Separation::TOUCHING).expect("a kind in motion");
            let (mut anew, mut ready, mut speedup) = (Vec::new(), Vec::new(), Vec::new());
            let mut found = None;
            for _ in 0..rounds {
                let step = scene.step();
                pools[0].install(|| {
                    let (ms, hits) = processor_ms(|| ask(&step));
                    anew.push(ms);
                    ready.push(processor_ms(|| ask(&step)).0);
                    found = Some(hits);
                });
                let [one, two] = pools
                    .each_ref()
                    .map(|pool| pool.install(|| wall_ms(|| ask(&step)).0));
                speedup.push(one / two);
            }
            let Some(hits) = found else { continue };
            report.line(&format!(
                "| {} | {kind} | {} | {} | {} | {:.1} | {:.1} | {:.2} |",
                scene.name,
                hits.pairs.len(),
                hits.candidates,
                hits.by_integers,
                median(anew),
                median(ready),
                median(speedup),
            ));
        }
    }
}

fn first_impacts(report: &mut Report, scenes: &[Scene]) {
    report.heading("First impact");
    report.line(
        "Proved within 1e-6. *Anew*: trees built. *Kept*: a step that was at rest in the start frame before, its trees built for that; \
         `Step::set_motion` and the fitting of the trees are in the time. `compute_collision_free_stepsize` of ipctk, by tuned ACCD and by \
         TI with default settings, gives a lower bound; its `CollisionMesh` is made before, its broad phase finds nothing kept. Processor \
         time of one thread in ms, all in turns.\n",
    );
    report.line("| step | bounds | queries | anew | kept | ACCD, tuned | ms | / anew | / kept | TI | ms |");
    report.line("|---|---|---|---|---|---|---|---|---|---|---|");
    let rounds = if report.full { 5 } else { 1 };
    for scene in scenes {
        let (mut ours, mut first) = ([Vec::new(), Vec::new()], None);
        let mut theirs: [Vec<[f64; 2]>; 2] = Default::default();
        for round in 0..rounds {
            let step = scene.step();
            let (ms, earliest) =
                processor_ms(|| step.earliest(Separation::TOUCHING, 1e-6).expect("a tolerance"));
            ours[0].push(ms);
            first = Some(earliest);
            let mut kept = scene.resting();
            let (ms, again) = processor_ms(|| {
                scene.set_motion(&mut kept);
                kept.earliest(Separation::TOUCHING, 1e-6).expect("a tolerance")
            });
            ours[1].push(ms);
            assert!(
                again.is_proved && again.time[0] <= earliest.time[1] && earliest.time[0] <= again.time[1]
            );
            let wanted = if round == 0 { "ACCD,TI" } else { "ACCD" };
            let text = match scene.name.starts_with("cloth-") {
                true => crate::ask_peer(&format!("free-step:{}:{wanted}", scene.name)),
                false => None,
            };
            for line in text.iter().flat_map(|text| text.lines()) {
                let mut words = line.split_whitespace();
                let method = usize::from(words.next() == Some("TI"));
                let numbers: Vec<f64> = words.filter_map(|word| word.parse().ok()).collect();
                theirs[method].extend(<[f64; 2]>::try_from(numbers));
            }
        }
        let Some(earliest) = first else { continue };
        assert!(earliest.is_proved);
        let ours = ours.map(median);
        let theirs = theirs.map(|runs| {
            let step = runs.first().map(|run| run[0])?;
            Some([step, median(runs.iter().map(|run| run[1]).collect())])
        });
        let cells = |run: &Option<[f64; 2]>| match run {
            Some([step, ms]) => format!("{step:.5e} | {ms:.0}"),
            None => "- | -".to_owned(),
        };
        let ratios = ours.map(|ours| theirs[0].map_or("-".to_owned(), |[_, ms]| format!("{:.1}", ms / ours)));
        report.line(&format!(
            "| {} | {:.7e} to {:.7e} | {} | {:.1} | {:.1} | {} | {} | {} | {} |",
            scene.name,
            earliest.time[0],
            earliest.time[1],
            earliest.queries,
            ours[0],
            ours[1],
            cells(&theirs[0]),
            ratios[0],
            ratios[1],
            cells(&theirs[1]),
        ));
    }
}
