//! The library as its users call it. One program, because each compiles the search again for every type of problem.

mod allocation;
mod axes;
mod best;
mod checkpoint;
mod closures;
mod conformance;
mod equations;
mod failing_points;
mod isolated_hits;
mod lanes;
mod lanes_apart;
mod many_axes;
mod model_at_work;
mod panics;
mod patience;
mod portfolio;
mod problem_suite;
mod problem_suite_rare;
mod rounds;
mod slices;
mod start_points;
mod tickets;
mod tickets_at_once;
mod tickets_unused;
mod told;
mod unsized_problem;
