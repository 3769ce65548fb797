//! Welding: points with equal coordinates become one vertex.

use std::hash::BuildHasher;

use foldhash::fast::RandomState;
use hashbrown::HashTable;

/// Merges points whose coordinates are exactly equal (0.0 and -0.0 are equal), keeping the order of first appearance.
///
/// Returns the distinct points and, for every given point, the number of its distinct point. There is no tolerance: points
/// that differ in the last bit stay separate. The coordinates must be finite. Cost: O(n).
///
/// ```
/// use satisfice_collision::mesh::weld;
/// let (distinct, number) = weld(&[[1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [1.0, -0.0, 0.0]]);
/// assert_eq!(distinct, [[1.0, 0.0, 0.0], [2.0, 0.0, 0.0]]);
/// assert_eq!(number, [0, 1, 0]);
/// ```
#[must_use]
pub fn weld(points: &[[f64; 3]]) -> (Vec<[f64; 3]>, Vec<usize>) {
    // Seeded anew each time, so that no file can be made to collide; the result does not depend on it.
    let state = RandomState::default();
    let bits = |point: &[f64; 3]| point.map(f64::to_bits);
    let hash = |point: &[f64; 3]| state.hash_one(bits(point));
    let mut known: HashTable<usize> = HashTable::new();
    let mut distinct: Vec<[f64; 3]> = Vec::new();
    let mut number = Vec::with_capacity(points.len());
    for point in points {
        // Adding 0.0 turns -0.0 into 0.0 and changes nothing else.
        let point = point.map(|c| c + 0.0);
        let next = distinct.len();
        let is_same = |&other: &usize| bits(&distinct[other]) == bits(&point);
        let entry = known.entry(hash(&point), is_same, |&other| hash(&distinct[other]));
        let at = *entry.or_insert(next).get();
        if at == next {
            distinct.push(point);
        }
        number.push(at);
    }
    (distinct, number)
}
