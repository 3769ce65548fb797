//! Welding: points with equal coordinates become one vertex.

/// Merges points whose coordinates are exactly equal (0.0 and -0.0 are equal), keeping the order of first appearance.
///
/// Returns the distinct points and, for every given point, the number of its distinct point. There is no tolerance: points
/// that differ in the last bit stay separate. The coordinates must be finite. Cost: O(n log n).
///
/// ```
/// use satisfice_collision::mesh::weld;
/// let (distinct, number) = weld(&[[1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [1.0, -0.0, 0.0]]);
/// assert_eq!(distinct, [[1.0, 0.0, 0.0], [2.0, 0.0, 0.0]]);
/// assert_eq!(number, [0, 1, 0]);
/// ```
#[must_use]
pub fn weld(points: &[[f64; 3]]) -> (Vec<[f64; 3]>, Vec<usize>) {
    // Adding 0.0 turns -0.0 into 0.0 and changes nothing else.
    let points: Vec<[f64; 3]> = points.iter().map(|p| p.map(|c| c + 0.0)).collect();
    let mut order: Vec<usize> = (0..points.len()).collect();
    let compare = |a: &[f64; 3], b: &[f64; 3]| {
        a[0].total_cmp(&b[0])
            .then(a[1].total_cmp(&b[1]))
            .then(a[2].total_cmp(&b[2]))
    };
    order.sort_unstable_by(|&a, &b| compare(&points[a], &points[b]).then(a.cmp(&b)));

    let mut first: Vec<usize> = (0..points.len()).collect();
    for pair in order.windows(2) {
        if compare(&points[pair[0]], &points[pair[1]]).is_eq() {
            first[pair[1]] = first[pair[0]];
        }
    }
    let mut distinct = Vec::new();
    let mut number: Vec<usize> = Vec::with_capacity(points.len());
    for (i, &f) in first.iter().enumerate() {
        if f == i {
            number.push(distinct.len());
            distinct.push(points[i]);
        } else {
            number.push(number[f]);
        }
    }
    (distinct, number)
}
