//! Whether the bodies of an animation move straight between two times of it, as a step takes them to.

use super::super::body::NamedBody;
use super::super::digits::digits;

/// So many times within the step are looked at. A bend that begins and ends between two of them is not seen.
const LOOKS: u32 = 7;
/// A body that stays so close to the step, as a part of its size, is taken to move straight.
const STRAIGHT: f64 = 0.01;

/// A body and how far it is from where a step has it.
struct Bend {
    body: String,
    seconds: f64,
    away: f64,
    /// As a part of the body's size.
    part: f64,
}

/// What is said of the body that is farthest from the straight step between these ends, in its sizes, if it is worth saying.
pub(super) fn bent(
    [from, to]: [&[NamedBody]; 2],
    [start, end]: [f64; 2],
    at: impl Fn(f64) -> anyhow::Result<Vec<NamedBody>>,
) -> anyhow::Result<Option<String>> {
    let mut worst: Option<Bend> = None;
    for look in 1..=LOOKS {
        let part = f64::from(look) / f64::from(LOOKS + 1);
        let seconds = start * (1.0 - part) + end * part;
        for (there, (from, to)) in at(seconds)?.into_iter().zip(from.iter().zip(to)) {
            let ends = from.vertices().zip(to.vertices());
            let squares = ends.zip(there.vertices()).map(|((p, q), there)| {
                let along = |k: usize| p[k] * (1.0 - part) + q[k] * part;
                (0..3).map(|k| (there[k] - along(k)).powi(2)).sum::<f64>()
            });
            let away = squares.fold(0.0, f64::max).sqrt();
            let bend = Bend {
                part: away / from.bounds().size(),
                body: there.name,
                seconds,
                away,
            };
            if bend.part > worst.as_ref().map_or(STRAIGHT, |known| known.part) {
                worst = Some(bend);
            }
        }
    }
    Ok(worst.map(|bend| {
        format!(
            "the bodies do not move straight: at {} s {} is {} from where the step has it; smaller steps come closer",
            digits(bend.seconds),
            bend.body,
            digits(bend.away)
        )
    }))
}
