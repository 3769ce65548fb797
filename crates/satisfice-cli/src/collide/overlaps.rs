//! `--solid`: which closed bodies overlap, how they lie, and how deep.

use anyhow::Context;
use satisfice_collision::scene::Completeness;
use satisfice_collision::solid::{self, Relation, Solid};
use serde::{Deserialize, Serialize};

use super::body::NamedBody;
use super::digits::digits;

/// Two bodies that overlap.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Overlap {
    pub(super) a: usize,
    pub(super) b: usize,
    pub(super) relation: Lies,
    /// No shorter translation separates them.
    pub(super) depth_at_least: f64,
    /// A translation of this length does; `null` where none is known.
    pub(super) depth_at_most: Option<f64>,
    /// Where it moves the first body, of length 1.
    pub(super) direction: [f64; 3],
}

/// How two bodies lie that overlap.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Lies {
    SurfacesMeet,
    AInsideB,
    BInsideA,
    /// Some connected parts of one inside the other.
    PartsInside,
}

impl From<Relation> for Lies {
    fn from(relation: Relation) -> Self {
        match relation {
            Relation::SurfacesMeet => Self::SurfacesMeet,
            Relation::FirstInsideSecond => Self::AInsideB,
            Relation::SecondInsideFirst => Self::BInsideA,
            Relation::PartsInside => Self::PartsInside,
        }
    }
}

/// The bodies as solids.
///
/// # Errors
/// If one is not closed.
pub(super) fn solids(bodies: &[NamedBody]) -> anyhow::Result<Vec<Solid>> {
    let of = |body: &NamedBody| {
        let solid = body.placed().and_then(|mesh| Solid::new(&mesh));
        solid.with_context(|| format!("--solid asks for solids, which {} is not", body.name))
    };
    bodies.iter().map(of).collect()
}

/// The bodies that overlap, as far as they were found until `stop`, and whether these are all, with the best bounds of their depths.
pub(super) fn find(solids: &[Solid], stop: &(dyn Fn() -> bool + Sync)) -> (Vec<Overlap>, bool) {
    let pairs = (0..solids.len()).flat_map(|a| (a + 1..solids.len()).map(move |b| (a, b)));
    let mut found = Vec::new();
    for (a, b) in pairs {
        if stop() {
            return (found, false);
        }
        let (overlap, completeness) = solid::overlap(&solids[a], &solids[b], stop);
        if let Some(solid::Overlap { relation, depth }) = overlap {
            found.push(Overlap {
                a,
                b,
                relation: relation.into(),
                depth_at_least: depth.at_least,
                depth_at_most: Some(depth.at_most).filter(|depth| depth.is_finite()),
                direction: depth.direction,
            });
        }
        if completeness == Completeness::Unknown {
            return (found, false);
        }
    }
    (found, true)
}

impl Overlap {
    /// Whether both say the same, as far as each of them knows.
    pub(super) fn agrees(&self, other: &Self) -> bool {
        let below = |least: f64, most: Option<f64>| {
            most.is_none_or(|most| least <= most * (1.0 + 1e-9) + f64::MIN_POSITIVE)
        };
        (self.a, self.b, self.relation) == (other.a, other.b, other.relation)
            && below(self.depth_at_least, other.depth_at_most)
            && below(other.depth_at_least, self.depth_at_most)
    }

    /// In words.
    pub(super) fn text(&self, bodies: &[NamedBody]) -> String {
        let (a, b) = (&bodies[self.a].name, &bodies[self.b].name);
        let how = match self.relation {
            Lies::SurfacesMeet => format!("the surfaces of {a} and {b} meet"),
            Lies::AInsideB => format!("{a} lies inside {b}"),
            Lies::BInsideA => format!("{b} lies inside {a}"),
            Lies::PartsInside => format!("parts of {a} or {b} lie inside the other"),
        };
        let least = self.depth_at_least;
        let depth = match self.depth_at_most {
            None => format!("depth at least {}", digits(least)),
            Some(most) if digits(most) == digits(least) => format!("depth {}", digits(most)),
            Some(most) => format!("depth {} to {}", digits(least), digits(most)),
        };
        format!("{how}, {depth}")
    }
}
