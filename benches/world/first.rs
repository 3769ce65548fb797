//! The first frame with its pairs of triangles, beside parry3d's trees of bodies and of triangles.

use std::fmt;

use satisfice_collision::generate;

use crate::measure::{Meshes, add, boxes_of, median, time};
use crate::peers::{self, Triangles};
use crate::scenes::Scene;

/// Both sides take turns so often.
const ROUNDS: usize = 5;

/// A row of the table.
pub(crate) struct FirstRow {
    name: String,
    ours: f64,
    theirs: f64,
    contacts: usize,
    their_contacts: usize,
}

impl FirstRow {
    pub(crate) const HEADING: &'static str =
        "| scene | world ms | parry ms | ratio | contacts | of parry |\n|---|---|---|---|---|---|";
}

impl fmt::Display for FirstRow {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "| {} | {:.2} | {:.2} | {:.2} | {} | {} |",
            self.name,
            self.ours,
            self.theirs,
            self.theirs / self.ours,
            self.contacts,
            self.their_contacts,
        )
    }
}

/// The first frame of a scene; meshes are made before, trees within the time.
pub(crate) fn first_frame(scene: &Scene) -> FirstRow {
    let (mut ours, mut theirs, mut counts) = (Vec::new(), Vec::new(), [0; 2]);
    for _ in 0..ROUNDS {
        let meshes = Meshes::new(scene);
        let run = time(|| {
            let (mut world, _) = add(scene, &meshes);
            world.update().expect("a frame");
            world.contacts().count()
        });
        ours.push(run.0);
        counts[0] = run.1;
        let of = |radius: f64| generate::icosphere(radius, 1).expect("a sphere");
        let shapes = [0, 1].map(|body| of(scene.radius(body)));
        let run = time(|| {
            let shapes = shapes.each_ref().map(Triangles::new);
            let pairs = peers::pairs(&boxes_of(scene, &scene.centres));
            let near = |&(a, b): &(u32, u32)| {
                let [a, b] = [a as usize, b as usize];
                let apart = std::array::from_fn(|k| scene.centres[b][k] - scene.centres[a][k]);
                shapes[a.min(1)].near(&shapes[b.min(1)], apart, 0.01)
            };
            pairs.iter().map(near).sum()
        });
        theirs.push(run.0);
        counts[1] = run.1;
    }
    FirstRow {
        name: scene.name.clone(),
        ours: median(&mut ours),
        theirs: median(&mut theirs),
        contacts: counts[0],
        their_contacts: counts[1],
    }
}
