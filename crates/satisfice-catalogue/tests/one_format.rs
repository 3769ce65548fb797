//! A library's report and the command's are the same JSON.

#![allow(clippy::unwrap_used, missing_docs)]

use satisfice::catalogue::{Catalogued, Params};
use satisfice::{Budget, Search};
use satisfice_catalogue::{RunControl, RunSpec, catalogue};
use satisfice_problems::{Himmelblau, Queens};
use serde::{Serialize, de::DeserializeOwned};

/// The text with the numbers behind these keys replaced.
fn without_times(json: &str) -> String {
    let keys = ["\"elapsed_seconds\":", "\"overshoot_seconds\":", "\"seconds\":"];
    let mut text = json.to_owned();
    for key in keys {
        let parts: Vec<&str> = text.split(key).collect();
        let rest = parts[1..]
            .iter()
            .map(|part| part.trim_start_matches(|c| !",}".contains(c)));
        text = std::iter::once(parts[0])
            .chain(rest)
            .collect::<Vec<_>>()
            .join(key);
    }
    text
}

fn compare<P>(settings: &[(&str, &str)], engine: &str, islands: usize, probes: Option<f64>)
where
    P: Catalogued,
    P::Solution: Serialize + DeserializeOwned,
{
    let settings = settings.iter().copied();
    let problem = P::from_params(&Params::with(P::PARAMETERS, P::NAME, settings.clone()).unwrap()).unwrap();
    let mut search = Search::named(engine).unwrap().seed(7).islands(islands);
    if let Some(share) = probes {
        search = search.probes(share);
    }
    let library = search
        .run(&problem, &Budget::evaluations(3_000).and_hits(500))
        .unwrap();
    let mut spec = RunSpec::new(engine).seed(7).evaluations(3_000).hits(500);
    spec.probes = probes;
    spec.islands = islands;
    let command = catalogue::find(P::NAME).unwrap().build(settings).unwrap();
    let command = command.run(&spec, RunControl::default()).unwrap();
    assert!(library.hit_count() > 0);
    assert_eq!(
        without_times(&serde_json::to_string(&library).unwrap()),
        without_times(&serde_json::to_string(&command).unwrap()),
    );
}

#[test]
fn the_library_writes_what_the_command_writes() {
    compare::<Queens>(&[("n", "6")], "latest-hit-qpso", 1, None);
    compare::<Queens>(&[("n", "5")], "portfolio", 2, Some(0.25));
    compare::<Himmelblau>(&[], "restarted-cma-es", 1, Some(0.125));
}
