//! `run`, `list`, `verify` and `completions`, as a user calls them.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::fs;
use std::process::Stdio;

use common::{command, error, error_in, report, satisfice, satisfice_in, without_times};
use satisfice::engine;
use satisfice_catalogue::catalogue;
use serde_json::Value;

/// A quick run with hits.
const TEAPOTS: &str = "run teapots --set samples=800 --evaluations 20000 --seed 1";

#[test]
fn help_is_as_it_was_written() {
    for (name, arguments) in [
        ("help", "--help"),
        ("help_list", "list --help"),
        ("help_run", "run --help"),
        ("help_collide", "collide --help"),
        ("help_bench", "bench --help"),
        ("help_verify", "verify --help"),
        ("help_completions", "completions --help"),
    ] {
        let done = satisfice(arguments);
        assert_eq!((done.code, done.stderr.as_str()), (0, ""), "{arguments}");
        insta::assert_snapshot!(name, done.stdout);
    }
    assert_eq!(
        satisfice("--version").stdout,
        format!("satisfice {}\n", env!("CARGO_PKG_VERSION"))
    );
}

/// Every mistake is told in one line, with the nearest name where a name is wrong; exit code 2.
#[test]
fn mistakes_are_told_in_one_line() {
    let lines: Vec<String> = [
        "",
        "rum teapots",
        "run",
        "run teapost",
        "run teapots --engine latest-hit-qspo",
        "run teapots --set dleta=0.1",
        "run teapots --set delta=-1",
        "run teapots --set delta=wide",
        "run teapots --set delta",
        "run teapots --engine-set partciles=3",
        "run teapots --engine-set particles=0",
        "run teapots --tiem 1s",
        "run teapots delta=0.1",
        "run teapots --offset 0.1",
        "run teapots --time 100",
        "run teapots --time 0",
        "run teapots --time 0s",
        "run teapots --time -1s",
        "run teapots --time soon",
        "run teapots --evaluations 0",
        "run teapots --evaluations -5",
        "run teapots --evaluations 1.5",
        "run teapots --hits 0",
        "run teapots --patience 0",
        "run teapots --slices 0",
        "run teapots --seed -1",
        "run teapots --probes 0.9",
        "run teapots --threads many",
        "run teapots --threads 100000",
        "run teapots --islands 0",
        "run teapots --parallel 1e12",
        "list qeens",
        "run teapots --plot hits.pdf",
        "run teapots --json no/such/folder/report.json",
        "run teapots --json src",
        "verify no-such-report.json",
        "verify Cargo.toml",
        "completions csh",
        "collide --from -1s --to 0.5s a.glb --threshold 1",
        "collide --from=-1s --to 0.5s a.glb --threshold 1",
    ]
    .iter()
    .map(|arguments| {
        let line = error(arguments);
        // The lists of what is known grow with the registry.
        let line = match line.split_once("; known: ") {
            Some((line, known)) if known.contains("qpso") || known.contains("teapots") => {
                format!("{line}; known: ...")
            }
            _ => line,
        };
        format!("satisfice {arguments}\n    {line}")
    })
    .collect();
    insta::assert_snapshot!("mistakes", lines.join("\n"));
}

#[test]
fn list_names_every_engine_and_problem_with_its_parameters() {
    let text = satisfice("list");
    assert_eq!((text.code, text.stderr.as_str()), (0, ""));
    let json = report("list --json");
    let names = |key: &str| -> Vec<&str> {
        let items = json[key].as_array().unwrap().iter();
        items.map(|item| item["name"].as_str().unwrap()).collect()
    };
    let engines: Vec<_> = engine::all().iter().map(|entry| entry.name).collect();
    let problems: Vec<_> = catalogue::all().iter().map(|entry| entry.name).collect();
    assert_eq!((names("engines"), names("problems")), (engines, problems));
    let parameters = engine::all().iter().map(|entry| (entry.name, entry.parameters()));
    for (name, parameters) in parameters.chain(
        catalogue::all()
            .iter()
            .map(|entry| (entry.name, entry.parameters)),
    ) {
        assert!(text.stdout.contains(&format!("\n  {name}: ")), "{name}");
        for parameter in parameters {
            assert!(
                text.stdout.contains(&format!("\n      {} ", parameter.name)),
                "{name} {}",
                parameter.name
            );
        }
    }
    let particles = &json["engines"]
        .as_array()
        .unwrap()
        .iter()
        .find(|e| e["name"] == "latest-hit-qpso")
        .unwrap();
    let particles = &particles["parameters"][0];
    assert_eq!(
        (&particles["name"], &particles["kind"], &particles["default"]),
        (&"particles".into(), &"integer".into(), &30.into())
    );
}

#[test]
fn a_report_repeats_itself_on_any_number_of_threads() {
    let once = without_times(report(&format!("{TEAPOTS} --json -")));
    assert!(once["hits"].as_u64().unwrap() > 0);
    for more in ["", "--threads 2", "--threads 0"] {
        assert!(
            without_times(report(&format!("{TEAPOTS} --json - {more}"))) == once,
            "{more}"
        );
    }
    let other = report(&format!("{} --json -", TEAPOTS.replace("--seed 1", "--seed 2")));
    assert!(without_times(other) != once);
}

#[test]
fn islands_find_the_same_on_any_number_of_threads() {
    let run = |more: &str| {
        let arguments = "run falsification --islands 4 --evaluations 30000 --seed 1 --json -";
        report(&format!("{arguments} {more}"))
    };
    let one = run("");
    assert_eq!(one["islands"], 4);
    assert_eq!(one["evaluations"], 30_000);
    assert!(one["hits"].as_u64().unwrap() > 3_000, "{}", one["hits"]);
    assert_eq!(without_times(one), without_times(run("--threads 2")));
}

#[test]
fn patience_ends_a_run_and_its_report_is_checked() {
    let mut report = report("run himmelblau --patience 700 --seed 1 --json -");
    let hits = report["hits"].as_u64().unwrap() as usize;
    let last = report["solutions"][hits - 1]["evaluation"].as_u64().unwrap();
    assert_eq!(report["budget"]["time_seconds"], Value::Null);
    assert_eq!(
        (&report["budget"]["patience"], &report["stop_reason"]),
        (&700.into(), &"Patience".into())
    );
    assert_eq!(report["evaluations"], last + 700);
    report["budget"]["patience"] = 600.into();
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("impatient.json"), report.to_string()).unwrap();
    let wrong = satisfice_in(folder.path(), "verify impatient.json");
    assert_eq!(wrong.code, 1);
    assert!(wrong.stdout.contains("patience of 600"), "{}", wrong.stdout);
}

#[test]
fn parallel_changes_the_result_and_threads_do_not() {
    let run = |more: &str| {
        let arguments = "run himmelblau --evaluations 2000 --seed 1 --json -";
        without_times(report(&format!("{arguments} {more}")))
    };
    let (alone, eight) = (run(""), run("--parallel 8"));
    assert_eq!(alone["budget"].get("parallel"), None);
    assert_eq!(eight["budget"]["parallel"], 8);
    assert_ne!(alone["solutions"], eight["solutions"]);
    assert_eq!(eight, run("--parallel 8 --threads 2"));
}

#[test]
fn a_summary_shows_the_first_slices_and_counts_the_others() {
    let shown = satisfice("run teapots --evaluations 10 --slices 25").stdout;
    assert!(
        shown.contains("slice 20 ") && !shown.contains("slice 21 "),
        "{shown}"
    );
    assert!(
        shown.contains("and 5 more slices; --json FILE lists them all"),
        "{shown}"
    );
}

#[test]
fn a_report_has_the_keys_of_the_contract() {
    let report = report("run arm --evaluations 20000 --seed 1 --json - --slices 2");
    let keys: Vec<&String> = report.as_object().unwrap().keys().collect();
    insta::assert_debug_snapshot!("keys", keys);
    assert_eq!(report["evaluations"], 40_000);
    assert_eq!(report["slices"].as_array().unwrap().len(), 2);
    assert_eq!(report["hits"], report["solutions"].as_array().unwrap().len());
    let reference = report["reference_hits"].as_f64().unwrap();
    assert_eq!(report["recall"], report["hits"].as_f64().unwrap() / reference);
    for key in ["solution", "fitness", "evaluation", "seconds"] {
        assert!(report["solutions"][0].get(key).is_some(), "{key}");
    }
    let fitness = |hit: &Value| hit["fitness"].as_f64().unwrap();
    let least = report["solutions"].as_array().unwrap().iter().map(fitness);
    assert!(fitness(&report["best"]) <= least.fold(f64::INFINITY, f64::min));
    for key in ["evaluations", "elapsed_seconds", "hits"] {
        assert!(report["trace"][0].get(key).is_some(), "{key}");
    }
}

#[test]
fn the_exit_code_says_whether_there_is_a_hit() {
    let found = satisfice(TEAPOTS);
    assert_eq!((found.code, found.stderr.as_str()), (0, ""));
    assert!(
        found.stdout.starts_with("teapots by portfolio, seed 1\n  hits "),
        "{}",
        found.stdout
    );
    let none = satisfice("run teapots --set samples=800 --set offset=50 --evaluations 1000");
    assert_eq!(none.code, 1);
    assert!(
        none.stdout.contains("  hits          0 of 0\n"),
        "{}",
        none.stdout
    );
    let stopped = report("run teapots --engine random --hits 3 --time 1min --json -");
    assert_eq!(
        (&stopped["hits"], &stopped["stop_reason"]),
        (&3.into(), &"Hits".into())
    );
}

#[test]
fn files_are_written_and_verified() {
    let folder = tempfile::tempdir().unwrap();
    for figure in ["hits.svg", "hits.png"] {
        let done = satisfice_in(
            folder.path(),
            &format!("{TEAPOTS} --json report.json --plot {figure} --page page.html"),
        );
        assert_eq!((done.code, done.stderr.as_str()), (0, ""));
        assert!(fs::metadata(folder.path().join(figure)).unwrap().len() > 1000);
    }
    let page = fs::read_to_string(folder.path().join("page.html")).unwrap();
    assert!(page.starts_with("<!DOCTYPE html>") && page.ends_with("</html>"));
    let done = satisfice_in(folder.path(), "verify report.json");
    assert_eq!(done.code, 0);
    assert!(
        done.stdout.starts_with("report.json is true: "),
        "{}",
        done.stdout
    );
    let mut left: Vec<_> = fs::read_dir(folder.path())
        .unwrap()
        .map(|f| f.unwrap().file_name())
        .collect();
    left.sort();
    assert_eq!(
        left,
        ["hits.png", "hits.svg", "page.html", "report.json"],
        "nothing half-written stays"
    );
}

/// A report that was tampered with is found out, whatever was changed.
#[test]
fn a_false_report_is_found_out() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("report.json");
    let report = report(&format!("{TEAPOTS} --json -"));
    type Change = fn(&mut Value);
    let changes: [(&str, Change); 6] = [
        ("solutions[0].solution", |r| {
            r["solutions"][0]["solution"] = serde_json::json!([1, 1]);
        }),
        ("solutions[0].solution", |r| {
            r["solutions"][0]["solution"] = serde_json::json!([u32::MAX, 0]);
        }),
        ("solutions[1].solution", |r| {
            r["solutions"][1] = r["solutions"][0].clone();
        }),
        ("hits", |r| r["hits"] = 100_000.into()),
        ("reference_hits", |r| r["reference_hits"] = 3.into()),
        ("trace[1].evaluations", |r| {
            r["trace"][1]["evaluations"] = 0.into();
        }),
    ];
    for (place, change) in changes {
        let mut false_one = report.clone();
        change(&mut false_one);
        fs::write(&file, false_one.to_string()).unwrap();
        let done = satisfice_in(folder.path(), "verify report.json");
        assert_eq!((done.code, done.stderr.as_str()), (1, ""), "{place}");
        assert!(
            done.stdout.contains(&format!("\n  {place}: ")),
            "{place}: {}",
            done.stdout
        );
    }
    let mut other = report.clone();
    other["problem_parameters"]["dleta"] = 1.into();
    fs::write(&file, other.to_string()).unwrap();
    let line = error_in(folder.path(), "verify report.json");
    assert!(
        line.contains("the problem of the report cannot be built: unknown parameter of `teapots` `dleta`"),
        "{line}"
    );
}

#[test]
fn a_reader_that_leaves_is_no_error() {
    let mut child = command(
        env!("CARGO_MANIFEST_DIR").as_ref(),
        "run teapots --evaluations 30000 --json -",
    )
    .stdout(Stdio::piped())
    .stderr(Stdio::piped())
    .spawn()
    .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!((output.status.code(), output.stderr.len()), (Some(0), 0));
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_an_error() {
    let done = satisfice("run teapots --evaluations 100 --json /dev/full");
    assert_eq!(done.code, 2, "{done:?}");
    assert!(
        done.stderr
            .starts_with("error: cannot write /dev/full: free some space")
            && done.stderr.lines().count() == 1,
        "{}",
        done.stderr
    );
    // The summary is shown all the same.
    assert!(done.stdout.contains("  hits          "), "{}", done.stdout);
    for arguments in ["list", "--help", "run --help", "--version"] {
        let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        let output = command(env!("CARGO_MANIFEST_DIR").as_ref(), arguments)
            .stdout(full)
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments}");
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(
            said.starts_with("error: cannot write to stdout") && said.lines().count() == 1,
            "{arguments}: {said}"
        );
    }
}

/// The first Ctrl-C ends the search, and what it found is written.
#[cfg(unix)]
#[test]
fn an_interrupted_run_keeps_its_hits() {
    let folder = tempfile::tempdir().unwrap();
    let partial = |entry: fs::DirEntry| entry.file_name().to_string_lossy().ends_with(".partial");
    for signal in ["INT", "TERM"] {
        let mut child = command(folder.path(), "run teapots --time 10min --json report.json")
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        // The search begins once the place of the report is open.
        while !fs::read_dir(folder.path())
            .unwrap()
            .any(|entry| partial(entry.unwrap()))
        {
            std::thread::yield_now();
        }
        let kill = std::process::Command::new("kill")
            .args(["-s", signal, &child.id().to_string()])
            .status();
        assert!(kill.unwrap().success());
        let code = child.wait().unwrap().code();
        let report: Value =
            serde_json::from_slice(&fs::read(folder.path().join("report.json")).unwrap()).unwrap();
        assert_eq!(
            (&report["stop_reason"], &report["reference_hits"]),
            (&"Cancelled".into(), &Value::Null)
        );
        assert_eq!(code, Some(i32::from(report["hits"] == 0)));
        assert_eq!(satisfice_in(folder.path(), "verify report.json").code, 0);
        fs::remove_file(folder.path().join("report.json")).unwrap();
    }
}

/// All hits of this problem take minutes to count: the answer does not wait for them.
#[cfg(unix)]
#[test]
fn the_answer_comes_before_the_count_of_all_hits() {
    use std::io::{BufRead, BufReader, Read};
    use std::path::Path;

    let mut child = command(Path::new("."), "run langford --set n=32 --evaluations 50")
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut out = BufReader::new(child.stdout.take().unwrap());
    let mut summary = String::new();
    while !summary.contains("  time  ") {
        assert_ne!(out.read_line(&mut summary).unwrap(), 0, "{summary}");
    }
    assert!(summary.contains("(all hits are being counted)"), "{summary}");
    assert!(child.try_wait().unwrap().is_none(), "the count has ended");
    out.read_to_string(&mut summary).unwrap();
    assert!(summary.ends_with("  all hits      not known\n"), "{summary}");
    assert_eq!(child.wait().unwrap().code(), Some(1));
}

#[test]
fn completions_know_the_names() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let done = satisfice(&format!("completions {shell}"));
        assert_eq!((done.code, done.stderr.as_str()), (0, ""));
        assert!(done.stdout.contains("collide"), "{shell}");
        // Not every shell completes values.
        if ["bash", "zsh"].contains(&shell) {
            let has = |name: &str| done.stdout.contains(name);
            assert!(has("teapots") && has("descent-flood"), "{shell}");
        }
    }
}

/// Every hit that there is, and the true count beside it, which enumeration gives.
#[test]
fn six_queens_have_four_solutions() {
    let report = report("run queens --set n=6 --engine random --evaluations 200000 --json -");
    assert_eq!(report["reference_hits"], 4);
    assert_eq!((&report["hits"], &report["recall"]), (&4.into(), &1.0.into()));
}

/// Probes estimate what is missing; without them, and unless the space was covered, nothing is claimed.
#[test]
fn probes_estimate_the_hits_not_seen() {
    let blind = report("run teapots --evaluations 20000 --engine random --json -");
    assert_eq!(
        (&blind["unseen_estimate"], &blind["unseen_interval"]),
        (&Value::Null, &Value::Null)
    );
    let probed =
        report("run teapots --evaluations 400000 --engine latest-hit-qpso --probes 0.5 --slices 2 --json -");
    let missing = probed["reference_hits"].as_f64().unwrap() - probed["hits"].as_f64().unwrap();
    let interval = &probed["unseen_interval"];
    assert!(
        interval[0].as_f64().unwrap() <= missing && missing <= interval[1].as_f64().unwrap(),
        "{interval}"
    );
    assert_eq!(
        (&probed["probe_share"], &probed["completeness"]),
        (&0.5.into(), &"Unknown".into())
    );
}
