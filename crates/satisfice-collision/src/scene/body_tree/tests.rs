//! The tree over bodies against lists of boxes.

use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

use super::*;
use crate::broad::inflate;
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
                body: *body,
                is_recheck: false,
                to: self.tree.place(bounds),
                before: Box32::EMPTY,
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
        let mut told = Vec::new();
        self.tree.changed_pairs(|a, b| told.push((a.min(b), a.max(b))));
        self.tree.forget_changes();
        told.sort_unstable();
        assert!(told.is_sorted_by(|a, b| a < b), "each once");
        let is_changed = |n: u32| is_new || changes.iter().any(|change| change.body == n);
        let all = self.all();
        let mut expected = Vec::new();
        for (at, &(n, _)) in all.iter().enumerate() {
            for &(m, _) in &all[at + 1..] {
                if (is_changed(n) || is_changed(m)) && self.tree.overlap(n, m) {
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
    /// Whether the box of a body, as it is in the tree, encloses `bounds`, which is not rounded.
    fn encloses(&self, body: u32, bounds: &Aabb) -> bool {
        let known = self.box_of(body);
        let at = |c: f64, k: usize| (c - self.origin[k]) * self.scale;
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
            let room = boxes.tree.room(&boxes.tree.box_of(body), &extent, half);
            for _ in 0..200 {
                let near = placement(&mut boxes, places[body as usize].translation(), 8.0);
                let centre = near.apply(extent.centre());
                if (0..3).all(|k| room.min[k] <= centre[k] && centre[k] <= room.max[k]) {
                    inside += 1;
                    for &vertex in mesh.vertices() {
                        let ball = inflate(&Aabb::point(near.apply(vertex)), half);
                        assert!(boxes.tree.encloses(body, &ball));
                    }
                }
            }
        }
        assert!(inside > 20, "{inside} at {scale}, {shift}");
    }
}
