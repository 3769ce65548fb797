//! The undirected edges of a mesh, each once.

/// Every edge of `lines` and side of `triangles` as `[low, high]`, sorted and without repetitions. Edges from a vertex
/// to itself are left out. All indices must be below `vertices`.
///
/// The edges are bucketed by their lower end first, so that only the short rows need sorting.
pub(super) fn unique(vertices: usize, lines: &[[u32; 2]], triangles: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let sides = || {
        let of_triangles = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
        let all = lines.iter().copied().chain(of_triangles);
        all.filter(|[a, b]| a != b).map(|[a, b]| [a.min(b), a.max(b)])
    };
    // `ends[v + 1]` is first the start of row `v` and, once the row is filled, its end.
    let mut ends = vec![0_usize; vertices + 2];
    for [low, _] in sides() {
        ends[low as usize + 2] += 1;
    }
    for v in 2..ends.len() {
        ends[v] += ends[v - 1];
    }
    let mut highs = vec![0_u32; ends[vertices + 1]];
    for [low, high] in sides() {
        let end = &mut ends[low as usize + 1];
        highs[*end] = high;
        *end += 1;
    }

    let mut edges = Vec::with_capacity(highs.len() / 2 + 1);
    for (low, row) in (0..).zip(ends.windows(2)) {
        let row = &mut highs[row[0]..row[1]];
        row.sort_unstable();
        let mut last = None;
        for &high in &*row {
            if last.replace(high) != Some(high) {
                edges.push([low, high]);
            }
        }
    }
    edges.shrink_to_fit();
    edges
}
