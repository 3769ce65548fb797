//! `satisfice collide`: pairs of mesh features that are closer than a threshold.

pub(crate) mod arguments;
mod exact;
mod picture;
mod report;
mod scene;
mod search;
mod warnings;

use std::path::Path;
use std::process::ExitCode;
use std::sync::{Arc, Mutex};

use anyhow::{Context, bail};
use satisfice::engine;
use satisfice_catalogue::{Mismatch, RunReport, json};
use satisfice_collision::broad::Method;
use satisfice_collision::scene::{Completeness, Contact, Skips};
use serde::Deserialize;

use crate::{interrupt, message, output, reference, summary};
use arguments::{CollideArguments, Find};
use exact::{Exact, METHODS};
use report::Report;
use scene::{Pair, World};

/// The problem's name in a report.
pub(crate) const PROBLEM: &str = "collide";
/// The pairs of a scene are not counted beyond this: they would fill the memory.
const MOST_COUNTED: usize = 100_000_000;

pub(crate) fn collide(arguments: &CollideArguments) -> anyhow::Result<ExitCode> {
    let engines = || engine::all().iter().map(|entry| entry.name);
    let exact = METHODS.iter().find(|(name, _)| *name == arguments.method);
    if exact.is_none() && !engines().any(|name| name == arguments.method) {
        let methods = METHODS.iter().map(|(name, _)| *name).chain(engines());
        return Err(satisfice::Error::unknown("method", &arguments.method, methods).into());
    }
    check(arguments, exact.is_some())?;
    let world = World::read(scene::Request {
        paths: arguments.meshes.clone(),
        kind: arguments.pairs.into(),
        threshold: arguments.threshold,
        within: arguments.within,
        ring_width: arguments.ring_width,
        find: arguments.find.find(),
    })?;
    let world = Arc::new(world);
    let cancel = interrupt::listen()?;
    let (record, skips, reference, mut files) = if let Some(&(name, method)) = exact {
        let files = Files::open(arguments)?;
        warn(&world);
        let (time, hits) = arguments.search.limits();
        let found = Exact {
            name,
            method,
            time,
            hits,
            threads: arguments.search.threads(),
            cancel: &cancel,
        }
        .find(&world)?;
        (found.report, found.skips, Vec::new(), files)
    } else {
        let mut spec = arguments.search.spec(&arguments.method)?;
        if arguments.prune {
            spec = spec.set("prune", "yes");
        }
        let files = Files::open(arguments)?;
        warn(&world);
        let mut record = search::find(&world, &spec, &cancel)?;
        let reference = Arc::new(Mutex::new((Vec::new(), Skips::default())));
        let (counted, kept) = (Arc::clone(&world), Arc::clone(&reference));
        record.set_reference(reference::wait_for(
            "the scene",
            reference::Patience::Unlimited,
            &cancel,
            move || count(&counted, &kept),
        ));
        let (all, skips) = reference
            .lock()
            .map(|mut kept| std::mem::take(&mut *kept))
            .unwrap_or_default();
        (record, skips, all, files)
    };
    if let Some(file) = &mut files.picture {
        let contacts = world.contacts(&pairs(&record)?);
        let missed = picture::missed(&reference, &contacts);
        file.write(&picture::draw(&world, arguments.up, &contacts, &missed)?)?;
    }
    files.finish(&Report::new(record, &skips, &world)?, &world)
}

/// Refuses options that do not go together, before anything is read.
fn check(arguments: &CollideArguments, is_exact: bool) -> anyhow::Result<()> {
    let method = &arguments.method;
    let useless = arguments.search.for_an_engine();
    if is_exact && (arguments.prune || !useless.is_empty()) {
        let option = useless.first().map_or("--prune", String::as_str);
        bail!("--method {method} makes no use of {option}: leave it out or choose an engine");
    }
    let (_, hits) = arguments.search.limits();
    let find = arguments.find.find();
    if find != Find::All && (!is_exact || hits.is_some()) {
        bail!(
            "--{} is answered by the exact methods and lists what it is asked for: leave out --method and --hits",
            find.name()
        );
    }
    if hits.is_some() && ["grid", "brute-force"].contains(&method.as_str()) {
        bail!("--method {method} does not count its hits: for --hits choose exact, tree or an engine");
    }
    if method == "grid" && arguments.pairs != arguments::PairKind::VertexVertex {
        bail!("--method grid is for --pairs vertex-vertex: choose exact or tree");
    }
    picture::check(arguments.picture.as_deref())
}

fn warn(world: &World) {
    for warning in warnings::warnings(world) {
        message::say(format_args!("warning: {warning}"));
    }
}

/// Counts the pairs by an exact method; keeps them, and what was skipped.
fn count(world: &World, kept: &Mutex<(Vec<Contact>, Skips)>) -> Option<u64> {
    let mut scene = world.scene(Method::Auto).ok()?;
    let mut pass = scene.pass();
    let done = scene.advance(&mut pass, &mut |found| found > MOST_COUNTED).ok()?;
    if done != Completeness::Proved {
        return None;
    }
    let frame = scene.frame_of(&pass);
    let count = frame.contacts.len() as u64;
    if let Ok(mut kept) = kept.lock() {
        *kept = (frame.contacts, frame.skips);
    }
    Some(count)
}

/// The pairs that a record lists.
fn pairs(record: &RunReport) -> anyhow::Result<Vec<Pair>> {
    let solutions = record.solutions.iter();
    let pairs = solutions.map(|found| Pair::deserialize(&found.solution));
    Ok(pairs.collect::<Result<_, _>>()?)
}

/// Where the results go.
struct Files {
    json: Option<output::Output>,
    csv: Option<output::Output>,
    picture: Option<output::Output>,
    summary: bool,
}

impl Files {
    fn open(arguments: &CollideArguments) -> anyhow::Result<Self> {
        let (
            stdout,
            CollideArguments {
                json, out, picture, ..
            },
        ) = (Path::new("-"), arguments);
        let to_stdout = [json, out, picture]
            .into_iter()
            .filter(|path| path.as_deref() == Some(stdout))
            .count();
        if to_stdout > 1 {
            bail!("only one of --json, --out and --picture can go to stdout: name files for the others");
        }
        Ok(Self {
            json: output::open(json.as_ref())?,
            csv: output::open(out.as_ref())?,
            picture: output::open(picture.as_ref())?,
            summary: to_stdout == 0,
        })
    }

    fn finish(&mut self, report: &Report, world: &World) -> anyhow::Result<ExitCode> {
        if let Some(file) = &mut self.json {
            file.write(&json::to_vec(report)?)?;
        }
        if let Some(file) = &mut self.csv {
            file.write(report.csv().as_bytes())?;
        }
        if self.summary {
            output::print(report.summary(world).as_bytes())?;
        }
        Ok(summary::exit_code(&report.run))
    }
}

/// Reads the meshes of a report again and measures its pairs anew.
pub(crate) fn verify(text: &[u8]) -> anyhow::Result<Vec<Mismatch>> {
    let report: Report = serde_json::from_slice(text).context("the report is none of `collide --json`")?;
    let world = World::of_report(&report.run).context("the scene of the report cannot be built")?;
    report.verify(&world)
}
