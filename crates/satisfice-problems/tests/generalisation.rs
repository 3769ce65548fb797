//! Whether the paper's rule helps on other problems: the latest-hit swarm against QPSO attracted to the best and against
//! uniform sampling, on problems whose hits cluster and on one whose hits do not.
#![allow(clippy::unwrap_used, missing_docs)]

use satisfice::catalogue::{Catalogued, Params};
use satisfice::{Budget, Search};
use satisfice_problems::{
    Arm, Falsification, Islands, Needles, Queens, Rastrigin, SallenKey, SevenJoints, Shell, SmallRegions,
};

const EVALUATIONS: u64 = 30_000;
const SEEDS: u64 = 6;
/// The family: the paper's engine, and small swarms with restarts that follow the latest hit of their own.
const FAMILY: [&str; 3] = ["latest-hit-qpso", "pso-latest-hit", "portfolio"];

/// Hits of all seeds together.
fn hits<P: Catalogued<Scalar = f64>>(engine: &str, settings: &[(&str, &str)]) -> f64 {
    hits_within::<P>(EVALUATIONS, engine, settings)
}

fn hits_within<P: Catalogued<Scalar = f64>>(
    evaluations: u64,
    engine: &str,
    settings: &[(&str, &str)],
) -> f64 {
    let problem =
        P::from_params(&Params::with(P::PARAMETERS, P::NAME, settings.iter().copied()).unwrap()).unwrap();
    let count = (0..SEEDS).map(|seed| {
        let mut search = Search::named(engine).unwrap().seed(seed);
        let report = search.run(&problem, &Budget::evaluations(evaluations)).unwrap();
        report.hit_count()
    });
    count.sum::<usize>() as f64
}

/// The best of the family, and the two that it has to beat.
fn contest<P: Catalogued<Scalar = f64>>(settings: &[(&str, &str)]) -> [f64; 4] {
    let family = FAMILY.map(|engine| hits::<P>(engine, settings));
    let best = family.into_iter().fold(0.0, f64::max);
    let result = [
        family[0],
        best,
        hits::<P>("qpso", settings),
        hits::<P>("random", settings),
    ];
    println!(
        "{} {settings:?}: paper, family, best-attracting, uniform {result:?}",
        P::NAME
    );
    result
}

/// Sums of 6 seeds at 30,000 evaluations. The family's best is the portfolio everywhere but on none; it has from 3 times (arms) to
/// 100 times as many hits as uniform sampling, so that 1.5 times is far from chance. The paper's own swarm varies by a half from
/// seed to seed: it is only asked to win over all problems together, by the geometric mean.
#[test]
fn latest_hits_lead_where_hits_cluster() {
    let contests: [fn() -> [f64; 4]; 10] = [
        || contest::<Falsification>(&[]),
        || contest::<SallenKey>(&[]),
        || contest::<Arm>(&[]),
        || contest::<Arm>(&[("links", "5")]),
        || contest::<SevenJoints>(&[]),
        || contest::<Islands>(&[]),
        || contest::<Rastrigin>(&[]),
        || contest::<Rastrigin>(&[("dimension", "3")]),
        || contest::<Shell>(&[]),
        || contest::<Queens>(&[]),
    ];
    let results = std::thread::scope(|scope| {
        let running = contests.map(|contest| scope.spawn(contest));
        running.map(|contest| contest.join().unwrap())
    });
    let (mut over_best, mut over_uniform) = (0.0, 0.0);
    for [paper, family, best, uniform] in results {
        assert!(family > 1.5 * best && family > 1.5 * uniform, "{results:?}");
        over_best += (paper.max(1.0) / best.max(1.0)).ln();
        over_uniform += (paper.max(1.0) / uniform.max(1.0)).ln();
    }
    assert!(
        over_best > 0.0 && over_uniform > 0.0,
        "{over_best} {over_uniform}"
    );
}

/// 2,026 needles among a million points, at places that nothing hints at: 30,000 draws hit 60 of them a seed, 359 of six, with a
/// deviation of 19. Whatever proposes points without looking back does as well, and nothing does better; a swarm that
/// repeats itself does worse, but the default engine must not.
#[test]
fn nobody_leads_on_needles() {
    let needles =
        Needles::from_params(&Params::with(Needles::PARAMETERS, Needles::NAME, []).unwrap()).unwrap();
    let known = needles.reference_hits().unwrap() as f64;
    let expected = known * (1.0 - (1.0 - 1e-6_f64).powi(EVALUATIONS as i32)) * SEEDS as f64;
    let deviation = expected.sqrt();
    for name in ["random", "latest-hit-qpso", "portfolio"] {
        let found = hits::<Needles>(name, &[]);
        println!("{name}: {found}, expected {expected:.0} +- {deviation:.0}");
        assert!(
            (found - expected).abs() < 4.0 * deviation,
            "{name}: {found} instead of {expected}"
        );
    }
}

/// Stairs that lead down to eight boxes: the value of the lowest one that misses is delta itself. A model that took it for the edge of a hit
/// would stay there; 200 uniform points find three of the boxes.
#[test]
fn a_model_leaves_the_lowest_stair() {
    let stairs = [
        ("dimension", "4"),
        ("radius", "0.1"),
        ("steps", "4"),
        ("instance", "3"),
    ];
    let found = ["surrogate", "random"].map(|engine| hits_within::<SmallRegions>(200, engine, &stairs));
    println!("surrogate, random: {found:?}");
    assert!(found[0] > 0.8 * found[1], "{found:?}");
}

/// 400 uniform points find 6.5 of eight boxes that fill 3 % of six axes and whose surroundings are flat. One of the 65 points of two grids is in each
/// box inside the bounds whose sides are above a third.
#[test]
fn no_plateau_is_overlooked_by_the_default() {
    for instance in ["70", "71", "72"] {
        let stairs = [("radius", "0.2"), ("steps", "3"), ("instance", instance)];
        let found = hits_within::<SmallRegions>(400, "portfolio", &stairs) / SEEDS as f64;
        assert!(found > 7.5, "{found} of 8, instance {instance}");
    }
}
