//! The documents agree with the code.

use std::path::{Path, PathBuf};

use satisfice_catalogue::Catalogue;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

#[test]
fn links_between_the_documents_lead_somewhere() {
    let root = root();
    let mut links = 0;
    for document in [
        "README.md",
        "CONTRIBUTING.md",
        "docs/architecture.md",
        "docs/adding-an-engine.md",
        "docs/adding-a-problem.md",
        "docs/collision.md",
        "docs/engines.md",
        "docs/glossary.md",
        "docs/guide.md",
        "docs/problems.md",
        "docs/completeness.md",
        "docs/reproducibility.md",
        "docs/results/generalisation.md",
        "docs/results/paper.md",
        "examples/README.md",
    ] {
        let path = root.join(document);
        let text = std::fs::read_to_string(&path).unwrap_or_default();
        assert!(!text.is_empty(), "{document} is missing or empty");
        for link in text.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            if link.contains("://") || link.contains("::") {
                continue;
            }
            let (file, heading) = link.split_once('#').unwrap_or((link, ""));
            let target = match file {
                "" => path.clone(),
                file => path.with_file_name("").join(file),
            };
            assert!(target.exists(), "{document} links to {link}, which is not there");
            assert!(
                heading.is_empty() || has_heading(&target, heading),
                "{document} links to {link}, where there is no such heading"
            );
            links += 1;
        }
    }
    assert!(links >= 10, "only {links} links were looked at");
}

/// Whether a document has a heading whose anchor is this: its words in lower case, joined by hyphens.
fn has_heading(document: &Path, anchor: &str) -> bool {
    let text = std::fs::read_to_string(document).unwrap_or_default();
    let headings = text.lines().filter(|line| line.starts_with('#'));
    let anchor_of = |heading: &str| {
        let words = heading.trim_start_matches('#').trim().to_lowercase();
        let kept = words
            .chars()
            .filter(|c| c.is_alphanumeric() || " -_".contains(*c));
        kept.map(|c| if c == ' ' { '-' } else { c }).collect::<String>()
    };
    headings.map(anchor_of).any(|of| of == anchor)
}

#[test]
fn the_examples_are_all_listed() {
    let folder = root().join("examples");
    let list = std::fs::read_to_string(folder.join("README.md")).unwrap_or_default();
    let entries = std::fs::read_dir(&folder).expect("the folder of the examples");
    for path in entries.filter_map(Result::ok).map(|entry| entry.path()) {
        if path.extension().is_some_and(|extension| extension == "rs") {
            let name = path
                .file_stem()
                .unwrap_or_default()
                .to_string_lossy()
                .into_owned();
            assert!(
                list.contains(&format!("| `{name}` |")),
                "examples/README.md does not list {name}"
            );
        }
    }
}

/// `docs/problems.md`, from the catalogue.
fn page_of_problems() -> String {
    let catalogue = Catalogue::bundled();
    let cell = |text: &str| text.replace('|', "\\|");
    let mut page = "# Problems\n\nEvery bundled problem, in the order of `satisfice list`. A test keeps this page like the catalogue; after a change run\n\
        `UPDATE=1 cargo test -p satisfice-bench --test documents`. Run one by `satisfice run NAME --set PARAMETER=VALUE`; write your own by\n\
        [adding-a-problem.md](adding-a-problem.md).\n\n| problem | the answers | source |\n|---|---|---|\n"
        .to_owned();
    for spec in catalogue.problems() {
        page += &format!(
            "| `{}` | {} | {} |\n",
            spec.name,
            cell(spec.summary),
            cell(spec.source)
        );
    }
    for spec in catalogue
        .problems()
        .iter()
        .filter(|spec| !spec.parameters.is_empty())
    {
        page += &format!(
            "\n## {}\n\n| parameter | default | allowed | meaning |\n|---|---|---|---|\n",
            spec.name
        );
        for parameter in spec.parameters {
            let (default, allowed) = (parameter.default_text(), cell(&parameter.allowed()));
            page += &format!(
                "| `{}` | {default} | {allowed} | {} |\n",
                parameter.name,
                cell(parameter.summary)
            );
        }
    }
    page
}

#[test]
fn the_page_of_problems_is_that_of_the_catalogue() {
    let (path, page) = (root().join("docs/problems.md"), page_of_problems());
    if std::env::var_os("UPDATE").is_some() {
        std::fs::write(&path, &page).expect("the page is written");
    }
    let found = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(
        found == page,
        "docs/problems.md is not that of the catalogue: set UPDATE=1 to write it"
    );
    assert!(!page.contains("](crate::") && !page.contains("](super::"));
}
