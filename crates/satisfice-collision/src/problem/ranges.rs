//! Boxes around ranges of an order, for bounds of regions of a search space.

use crate::Aabb;

/// The number of consecutive items with one box in the tree; the ends of a range are visited item by item.
const BLOCK: usize = 8;

/// A box for every block of an order, and for every two of those, and so on.
#[derive(Debug, Clone)]
pub(super) struct Ranges {
    /// The root is at 1, the children of `n` at `2 n` and `2 n + 1`, the blocks at the end.
    boxes: Vec<Aabb>,
}

impl Ranges {
    /// A tree over `count` items, at least one, whose boxes `of` returns. Cost: O(count).
    pub(super) fn new(count: usize, of: impl Fn(usize) -> Aabb) -> Self {
        let blocks = count.div_ceil(BLOCK);
        let mut boxes = vec![of(0); 2 * blocks];
        for block in 0..blocks {
            let first = block * BLOCK;
            let mut around = of(first);
            (first + 1..count.min(first + BLOCK)).for_each(|item| include(&mut around, &of(item)));
            boxes[blocks + block] = around;
        }
        for node in (1..blocks).rev() {
            let mut around = boxes[2 * node];
            include(&mut around, &boxes[2 * node + 1]);
            boxes[node] = around;
        }
        Self { boxes }
    }

    /// The smallest box around the items `first..=last`. Cost: O(log count).
    pub(super) fn around(&self, first: usize, last: usize, of: impl Fn(usize) -> Aabb) -> Aabb {
        let mut around = of(first);
        let (from, to) = (first.div_ceil(BLOCK), (last + 1) / BLOCK);
        if from >= to {
            (first + 1..=last).for_each(|item| include(&mut around, &of(item)));
            return around;
        }
        (first + 1..from * BLOCK)
            .chain(to * BLOCK..last + 1)
            .for_each(|item| include(&mut around, &of(item)));
        let blocks = self.boxes.len() / 2;
        let (mut left, mut right) = (from + blocks, to + blocks);
        while left < right {
            if left % 2 == 1 {
                include(&mut around, &self.boxes[left]);
                left += 1;
            }
            if right % 2 == 1 {
                right -= 1;
                include(&mut around, &self.boxes[right]);
            }
            (left, right) = (left / 2, right / 2);
        }
        around
    }
}

fn include(around: &mut Aabb, other: &Aabb) {
    around.include(other.min);
    around.include(other.max);
}

/// A lower bound of every distance between a point in `a` and a point in `b`, also of the distance as rounded.
pub(super) fn bound(a: &Aabb, b: &Aabb) -> f64 {
    // Differences, squares and the root have relative errors of a few units in the last place.
    const BELOW_ONE: f64 = 1.0 - 16.0 * f64::EPSILON;
    let gaps: [f64; 3] = std::array::from_fn(|k| {
        (b.min[k] - a.max[k])
            .max(a.min[k] - b.max[k])
            .clamp(0.0, f64::MAX)
    });
    let square = gaps.iter().map(|gap| gap * gap).sum::<f64>();
    // The longest gap is also a bound, for squares that underflow or overflow.
    let distance = if (1e-270..1e300).contains(&square) {
        square.sqrt()
    } else {
        gaps.into_iter().fold(0.0, f64::max)
    };
    (distance * BELOW_ONE).next_down().next_down().max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_range_of_every_length() {
        // Items without any order.
        let of =
            |item: usize| Aabb::point([item * 37 % 101, item * 53 % 89, item * item % 97].map(|c| c as f64));
        for count in [1, 2, 7, 8, 9, 16, 31, 100] {
            let ranges = Ranges::new(count, of);
            for first in 0..count {
                let mut expected = of(first);
                for last in first..count {
                    include(&mut expected, &of(last));
                    assert_eq!(
                        ranges.around(first, last, of),
                        expected,
                        "{first} to {last} of {count}"
                    );
                }
            }
        }
    }

    #[test]
    fn bounds_hold_at_the_ends_of_the_range_of_numbers() {
        let at = |x: f64| Aabb::point([x, 0.0, 0.0]);
        assert_eq!(bound(&at(1.0), &at(1.0)), 0.0);
        for (x, y) in [
            (0.0, 3.0),
            (-1.7e308, 1.7e308),
            (0.0, 5e-324),
            (0.0, 1e-200),
            (1e200, 2e200),
        ] {
            let (a, b) = (at(x), at(y));
            let exact = crate::distance::vertex_vertex::proximity(&a.min, &b.min)
                .distance
                .min(f64::MAX);
            assert!(bound(&a, &b) <= exact && bound(&b, &a) <= exact, "{x} {y}");
        }
        assert!(bound(&at(0.0), &at(3.0)) > 3.0 * (1.0 - 1e-14));
        assert!(bound(&at(1e200), &at(2e200)) > 1e200 * (1.0 - 1e-14));
    }
}
