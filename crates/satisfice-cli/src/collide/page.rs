//! The page of a scene: bodies, the pairs found and those missed, in the order found.

use std::path::Path;

use anyhow::bail;
use satisfice_catalogue::quantity::shown;
use satisfice_collision::FeatureKind;
use satisfice_page::{Contact, Feature, ScenePage, Up};

use super::arguments::Axis;
use super::pairs::Pairs;
use super::picture::up_of;
use super::report::Report;
use super::scene::{Pair, World};
use super::summary;

/// A page lists at most so many pairs found, and so many missed, evenly chosen; it says so.
const LISTED: usize = 100_000;

/// Refuses a file that is not a page, before the work begins.
pub(super) fn check(path: Option<&Path>) -> anyhow::Result<()> {
    if let Some(path) = path
        && path != Path::new("-")
        && !path.extension().is_some_and(|ending| {
            ["html", "htm"]
                .iter()
                .any(|html| ending.eq_ignore_ascii_case(html))
        })
    {
        bail!("cannot write {}: a page is an .html file", path.display());
    }
    Ok(())
}

fn kind(kind: FeatureKind) -> satisfice_page::FeatureKind {
    match kind {
        FeatureKind::Vertex => satisfice_page::FeatureKind::Vertex,
        FeatureKind::Edge => satisfice_page::FeatureKind::Edge,
        FeatureKind::Triangle => satisfice_page::FeatureKind::Triangle,
    }
}

/// The page of a report, with the pairs that were missed as far as they are known.
pub(super) fn html(report: &Report<'_>, up: Option<Axis>, missed: &[Pair]) -> anyhow::Result<String> {
    let (world, head) = (report.world, &report.head);
    let names: Vec<&str> = world.bodies.iter().map(|body| body.name.as_str()).collect();
    let title = match names[..] {
        [one] => one.to_owned(),
        [one, two] => format!("{one} and {two}"),
        [first, ..] => format!("{first} and {} more bodies", names.len() - 1),
        [] => String::new(),
    };
    let (kind_a, kind_b) = world.kinds();
    let title = format!("{title}: {} pairs", world.request.kind.name());
    let mut page = ScenePage::new(title, [kind(kind_a), kind(kind_b)]);
    page.up(match up_of(world, up) {
        Axis::X => Up::X,
        Axis::Y => Up::Y,
        Axis::Z => Up::Z,
    });
    page.threshold(head.threshold);
    page.method(&head.engine);
    for body in &world.bodies {
        let mesh = &body.mesh;
        page.body(&body.name, mesh.vertices(), mesh.triangles(), mesh.lines());
    }
    page.fact("Completeness", summary::completeness(report));
    page.fact("Time", summary::elapsed(head));
    page.fact("Evaluations", shown::count(head.evaluations));
    for (reason, count) in &report.skipped {
        page.fact("Skipped", format!("{} {reason}", shown::count(*count)));
    }
    add(&mut page, world, &report.pairs, missed)?;
    page.counts(Some(head.hits), head.reference_hits);
    Ok(page.html()?)
}

fn add(page: &mut ScenePage, world: &World, pairs: &Pairs, missed: &[Pair]) -> anyhow::Result<()> {
    let measure = world.measure()?;
    let contact = |pair: &Pair| -> anyhow::Result<Contact> {
        let near = measure.proximity(pair)?;
        let features = [pair.a, pair.b].map(|side| Feature {
            body: side.body as usize,
            number: side.feature,
        });
        Ok(Contact::new(features, [near.point_a, near.point_b]))
    };
    for index in evenly(pairs.len()) {
        let mut listed = contact(&pairs.pairs[index])?;
        if let Some(distance) = pairs.distance(index) {
            listed = listed.distance(distance);
        }
        if let Some((evaluation, seconds)) = pairs.found.as_ref().map(|found| found[index]) {
            listed = listed.found(evaluation, seconds);
        }
        page.contact(listed);
    }
    for index in evenly(missed.len()) {
        page.contact(contact(&missed[index])?.missed());
    }
    Ok(())
}

/// At most [`LISTED`] of so many.
fn evenly(count: usize) -> impl Iterator<Item = usize> {
    (0..count).step_by(count.div_ceil(LISTED).max(1))
}
