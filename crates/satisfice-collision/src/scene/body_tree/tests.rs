//! The tree over bodies against lists of boxes.

use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

use super::*;

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

    /// What the tree says holds everything that the list says, and little else.
    fn check(&mut self) {
        let all: Vec<(u32, Aabb)> = (0..)
            .zip(&self.known)
            .filter_map(|(n, b)| b.map(|b| (n, b)))
            .collect();
        assert_eq!(self.tree.bodies, all.len());
        let slack = 1e-5 * (self.size + self.shift.abs());
        let near = |a: &Aabb, b: &Aabb| meets(a, &crate::broad::inflate(b, slack));
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
        let mut pairs = Vec::new();
        self.tree.pairs(|a, b| pairs.push((a.min(b), a.max(b))));
        pairs.sort_unstable();
        assert!(pairs.is_sorted_by(|a, b| a < b), "each once");
        for (at, (n, a)) in all.iter().enumerate() {
            for (m, b) in &all[at + 1..] {
                let is_found = pairs.binary_search(&(*n, *m)).is_ok();
                assert_eq!(is_found, self.tree.overlap(*n, *m));
                assert!(is_found || !meets(a, b));
            }
        }
        assert!(pairs.iter().all(|(a, b)| a != b));
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
        let first: Vec<(u32, Aabb)> = (0..70).map(|n| (n, boxes.any())).collect();
        boxes.known = first.iter().map(|(_, b)| Some(*b)).collect();
        boxes.known.resize(150, None);
        boxes.tree.build(&first);
        boxes.check();
        for round in 0..300 {
            for _ in 0..4 {
                let body = boxes.rng.next_u32() % 150;
                let to = boxes.any();
                match boxes.rng.next_u32() % 3 {
                    0 => {
                        boxes.tree.remove(body);
                        boxes.known[body as usize] = None;
                    }
                    _ => {
                        boxes.tree.put(body, &to);
                        boxes.known[body as usize] = Some(to);
                    }
                }
            }
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
            boxes.tree.put(body, &to);
            boxes.known[body as usize] = Some(to);
        }
        boxes.check();
    }
}

#[test]
fn boxes_in_one_place_are_all_found() {
    let one = Aabb::point([0.25; 3]);
    let mut tree = BodyTree::default();
    for body in 0..100 {
        tree.put(body, &one);
    }
    let mut pairs = 0;
    tree.pairs(|_, _| pairs += 1);
    assert_eq!(pairs, 100 * 99 / 2);
}
