//! The simulation: particles, springs, gravity, and contacts that the collision crate detects.

use satisfice_collision::distance::{PairKind, Point, Threshold};
use satisfice_collision::scene::{Body, BodyId, World};
use satisfice_collision::{Error, Mesh, generate};

use crate::settings::{Response, Settings};
use crate::springs::{Spring, relax, springs};

/// Relaxation steps of the springs between two detections.
const SUBSTEPS: u32 = 2;
/// Frames per second.
const FRAMES: f64 = 60.0;
/// Gravity, m/s^2, along -z.
const GRAVITY: f64 = 9.81;
/// The thickness: the distance kept between two particles, and between a particle and the sphere, in spacings.
const THICKNESS: f64 = 0.85;

/// A falling cloth.
pub struct Simulation {
    settings: Settings,
    cloth: Mesh,
    sphere: Mesh,
    springs: Vec<Spring>,
    points: Vec<Point>,
    before: Vec<Point>,
    velocities: Vec<Point>,
    world: World,
    /// The cloth in it.
    body: BodyId,
    detected: Contacts,
}

/// The contacts of one detection, as pairs of vertex numbers.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Contacts {
    /// Contacts of the cloth with itself, lower number first.
    pub within: Vec<(u32, u32)>,
    /// Contacts of a cloth vertex with a vertex of the sphere.
    pub sphere: Vec<(u32, u32)>,
}

/// Failures of the simulation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Crossings {
    /// Pairs of triangles of the cloth that intersect and share no vertex.
    pub triangles: usize,
    /// Particles inside the sphere.
    pub inside: usize,
}

impl Simulation {
    /// A flat cloth at rest above the sphere. Its mesh is [`generate::cloth`], the sphere's an icosphere fine enough that every
    /// particle near the sphere is detected.
    ///
    /// # Errors
    /// [`Error::Parameter`] for settings out of range.
    pub fn new(settings: &Settings) -> Result<Self, Error> {
        settings.check()?;
        let columns = settings.columns as usize;
        let flat = generate::cloth(settings.width, settings.width, columns, columns)?;
        let height = settings.start_height();
        // A ripple of a thousandth of a spacing: a cloth that is exactly flat cannot buckle.
        let ripple = |v: usize| 1e-3 * settings.spacing() * (v as f64 * 12.9898).sin();
        let placed = flat.vertices().iter().enumerate();
        let placed = placed
            .map(|(v, &[x, y, _])| [x + settings.beside, y, height + ripple(v)])
            .collect();
        let cloth = flat.with_vertices(placed)?;
        let sphere = sphere(settings)?;
        let mut world = World::new(PairKind::VertexVertex, Threshold::new(settings.delta())?);
        let body = world.add(Body::deforming(cloth.clone()).beyond_ring(1))?;
        world.add(Body::fixed(sphere.clone()))?;
        let points = cloth.vertices().to_vec();
        Ok(Self {
            settings: *settings,
            springs: springs(settings.columns, settings.spacing()),
            before: points.clone(),
            velocities: vec![[0.0; 3]; points.len()],
            points,
            cloth,
            sphere,
            world,
            body,
            detected: Contacts::default(),
        })
    }

    /// The settings.
    #[must_use]
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Positions of the particles.
    #[must_use]
    pub fn points(&self) -> &[Point] {
        &self.points
    }

    /// The cloth as it is now.
    ///
    /// # Errors
    /// [`Error::NonFiniteVertex`] if a position overflowed, which the integrator excludes.
    pub fn mesh(&self) -> Result<Mesh, Error> {
        self.cloth.with_vertices(self.points.clone())
    }

    /// The sphere.
    #[must_use]
    pub fn sphere(&self) -> &Mesh {
        &self.sphere
    }

    /// The contacts detected last.
    #[must_use]
    pub fn contacts(&self) -> &Contacts {
        &self.detected
    }

    /// Steps in a frame.
    #[must_use]
    pub fn steps(&self) -> u32 {
        self.settings.steps()
    }

    /// Mean position of the particles.
    #[must_use]
    pub fn centre(&self) -> Point {
        let n = self.points.len() as f64;
        [0, 1, 2].map(|k| self.points.iter().map(|p| p[k]).sum::<f64>() / n)
    }

    /// Advances by a sixtieth of a second, in steps of [`Simulation::detect`] and [`Simulation::advance`].
    ///
    /// # Errors
    /// As [`Simulation::detect`].
    pub fn frame(&mut self) -> Result<(), Error> {
        for _ in 0..self.steps() {
            self.detect()?;
            self.advance();
        }
        Ok(())
    }

    /// Detects all contacts, exactly.
    ///
    /// # Errors
    /// [`Error::NonFiniteVertex`] if a position overflowed, which the integrator excludes.
    pub fn detect(&mut self) -> Result<(), Error> {
        self.world.deform(self.body, &self.points)?;
        let contacts = self.world.frame()?.contacts;
        self.detected.within.clear();
        self.detected.sphere.clear();
        for contact in contacts {
            let pair = (contact.a, contact.b);
            if contact.body_b == self.body {
                self.detected.within.push(pair);
            } else {
                self.detected.sphere.push(pair);
            }
        }
        Ok(())
    }

    /// Advances the particles by a step, with the contacts detected last.
    pub fn advance(&mut self) {
        let dt = 1.0 / (FRAMES * f64::from(self.steps() * SUBSTEPS));
        let slower = (-self.settings.drag * dt).exp();
        for _ in 0..SUBSTEPS {
            for ((x, v), before) in self
                .points
                .iter_mut()
                .zip(&mut self.velocities)
                .zip(&mut self.before)
            {
                *before = *x;
                v[2] -= GRAVITY * dt;
                for k in 0..3 {
                    v[k] *= slower;
                    x[k] += v[k] * dt;
                }
            }
            relax(&self.springs, &mut self.points, dt);
            self.push_off_sphere();
            if self.settings.response == Response::All {
                self.push_apart();
            }
            for ((x, v), before) in self.points.iter().zip(&mut self.velocities).zip(&self.before) {
                for k in 0..3 {
                    v[k] = (x[k] - before[k]) / dt;
                }
            }
        }
    }

    /// A particle stays half a thickness above the tangent plane of every sphere vertex that it is in contact with.
    fn push_off_sphere(&mut self) {
        let gap = 0.5 * THICKNESS * self.settings.spacing();
        for &(i, j) in &self.detected.sphere {
            let (x, before) = (&mut self.points[i as usize], &self.before[i as usize]);
            let foot = self.sphere.vertex(j);
            let normal = foot.map(|c| c / self.settings.radius);
            let depth = gap - (0..3).map(|k| (x[k] - foot[k]) * normal[k]).sum::<f64>();
            if depth > 0.0 {
                (0..3).for_each(|k| x[k] += depth * normal[k]);
                let moved = [x[0] - before[0], x[1] - before[1], x[2] - before[2]];
                let back = slip(moved, normal, self.settings.friction * depth);
                (0..3).for_each(|k| x[k] -= back[k]);
            }
        }
    }

    /// Two particles stay a thickness apart.
    fn push_apart(&mut self) {
        let gap = THICKNESS * self.settings.spacing();
        for &(i, j) in &self.detected.within {
            let (i, j) = (i as usize, j as usize);
            let (p, q) = (self.points[i], self.points[j]);
            let d = [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
            let square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
            if square >= gap * gap || square <= 0.0 {
                continue;
            }
            let length = square.sqrt();
            let (depth, normal) = (gap - length, d.map(|c| c / length));
            let moved = [0, 1, 2].map(|k| (p[k] - self.before[i][k]) - (q[k] - self.before[j][k]));
            let back = slip(moved, normal, self.settings.friction * depth);
            for k in 0..3 {
                let change = 0.5 * (depth * normal[k] - back[k]);
                self.points[i][k] += change;
                self.points[j][k] -= change;
            }
        }
    }

    /// Failures: triangles of the cloth that pass through each other, decided exactly, and particles in the sphere.
    /// Cost: a traversal of all triangle pairs.
    ///
    /// # Errors
    /// As [`Simulation::mesh`].
    pub fn crossings(&self) -> Result<Crossings, Error> {
        // A billionth of a spacing: closer counts as touching.
        let mut world = World::new(
            PairKind::TriangleTriangle,
            Threshold::new(1e-9 * self.settings.spacing())?,
        );
        world.add(Body::deforming(self.mesh()?))?;
        let square = |p: &Point| p.iter().map(|c| c * c).sum::<f64>();
        Ok(Crossings {
            triangles: {
                world.update()?;
                world.contacts().count()
            },
            inside: self
                .points
                .iter()
                .filter(|p| square(p) < self.settings.radius.powi(2))
                .count(),
        })
    }
}

/// The part of a motion that friction undoes: along the surface, at most `most` long.
fn slip(moved: Point, normal: Point, most: f64) -> Point {
    let along: f64 = (0..3).map(|k| moved[k] * normal[k]).sum();
    let tangent = [0, 1, 2].map(|k| moved[k] - along * normal[k]);
    let length = tangent.iter().map(|c| c * c).sum::<f64>().sqrt();
    if length <= most {
        tangent
    } else {
        tangent.map(|c| c * most / length)
    }
}

/// An icosphere so fine that a particle at rest on it is in contact with one of its vertices, with a tenth to spare.
fn sphere(settings: &Settings) -> Result<Mesh, Error> {
    let gap = 0.5 * THICKNESS * settings.spacing();
    // An icosahedron's edge is 1.05 radii; subdivided ones are at most 1.2 times their mean; a triangle's centre is an edge
    // over the root of 3 away.
    let apart = |level: u32| 1.05 * 1.2 * settings.radius / f64::from(1_u32 << level) / 3.0_f64.sqrt();
    let level = (0..8)
        .find(|&level| apart(level).hypot(gap) <= 0.9 * settings.delta())
        .unwrap_or(8);
    generate::icosphere(settings.radius, level)
}

#[cfg(test)]
mod tests {
    use satisfice_collision::oracle;

    use super::*;

    fn small(response: Response) -> Simulation {
        Simulation::new(&Settings {
            columns: 24,
            response,
            ..Settings::default()
        })
        .unwrap()
    }

    #[test]
    fn a_cloth_drapes_over_the_sphere_and_keeps_its_shape() {
        let mut cloth = small(Response::All);
        for _ in 0..45 {
            cloth.frame().unwrap();
        }
        let lengths = cloth
            .springs
            .iter()
            .filter(|spring| spring.compliance == 0.0)
            .map(|spring| {
                let (p, q) = (cloth.points[spring.a as usize], cloth.points[spring.b as usize]);
                (0..3).map(|k| (p[k] - q[k]).powi(2)).sum::<f64>().sqrt() / spring.rest
            });
        let (mut least, mut greatest) = (f64::INFINITY, 0.0_f64);
        lengths.for_each(|length| (least, greatest) = (least.min(length), greatest.max(length)));
        assert!(least > 0.5 && greatest < 1.15, "{least} {greatest}");
        let top = cloth
            .points
            .iter()
            .map(|p| p[2])
            .fold(f64::NEG_INFINITY, f64::max);
        let bottom = cloth.points.iter().map(|p| p[2]).fold(f64::INFINITY, f64::min);
        assert!((0.5..0.6).contains(&top) && bottom < 0.1, "{top} {bottom}");
        assert_eq!(cloth.crossings().unwrap().inside, 0);
    }

    /// The referee is brute force over all pairs of particles.
    #[test]
    fn no_contact_is_missed() {
        let mut cloth = small(Response::All);
        let mut seen = 0;
        for _ in 0..12 {
            (0..3).for_each(|_| cloth.frame().unwrap());
            cloth.detect().unwrap();
            let threshold = Threshold::new(cloth.settings.delta()).unwrap();
            let excluded = cloth.cloth.adjacency().rings(1);
            let within: Vec<(u32, u32)> = oracle::pairs_within(&cloth.points, &excluded, threshold)
                .into_iter()
                .map(|[i, j]| (i, j))
                .collect();
            let sphere: Vec<(u32, u32)> =
                oracle::pairs_between(&cloth.points, cloth.sphere.vertices(), threshold)
                    .into_iter()
                    .map(|[i, j]| (i, j))
                    .collect();
            seen += within.len() + sphere.len();
            assert_eq!(
                (&cloth.detected.within, &cloth.detected.sphere),
                (&within, &sphere)
            );
        }
        assert!(seen > 1000, "{seen}");
    }

    /// Gravity alone: half g t^2, apart from drag and the error of the integrator.
    #[test]
    fn a_cloth_beside_the_sphere_falls_as_everything_does() {
        let settings = Settings {
            columns: 12,
            beside: 5.0,
            drag: 0.0,
            ..Settings::default()
        };
        let mut cloth = Simulation::new(&settings).unwrap();
        let start = cloth.centre()[2];
        (0..30).for_each(|_| cloth.frame().unwrap());
        let fallen = start - cloth.centre()[2];
        assert!((fallen / (0.5 * GRAVITY * 0.25) - 1.0).abs() < 0.02, "{fallen}");
    }

    #[test]
    fn the_same_settings_give_the_same_cloth() {
        let run = || {
            let mut cloth = small(Response::All);
            (0..10).for_each(|_| cloth.frame().unwrap());
            cloth.points
        };
        assert_eq!(run(), run());
    }
}
