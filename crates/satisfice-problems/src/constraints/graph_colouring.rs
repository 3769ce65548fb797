//! Colourings of a graph.

use satisfice::catalogue::{Catalogued, Description, Parameter, Params};
use satisfice::{Error, SatisficingProblem};

use super::{Extendable, Violations, constraint_bounds, constraint_methods, counted, dimacs};
use crate::lattice::{Lattice, description};

/// Generalised Petersen graphs G(n, k): name, n, k.
const NAMED: [(&str, usize, usize); 6] = [
    ("petersen", 5, 2),
    ("cube", 4, 1),
    ("moebius-kantor", 8, 3),
    ("dodecahedron", 10, 2),
    ("desargues", 10, 3),
    ("nauru", 12, 5),
];
const NAMES: &[&str] = &[
    "petersen",
    "cube",
    "moebius-kantor",
    "dodecahedron",
    "desargues",
    "nauru",
];

/// A graph: number of vertices, and edges between vertices counted from 0.
///
/// ```
/// use satisfice_problems::Graph;
/// let petersen = Graph::petersen(5, 2)?;
/// assert_eq!((petersen.vertices, petersen.edges.len()), (10, 15));
/// # Ok::<(), satisfice::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Graph {
    /// Number of vertices.
    pub vertices: usize,
    /// Edges.
    pub edges: Vec<[usize; 2]>,
}

impl Graph {
    /// The generalised Petersen graph G(n, k): an outer cycle of n vertices, n spokes, and inner edges from i to i + k
    /// (Watkins 1969, doi 10.1016/S0021-9800(69)80116-X). Needs n > 2 k > 0.
    ///
    /// # Errors
    /// [`Error::Parameter`] for another k.
    pub fn petersen(n: usize, k: usize) -> Result<Self, Error> {
        if k == 0 || k >= n.div_ceil(2) {
            return Err(Error::parameter("k", k, "above 0 and below n / 2"));
        }
        let outer = (0..n).map(|i| [i, (i + 1) % n]);
        let spokes = (0..n).map(|i| [i, n + i]);
        let inner = (0..n).map(|i| [n + i, n + (i + k) % n]);
        Ok(Self {
            vertices: 2 * n,
            edges: outer.chain(spokes).chain(inner).collect(),
        })
    }

    /// The graph of a DIMACS `edge` file.
    ///
    /// # Errors
    /// [`Error::Parameter`] for the parameter `file` if it cannot be read, is malformed, or has not as many edges
    /// as it announces; half as many, or each edge twice, are allowed, as known files have it.
    pub fn read_dimacs(path: &str) -> Result<Self, Error> {
        let (vertices, edges) = dimacs::edges(path, &dimacs::read(path)?)?;
        Ok(Self { vertices, edges })
    }
}

/// All proper colourings of a graph with k colours.
///
/// F is the number of edges between vertices of the same colour; a hit is F < 1. Colourings that differ by a permutation of the
/// colours count as different: the Petersen graph has 120 with 3 colours. A neighbour has one vertex recoloured.
///
/// Source: the value at k of the chromatic polynomial, Birkhoff 1912, doi 10.2307/1967597; counts by backtracking.
///
/// ```
/// use satisfice::catalogue::Catalogued;
/// use satisfice_problems::{Graph, GraphColouring};
/// assert_eq!(GraphColouring::new(Graph::petersen(5, 2)?, 3)?.reference_hits(), Some(120));
/// # Ok::<(), satisfice::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct GraphColouring {
    lattice: Lattice,
    threshold: f64,
    description: Description,
    edges: Vec<[usize; 2]>,
    /// The neighbours of each vertex among those before it.
    earlier: Vec<Vec<usize>>,
    colours: u32,
}

impl GraphColouring {
    /// The colourings of `graph` with `colours` colours.
    ///
    /// # Errors
    /// [`Error::Parameter`] for an edge with an end that is not a vertex, or with equal ends; [`Error::Bounds`] for 0 colours.
    pub fn new(graph: Graph, colours: u32) -> Result<Self, Error> {
        Self::described("", graph, colours)
    }

    fn described(name: &str, graph: Graph, colours: u32) -> Result<Self, Error> {
        let mut earlier = vec![Vec::new(); graph.vertices];
        for &[a, b] in &graph.edges {
            if a == b || a.max(b) >= graph.vertices {
                let allowed = format!("two different vertices below {}", graph.vertices);
                return Err(Error::parameter("edge", format!("{a} {b}"), allowed));
            }
            earlier[a.max(b)].push(a.min(b));
        }
        Ok(Self {
            lattice: Lattice::new(vec![colours as usize; graph.vertices])?,
            threshold: 1.0,
            description: description(
                Self::NAME,
                [("graph", name.to_owned()), ("colours", colours.to_string())],
            ),
            edges: graph.edges,
            earlier,
            colours,
        })
    }
}

impl Violations for GraphColouring {
    /// Cost: one step per edge.
    #[inline]
    fn violations(&self, value: impl Fn(usize) -> Option<u32>) -> u32 {
        let same = |&&[a, b]: &&[usize; 2]| value(a).is_some() && value(a) == value(b);
        self.edges.iter().filter(same).count() as u32
    }
}

impl Extendable for GraphColouring {
    fn values(&self, vertex: usize) -> Option<u32> {
        (vertex < self.earlier.len()).then_some(self.colours)
    }
    fn extends(&self, partial: &[u32]) -> bool {
        let Some((colour, before)) = partial.split_last() else {
            return true;
        };
        self.earlier[before.len()]
            .iter()
            .all(|&other| before[other] != *colour)
    }
}

impl SatisficingProblem for GraphColouring {
    constraint_methods!();
}

constraint_bounds!(GraphColouring);

impl Catalogued for GraphColouring {
    const NAME: &'static str = "graph-colouring";
    const SUMMARY: &'static str = "proper colourings of a graph";
    const SOURCE: &'static str = "Birkhoff 1912, doi 10.2307/1967597; counts by backtracking";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::choice("graph", "which graph", "petersen", NAMES),
        Parameter::text(
            "file",
            "path of a graph in DIMACS `edge` format, instead of a named one",
            "",
        ),
        Parameter::integer("colours", "number of colours, k", 3, 1, 1000),
    ];

    fn from_params(params: &Params) -> Result<Self, Error> {
        let (name, file) = (params.text("graph"), params.text("file"));
        let colours = params.count("colours") as u32;
        if !file.is_empty() {
            return Self::described(file, Graph::read_dimacs(file)?, colours);
        }
        let row = NAMED.iter().find(|row| row.0 == name);
        let &(_, n, k) = row.ok_or_else(|| Error::unknown("graph", name, NAMES.iter().copied()))?;
        Self::described(name, Graph::petersen(n, k)?, colours)
    }

    fn reference_hits(&self) -> Option<u64> {
        counted(self)
    }
}
