//! The data of a scene's page: checked, sorted, quantised.

use serde_json::{Value, json};

use super::{Body, Contact, FeatureKind, Frame, ScenePage, Up};
use crate::error::Error;
use crate::pack::{Pack, differences, zigzag};

/// Kinds by their number in the data.
const KINDS: [FeatureKind; 3] = [FeatureKind::Vertex, FeatureKind::Edge, FeatureKind::Triangle];

/// Coordinates as whole numbers of one cubic lattice.
struct Lattice {
    low: [f64; 3],
    /// The largest extent.
    span: f64,
    bits: u32,
}

impl Lattice {
    fn of(page: &ScenePage) -> Self {
        let mut low = [f64::INFINITY; 3];
        let mut high = [f64::NEG_INFINITY; 3];
        let vertices = page.bodies.iter().flat_map(|body| &body.positions);
        let contacts = page.frames.iter().flat_map(|frame| &frame.contacts);
        let points = vertices
            .flat_map(|(_, all)| all)
            .chain(contacts.flat_map(|contact| &contact.points));
        for point in points {
            for axis in 0..3 {
                // Halved, so that no difference overflows.
                low[axis] = low[axis].min(0.5 * point[axis]);
                high[axis] = high[axis].max(0.5 * point[axis]);
            }
        }
        let span = (0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max);
        let finest = page.threshold.map_or(0.0, |threshold| 16.0 * span / threshold);
        // A lattice of 2^24 values is what a graphics card tells apart.
        let bits = if finest > 0.0 {
            finest.log2().ceil().clamp(16.0, 24.0) as u32
        } else {
            16
        };
        Self { low, span, bits }
    }

    fn last(&self) -> f64 {
        f64::from((1_u32 << self.bits) - 1)
    }

    fn place(&self, point: [f64; 3]) -> [u32; 3] {
        std::array::from_fn(|axis| {
            let share = (0.5 * point[axis] - self.low[axis]) / self.span;
            // Without extent every share is NaN, and NaN becomes 0.
            (share * self.last()).round() as u32
        })
    }

    fn places(&self, points: &[[f64; 3]]) -> Vec<u32> {
        points.iter().flat_map(|&point| self.place(point)).collect()
    }
}

pub(super) fn encode(page: &ScenePage) -> Result<String, Error> {
    for (number, body) in page.bodies.iter().enumerate() {
        check_body(number, body)?;
    }
    let contacts = page.frames.iter().flat_map(|frame| &frame.contacts);
    contacts
        .clone()
        .try_for_each(|contact| check_contact(page, contact))?;

    let lattice = Lattice::of(page);
    let mut pack = Pack::default();
    let bodies: Vec<Value> = page
        .bodies
        .iter()
        .enumerate()
        .map(|(number, body)| pack_body(&mut pack, &lattice, number, body))
        .collect();
    let frames: Vec<Value> = page.frames.iter().map(frame_line).collect();
    pack_contacts(&mut pack, &lattice, page);
    let finite = |x: f64| if x.is_finite() { json!(x) } else { Value::Null };
    let header = json!({
        "title": page.title,
        "kinds": KINDS.map(FeatureKind::name),
        "up": match page.up { Up::X => "x", Up::Y => "y", Up::Z => "z" },
        "threshold": page.threshold.map(finite),
        "method": page.method,
        "facts": page.facts,
        "bits": lattice.bits,
        "low": lattice.low.map(|x| finite(2.0 * x)),
        "span": finite(2.0 * lattice.span),
        "bodies": bodies,
        "frames": frames,
    });
    Ok(pack.finish(header)?)
}

fn pack_body(pack: &mut Pack, lattice: &Lattice, number: usize, body: &Body) -> Value {
    pack.u32s(
        &format!("triangles {number}"),
        &differences(body.triangles.as_flattened(), 1),
    );
    pack.u32s(
        &format!("lines {number}"),
        &differences(body.lines.as_flattened(), 1),
    );
    let mut before: Option<Vec<u32>> = None;
    for (frame, points) in &body.positions {
        let places = lattice.places(points);
        let stored = match &before {
            None => differences(&places, 3),
            Some(before) => places
                .iter()
                .zip(before)
                .map(|(now, before)| zigzag(now.wrapping_sub(*before)))
                .collect(),
        };
        pack.u32s(&format!("places {number} {frame}"), &stored);
        before = Some(places);
    }
    let moved: Vec<usize> = body.positions.iter().map(|(frame, _)| *frame).collect();
    json!({ "name": body.name, "moved": moved })
}

fn frame_line(frame: &Frame) -> Value {
    let missed = frame.contacts.iter().filter(|contact| contact.is_missed).count();
    json!({
        "label": frame.label,
        "contacts": frame.contacts.len(),
        "missed": missed,
        "hits": frame.hits,
        "reference": frame.reference,
        "facts": frame.facts,
    })
}

/// Frame by frame in the order in which they were found; those that were missed last.
fn pack_contacts(pack: &mut Pack, lattice: &Lattice, page: &ScenePage) {
    let mut all: Vec<&Contact> = Vec::new();
    for frame in &page.frames {
        let mut listed: Vec<&Contact> = frame.contacts.iter().collect();
        listed.sort_by(|x, y| {
            let key = |contact: &Contact| (contact.is_missed, contact.seconds, contact.evaluation);
            let (x, y) = (key(x), key(y));
            x.0.cmp(&y.0).then(x.1.total_cmp(&y.1)).then(x.2.total_cmp(&y.2))
        });
        all.extend(listed);
    }
    for side in 0..2 {
        let bodies: Vec<u32> = all
            .iter()
            .map(|contact| contact.features[side].body as u32)
            .collect();
        let numbers: Vec<u32> = all.iter().map(|contact| contact.features[side].number).collect();
        let kinds = all.iter().map(|contact| contact.features[side].kind as u32);
        pack.u32s(&format!("kind {side}"), &kinds.collect::<Vec<_>>());
        pack.u32s(&format!("body {side}"), &differences(&bodies, 1));
        pack.u32s(&format!("feature {side}"), &differences(&numbers, 1));
    }
    let points = |side: usize| -> Vec<u32> {
        let all = all.iter().map(|contact| contact.points[side]);
        all.flat_map(|point| lattice.place(point)).collect()
    };
    let (first, second) = (points(0), points(1));
    pack.u32s("point 0", &differences(&first, 3));
    let apart = first.iter().zip(&second).map(|(a, b)| zigzag(b.wrapping_sub(*a)));
    pack.u32s("point 1", &apart.collect::<Vec<_>>());
    let mut known = |name: &str, value: fn(&Contact) -> f64| {
        let values: Vec<f64> = all.iter().map(|contact| value(contact)).collect();
        if values.iter().any(|value| !value.is_nan()) {
            pack.floats(name, &values);
        }
    };
    known("distance", |contact| contact.distance);
    known("evaluation", |contact| contact.evaluation);
    known("seconds", |contact| contact.seconds);
    known("impact", |contact| contact.impact);
}

fn check_body(number: usize, body: &Body) -> Result<(), Error> {
    let expected = body.positions.first().map_or(0, |(_, vertices)| vertices.len());
    for (_, vertices) in &body.positions {
        if vertices.len() != expected {
            return Err(Error::Vertices {
                body: number,
                expected,
                found: vertices.len(),
            });
        }
        if !vertices.as_flattened().iter().all(|x| x.is_finite()) {
            return Err(Error::NotFinite {
                what: format!("body {number}"),
            });
        }
    }
    let named = body
        .triangles
        .as_flattened()
        .iter()
        .chain(body.lines.as_flattened());
    match named.max() {
        Some(&most) if most as usize >= expected => Err(Error::Unknown {
            what: "vertex",
            number: most as usize,
            count: expected,
        }),
        _ => Ok(()),
    }
}

fn check_contact(page: &ScenePage, contact: &Contact) -> Result<(), Error> {
    for feature in &contact.features {
        let kind = feature.kind;
        let unknown = |what, number, count| Err(Error::Unknown { what, number, count });
        let Some(body) = page.bodies.get(feature.body) else {
            return unknown("body", feature.body, page.bodies.len());
        };
        let number = feature.number as usize;
        // Edges are not counted here: a number beyond them is shown without a mark.
        let count = match kind {
            FeatureKind::Vertex => body.positions.first().map_or(0, |(_, vertices)| vertices.len()),
            FeatureKind::Triangle => body.triangles.len(),
            FeatureKind::Edge => usize::MAX,
        };
        if number >= count {
            return unknown(kind.name(), number, count);
        }
    }
    if !contact.points.as_flattened().iter().all(|x| x.is_finite()) {
        return Err(Error::NotFinite {
            what: "a contact".to_owned(),
        });
    }
    Ok(())
}
