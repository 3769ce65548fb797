//! Shared by the examples that draw: a search of the right length, and the folder for pictures.

#![allow(dead_code, reason = "each example uses a part")]

use std::error::Error;
use std::path::PathBuf;
use std::{env, fs};

use satisfice::{Budget, Report, SatisficingProblem, Search};
use satisfice_draw::plot::Format;

/// Whether to run a short form that only shows that the example works.
pub(crate) fn is_quick() -> bool {
    env::var_os("SATISFICE_QUICK").is_some_and(|value| value != "0")
}

/// Searches with the default engine and seed 1 for at most `evaluations` (a fifth of them under `SATISFICE_QUICK`), or until `hits`.
pub(crate) fn search<P: SatisficingProblem<Scalar = f64>>(
    problem: &P,
    evaluations: u64,
    hits: u64,
) -> Result<Report<P::Solution>, satisfice::Error> {
    let evaluations = if is_quick() { evaluations / 5 } else { evaluations };
    let mut search = Search::new().seed(1);
    search.run(problem, &Budget::evaluations(evaluations).and_hits(hits))
}

/// Writes a picture as SVG and as PNG into `out/NAME`, or the folder in `SATISFICE_OUT`.
pub(crate) fn save(
    name: &str,
    draw: impl Fn(Format) -> Result<Vec<u8>, satisfice_draw::Error>,
) -> Result<(), Box<dyn Error>> {
    let out = env::var_os("SATISFICE_OUT");
    let folder = out.map_or_else(|| PathBuf::from("out").join(name), PathBuf::from);
    fs::create_dir_all(&folder)?;
    for (format, extension) in [(Format::Svg, "svg"), (Format::Png, "png")] {
        let path = folder.join(format!("{name}.{extension}"));
        fs::write(&path, draw(format)?)?;
        println!("look at {}", path.display());
    }
    Ok(())
}
