//! Compares engines on problems: [sweeps](sweep) of engines, problems and seeds, [studies], statistics and reports.

mod error;
mod finding;
pub mod plain_grid;
pub mod statistics;
pub mod studies;
pub mod sweep;
pub mod table;

pub use error::Error;
pub use finding::{Figure, Finding};

/// The code of the documents at the root, compiled and run with the doc tests.
#[cfg(doctest)]
mod documents {
    macro_rules! documents {
        ($($name:ident: $path:literal),* $(,)?) => {$(
            #[doc = include_str!(concat!("../../../", $path))]
            struct $name;
        )*};
    }
    documents! {
        Readme: "README.md",
        Architecture: "docs/architecture.md",
        AddingAnEngine: "docs/adding-an-engine.md",
        AddingAProblem: "docs/adding-a-problem.md",
        Completeness: "docs/completeness.md",
        Reproducibility: "docs/reproducibility.md",
    }
}
