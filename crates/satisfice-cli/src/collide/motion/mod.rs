//! `satisfice collide --from A --to B`: what comes near while bodies move from one frame to the next.

mod answer;
mod bent;
mod csv;
mod ends;
mod frames;
mod page;
mod report;
mod summary;
mod verify;

use std::process::ExitCode;

use anyhow::bail;
use satisfice_catalogue::json;

use super::arguments::{CollideArguments, Find};
use super::files::Files;
use super::summary::pairs_in_words;
use crate::output::{self, Steps};
use crate::{interrupt, message};
use answer::Search;
use ends::Ends;
use frames::{Frames, MotionRequest};
use report::MotionReport;
pub(super) use verify::{is_of_motion, verify};

/// Times of impact are known to within this part of the step.
const TOLERANCE: f64 = 1e-6;

pub(super) fn collide(arguments: &CollideArguments) -> anyhow::Result<ExitCode> {
    check(arguments)?;
    crate::page::check(arguments.page.as_deref())?;
    let frames = Frames::read(MotionRequest {
        ends: Ends::of_arguments(arguments)?,
        pairs: arguments.pairs.map(Into::into),
        threshold: arguments.threshold(),
        within: arguments.within,
        first: arguments.find.find() == Find::First,
    })?;
    let mut files = Files::open(arguments, &frames.files)?;
    if frames.is_at_rest() {
        message::say(format_args!(
            "warning: no vertex moves: the coordinates are the same at --from and --to"
        ));
    }
    if let Some(bent) = &frames.bent {
        message::say(format_args!("warning: {bent}"));
    }
    let cancel = interrupt::listen()?;
    let (time, hits) = arguments.search.limits();
    let search = Search {
        time,
        hits,
        most: usize::try_from(arguments.max_pairs).unwrap_or(usize::MAX),
        threads: arguments.search.threads(),
        cancel: &cancel,
    };
    let report = MotionReport::new(search.run(&frames)?, &search, &frames);
    if report.is_cut() {
        message::say(format_args!(
            "warning: the list ends after {}; --max-pairs N lists more, in 40 bytes of memory each",
            pairs_in_words(search.most)
        ));
    }
    let mut steps = Steps::default();
    if let Some(file) = &mut files.json {
        steps.step(file.write_by(&mut |out| json::write(&report, out)));
    }
    if let Some(file) = &mut files.page {
        let page = page::html(&report, arguments.up);
        steps.step(page.and_then(|page| file.write(page.as_bytes())));
    }
    if let Some(file) = &mut files.csv {
        steps.step(file.write_by(&mut |out| csv::write(&report, out)));
    }
    if files.summary {
        steps.step(output::print(summary::summary(&report).as_bytes()));
    }
    if let (0, Some(kind)) = (report.head.hits, frames.request.pairs) {
        message::say(format_args!(
            "note: only {} pairs were compared; without --pairs all those in which surfaces, wires and points first meet",
            kind.name()
        ));
    }
    steps.outcome()?;
    Ok(ExitCode::from(u8::from(report.head.hits == 0)))
}

/// Refuses options that a motion has no use for, before anything is read.
fn check(arguments: &CollideArguments) -> anyhow::Result<()> {
    if arguments.method != "exact" {
        bail!("a motion is searched by --method exact: leave --method out");
    }
    let engine_only = arguments.search.for_an_engine();
    let useless = [
        (arguments.prune, "--prune"),
        (arguments.weld.is_some(), "--weld"),
        (arguments.ring_width.is_some(), "--ring-width"),
        (arguments.picture.is_some(), "--picture"),
        (arguments.up.is_some() && arguments.page.is_none(), "--up"),
    ];
    let given = useless
        .iter()
        .find(|(given, _)| *given)
        .map(|(_, option)| *option);
    if let Some(option) = given.or(engine_only.first().map(String::as_str)) {
        bail!("a motion has no use for {option}: leave it out, or name the meshes without --from and --to");
    }
    match arguments.find.find() {
        Find::All | Find::First => {}
        other => bail!(
            "a motion is asked for all pairs or, by --first, for the earliest impact: leave out --{}",
            other.name()
        ),
    }
    if arguments.find.find() == Find::First && arguments.search.limits().1.is_some() {
        bail!("--first asks for one pair: leave out --hits");
    }
    Ok(())
}
