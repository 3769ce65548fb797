//! The page of a motion: the bodies on their way, and each pair from its time of impact on.

use satisfice_catalogue::quantity::shown;
use satisfice_page::{Contact, Feature, ScenePage};

use super::super::page::{kind, title, up};
use super::super::summary::elapsed;
use super::report::MotionReport;
use super::summary;

/// The step is shown at its start and at the end of so many equal parts.
const PARTS: u32 = 20;
/// A page lists at most so many pairs, evenly chosen; it says so.
const LISTED: usize = 5000;

/// The page of a report. Pairs whose time was not computed are counted, not drawn.
pub(super) fn html(
    report: &MotionReport<'_>,
    asked: Option<super::super::arguments::Axis>,
) -> anyhow::Result<String> {
    let (frames, head) = (report.frames, &report.head);
    let mut page = ScenePage::new(format!("{}: impacts during a step", title(&frames.bodies)));
    page.up(up(&frames.bodies, asked));
    if head.threshold > 0.0 {
        page.threshold(head.threshold);
    }
    page.method(&head.engine);
    for body in &frames.bodies {
        let mesh = body.placed()?;
        page.body(&body.name, mesh.vertices(), mesh.triangles(), mesh.lines());
    }
    page.fact("Completeness", summary::completeness(report));
    page.fact("First impact", summary::first_impact(report));
    page.fact("Time", elapsed(head));
    let every = report.pairs.len().div_ceil(LISTED).max(1);
    let listed = report.pairs.iter().step_by(every);
    let contacts: Vec<(f64, Contact)> = listed
        .filter_map(|hit| {
            let impact = report.impact(hit)?;
            let (kind_a, kind_b) = frames.kinds[usize::from(hit.kind)].features();
            let features = [(hit.contact.a, kind_a), (hit.contact.b, kind_b)].map(|(side, of)| Feature {
                body: side.body as usize,
                kind: kind(of),
                number: side.index,
            });
            let contact = Contact::new(features, [impact.point_a, impact.point_b]).impact(hit.time[0]);
            Some((hit.time[0], contact))
        })
        .collect();
    if every > 1 || contacts.len() < report.pairs.len() {
        let drawn = shown::count(contacts.len() as u64);
        page.fact(
            "Drawn",
            format!("{drawn} of {} pairs", shown::count(report.pairs.len() as u64)),
        );
    }
    for part in 0..=PARTS {
        let time = f64::from(part) / f64::from(PARTS);
        page.frame(format!("{time:.2} of the step"));
        for (number, (body, end)) in frames.bodies.iter().zip(&frames.ends).enumerate() {
            let ends = body.vertices().zip(end.vertices());
            let now = ends.map(|(from, to)| std::array::from_fn(|k| (1.0 - time) * from[k] + time * to[k]));
            page.move_body(number, &now.collect::<Vec<_>>())?;
        }
        let so_far = contacts.iter().filter(|(impact, _)| *impact <= time);
        so_far.for_each(|(_, contact)| page.contact(*contact));
        let so_far = report
            .pairs
            .iter()
            .filter(|hit| hit.is_timed() && hit.time[0] <= time);
        page.counts(Some(so_far.count() as u64), head.reference_hits);
    }
    Ok(page.html()?)
}
