//! Makes again, by visiting every lattice point, the reference counts that the problems keep as constants.
//!
//! `cargo run --release -p satisfice-problems --example enumerate`: about ten seconds.

use satisfice::Error;
use satisfice::catalogue::{Catalogued, Params};
use satisfice_problems::{Arm, Falsification, Islands, Rastrigin, SallenKey, SevenJoints, Shell, count_hits};

fn row<P: Catalogued<Scalar = f64>>(settings: &[(&str, &str)]) -> Result<bool, Error> {
    let problem = P::from_params(&Params::with(P::PARAMETERS, P::NAME, settings.iter().copied())?)?;
    let parameters: Vec<String> = (problem.description().parameters.iter())
        .map(|(name, value)| format!("{name}={value}"))
        .collect();
    let points = problem.space().cardinality().unwrap_or(f64::INFINITY);
    let (counted, kept) = (count_hits(&problem, 1e9), problem.reference_hits());
    let verdict = if counted == kept { "as kept" } else { "DIFFERS" };
    println!(
        "{:14} {:45} {points:>9} points {:>7} hits, {verdict}",
        P::NAME,
        parameters.join(" "),
        counted.unwrap_or(0)
    );
    Ok(counted == kept)
}

fn main() -> Result<(), Error> {
    let mut same = true;
    for dimension in ["2", "3", "4", "5", "6"] {
        same &= row::<Rastrigin>(&[("dimension", dimension)])?;
    }
    for dimension in ["2", "4", "6"] {
        same &= row::<Shell>(&[("dimension", dimension)])?;
    }
    same &= row::<Islands>(&[])?;
    for links in ["3", "4", "5"] {
        same &= row::<Arm>(&[("links", links)])?;
    }
    same &= row::<SallenKey>(&[])?;
    same &= row::<Falsification>(&[])?;
    same &= row::<SevenJoints>(&[])?;
    assert!(same, "a kept count is not the enumerated one");
    Ok(())
}
