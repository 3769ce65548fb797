//! Lattices and spaces of mixed axes whose neighbours the problem does not name. Instances are random, with fixed seeds. Where no level is
//! published, it is one that 1 in 3,000 to 1 in 10 million random points are below.

use core::f64::consts::PI;

use satisfice::{Axis, SearchRng, Space, from_fn};

use super::Named;

fn problem(
    name: &'static str,
    axes: impl IntoIterator<Item = Axis<f64>>,
    level: f64,
    function: impl Fn(&[f64]) -> f64 + Send + Sync + 'static,
) -> Result<Named, satisfice::Error> {
    Ok((name, from_fn(Space::new(axes)?, level, function).boxed()))
}

fn bits(count: usize) -> impl Iterator<Item = Axis<f64>> {
    (0..count).map(|_| Axis::integer(0, 1))
}

/// The problems.
#[rustfmt::skip]
pub(super) fn problems() -> Result<Vec<Named>, satisfice::Error> {
    Ok(vec![knapsack()?, tour()?, quadratic_assignment()?, flow_shop()?, bandwidth()?, max_cut()?, landscape()?, spin_glass()?, categories()?, pressure_vessel()?,
        // Deb, Goldberg 1993: in each of five traps, all ones are best and all zeros next.
        problem("traps", bits(25), 2.5, |x| x.chunks(5).map(|trap| match trap.iter().sum() { 5.0 => 0.0, ones => 1.0 + ones }).sum())?,
        // Sandgren 1990: the ratio of two pairs of gears.
        problem("gear train", (0..4).map(|_| Axis::integer(12, 60)), 1e-5, |x| (1.0 / 6.931 - x[0] * x[1] / (x[2] * x[3])).abs())?,
        problem("three cubes", (0..3).map(|_| Axis::integer(-400, 400)), 1.5, |x| (x.iter().map(|x| x.powi(3)).sum::<f64>() - 29.0).abs())?,
        // Seven marks whose distances all differ.
        problem("ruler", (0..6).map(|_| Axis::integer(1, 30)), 0.5, |x| {
            let marks: Vec<f64> = x.iter().copied().chain([0.0]).collect();
            let pairs = (0..7).flat_map(|i| (0..i).map(move |j| (i, j)));
            let mut distances: Vec<f64> = pairs.map(|(i, j)| (marks[i] - marks[j]).abs()).collect();
            distances.sort_unstable_by(f64::total_cmp);
            distances.windows(2).filter(|pair| pair[0] == pair[1]).count() as f64 + f64::from(distances[0] == 0.0)
        })?,
        // Arora 1989: the weight of a spring, its violations added.
        problem("spring", [Axis::continuous(0.05, 0.5), Axis::continuous(0.25, 1.3), Axis::integer(2, 15)], 0.02, |x| {
            let (wire, coil, turns) = (x[0], x[1], x[2]);
            let shear = (4.0 * coil * coil - wire * coil) / (12566.0 * (coil - wire) * wire.powi(3)).max(1e-9);
            let violations = [
                1.0 - coil.powi(3) * turns / (71785.0 * wire.powi(4)),
                shear + 1.0 / (5108.0 * wire * wire) - 1.0,
                1.0 - 140.45 * wire / (coil * coil * turns),
                (coil + wire) / 1.5 - 1.0,
            ];
            (turns + 2.0) * coil * wire * wire + violations.iter().map(|g| g.max(0.0)).sum::<f64>()
        })?,
    ])
}

/// 40 things of which the weight is at most half and the value nearly the best.
fn knapsack() -> Result<Named, satisfice::Error> {
    let mut rng = SearchRng::new(2);
    let things: Vec<(f64, f64)> = (0..40)
        .map(|_| {
            let weight = 10.0 + (90.0 * rng.uniform()).floor();
            (weight, weight + 10.0 * rng.uniform())
        })
        .collect();
    let most = things.iter().map(|thing| thing.0).sum::<f64>() / 2.0;
    problem("knapsack", bits(40), 0.5, move |x| {
        let sum =
            |of: fn(&(f64, f64)) -> f64| x.iter().zip(&things).map(|(x, thing)| x * of(thing)).sum::<f64>();
        (sum(|thing| thing.0) - most).max(0.0) + (1.085 * most - sum(|thing| thing.1)).max(0.0)
    })
}

/// The elements of a permutation in the order of their places.
fn in_order(places: &[f64]) -> Vec<usize> {
    let mut order = vec![0; places.len()];
    for (i, &place) in places.iter().enumerate() {
        order[place as usize] = i;
    }
    order
}

/// A closed tour of 12 random towns.
fn tour() -> Result<Named, satisfice::Error> {
    let mut rng = SearchRng::new(3);
    let towns: Vec<[f64; 2]> = (0..12).map(|_| [rng.uniform(), rng.uniform()]).collect();
    problem("tour", Axis::permutation(12), 3.6343, move |x| {
        let order = in_order(x);
        let legs = order.iter().zip(order.iter().cycle().skip(1));
        legs.map(|(&a, &b)| (towns[a][0] - towns[b][0]).hypot(towns[a][1] - towns[b][1]))
            .sum()
    })
}

/// Koopmans, Beckmann 1957: ten works at ten places.
fn quadratic_assignment() -> Result<Named, satisfice::Error> {
    let mut rng = SearchRng::new(4);
    let distances: Vec<f64> = (0..100).map(|_| (10.0 * rng.uniform()).floor()).collect();
    let flows: Vec<f64> = (0..100)
        .map(|_| {
            if rng.uniform() < 0.5 {
                0.0
            } else {
                (10.0 * rng.uniform()).floor()
            }
        })
        .collect();
    problem("quadratic assignment", Axis::permutation(10), 729.5, move |x| {
        let pairs = (0..10).flat_map(|i| (0..10).map(move |j| (i, j)));
        pairs
            .map(|(i, j)| flows[10 * i + j] * distances[10 * x[i] as usize + x[j] as usize])
            .sum()
    })
}

/// Ten jobs that pass five machines in one order: when the last one is done.
fn flow_shop() -> Result<Named, satisfice::Error> {
    let mut rng = SearchRng::new(5);
    let times: Vec<Vec<f64>> = (0..10)
        .map(|_| (0..5).map(|_| 1.0 + (20.0 * rng.uniform()).floor()).collect())
        .collect();
    problem("flow shop", Axis::permutation(10), 166.5, move |x| {
        let mut done = [0.0_f64; 5];
        for job in in_order(x) {
            let mut before = 0.0;
            for (done, time) in done.iter_mut().zip(&times[job]) {
                *done = done.max(before) + time;
                before = *done;
            }
        }
        done[4]
    })
}

/// The pairs of so many vertices that are edges with this probability.
fn edges(vertices: usize, probability: f64, seed: u64) -> Vec<(usize, usize)> {
    let mut rng = SearchRng::new(seed);
    let pairs = (0..vertices).flat_map(|i| (0..i).map(move |j| (j, i)));
    pairs.filter(|_| rng.uniform() < probability).collect()
}

/// A graph whose vertices are on a line: the longest edge, and a little of the others.
fn bandwidth() -> Result<Named, satisfice::Error> {
    let edges = edges(14, 0.2, 7);
    problem("bandwidth", Axis::permutation(14), 7.00008, move |x| {
        let lengths = edges.iter().map(|&(i, j)| (x[i] - x[j]).abs());
        let longest = lengths.clone().fold(0.0, f64::max);
        longest + lengths.map(|length| (length / 14.0).powi(8)).sum::<f64>() / 100.0
    })
}

fn max_cut() -> Result<Named, satisfice::Error> {
    let edges = edges(26, 0.3, 9);
    problem("max cut", bits(26), -70.5, move |x| {
        -(edges.iter().filter(|&&(i, j)| x[i] != x[j]).count() as f64)
    })
}

/// Kauffman 1993: 20 bits, the worth of each depends on four others.
fn landscape() -> Result<Named, satisfice::Error> {
    let mut rng = SearchRng::new(10);
    let worths: Vec<Vec<f64>> = (0..20)
        .map(|_| (0..32).map(|_| rng.uniform()).collect())
        .collect();
    let with: Vec<Vec<usize>> = (0..20)
        .map(|i| {
            let mut with = vec![i];
            while with.len() < 5 {
                let other = (20.0 * rng.uniform()) as usize;
                if !with.contains(&other) {
                    with.push(other);
                }
            }
            with
        })
        .collect();
    problem("landscape", bits(20), -14.808, move |x| {
        let index = |with: &[usize]| with.iter().fold(0, |index, &j| 2 * index + x[j] as usize);
        -worths
            .iter()
            .zip(&with)
            .map(|(worths, with)| worths[index(with)])
            .sum::<f64>()
    })
}

/// Six times six spins on a torus.
fn spin_glass() -> Result<Named, satisfice::Error> {
    let mut rng = SearchRng::new(11);
    let bonds: Vec<f64> = (0..72)
        .map(|_| if rng.uniform() < 0.5 { 1.0 } else { -1.0 })
        .collect();
    problem("spin glass", bits(36), -43.5, move |x| {
        let spin = |row: usize, column: usize| 2.0 * x[(row % 6) * 6 + column % 6] - 1.0;
        let cells = (0..6).flat_map(|row| (0..6).map(move |column| (row, column)));
        let energy = cells.map(|(row, column)| {
            let [down, right] = [bonds[row * 6 + column], bonds[36 + row * 6 + column]];
            spin(row, column) * (down * spin(row + 1, column) + right * spin(row, column + 1))
        });
        -energy.sum::<f64>()
    })
}

/// Ten choices of six: each pair of choices has a random price.
fn categories() -> Result<Named, satisfice::Error> {
    let mut rng = SearchRng::new(12);
    let prices: Vec<f64> = (0..3600).map(|_| rng.normal()).collect();
    problem(
        "categories",
        (0..10).map(|_| Axis::categorical(6)),
        -25.088,
        move |x| {
            let pairs = (0..10).flat_map(|i| (0..i).map(move |j| (i, j)));
            pairs
                .map(|(i, j)| prices[(10 * i + j) * 36 + 6 * x[i] as usize + x[j] as usize])
                .sum()
        },
    )
}

/// Sandgren 1990: the cost of a vessel of plates in sixteenths of an inch, its violations added.
fn pressure_vessel() -> Result<Named, satisfice::Error> {
    let plates = [Axis::integer(1, 40), Axis::integer(1, 40)];
    let lengths = [Axis::continuous(10.0, 200.0), Axis::continuous(10.0, 200.0)];
    problem(
        "pressure vessel",
        plates.into_iter().chain(lengths),
        6600.0,
        |x| {
            let (shell, head, radius, length) = (x[0] / 16.0, x[1] / 16.0, x[2], x[3]);
            let cost = 0.6224 * shell * radius * length
                + 1.7781 * head * radius * radius
                + 3.1661 * shell * shell * length
                + 19.84 * shell * shell * radius;
            let volume = PI * radius * radius * length + 4.0 / 3.0 * PI * radius.powi(3);
            let thin = (0.0193 * radius - shell).max(0.0) + (0.00954 * radius - head).max(0.0);
            cost + 1e4 * thin + (1_296_000.0 - volume).max(0.0) / 100.0
        },
    )
}
