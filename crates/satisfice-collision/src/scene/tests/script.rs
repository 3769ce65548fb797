//! Random scripts of frames in which bodies come, go, move, jump, grow and rest, against brute force over all pairs of bodies.

use std::collections::BTreeMap;

use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

use super::super::{Body, BodyId, ChangeKind, Completeness, Contact, World};
use super::referee::{self, KINDS};
use crate::distance::{PairKind, Threshold};
use crate::{Mesh, Placement, generate};

/// What the referee knows of a body.
struct Actor {
    mesh: Mesh,
    place: Placement,
    /// The vertices of a deforming body.
    soft: Option<Mesh>,
    ring: Option<usize>,
    groups: [u32; 2],
    /// Where it goes every frame, if anywhere.
    way: [f64; 3],
    moved: bool,
}

impl Actor {
    fn posed(&self) -> Mesh {
        self.soft
            .clone()
            .unwrap_or_else(|| self.place.place(&self.mesh).unwrap())
    }
}

struct Script {
    rng: Xoshiro256PlusPlus,
    kind: PairKind,
    delta: f64,
    world: World,
    actors: BTreeMap<BodyId, Actor>,
    gone: Vec<BodyId>,
    excluded: Vec<(BodyId, BodyId)>,
    /// Contacts of two bodies by brute force, as long as neither changes.
    known: BTreeMap<(BodyId, BodyId), Vec<[u32; 2]>>,
    shapes: Vec<Mesh>,
}

impl Script {
    fn new(kind: PairKind, seed: u64, parallel: bool) -> Self {
        let delta = 0.14;
        let world = World::new(kind, Threshold::new(delta).unwrap());
        Self {
            rng: Xoshiro256PlusPlus::seed_from_u64(seed),
            kind,
            delta,
            world: if parallel { world.parallel() } else { world },
            actors: BTreeMap::new(),
            gone: Vec::new(),
            excluded: Vec::new(),
            known: BTreeMap::new(),
            shapes: vec![
                generate::icosphere(0.3, 0).unwrap(),
                generate::torus(0.3, 0.1, 4, 3).unwrap(),
                generate::cloth(0.7, 0.7, 4, 4).unwrap(),
                generate::cloth(0.9, 0.3, 3, 2).unwrap(),
            ],
        }
    }

    fn unit(&mut self) -> f64 {
        (self.rng.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn below(&mut self, n: usize) -> usize {
        (self.unit() * n as f64) as usize
    }

    fn point(&mut self, size: f64) -> [f64; 3] {
        [(); 3].map(|()| size * (self.unit() - 0.5))
    }

    fn anywhere(&mut self) -> Placement {
        let (axis, angle, by) = (self.point(1.0), 6.0 * self.unit(), self.point(1.2));
        Placement::from_axis_angle(axis, angle)
            .unwrap()
            .moved(by)
            .unwrap()
    }

    fn someone(&mut self) -> Option<BodyId> {
        let n = self.actors.len();
        let at = self.below(n.max(1));
        self.actors.keys().nth(at).copied()
    }

    fn scaled(&mut self, mesh: &Mesh) -> Mesh {
        let scale = 0.5 + self.unit();
        mesh.with_vertices(mesh.vertices().iter().map(|p| p.map(|c| scale * c)).collect())
            .unwrap()
    }

    fn add(&mut self) {
        let at = self.below(self.shapes.len());
        let (mesh, place) = (self.shapes[at].clone(), self.anywhere());
        let groups = match self.below(4) {
            0 => [0b10, 0b11],
            1 => [0b01, 0b01],
            _ => [0b01, 0b11],
        };
        let (mut soft, mut ring) = (None, None);
        let body = match self.below(3) {
            0 => Body::fixed(mesh.clone()).at(place),
            1 => Body::rigid(mesh.clone()).at(place),
            _ => {
                let posed = place.place(&mesh).unwrap();
                soft = Some(posed.clone());
                ring = (self.below(3) > 0).then_some(self.below(2));
                match ring {
                    Some(ring) => Body::deforming(posed).beyond_ring(ring),
                    None => Body::deforming(posed).without_self_collision(),
                }
            }
        };
        let way = if self.below(2) == 0 {
            self.point(0.02)
        } else {
            [0.0; 3]
        };
        let id = self.world.add(body.in_groups(groups[0], groups[1])).unwrap();
        let rests = matches!(self.world.state(id.slot).kind, super::super::Motion::Fixed);
        let actor = Actor {
            mesh,
            place,
            soft,
            ring,
            groups,
            way: if rests { [0.0; 3] } else { way },
            moved: true,
        };
        assert!(self.actors.insert(id, actor).is_none() && !self.gone.contains(&id));
    }

    fn remove(&mut self) {
        if let Some(id) = self.someone() {
            self.world.remove(id).unwrap();
            self.actors.remove(&id);
            self.gone.push(id);
            self.excluded.retain(|&(a, b)| a != id && b != id);
        }
    }

    /// Something that happens now and then.
    fn event(&mut self) {
        match self.actors.len() {
            0..8 => return self.add(),
            16.. => return self.remove(),
            _ => {}
        }
        let Some(id) = self.someone() else { return };
        let motion = self.world.state(id.slot).kind;
        match self.below(8) {
            0 => self.add(),
            1 => self.remove(),
            2 if motion == super::super::Motion::Rigid => {
                let place = self.anywhere();
                self.world.place(id, place).unwrap();
                let actor = self.actors.get_mut(&id).unwrap();
                (actor.place, actor.moved) = (place, true);
            }
            3 => {
                let at = self.below(self.shapes.len());
                let mesh = self.shapes[at].clone();
                let mesh = self.scaled(&mesh);
                let actor = self.actors.get_mut(&id).unwrap();
                self.world.replace(id, mesh.clone()).unwrap();
                actor.soft = actor.soft.as_ref().map(|_| mesh.clone());
                (actor.mesh, actor.moved) = (mesh, true);
            }
            4 => {
                // growing and shrinking, and back and forth within a frame
                for _ in 0..=self.below(2) {
                    self.delta = [0.06, 0.1, 0.14, 0.18][self.below(4)];
                    self.world.set_threshold(Threshold::new(self.delta).unwrap());
                    self.known.clear();
                }
            }
            5 => {
                let other = self.someone().unwrap();
                let pair = (id.min(other), id.max(other));
                if let Some(at) = self.excluded.iter().position(|&known| known == pair) {
                    self.world.include(id, other).unwrap();
                    self.excluded.remove(at);
                } else {
                    self.world.exclude(id, other).unwrap();
                    self.excluded.push(pair);
                }
            }
            6 => {
                let groups = [1 + self.below(3) as u32, 1 + self.below(3) as u32];
                self.world.set_groups(id, groups[0], groups[1]).unwrap();
                self.actors.get_mut(&id).unwrap().groups = groups;
            }
            _ => {
                let way = if self.below(2) == 0 {
                    self.point(0.05)
                } else {
                    [0.0; 3]
                };
                if motion != super::super::Motion::Fixed {
                    self.actors.get_mut(&id).unwrap().way = way;
                }
            }
        }
    }

    fn move_on(&mut self) {
        let ids: Vec<BodyId> = self.actors.keys().copied().collect();
        for id in ids {
            let corner = self.below(3) == 0;
            let (jitter, by) = (self.point(0.05), self.below(3));
            let actor = self.actors.get_mut(&id).unwrap();
            if actor.way == [0.0; 3] {
                continue;
            }
            actor.moved = true;
            if let Some(soft) = &mut actor.soft {
                let mut points = soft.vertices().to_vec();
                let some = if corner { points.len() / 4 } else { points.len() };
                for point in &mut points[..some] {
                    for (x, step) in point.iter_mut().zip(actor.way) {
                        *x += step;
                    }
                }
                points[0][2] += jitter[2];
                *soft = soft.with_vertices(points).unwrap();
                self.world.deform(id, soft.vertices()).unwrap();
            } else {
                actor.place = actor.place.moved(actor.way).unwrap();
                // either way, or both: the last one counts
                if by != 1 {
                    self.world.place(id, actor.place).unwrap();
                }
                if by != 0 {
                    self.world.translate(id, actor.place.translation()).unwrap();
                }
            }
        }
    }

    fn may_collide(&self, a: BodyId, b: BodyId) -> bool {
        let (one, two) = (&self.actors[&a], &self.actors[&b]);
        let groups = one.groups[0] & two.groups[1] != 0 && two.groups[0] & one.groups[1] != 0;
        let wanted = if a == b { one.ring.is_some() } else { groups };
        wanted && !self.excluded.contains(&(a.min(b), a.max(b)))
    }

    /// All contacts by brute force over all pairs of bodies.
    fn expected(&mut self) -> Vec<Contact> {
        let threshold = Threshold::new(self.delta).unwrap();
        let (kind_a, kind_b) = self.world.feature_kinds();
        let posed: BTreeMap<BodyId, Mesh> = self
            .actors
            .iter()
            .map(|(&id, actor)| (id, actor.posed()))
            .collect();
        let moved = |id: &BodyId| self.actors.get(id).is_none_or(|actor| actor.moved);
        self.known.retain(|(a, b), _| !moved(a) && !moved(b));
        let mut contacts = Vec::new();
        for (&a, one) in &posed {
            for (&b, two) in &posed {
                if (kind_a == kind_b && a > b) || !self.may_collide(a, b) {
                    continue;
                }
                let ring = self.actors[&a].ring.filter(|_| a == b);
                let found = || referee::pairs(self.kind, one, two, ring, threshold);
                let found = self.known.entry((a, b)).or_insert_with(found);
                let contact = |&[i, j]: &[u32; 2]| Contact {
                    body_a: a,
                    body_b: b,
                    a: i,
                    b: j,
                };
                contacts.extend(found.iter().map(contact));
            }
        }
        self.actors.values_mut().for_each(|actor| actor.moved = false);
        contacts.sort_unstable();
        contacts
    }

    /// Plays some frames, each answered in one of the ways that there are.
    fn play(&mut self, frames: usize) -> usize {
        for _ in 0..9 {
            self.add();
        }
        let (mut before, mut total) = (Vec::new(), 0);
        for frame in 0..frames {
            let rest = frame % 7 == 5;
            if !rest {
                self.move_on();
                for _ in 0..self.below(3) {
                    self.event();
                }
                // of a frame of which bodies are gone by now, have other meshes or have given their places to others
                if frame % 2 == 1 {
                    self.world.measure_contacts();
                }
            }
            let expected = self.expected();
            let context = format!("{} frame {frame}", self.kind);
            match self.below(5) {
                0 => self.by_pass(&context),
                1 => {
                    let stop_at = self.below(40);
                    let asked = std::sync::atomic::AtomicUsize::new(0);
                    let stop = |_| asked.fetch_add(1, std::sync::atomic::Ordering::Relaxed) >= stop_at;
                    self.world.update_until(&stop).unwrap();
                    assert!(
                        self.world.contacts().all(|c| expected.binary_search(&c).is_ok()),
                        "{context}"
                    );
                }
                2 => {
                    let mut touching: Vec<_> = expected.iter().map(Contact::bodies).collect();
                    touching.sort_unstable();
                    touching.dedup();
                    assert_eq!(self.world.touching().unwrap(), touching, "{context}");
                    if self.below(2) == 0 {
                        continue;
                    }
                }
                3 => self.world.build_trees().unwrap(),
                _ => {}
            }
            let update = self.world.update().unwrap();
            assert_eq!(update.completeness, Completeness::Proved);
            let mut found: Vec<Contact> = self.world.contacts().collect();
            found.sort_unstable();
            assert!(
                found == expected,
                "{context}: {} of {}",
                found.len(),
                expected.len()
            );
            assert!(self.world.sorted_contacts() == expected, "{context}");
            if rest {
                assert_eq!(self.world.update().unwrap().recomputed, 0);
                assert_eq!(self.world.changes().count(), 0);
            }
            if frame % 3 == 0 {
                self.world.measure_contacts();
            }
            total += expected.len();
            before = expected;
        }
        assert!(self.gone.iter().all(|&id| !self.world.contains(id)));
        assert!(
            before
                .iter()
                .all(|&contact| self.world.proximity(contact).is_ok())
        );
        total
    }

    fn by_pass(&mut self, context: &str) {
        let mut pass = self.world.pass();
        let most = self.below(30);
        let mut asked = 0;
        self.world
            .advance(&mut pass, &mut |_| {
                asked += 1;
                asked > most
            })
            .unwrap();
        assert_eq!(self.world.found_by(&pass).count(), pass.found(), "{context}");
        if self.below(2) == 0 {
            let state = self.world.advance(&mut pass, &mut |_| false).unwrap();
            assert_eq!(state, Completeness::Proved);
        }
        let frame = self.world.finish(pass);
        assert!(
            frame.contacts.is_sorted_by(|a, b| a < b),
            "{context}: nothing twice"
        );
        if frame.completeness == Completeness::Proved {
            assert_eq!(self.world.update().unwrap().recomputed, 0, "{context}");
            assert!(self.world.sorted_contacts() == frame.contacts, "{context}");
        }
    }
}

#[test]
fn scripts_agree_with_brute_force_over_all_pairs_of_bodies() {
    for (seed, kind) in (1..).zip(KINDS) {
        let total = Script::new(kind, seed, false).play(200);
        assert!(total > 2_000, "{kind}: {total}");
    }
}

#[test]
fn scripts_agree_on_two_threads() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
    for (seed, kind) in (11..).zip(KINDS) {
        let total = pool.install(|| Script::new(kind, seed, true).play(200));
        assert!(total > 2_000, "{kind}: {total}");
    }
}

/// What began, persists and ended turns the contacts of one frame into those of the next, if every frame is completed at once.
#[test]
fn changes_lead_from_frame_to_frame() {
    for (seed, kind) in (21..).zip(KINDS) {
        let mut script = Script::new(kind, seed, false);
        for _ in 0..9 {
            script.add();
        }
        let mut contacts: Vec<Contact> = Vec::new();
        let mut counts = [0; 3];
        for _ in 0..60 {
            script.move_on();
            script.event();
            script.world.update().unwrap();
            for change in script.world.changes() {
                counts[change.kind as usize] += 1;
                let known = contacts.iter().position(|&contact| contact == change.contact);
                match (change.kind, known) {
                    (ChangeKind::Begun, None) => contacts.push(change.contact),
                    (ChangeKind::Persisting, Some(_)) => {}
                    (ChangeKind::Ended, Some(at)) => {
                        contacts.swap_remove(at);
                    }
                    wrong => panic!("{kind}: {wrong:?}"),
                }
            }
            contacts.sort_unstable();
            assert!(contacts == script.world.sorted_contacts(), "{kind}");
            let touching: usize = script.world.body_changes().map(|change| change.contacts).sum();
            let here = script
                .world
                .changes()
                .filter(|change| change.kind != ChangeKind::Ended);
            assert_eq!(touching, here.count());
        }
        assert!(counts.iter().all(|&count| count > 50), "{kind}: {counts:?}");
    }
}
