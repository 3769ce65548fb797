//! `list` and `help`, as a user calls them.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use common::{report, satisfice};

#[test]
fn help_is_there_however_it_is_asked_for() {
    let help = satisfice("--help");
    for arguments in ["help", "help --help", "help -h"] {
        assert_eq!(satisfice(arguments).stdout, help.stdout, "{arguments}");
    }
    assert_eq!(satisfice("help list").stdout, satisfice("list --help").stdout);
}

#[test]
fn list_shows_what_is_named_only() {
    let text = satisfice("list queens wang").stdout;
    assert!(text.starts_with("1 engine ("), "{text}");
    assert!(
        text.contains("\n1 problem (")
            && text.contains("\n  queens: ")
            && text.contains("\n  niching-pso-dbscan: ")
    );
    assert!(!text.contains("  teapots: ") && !text.contains("  portfolio: "));
    let problem = satisfice("list teapots").stdout;
    assert!(
        problem.starts_with("1 problem (") && !problem.contains("Every engine"),
        "{problem}"
    );
    let json = report("list portfolio --json");
    assert_eq!(json["engines"].as_array().unwrap().len(), 1);
    assert!(json["problems"].as_array().unwrap().is_empty());
    // Links are for the documentation.
    assert!(!satisfice("list").stdout.contains("]("));
}
