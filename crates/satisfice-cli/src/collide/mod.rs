//! `satisfice collide`: pairs of mesh features that are closer than a threshold.

pub(crate) mod arguments;
mod body;
mod building;
mod couples;
mod csv;
mod digits;
mod exact;
mod files;
pub(crate) mod inputs;
mod limit;
mod memory;
mod motion;
mod names;
mod overlaps;
mod page;
mod pairs;
mod picture;
mod report;
mod scene;
mod search;
mod summary;
mod verify;
mod warnings;
mod weld;

use std::process::ExitCode;
use std::sync::{Arc, Mutex};

use anyhow::bail;
use satisfice::{Cancel, engine};
use satisfice_catalogue::json;
use satisfice_collision::broad::Method;
use satisfice_collision::scene::{Completeness, Skips};

use crate::output::{self, Steps};
use crate::{interrupt, message, reference};
use arguments::{CollideArguments, Find};
use exact::{Exact, METHODS};
use files::Files;
use inputs::Inputs;
use overlaps::Overlap;
use pairs::Pairs;
use report::{Head, Report};
use scene::{Pair, World};
use search::Searched;
pub(crate) use verify::verify;

/// The problem's name in a report.
pub(crate) const PROBLEM: &str = "collide";

pub(crate) fn collide(arguments: &CollideArguments) -> anyhow::Result<ExitCode> {
    if arguments.from.is_empty() {
        collide_at_rest(arguments)
    } else {
        motion::collide(arguments)
    }
}

fn collide_at_rest(arguments: &CollideArguments) -> anyhow::Result<ExitCode> {
    let engines = || engine::all().iter().map(|entry| entry.name);
    let exact = METHODS.iter().find(|(name, _)| *name == arguments.method);
    if exact.is_none() && !engines().any(|name| name == arguments.method) {
        let methods = METHODS.iter().map(|(name, _)| *name).chain(engines());
        return Err(satisfice::Error::unknown("method", &arguments.method, methods).into());
    }
    check(arguments, exact.is_some())?;
    let world = Arc::new(World::read(scene::Request {
        inputs: Inputs {
            paths: arguments.meshes.clone(),
            format: arguments.format.clone(),
            at: arguments.at.clone(),
            weld: arguments.weld,
        },
        kind: arguments.pairs_at_rest().into(),
        threshold: arguments.threshold(),
        within: arguments.within,
        ring_width: arguments.ring_width,
        find: arguments.find.find(),
        solid: arguments.solid,
    })?);
    let cancel = interrupt::listen()?;
    let mut answer = match exact {
        Some(&(name, method)) => by_exact_method(arguments, &world, name, method, &cancel)?,
        None => by_engine(arguments, &world, &cancel)?,
    };
    let files = &mut answer.files;
    let mut steps = Steps::default();
    let report = Report::new(answer.head, answer.pairs, answer.overlaps, &answer.skips, &world);
    if let Some(file) = &mut files.picture {
        let missed = picture::missed(&answer.reference, &report.pairs.pairs);
        let drawn = picture::draw(&world, arguments.up, &report.pairs.pairs, &missed);
        steps.step(drawn.and_then(|drawn| file.write(&drawn)));
    }
    if let Some(file) = &mut files.page {
        let missed = picture::missed(&answer.reference, &report.pairs.pairs);
        let page = page::html(&report, arguments.up, &missed);
        steps.step(page.and_then(|page| file.write(page.as_bytes())));
    }
    if let Some(file) = &mut files.json {
        steps.step(file.write_by(&mut |out| json::write(&report, out)));
    }
    if let Some(file) = &mut files.csv {
        steps.step(file.write_by(&mut |out| csv::write(&report.pairs, &world, out)));
    }
    if files.summary {
        steps.step(output::print(summary::summary(&report).as_bytes()));
    }
    if (report.head.hits == 0 || report.head.answer == satisfice::Completeness::Proved)
        && let Some(hint) = warnings::surfaces_not_compared(&world, &report.touching)
    {
        message::say(format_args!("note: {hint}"));
    }
    steps.outcome()?;
    if answer.is_full {
        return Err(memory::ended(report.head.hits, files.lists_pairs()));
    }
    let is_empty = report.head.hits == 0 && report.overlaps.iter().flatten().next().is_none();
    Ok(ExitCode::from(u8::from(is_empty)))
}

/// What a method found, and where it goes.
struct Answer {
    head: Head,
    pairs: Pairs,
    /// Bodies that overlap as solids, if that was asked for.
    overlaps: Option<Vec<Overlap>>,
    skips: Skips,
    /// All pairs that there are, to show which an engine missed.
    reference: Vec<Pair>,
    files: Files,
    /// Whether memory ended before the search.
    is_full: bool,
}

fn by_exact_method(
    arguments: &CollideArguments,
    world: &Arc<World>,
    name: &str,
    method: Method,
    cancel: &Cancel,
) -> anyhow::Result<Answer> {
    let files = Files::open(arguments, &world.files)?;
    warn(world);
    let (time, hits) = arguments.search.limits();
    let how = Exact {
        method,
        time,
        hits,
        most: usize::try_from(arguments.max_pairs).unwrap_or(usize::MAX),
        witnesses: arguments.witnesses,
        threads: arguments.search.threads(),
        cancel,
    };
    let found = how.find(world)?;
    if found.pairs.len() == how.most && !found.complete && hits.is_none() {
        message::say(format_args!(
            "warning: the list ends after {}; --max-pairs N lists more, in about 40 bytes of memory each",
            summary::pairs_in_words(how.most)
        ));
    }
    Ok(Answer {
        head: Head::of_exact(name, &how, &found, world),
        pairs: found.pairs,
        overlaps: found.overlaps,
        skips: found.skips,
        reference: Vec::new(),
        files,
        is_full: found.is_full,
    })
}

fn by_engine(arguments: &CollideArguments, world: &Arc<World>, cancel: &Cancel) -> anyhow::Result<Answer> {
    let mut spec = arguments.search.spec(&arguments.method)?;
    if arguments.prune {
        spec = spec.set("prune", "yes");
    }
    let files = Files::open(arguments, &world.files)?;
    warn(world);
    let Searched {
        mut report,
        pairs,
        apart,
    } = search::find(world, &spec, arguments.witnesses, cancel)?;
    let reference = Arc::new(Mutex::new((Vec::new(), Skips::default())));
    let (counted, kept) = (Arc::clone(world), Arc::clone(&reference));
    let most = usize::try_from(arguments.max_pairs).unwrap_or(usize::MAX);
    report.set_reference(reference::wait_for(
        "the scene",
        arguments.search.patience(report.elapsed_seconds),
        cancel,
        || {},
        move || count(&counted, most, &kept),
    ));
    let (reference, mut skips) = reference
        .lock()
        .map(|mut kept| std::mem::take(&mut *kept))
        .unwrap_or_default();
    if apart > 0 {
        skips.boxes_apart = apart;
    }
    Ok(Answer {
        head: Head::of_search(report, world),
        pairs,
        overlaps: None,
        skips,
        reference,
        files,
        is_full: false,
    })
}

/// So many threads, 0 for as many as there are cores, and no more than that: they compute, and wait for nothing.
fn threads(threads: usize) -> anyhow::Result<rayon::ThreadPool> {
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let threads = if threads == 0 { cores } else { threads.min(cores) };
    Ok(rayon::ThreadPoolBuilder::new().num_threads(threads).build()?)
}

/// Refuses options that do not go together, before anything is read.
fn check(arguments: &CollideArguments, is_exact: bool) -> anyhow::Result<()> {
    if arguments.threshold() == 0.0 {
        bail!(
            "--threshold 0 asks for pairs that touch in a motion, between --from and --to: bodies at rest need a distance above 0, such as 1e-300 for surfaces that meet (--pairs triangle-triangle)"
        );
    }
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
    if arguments.solid && !is_exact {
        bail!("--solid is answered by the exact methods: leave out --method {method}");
    }
    if hits.is_some() && ["grid", "brute-force"].contains(&method.as_str()) {
        bail!("--method {method} does not count its hits: for --hits choose exact, tree or an engine");
    }
    if method == "grid" && arguments.pairs_at_rest() != arguments::PairKind::VertexVertex {
        bail!("--method grid is for --pairs vertex-vertex: choose exact or tree");
    }
    let draws = arguments.picture.is_some() || arguments.page.is_some();
    if arguments.up.is_some() && !draws {
        bail!("--up says how a picture or a page is drawn: add --picture FILE.png or --page FILE.html");
    }
    picture::check(arguments.picture.as_deref())?;
    crate::page::check(arguments.page.as_deref())
}

fn warn(world: &World) {
    for warning in warnings::warnings(world) {
        message::say(format_args!("warning: {warning}"));
    }
}

/// Counts the pairs by an exact method; keeps them, and what was skipped, if they are at most so many.
fn count(world: &World, most: usize, kept: &Mutex<(Vec<Pair>, Skips)>) -> Option<u64> {
    let mut scene = world.scene(Method::Auto).ok()?;
    let mut pass = scene.pass();
    let done = scene.advance(&mut pass, &mut |found| found > most).ok()?;
    if done != Completeness::Proved {
        drop(pass);
        return scene.count_until(&|_| false).ok().map(|(count, _)| count);
    }
    let mut pairs: Vec<Pair> = world.pairs(scene.found_by(&pass)).collect();
    pairs.sort_unstable_by_key(Pair::order);
    let count = pairs.len() as u64;
    if let Ok(mut kept) = kept.lock() {
        *kept = (pairs, pass.skips());
    }
    Some(count)
}
