//! The tree over bodies against lists of boxes.

use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

use super::super::ahead::ahead;
use super::*;
use crate::broad::inflate;
use crate::placement::rotate;
use crate::simd::{Lanes, Work, dispatch};
use crate::{Placement, generate};

fn meets(a: &Aabb, b: &Aabb) -> bool {
    (0..3).all(|k| a.min[k] <= b.max[k] && b.min[k] <= a.max[k])
}

struct Boxes {
    rng: Xoshiro256PlusPlus,
    tree: BodyTree,
    known: Vec<Option<Aabb>>,
    size: f64,
    shift: f64,
}

impl Boxes {
    fn unit(&mut self) -> f64 {
        (self.rng.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn any(&mut self) -> Aabb {
        let min: [f64; 3] = [(); 3].map(|()| self.shift + self.size * self.unit());
        let max = min.map(|c| c + 0.1 * self.size * self.unit() * self.unit());
        Aabb { min, max }
    }

    /// Gives bodies other boxes, as a world does, and checks the pairs that are told.
    fn change(&mut self, to: &[(u32, Aabb)]) {
        let before: Vec<Box32> = (0..self.known.len() as u32)
            .map(|n| self.tree.box_of(n))
            .collect();
        let mut changes: Vec<Change> = to
            .iter()
            .map(|(body, bounds)| Change {
                is_recheck: before[*body as usize] != Box32::EMPTY && body % 7 == 0,
                ..Change::to(*body, self.tree.place(bounds))
            })
            .collect();
        let is_new = self.tree.is_empty() || self.tree.has_left_frame();
        if is_new {
            for (n, bounds) in to {
                self.known[*n as usize] = Some(*bounds);
            }
            let all: Vec<(u32, Aabb)> = self.all();
            self.tree.build(&all);
        } else {
            self.tree.follow(&mut changes);
            for change in &changes {
                assert_eq!(change.before, before[change.body as usize]);
                assert_eq!(self.tree.box_of(change.body), change.to);
            }
        }
        for (n, bounds) in to {
            self.known[*n as usize] = Some(*bounds);
        }
        if is_new {
            changes = self
                .all()
                .iter()
                .map(|&(body, _)| Change {
                    is_recheck: before[body as usize] != Box32::EMPTY,
                    ..Change::to(body, self.tree.box_of(body))
                })
                .collect();
        }
        let mut told = Vec::new();
        self.tree.begun(
            &changes,
            |Meeting {
                 bodies: [a, b],
                 is_recheck,
             }| {
                let rechecks = |n| changes.iter().any(|change| change.body == n && change.is_recheck);
                assert_eq!(is_recheck, rechecks(a) || rechecks(b));
                told.push((a.min(b), a.max(b)));
            },
        );
        self.tree.forget_changes();
        told.sort_unstable();
        assert!(told.is_sorted_by(|a, b| a < b), "each once");
        let is_told = |n: u32, m: u32| {
            let change = |n: u32| changes.iter().find(|change| change.body == n);
            let is_recheck = |n: u32| change(n).is_some_and(|change| change.is_recheck);
            let met = before[n as usize].overlaps(&before[m as usize]);
            (change(n).is_some() || change(m).is_some()) && (is_recheck(n) || is_recheck(m) || !met)
        };
        let all = self.all();
        let mut expected = Vec::new();
        for (at, &(n, _)) in all.iter().enumerate() {
            for &(m, _) in &all[at + 1..] {
                if is_told(n, m) && self.tree.overlap(n, m) {
                    expected.push((n, m));
                }
            }
        }
        assert_eq!(told, expected);
    }

    fn all(&self) -> Vec<(u32, Aabb)> {
        (0..)
            .zip(&self.known)
            .filter_map(|(n, b)| b.map(|b| (n, b)))
            .collect()
    }

    /// What the tree says holds everything that the list says, and little else.
    fn check(&mut self) {
        let all = self.all();
        assert_eq!(self.tree.bodies, all.len());
        let slack = 1e-5 * (self.size + self.shift.abs());
        let near = |a: &Aabb, b: &Aabb| meets(a, &inflate(b, slack));
        let mut stack = Vec::new();
        for _ in 0..5 {
            let question = self.any();
            let mut found = Vec::new();
            self.tree
                .overlapping(&question, &mut stack, |body| found.push(body));
            found.sort_unstable();
            assert!(found.is_sorted_by(|a, b| a < b), "each once");
            for (n, b) in &all {
                let is_found = found.binary_search(n).is_ok();
                assert!(is_found || !meets(b, &question));
                assert!(!is_found || near(b, &question));
            }
        }
        for (at, (n, a)) in all.iter().enumerate() {
            for (m, b) in &all[at + 1..] {
                assert!(self.tree.overlap(*n, *m) || !meets(a, b));
            }
        }
        for (n, b) in &all {
            assert!(self.tree.holds(*n, b));
        }
    }
}

#[test]
fn a_changing_tree_finds_what_a_list_finds() {
    for (size, shift) in [(1.0, 0.0), (1e-200, 0.0), (1e200, 0.0), (1.0, 1e7)] {
        let mut boxes = Boxes {
            rng: Xoshiro256PlusPlus::seed_from_u64(7),
            tree: BodyTree::default(),
            known: Vec::new(),
            size,
            shift,
        };
        boxes.known.resize(150, None);
        let first: Vec<(u32, Aabb)> = (0..70).map(|n| (n, boxes.any())).collect();
        boxes.change(&first);
        boxes.check();
        for round in 0..300 {
            let mut to = Vec::new();
            for _ in 0..[4, 4, 90][round % 3] {
                let body = boxes.rng.next_u32() % 150;
                let known = boxes.known[body as usize];
                let next = match known {
                    // near, so that it stays in its leaf
                    Some(known) if boxes.unit() < 0.7 => inflate(&known, 0.01 * size),
                    _ => boxes.any(),
                };
                if boxes.unit() < 0.2 {
                    boxes.tree.remove(body);
                    boxes.known[body as usize] = None;
                } else {
                    to.push((body, next));
                }
            }
            to.retain(|(body, _)| round % 2 == 0 || boxes.known[*body as usize].is_some());
            to.sort_by_key(|(body, _)| *body);
            to.dedup_by_key(|(body, _)| *body);
            boxes.change(&to);
            if round % 10 == 0 {
                boxes.check();
            }
        }
        // empty, and filled again
        for body in 0..150 {
            boxes.tree.remove(body);
            boxes.known[body as usize] = None;
        }
        boxes.check();
        for body in 0..20 {
            let to = boxes.any();
            boxes.change(&[(body, to)]);
        }
        boxes.check();
        // far away, where the frame is too coarse
        for body in 0..20 {
            let to = boxes.any();
            let far = |c: [f64; 3]| c.map(|c| c + 1e5 * size);
            let to = Aabb {
                min: far(to.min),
                max: far(to.max),
            };
            boxes.change(&[(body, to)]);
        }
        let to = boxes.any();
        boxes.change(&[(0, to)]);
    }
}

#[test]
fn boxes_in_one_place_are_all_found() {
    let one = Aabb::point([0.25; 3]);
    let mut boxes = Boxes {
        rng: Xoshiro256PlusPlus::seed_from_u64(7),
        tree: BodyTree::default(),
        known: vec![None; 100],
        size: 1.0,
        shift: 0.0,
    };
    for body in 0..100 {
        boxes.change(&[(body, one)]);
    }
    let mut pairs = 0;
    boxes.change(&(0..100).map(|body| (body, one)).collect::<Vec<_>>());
    for a in 0..100 {
        pairs += (0..a).filter(|&b| boxes.tree.overlap(a, b)).count();
    }
    assert_eq!(pairs, 100 * 99 / 2);
}

impl BodyTree {
    /// Whether a box in the tree encloses `bounds`, which is not rounded.
    fn encloses(&self, known: &Box32, bounds: &Aabb) -> bool {
        let at = |c: f64, k: usize| (c - self.frame.origin[k]) * self.frame.scale;
        (0..3).all(|k| {
            f64::from(known.min[k]) <= at(bounds.min[k], k) && at(bounds.max[k], k) <= f64::from(known.max[k])
        })
    }
}

/// A body whose centre is in its room is held by its box, however it is turned.
#[test]
fn a_body_in_its_room_is_in_its_box() {
    let mut boxes = Boxes {
        rng: Xoshiro256PlusPlus::seed_from_u64(11),
        tree: BodyTree::default(),
        known: vec![None; 8],
        size: 1.0,
        shift: 0.0,
    };
    for (scale, shift) in [(1.0, 0.0), (1e-12, 0.0), (1e12, 0.0), (1.0, 1e7)] {
        let ball = generate::icosphere(scale, 1).unwrap();
        let off = |&[x, y, z]: &[f64; 3]| [x + scale, 2.0 * y, z / 3.0];
        let mesh = ball
            .with_vertices(ball.vertices().iter().map(off).collect())
            .unwrap();
        let extent = Extent::new(&mesh);
        let half = 0.01 * scale;
        let placement = |boxes: &mut Boxes, around: [f64; 3], spread: f64| {
            let turn = Placement::from_quaternion([(); 4].map(|()| boxes.unit() - 0.5)).unwrap();
            let way = [(); 3].map(|()| spread * scale * (boxes.unit() - 0.5));
            turn.moved(around).and_then(|place| place.moved(way)).unwrap()
        };
        let places: Vec<Placement> = (0..8).map(|_| placement(&mut boxes, [shift; 3], 10.0)).collect();
        let wide = |place: &Placement| inflate(&extent.posed(place), 2.0 * scale);
        let all: Vec<(u32, Aabb)> = (0..).zip(places.iter().map(wide)).collect();
        boxes.tree.build(&all);
        let mut inside = 0;
        for body in 0..8 {
            for _ in 0..200 {
                let near = placement(&mut boxes, places[body as usize].translation(), 8.0);
                let (known, offset) = (
                    boxes.tree.box_of(body),
                    rotate(near.quaternion(), extent.centre()),
                );
                let room = boxes.tree.room(&known, &extent, &offset, half);
                if room.holds(boxes.tree.frame(), &near.translation()) {
                    inside += 1;
                    for &vertex in mesh.vertices() {
                        let ball = inflate(&Aabb::point(near.apply(vertex)), half);
                        assert!(boxes.tree.encloses(&boxes.tree.box_of(body), &ball));
                    }
                }
            }
        }
        assert!(inside > 20, "{inside} at {scale}, {shift}");
    }
}

struct OneAhead<'a>(&'a TreeFrame, &'a Box32, [[f64; 3]; 2], f64);

impl Work for OneAhead<'_> {
    type Output = (Box32, Room);

    #[inline(always)]
    fn run<L: Lanes>(self, unit: L) -> (Box32, Room) {
        ahead(unit, self.0, self.1, self.2, self.3, self.3 > 0.0)
    }
}

/// A body that is not turned and is in the room of its next box is held by that box, and is in its room when it gets it.
#[test]
fn a_body_moved_in_its_room_is_in_its_box() {
    let mut boxes = Boxes {
        rng: Xoshiro256PlusPlus::seed_from_u64(13),
        tree: BodyTree::default(),
        known: vec![None; 8],
        size: 1.0,
        shift: 0.0,
    };
    for (scale, shift) in [(1.0, 0.0), (1e-12, 0.0), (1e12, 0.0), (1.0, 1e7), (1e100, 0.0)] {
        let small = f64::min(scale, 1e12);
        let ball = generate::icosphere(small, 1).unwrap();
        let off = |&[x, y, z]: &[f64; 3]| [x + 3.0 * small, 2.0 * y, z / 3.0];
        let mesh = ball
            .with_vertices(ball.vertices().iter().map(off).collect())
            .unwrap();
        let (extent, half) = (Extent::new(&mesh), 0.01 * small);
        let (hull, whole) = (extent.hull(), mesh.bounds());
        for k in 0..3 {
            assert!(f64::from(hull.min[k]) <= whole.min[k] && whole.max[k] <= f64::from(hull.max[k]));
        }
        let mut place = |spread: f64| [(); 3].map(|()| shift + spread * (boxes.unit() - 0.5));
        let all: Vec<(u32, Aabb)> = (0..8)
            .map(|n| (n, inflate(&extent.moved(&place(10.0 * scale)), scale)))
            .collect();
        let ways: Vec<[[f64; 3]; 4]> = (0..2000)
            .map(|_| {
                [
                    place(10.0 * scale),
                    place(0.1 * small),
                    place(0.3 * small),
                    place(0.0),
                ]
            })
            .collect();
        boxes.tree.build(&all);
        let frame = boxes.tree.frame();
        let mut inside = 0;
        for [from, step, further, zero] in ways {
            let moved = |by: [f64; 3], from: [f64; 3]| std::array::from_fn(|k| from[k] + (by[k] - zero[k]));
            let to = moved(step, from);
            let (bounds, room) = dispatch(OneAhead(frame, &hull, [from, to], half));
            for place in [to, moved(further, to)] {
                if !room.holds(frame, &place) {
                    assert!(place != to || scale == 1e100 || shift != 0.0, "{place:?}");
                    continue;
                }
                inside += 1;
                assert!(
                    boxes
                        .tree
                        .encloses(&bounds, &inflate(&extent.moved(&place), half))
                );
                let posed = Placement::from_translation(place).unwrap();
                for &vertex in mesh.vertices() {
                    let ball = inflate(&Aabb::point(posed.apply(vertex)), half);
                    assert!(boxes.tree.encloses(&bounds, &ball));
                }
            }
            assert!(boxes.tree.encloses(&bounds, &inflate(&extent.moved(&to), half)));
        }
        assert!(inside > 400 || scale == 1e100, "{inside} at {scale}, {shift}");
    }
    // too coarse, too large and too small for f32
    for (scale, shift) in [(1.0, 1e7), (1e200, 0.0), (1e-200, 0.0)] {
        let ball = generate::icosphere(1.0, 1).unwrap();
        let far = |p: &[f64; 3]| p.map(|c| scale * c + shift);
        let far = ball
            .with_vertices(ball.vertices().iter().map(far).collect())
            .unwrap();
        assert_eq!(Extent::new(&far).hull(), Box32::EMPTY);
    }
}
