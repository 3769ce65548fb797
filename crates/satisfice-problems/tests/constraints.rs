//! Constraint problems: backtracking against full enumeration and published counts, bounds, encodings, DIMACS files.
#![allow(clippy::unwrap_used, missing_docs)]

use satisfice::catalogue::{Catalogued, Params};
use satisfice::{Region, SatisficingProblem, SearchRng};
use satisfice_problems::{
    Costas, ENUMERABLE, Encoding, Extendable, Formula, Graph, GraphColouring, Langford, LatinSquare,
    MagicSquare, Queens, Sat, backtrack, count_hits,
};

fn problem<P: Catalogued>(settings: &[(&str, &str)]) -> P {
    P::from_params(&Params::with(P::PARAMETERS, P::NAME, settings.iter().copied()).unwrap()).unwrap()
}

fn solutions(problem: &impl Extendable) -> Vec<Vec<u32>> {
    let mut all = Vec::new();
    let result = backtrack(problem, 100_000_000, &mut |solution| all.push(solution.to_vec()));
    assert!(result.complete && result.solutions == all.len() as u64);
    all
}

/// Every solution of backtracking is a hit and is encoded; every point is a hit only if it is a solution; bounds are sound.
fn agrees<P>(problem: &P) -> u64
where
    P: Catalogued<Scalar = f64, Solution = Vec<u32>> + Extendable,
{
    let all = solutions(problem);
    let dimension = problem.space().dimension();
    let mut values = vec![0.0; dimension];
    for solution in &all {
        assert!(problem.fitness(solution) < problem.threshold());
        assert!(problem.encoding().unwrap().encode(solution, &mut values));
        assert_eq!(problem.decode(&values), *solution);
    }
    if let Some(enumerated) = count_hits(problem, 1e6) {
        assert_eq!(enumerated, all.len() as u64, "{:?}", problem.description());
    }
    let mut rng = SearchRng::new(3);
    let axes = problem.space().axes();
    for _ in 0..300 {
        let draw: Vec<f64> = axes
            .iter()
            .map(|axis| axis.value(axis.at(rng.uniform())))
            .collect();
        let solution = problem.decode(&draw);
        assert_eq!(
            problem.fitness(&solution) < problem.threshold(),
            all.binary_search(&solution).is_ok()
        );
        let neighbourhood = problem.neighbourhood().unwrap();
        let count = neighbourhood.count(&solution);
        for index in 0..count {
            let neighbour = neighbourhood.neighbour(&solution, index).unwrap();
            assert!(neighbour != solution && problem.encoding().unwrap().encode(&neighbour, &mut values));
        }
        assert!(count > 0 || dimension == 1);
        // Some axes fixed at this point, the others free.
        let free: Vec<bool> = axes.iter().map(|_| rng.below(2) == 1).collect();
        let end = |free: &bool, x: f64, end: f64| if *free { end } else { x };
        let region = Region {
            lower: (0..dimension)
                .map(|j| end(&free[j], draw[j], axes[j].lower()))
                .collect(),
            upper: (0..dimension)
                .map(|j| end(&free[j], draw[j], axes[j].upper()))
                .collect(),
        };
        let bounds = problem.bounds();
        if let Some(bound) = bounds.and_then(|bounds| bounds.lower_bound(&region)) {
            for solution in all.iter().chain([&solution]) {
                assert!(problem.encoding().unwrap().encode(solution, &mut values));
                assert!(!region.contains(&values) || bound <= problem.fitness(solution));
            }
        }
    }
    assert!(problem.fitness(&Vec::new()).is_nan() && problem.fitness(&vec![u32::MAX; dimension]).is_nan());
    all.len() as u64
}

#[test]
fn queens() {
    for (n, hits) in [(1, 1), (2, 0), (3, 0), (4, 2), (5, 10), (6, 4), (7, 40), (8, 92)] {
        for encoding in [Encoding::Integer, Encoding::RandomKey] {
            assert_eq!(agrees(&Queens::with_encoding(n, encoding).unwrap()), hits);
        }
    }
}

#[test]
fn costas() {
    for (n, hits) in [
        (1, 1),
        (2, 2),
        (3, 4),
        (4, 12),
        (5, 40),
        (6, 116),
        (7, 200),
        (8, 444),
        (9, 760),
    ] {
        let costas = Costas::new(n, Encoding::Integer).unwrap();
        assert_eq!((agrees(&costas), costas.reference_hits()), (hits, Some(hits)));
    }
    assert_eq!(agrees(&Costas::new(6, Encoding::RandomKey).unwrap()), 116);
    assert!(Costas::new(0, Encoding::Integer).is_err());
}

#[test]
fn magic_squares() {
    let squares = problem::<MagicSquare>(&[]);
    assert_eq!((agrees(&squares), squares.reference_hits()), (8, Some(8)));
    assert_eq!(agrees(&problem::<MagicSquare>(&[("encoding", "integer")])), 8);
    for (n, hits) in [("1", 1), ("2", 0)] {
        assert_eq!(
            agrees(&problem::<MagicSquare>(&[("n", n), ("encoding", "integer")])),
            hits
        );
    }
    // Lo Shu.
    assert_eq!(squares.fitness(&vec![3, 8, 1, 2, 4, 6, 7, 0, 5]), 0.0);
    assert_eq!(
        problem::<MagicSquare>(&[("n", "4")]).reference_hits(),
        Some(7_040)
    );
}

#[test]
fn latin_squares() {
    for (n, hits) in [(1, 1), (2, 2), (3, 12), (4, 576)] {
        assert_eq!(agrees(&LatinSquare::new(n).unwrap()), hits);
    }
    let five = LatinSquare::new(5).unwrap();
    assert_eq!(
        Some(backtrack(&five, 10_000_000, &mut |_| ()).solutions),
        five.reference_hits()
    );
}

#[test]
fn langford_pairings() {
    for (n, hits) in [(1, 0), (2, 0), (3, 2), (4, 2), (5, 0), (6, 0), (7, 52), (8, 300)] {
        let langford = Langford::new(n).unwrap();
        assert_eq!(langford.reference_hits(), Some(hits));
        if n > 1 {
            assert_eq!(agrees(&langford), hits);
        }
    }
    let langford = Langford::new(4).unwrap();
    let rows: Vec<_> = solutions(&langford)
        .iter()
        .map(|s| langford.row(s).unwrap())
        .collect();
    assert!(rows.contains(&vec![4, 1, 3, 1, 2, 4, 3, 2]) && rows.contains(&vec![2, 3, 4, 2, 1, 3, 1, 4]));
}

/// The chromatic polynomial at `k`, by deletion and contraction.
fn chromatic(vertices: usize, edges: &[[usize; 2]], k: i64) -> i64 {
    let Some((&[a, b], rest)) = edges.split_last() else {
        return k.pow(vertices as u32);
    };
    if a == b {
        return 0;
    }
    let merged: Vec<_> = (rest.iter())
        .map(|e| e.map(|v| if v == b { a } else { v }))
        .collect();
    chromatic(vertices, rest, k) - chromatic(vertices - 1, &merged, k)
}

#[test]
fn colourings() {
    for (name, n, k, colours) in [
        ("petersen", 5, 2, 3),
        ("petersen", 5, 2, 4),
        ("cube", 4, 1, 2),
        ("cube", 4, 1, 3),
    ] {
        let graph = Graph::petersen(n, k).unwrap();
        let count = chromatic(graph.vertices, &graph.edges, colours) as u64;
        let colouring = problem::<GraphColouring>(&[("graph", name), ("colours", &colours.to_string())]);
        assert_eq!(
            (agrees(&colouring), colouring.reference_hits()),
            (count, Some(count))
        );
    }
    assert_eq!(problem::<GraphColouring>(&[]).reference_hits(), Some(120));
    assert_eq!(
        problem::<GraphColouring>(&[("graph", "dodecahedron")]).reference_hits(),
        Some(7_200)
    );
    for name in ["moebius-kantor", "desargues", "nauru"] {
        assert!(
            problem::<GraphColouring>(&[("graph", name)])
                .reference_hits()
                .unwrap()
                > 0
        );
    }
    assert!(Graph::petersen(4, 2).is_err() && Graph::petersen(3, 0).is_err());
    let loops = Graph {
        vertices: 2,
        edges: vec![[1, 1]],
    };
    assert!(GraphColouring::new(loops, 3).is_err());
}

#[test]
fn models() {
    let sat = problem::<Sat>(&[("variables", "16"), ("ratio", "3.5")]);
    assert!(agrees(&sat) > 0);
    let default = problem::<Sat>(&[]);
    assert_eq!(default.reference_hits(), Some(46));
    assert_eq!(default.reference_hits(), count_hits(&default, ENUMERABLE));
    // The pigeonhole principle: two pigeons, one hole.
    let formula = Formula {
        variables: 2,
        clauses: vec![vec![1], vec![2], vec![-1, -2]],
    };
    assert_eq!(agrees(&Sat::new(&formula).unwrap()), 0);
    let empty = Formula {
        variables: 1,
        clauses: vec![vec![]],
    };
    assert_eq!(agrees(&Sat::new(&empty).unwrap()), 0);
    assert!(
        Sat::new(&Formula {
            variables: 1,
            clauses: vec![vec![2]]
        })
        .is_err()
    );
    assert!(Formula::random(2, 1, 0).is_err());
}

#[test]
fn dimacs_files() {
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR"));
    let formula = Formula::random(12, 40, 7).unwrap();
    let path = folder.join("twelve.cnf");
    std::fs::write(&path, format!("c generated\n{}", formula.dimacs())).unwrap();
    assert_eq!(Formula::read_dimacs(path.to_str().unwrap()).unwrap(), formula);
    let read = problem::<Sat>(&[("file", path.to_str().unwrap())]);
    assert_eq!(
        read.reference_hits(),
        Sat::new(&formula).unwrap().reference_hits()
    );

    let path = folder.join("triangle.col");
    std::fs::write(&path, "c a triangle\np edge 3 3\ne 1 2\ne 2 3\ne 3 1\n").unwrap();
    let triangle = problem::<GraphColouring>(&[("file", path.to_str().unwrap())]);
    assert_eq!(triangle.reference_hits(), Some(6));

    let missing = Params::with(Sat::PARAMETERS, "sat", [("file", "no/such/file.cnf")]).unwrap();
    let error = Sat::from_params(&missing).unwrap_err().to_string();
    assert!(error.starts_with("cannot read no/such/file.cnf: "), "{error}");
}
