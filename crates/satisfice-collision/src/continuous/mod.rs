//! Continuous collision: whether and when two moving features come near each other.
//!
//! Vertices move along straight lines at constant speed during a step, from time 0 to time 1. Three questions about a pair
//! (vertex and vertex, vertex and edge, vertex and triangle, edge and edge):
//!
//! * [`is_hit`]: whether the Euclidean distance is below delta at some time of the step;
//! * [`touches`]: whether the distance is 0 at some time;
//! * [`impact`]: the first such time between two proved bounds, and where.
//!
//! Every answer is right for the coordinates exactly as given, without a setting or a tolerance. Floating point decides
//! where it proves the answer (`advance`), integers of any size decide the rest (`exact`), and [`DecidedBy`] says which.
//! A degenerate triangle or edge is the segment or the point it geometrically is.
//!
//! ```
//! use satisfice_collision::continuous::{Moving, Separation, impact, touches};
//! let floor = Moving::at_rest([[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]]);
//! let falling = Moving::new([1.0, 1.0, 3.0], [1.0, 1.0, -1.0]);
//! assert!(touches(&falling, &floor));
//! let impact = impact(&falling, &floor, Separation::TOUCHING, 1e-6)?.expect("it falls through");
//! assert!(impact.time[0] <= 0.75 && 0.75 <= impact.time[1]);
//! # Ok::<(), satisfice_collision::Error>(())
//! ```

mod advance;
mod body_order;
mod boxes;
mod conditions;
mod cubic;
mod deadline;
mod divisors;
mod earliest;
mod exact;
mod form;
mod four;
mod hits;
mod hull;
mod integers;
mod looks;
mod meetings;
mod motion;
mod near_bodies;
mod nearest;
mod one_pair;
mod pairs;
mod problem;
mod query;
mod resolve;
mod rigid;
mod rounded;
mod separation;
mod sight;
mod step;
mod step_tree;
mod swept;
mod system;
mod tree;
mod vector;
mod waiting;

pub use crate::distance::DecidedBy;
pub use earliest::Earliest;
pub use hits::Hits;
pub use motion::Moving;
pub use pairs::Against;
pub use problem::MovingPairs;
pub use query::{Decided, Impact, decide, impact, is_hit, touches};
pub use rigid::{RigidHits, RigidMotion, rigid_hits};
pub use separation::Separation;
pub use step::{FeatureOf, MovingContact, Step};
