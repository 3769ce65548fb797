//! The experiments in small, and their reports examined in a browser.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use common::satisfice_in;
use serde_json::Value;

/// What a browser makes of a page, written into the page itself.
const LOOK: &str = r#"
<pre id="seen"></pre>
<script>
document.querySelectorAll("details").forEach(fold => fold.open = true);
window.onload = () => {
  const size = e => { const box = e.getBoundingClientRect(); return [box.width, box.height]; };
  const all = selector => [...document.querySelectorAll(selector)];
  const outside = all("figure svg").filter(svg => {
    const frame = svg.getBoundingClientRect();
    return [...svg.querySelectorAll("text")].some(text => {
      const box = text.getBoundingClientRect();
      return box.left < frame.left - 2 || box.right > frame.right + 2 || box.top < frame.top - 2 || box.bottom > frame.bottom + 2;
    });
  });
  document.getElementById("seen").textContent = JSON.stringify({
    figures: all("figure svg").map(size),
    images: all("figure img").map(image => [image.naturalWidth, image.naturalHeight]),
    tables: all("table").length,
    headings: all("h1, h2").map(e => e.textContent),
    outside: outside.length,
    overflow: document.documentElement.scrollWidth - window.innerWidth,
  });
};
</script>
"#;

/// The first browser of the Chromium family on the path.
fn browser() -> Option<PathBuf> {
    let folders = std::env::var_os("PATH")?;
    let names = ["chromium", "chromium-browser", "google-chrome", "chrome"];
    std::env::split_paths(&folders)
        .flat_map(|folder| names.map(|name| folder.join(name)))
        .find(|path| path.is_file())
}

/// Lays the page out, and returns what it looks like; nothing where there is no browser.
fn look(page: &Path) -> Option<Value> {
    let Some(browser) = browser() else {
        eprintln!(
            "skipped: no Chromium on the path, so the report was not looked at; install the package chromium"
        );
        return None;
    };
    let seen = page.with_file_name("seen.html");
    let text = fs::read_to_string(page).unwrap();
    fs::write(&seen, text.replace("</body>", &format!("{LOOK}</body>"))).unwrap();
    let profile = page.with_file_name("profile");
    let done = Command::new(browser)
        .args([
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--disable-dev-shm-usage",
            "--no-first-run",
        ])
        .args(["--window-size=1280,1600", "--timeout=60000", "--dump-dom"])
        .arg(format!("--user-data-dir={}", profile.display()))
        .arg(format!("file://{}", seen.display()))
        .stderr(Stdio::null())
        .output()
        .unwrap();
    let dom = String::from_utf8(done.stdout).unwrap();
    let found = dom
        .split("<pre id=\"seen\">")
        .nth(1)
        .and_then(|rest| rest.split("</pre>").next());
    let found = found
        .unwrap_or_else(|| panic!("the browser shows no such page: {dom:.2000}"))
        .replace("&amp;", "&");
    Some(serde_json::from_str(&found).unwrap_or_else(|error| panic!("{error}: {found:.2000}")))
}

/// Nothing is fetched, everything is seen.
fn check(page: &Path, figures: usize, images: usize, headings: &[&str]) {
    let text = fs::read_to_string(page).unwrap();
    for outside in ["src=\"http", "href=\"http", "url(http", "@import", "<script"] {
        assert!(!text.contains(outside), "{outside}");
    }
    assert_eq!(text.matches("<figure>").count(), figures + images);
    for heading in headings {
        assert!(text.contains(&format!("<h2>{heading}</h2>")), "{heading}");
    }
    let Some(seen) = look(page) else { return };
    let sizes = |key: &str| -> Vec<(f64, f64)> {
        let list = seen[key].as_array().unwrap().iter();
        list.map(|size| (size[0].as_f64().unwrap(), size[1].as_f64().unwrap()))
            .collect()
    };
    assert_eq!(
        (sizes("figures").len(), sizes("images").len()),
        (figures, images),
        "{seen}"
    );
    assert!(
        sizes("figures")
            .iter()
            .chain(&sizes("images"))
            .all(|&(width, height)| width > 300.0 && height > 150.0),
        "{seen}"
    );
    assert_eq!(seen["outside"], 0, "text that leaves its figure: {seen}");
    assert!(
        seen["overflow"].as_f64().unwrap() <= 0.0,
        "the page is wider than the window: {seen}"
    );
}

#[test]
fn the_first_experiment_in_small_makes_a_report() {
    let place = tempfile::tempdir().unwrap();
    let done = satisfice_in(place.path(), "bench experiment-one-smoke --out one");
    assert_eq!(done.code, 0, "{}", done.stderr);
    for engine in [
        "latest-hit-qpso",
        "niching-pso-dbscan",
        "bounded-swarms",
        "aabb",
        "grid",
    ] {
        assert!(done.stdout.contains(&format!("  {engine} ")), "{}", done.stdout);
    }
    let out = place.path().join("one");
    // A group with a clock has four figures, one by evaluations three, one without hits one.
    check(
        &out.join("report.html"),
        4 + 2 * 3 + 2,
        0,
        &["100 ms", "poses and orders", "The machine", "The suite"],
    );
    let compare = fs::read_to_string(out.join("compare.html")).unwrap();
    assert!(compare.starts_with("<!DOCTYPE html>") && compare.len() < 1_500_000);
    let charts = fs::read_dir(out.join("figures"))
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let (svg, png): (Vec<_>, Vec<_>) = charts.partition(|path| path.extension().is_some_and(|e| e == "svg"));
    assert_eq!((svg.len(), png.len()), (12, 12));

    // The exact methods agree with the reference count, in every run.
    let rows = fs::read_to_string(out.join("results.jsonl")).unwrap();
    let rows: Vec<Value> = rows
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    let exact = rows
        .iter()
        .filter(|row| row["engine"] == "aabb" || row["engine"] == "grid");
    assert!(exact.clone().count() == 4 && exact.clone().all(|row| row["hits"] == row["reference_hits"]));
}

#[test]
fn the_second_experiment_in_small_makes_a_report() {
    let place = tempfile::tempdir().unwrap();
    let done = satisfice_in(place.path(), "bench experiment-two-smoke --out two");
    assert_eq!(done.code, 0, "{}", done.stderr);
    assert!(
        done.stdout.contains("The cloth, frame by frame"),
        "{}",
        done.stdout
    );
    check(
        &place.path().join("two/report.html"),
        2 * 3 + 2,
        1,
        &["single frames", "The cloth, frame by frame"],
    );
    assert!(place.path().join("two/figures/cloth.png").exists());
}

#[test]
fn exact_methods_are_refused_where_there_are_no_vertices() {
    let place = tempfile::tempdir().unwrap();
    let suite =
        "seeds = \"0..1\"\n[[part]]\nengines = [\"aabb\"]\nproblems = [\"islands\"]\nevaluations = 10\n";
    fs::write(place.path().join("mine.toml"), suite).unwrap();
    let line = common::error_in(place.path(), "bench mine.toml");
    assert!(
        line.contains("`aabb` finds pairs of vertices, and `islands` has none: choose an engine"),
        "{line}"
    );
}
