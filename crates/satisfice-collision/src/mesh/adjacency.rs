//! Which vertices are joined: compressed rows, and rings of a chosen width.

/// The neighbours of every vertex, in compressed sparse rows: sorted, symmetric, without the vertex itself.
///
/// ```
/// use satisfice_collision::generate;
/// let ball = generate::icosphere(1.0, 0)?;
/// let adjacency = ball.adjacency();
/// assert_eq!(adjacency.neighbours(0).len(), 5);
/// assert_eq!(adjacency.ring(0, 2).len(), 10);
/// # Ok::<(), satisfice_collision::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Adjacency {
    offsets: Vec<usize>,
    targets: Vec<u32>,
}

impl Adjacency {
    /// From unique undirected edges `[low, high]`, sorted, all below `vertices`. O(V + E).
    pub(crate) fn from_edges(vertices: usize, edges: &[[u32; 2]]) -> Self {
        let mut offsets = vec![0_usize; vertices + 1];
        for &[a, b] in edges {
            offsets[a as usize + 1] += 1;
            offsets[b as usize + 1] += 1;
        }
        for v in 0..vertices {
            offsets[v + 1] += offsets[v];
        }
        let mut next = offsets.clone();
        let mut targets = vec![0_u32; offsets[vertices]];
        // Two passes over sorted edges leave every row sorted: first the lower neighbours, then the higher ones.
        for &[a, b] in edges {
            targets[next[b as usize]] = a;
            next[b as usize] += 1;
        }
        for &[a, b] in edges {
            targets[next[a as usize]] = b;
            next[a as usize] += 1;
        }
        Self { offsets, targets }
    }

    /// Elements that share a vertex: rows are elements, not vertices. O(sum of the squared numbers of elements at a vertex).
    pub(crate) fn sharing<const N: usize>(vertices: usize, elements: &[[u32; N]]) -> Self {
        let mut at = vec![0_usize; vertices + 1];
        for &v in elements.iter().flatten() {
            at[v as usize + 1] += 1;
        }
        for v in 0..vertices {
            at[v + 1] += at[v];
        }
        let mut next = at.clone();
        let mut users = vec![0_u32; at[vertices]];
        for (element, corners) in (0..).zip(elements) {
            for &v in corners {
                users[next[v as usize]] = element;
                next[v as usize] += 1;
            }
        }
        let mut offsets = Vec::with_capacity(elements.len() + 1);
        let mut targets = Vec::new();
        offsets.push(0);
        let mut row = Vec::new();
        for (element, corners) in (0..).zip(elements) {
            row.clear();
            for &v in corners {
                row.extend_from_slice(&users[at[v as usize]..at[v as usize + 1]]);
            }
            row.sort_unstable();
            row.dedup();
            targets.extend(row.iter().copied().filter(|&other| other != element));
            offsets.push(targets.len());
        }
        Self { offsets, targets }
    }

    /// The same with only those joints for which `keep` is true; `keep` must be symmetric.
    pub(crate) fn filtered(&self, keep: impl Fn(u32, u32) -> bool) -> Self {
        let mut offsets = Vec::with_capacity(self.offsets.len());
        let mut targets = Vec::new();
        offsets.push(0);
        for v in 0..self.len() as u32 {
            targets.extend(self.neighbours(v).iter().copied().filter(|&w| keep(v, w)));
            offsets.push(targets.len());
        }
        Self { offsets, targets }
    }

    /// An adjacency in which no vertex is joined to any other.
    pub(crate) fn none(vertices: usize) -> Self {
        Self {
            offsets: vec![0; vertices + 1],
            targets: Vec::new(),
        }
    }

    /// The adjacency of the vertices that are kept. Two are joined if a path joins them whose inner vertices are all omitted,
    /// so that omitting vertices tears no surface apart. Omitted vertices have no neighbours.
    ///
    /// Cost: O(vertices x kept vertices around a gap), near linear for samples spread over a surface.
    pub(crate) fn bridged(&self, keep: impl Fn(u32) -> bool) -> Self {
        let mut offsets = Vec::with_capacity(self.offsets.len());
        let mut targets = Vec::new();
        let mut seen_from = vec![u32::MAX; self.len()];
        let mut through = Vec::new();
        offsets.push(0);
        for v in 0..self.len() as u32 {
            if keep(v) {
                let start = targets.len();
                seen_from[v as usize] = v;
                through.push(v);
                while let Some(w) = through.pop() {
                    for &u in self.neighbours(w) {
                        if core::mem::replace(&mut seen_from[u as usize], v) == v {
                            continue;
                        }
                        if keep(u) { &mut targets } else { &mut through }.push(u);
                    }
                }
                targets[start..].sort_unstable();
            }
            offsets.push(targets.len());
        }
        Self { offsets, targets }
    }

    /// Whether no vertex is joined to any other.
    #[must_use]
    pub fn has_none(&self) -> bool {
        self.targets.is_empty()
    }

    /// The number of vertices.
    #[must_use]
    pub fn len(&self) -> usize {
        self.offsets.len() - 1
    }

    /// Whether there is no vertex.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The vertices joined to `v`, sorted; empty if `v` is not a vertex.
    #[must_use]
    pub fn neighbours(&self, v: u32) -> &[u32] {
        let v = v as usize;
        if v < self.len() {
            &self.targets[self.offsets[v]..self.offsets[v + 1]]
        } else {
            &[]
        }
    }

    /// Whether `a` and `b` are joined. O(log degree).
    #[must_use]
    pub fn contains(&self, a: u32, b: u32) -> bool {
        self.neighbours(a).binary_search(&b).is_ok()
    }

    /// The vertices at 1 to `width` edges from `v` (its rings), sorted; empty for `width` 0. Cost: O(n d log n) for a
    /// result of n vertices of degree d.
    #[must_use]
    pub fn ring(&self, v: u32, width: usize) -> Vec<u32> {
        let mut seen = vec![v];
        let mut front = vec![v];
        for _ in 0..width {
            let mut next: Vec<u32> = front.iter().flat_map(|&u| self.neighbours(u)).copied().collect();
            next.sort_unstable();
            next.dedup();
            next.retain(|u| seen.binary_search(u).is_err());
            if next.is_empty() {
                break;
            }
            seen.extend_from_slice(&next);
            seen.sort_unstable();
            front = next;
        }
        seen.retain(|&u| u != v);
        seen
    }

    /// The adjacency that joins vertices at most `width` edges apart: [`Adjacency::ring`] of every vertex.
    #[must_use]
    pub fn rings(&self, width: usize) -> Self {
        if width == 1 {
            return self.clone();
        }
        let mut offsets = Vec::with_capacity(self.offsets.len());
        let mut targets = Vec::new();
        offsets.push(0);
        for v in 0..self.len() {
            // A mesh numbers its vertices by u32.
            targets.extend(self.ring(v as u32, width));
            offsets.push(targets.len());
        }
        Self { offsets, targets }
    }
}
