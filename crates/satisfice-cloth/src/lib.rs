//! Experiment II: a cloth of n x n particles that falls on a sphere.
//!
//! Springs by extended position-based dynamics in small steps (Macklin, Müller, Chentanez 2016, doi 10.1145/2994258.2994272;
//! Macklin et al. 2019, doi 10.1145/3309486.3340247): unconditionally stable, and deterministic, since every loop runs in a fixed
//! order on one thread. [`satisfice_collision::scene::World`] detects the contacts of the cloth with the sphere and with itself;
//! nothing else keeps the cloth from passing through itself.
//!
//! ```
//! use satisfice_cloth::{Settings, Simulation};
//! let mut cloth = Simulation::new(&Settings { columns: 16, ..Settings::default() })?;
//! for _ in 0..5 {
//!     cloth.frame()?; // a sixtieth of a second
//! }
//! assert!(cloth.centre()[2] < cloth.settings().start_height());
//! # Ok::<(), satisfice_collision::Error>(())
//! ```

mod problem;
mod settings;
mod simulation;
mod springs;

pub use problem::{Cloth, FallenCloth};
pub use settings::{Response, Settings};
pub use simulation::{Contacts, Crossings, Simulation};
