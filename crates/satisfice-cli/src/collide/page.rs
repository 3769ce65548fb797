//! The page of a scene: bodies, the pairs found and those missed, in the order found.

use satisfice_catalogue::quantity::shown;
use satisfice_collision::FeatureKind;
use satisfice_page::{Contact, Feature, ScenePage, Up};

use super::arguments::Axis;
use super::body::NamedBody;
use super::pairs::Pairs;
use super::picture::up_of;
use super::report::Report;
use super::scene::{Pair, World};
use super::summary;
use crate::page::{LISTED, evenly};

pub(super) fn kind(kind: FeatureKind) -> satisfice_page::FeatureKind {
    match kind {
        FeatureKind::Vertex => satisfice_page::FeatureKind::Vertex,
        FeatureKind::Edge => satisfice_page::FeatureKind::Edge,
        FeatureKind::Triangle => satisfice_page::FeatureKind::Triangle,
    }
}

/// What bodies are called together.
pub(super) fn title(bodies: &[NamedBody]) -> String {
    let names: Vec<&str> = bodies.iter().map(|body| body.name.as_str()).collect();
    match names[..] {
        [] => String::new(),
        [one] => one.to_owned(),
        [one, two] => format!("{one} and {two}"),
        [first, ..] => format!("{first} and {} more bodies", names.len() - 1),
    }
}

/// The axis that points upwards.
pub(super) fn up(bodies: &[NamedBody], asked: Option<Axis>) -> Up {
    match up_of(bodies, asked) {
        Axis::X => Up::X,
        Axis::Y => Up::Y,
        Axis::Z => Up::Z,
    }
}

/// The page of a report, with the pairs that were missed as far as they are known.
pub(super) fn html(report: &Report<'_>, asked: Option<Axis>, missed: &[Pair]) -> anyhow::Result<String> {
    let (world, head) = (report.world, &report.head);
    let mut page = ScenePage::new(format!(
        "{}: {} pairs",
        title(&world.bodies),
        world.request.kind.name()
    ));
    page.up(up(&world.bodies, asked));
    if head.threshold.is_finite() {
        page.threshold(head.threshold);
    }
    page.method(&head.engine);
    for body in &world.bodies {
        let mesh = body.placed()?;
        page.body(&body.name, mesh.vertices(), mesh.triangles(), mesh.lines());
    }
    let (name, says) = summary::assurance(report);
    page.fact(name, says);
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
    let (kind_a, kind_b) = world.kinds();
    let contact = |pair: &Pair| -> anyhow::Result<Contact> {
        let near = measure.proximity(pair)?;
        let features = [(pair.a, kind_a), (pair.b, kind_b)].map(|(side, of)| Feature {
            body: side.body as usize,
            kind: kind(of),
            number: side.feature,
        });
        Ok(Contact::new(features, [near.point_a, near.point_b]))
    };
    for index in evenly(pairs.len(), LISTED) {
        let mut listed = contact(&pairs.pairs[index])?;
        if let Some(distance) = pairs.distance(index) {
            listed = listed.distance(distance);
        }
        if let Some((evaluation, seconds)) = pairs.found.as_ref().map(|found| found[index]) {
            listed = listed.found(evaluation, seconds);
        }
        page.contact(listed);
    }
    for index in evenly(missed.len(), LISTED) {
        page.contact(contact(&missed[index])?.missed());
    }
    Ok(())
}
