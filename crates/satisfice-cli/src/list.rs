//! `satisfice list`: every engine and problem with its parameters.

use std::fmt::Write;
use std::process::ExitCode;

use satisfice_catalogue::listing::{Item, Listing, Range, Row, listing};
use satisfice_catalogue::{Catalogue, json};

use satisfice_bench::table;

use crate::arguments::ListArguments;
use crate::output;

/// Choices that take more characters than this are listed after the summary: a column as wide as they are is not readable.
const WIDEST_CHOICES: usize = 40;

pub(crate) fn list(arguments: &ListArguments, catalogue: &Catalogue) -> anyhow::Result<ExitCode> {
    let mut listing = listing(catalogue);
    if !arguments.names.is_empty() {
        select(&mut listing, &arguments.names)?;
    }
    if arguments.json {
        output::print(&json::to_vec(&listing)?)?;
    } else {
        output::print(text(&listing).as_bytes())?;
    }
    Ok(ExitCode::SUCCESS)
}

/// Keeps the engines and problems of these names.
fn select(listing: &mut Listing, names: &[String]) -> anyhow::Result<()> {
    let mut wanted = Vec::new();
    for name in names {
        // An engine may be named by its alias.
        let engine = satisfice::engine::find(name).map(|engine| engine.name);
        let mut known = listing
            .engines
            .iter()
            .chain(&listing.problems)
            .map(|item| item.name);
        match engine.ok().or_else(|| known.find(|known| known == name)) {
            Some(name) => wanted.push(name),
            None => {
                let known = listing.problems.iter().chain(&listing.engines);
                return Err(satisfice::Error::unknown(
                    "problem or engine",
                    name,
                    known.map(|item| item.name),
                )
                .into());
            }
        }
    }
    listing.engines.retain(|item| wanted.contains(&item.name));
    listing.problems.retain(|item| wanted.contains(&item.name));
    Ok(())
}

fn text(listing: &Listing) -> String {
    let mut parts = Vec::new();
    if !listing.engines.is_empty() {
        let usage = "--engine NAME --engine-set PARAMETER=VALUE";
        let mut text = items("engine", usage, &listing.engines);
        text.push_str("\n  Every engine also takes:\n");
        text.push_str(&parameters(&listing.common_engine_parameters));
        parts.push(text);
    }
    if !listing.problems.is_empty() {
        parts.push(items(
            "problem",
            "run PROBLEM --set PARAMETER=VALUE",
            &listing.problems,
        ));
    }
    parts.join("\n")
}

/// The items one below the other, each with a table of its parameters.
fn items(what: &str, usage: &str, items: &[Item]) -> String {
    let plural = if items.len() == 1 { "" } else { "s" };
    let mut text = format!("{} {what}{plural} ({usage})\n", items.len());
    // Writing to a string cannot fail.
    for item in items {
        let _ = writeln!(text, "\n  {}: {}", item.name, item.summary);
        let _ = writeln!(text, "      source: {}", item.reference);
        text.push_str(&parameters(&item.parameters));
    }
    text
}

/// A table of parameters, a line each.
fn parameters(rows: &[Row]) -> String {
    let rows: Vec<Vec<String>> = rows.iter().map(|row| columns(row).to_vec()).collect();
    table::plain(&rows, 6, 4)
}

/// Name, default, range, summary.
fn columns(row: &Row) -> [String; 4] {
    let mut summary = row.summary.clone();
    let (default, range) = match row.values {
        Range::Integer { default, min, max } => (default.to_string(), format!("{min} to {}", greatest(max))),
        Range::Real { default, min, max } => (default.to_string(), format!("{} to {}", real(min), real(max))),
        Range::OptionalInteger { default, min, max } => (
            default.to_owned(),
            format!("{default} or {min} to {}", greatest(max)),
        ),
        Range::OptionalReal { default, min, max } => (
            default.to_owned(),
            format!("{default} or {} to {}", real(min), real(max)),
        ),
        Range::Choice { default, of } => {
            let mut choices = of.join(" | ");
            if choices.len() > WIDEST_CHOICES {
                summary = format!("{}; one of: {choices}", summary.trim_end_matches('.'));
                choices = format!("one of {}", of.len());
            }
            (default.to_owned(), choices)
        }
        Range::Text { default } => (format!("{default:?}"), "any text".to_owned()),
    };
    [row.name.to_owned(), default, range, summary]
}

/// The greatest integer stands for no bound.
fn greatest(max: i64) -> String {
    if max == i64::MAX {
        "2^63 - 1".to_owned()
    } else {
        max.to_string()
    }
}

/// Large and small numbers with an exponent.
fn real(value: f64) -> String {
    if value != 0.0 && !(1e-4..1e7).contains(&value.abs()) {
        format!("{value:e}")
    } else {
        value.to_string()
    }
}

#[cfg(test)]
mod tests {
    use satisfice::catalogue::Parameter;

    use super::*;

    #[test]
    fn a_table_is_readable() {
        let rows = [
            Parameter::integer("particles", "N", 30, 1, 10_000),
            Parameter::integer("sample-seed", "seed of the sample", 1, 0, i64::MAX),
            Parameter::real("alpha", "contraction-expansion coefficient", 1.0, 1e-12, 1e9),
            Parameter::choice("attractor", "who attracts", "best", &["best", "latest-hit"]),
            Parameter::choice(
                "without",
                "What to leave out.",
                "none",
                &["none", "swarms", "recombination", "quadratic-descents", "model"],
            ),
            Parameter::text("mesh", "a file", ""),
        ];
        let swarm = Item {
            name: "swarm",
            summary: "a swarm",
            reference: "somebody 1995",
            parameters: rows.iter().map(Row::from).collect(),
        };
        let plain = Item {
            name: "plain",
            summary: "no parameters",
            reference: "none needed",
            parameters: Vec::new(),
        };
        insta::assert_snapshot!(items("engine", "--engine NAME", &[swarm, plain]));
    }
}
