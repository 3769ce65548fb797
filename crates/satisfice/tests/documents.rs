//! The README and `docs/engines.md` agree with the registry of engines.

#![allow(clippy::expect_used, reason = "a test")]

use std::path::{Path, PathBuf};

use satisfice::catalogue::Parameter;
use satisfice::engine;

const README: &str = include_str!("../../../README.md");

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The names in the first table under a heading of the README.
fn names_under(heading: &str) -> Vec<&'static str> {
    let section = README.split(heading).nth(1).unwrap_or_default();
    let rows = section.lines().skip_while(|line| !line.starts_with('|'));
    rows.take_while(|line| line.starts_with('|'))
        .filter_map(|row| row.split('`').nth(1))
        .collect()
}

#[test]
fn the_readme_names_engines_that_exist() {
    let names = names_under("## Engines");
    assert!(names.len() > 3 && names[0] == engine::default::<f64>().name());
    for name in names {
        assert!(engine::find(name).is_ok_and(|spec| spec.name == name), "{name}");
    }
}

/// A text in a table.
fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}

/// `docs/engines.md`, from the registry.
fn page_of_engines() -> String {
    let mut page = "# Engines\n\nEvery registered engine, in the order of `satisfice list`. A test keeps this page like the registry; after a change run\n\
        `UPDATE=1 cargo test -p satisfice --test documents`.\n\n| engine | what it does | after |\n|---|---|---|\n"
        .to_owned();
    for spec in engine::all() {
        page += &format!(
            "| `{}` | {} | {} |\n",
            spec.name,
            cell(spec.summary),
            cell(spec.citation)
        );
    }
    page += &format!("\nEvery engine also takes:\n{}", table(engine::COMMON_PARAMETERS));
    for spec in engine::all() {
        if !spec.parameters().is_empty() {
            page += &format!("\n## {}\n{}", spec.name, table(spec.parameters()));
        }
    }
    page
}

/// A table of parameters.
fn table(parameters: &[Parameter]) -> String {
    let mut table = "\n| parameter | default | allowed | meaning |\n|---|---|---|---|\n".to_owned();
    for parameter in parameters {
        table += &format!(
            "| `{}` | {} | {} | {} |\n",
            parameter.name,
            parameter.default_text(),
            cell(&parameter.allowed()),
            cell(parameter.summary)
        );
    }
    table
}

/// Links of the API's docs lead nowhere on the page.
#[test]
fn the_page_of_engines_has_no_links_into_the_api() {
    assert!(!page_of_engines().contains("](crate::") && !page_of_engines().contains("](super::"));
}

#[test]
fn the_page_of_engines_is_that_of_the_registry() {
    let (path, page) = (root().join("docs/engines.md"), page_of_engines());
    if std::env::var_os("UPDATE").is_some() {
        std::fs::write(&path, &page).expect("the page is written");
    }
    let found = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(
        found == page,
        "docs/engines.md is not that of the registry: set UPDATE=1 to write it"
    );
}
