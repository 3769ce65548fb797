//! The README's table of engines is the registry.

use satisfice::engine;

#[test]
fn the_readme_lists_every_engine_in_the_order_of_the_registry() {
    let readme = include_str!("../README.md");
    let listed: Vec<&str> = readme
        .lines()
        .skip_while(|line| *line != "| engine | what it does |")
        .skip(2)
        .map_while(|line| line.strip_prefix("| `"))
        .filter_map(|line| line.split('`').next())
        .collect();
    let known: Vec<&str> = engine::all().iter().map(|entry| entry.name).collect();
    assert_eq!(listed, known);
}
