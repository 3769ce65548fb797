//! Problems whose F has no value at many points.

use std::collections::BTreeMap;
use std::sync::Mutex;

use satisfice::{Budget, Search, Space, from_fn};

#[test]
fn a_local_search_leaves_a_start_that_fails() {
    let calls: Mutex<BTreeMap<Vec<u64>, u32>> = Mutex::default();
    let problem = from_fn(Space::cube(6, 0.0, 1.0).unwrap(), 1e-3, |x: &[f64]| {
        match x[0] < 0.5 {
            true => {
                let bits = x.iter().map(|x| x.to_bits()).collect();
                *calls.lock().unwrap().entry(bits).or_default() += 1;
                f64::NAN
            }
            false => x.iter().map(|x| (x - 0.7) * (x - 0.7)).sum(),
        }
    });
    let report = Search::named("restarted-cma-es")
        .unwrap()
        .seed(3)
        .run(&problem, &Budget::evaluations(5_000))
        .unwrap();
    let calls = calls.into_inner().unwrap();
    let most = calls.values().max().unwrap();
    assert!(*most == 1, "one point was evaluated {most} times");
    let hits = report.hits().len();
    assert!(hits > 0, "half of the starts lead to the hits");
}
