//! Pages of searches and comparisons, worked with in a browser.

#![allow(clippy::unwrap_used, missing_docs)]

mod browser;

use std::fs;

use browser::Browser;
use satisfice_page::{ComparePage, SearchPage};
use serde_json::{Value, json};

const HOSTILE: &str = "</script><img src=x onerror=\"window.hacked=1\"><script>window.hacked=1</script>";

/// 200 hits on a line; F falls from 2 to just above 0.
fn vectors() -> SearchPage {
    let mut page = SearchPage::new(HOSTILE);
    page.fact("Engine", HOSTILE);
    page.counts(None, Some(400));
    for k in 0..200_u32 {
        let x = f64::from(k);
        page.hit(
            &json!([x, 1000.0 - x, 0.1]),
            2.0 - x / 100.0,
            u64::from(10 * k + 1),
            x * 1e-4,
        );
    }
    page.trace(2000, 0.02, 200);
    page
}

fn text(value: &Value) -> &str {
    value.as_str().unwrap()
}

#[test]
fn hits_are_brushed_sorted_and_copied() {
    let Some(mut browser) = Browser::start(&[]) else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("run.html");
    fs::write(&file, vectors().html().unwrap()).unwrap();
    let mut tab = browser.open(&file);
    assert!(text(&tab.run("$('facts').textContent")).contains("Hits200 of 400 (50.0 %)"));
    // The least F first: the last hit found.
    let cells = "Array.from(document.querySelectorAll('#hits tr')[1].cells, cell => cell.textContent)";
    assert_eq!(
        tab.run(cells),
        json!(["199", "801", "0.1", "0.01", "1,991", "19.9 ms"])
    );
    assert_eq!(
        tab.run("document.querySelectorAll('#hits tr').length"),
        json!(101)
    );

    // The curve goes up at every hit, also where the trace is coarse.
    assert_eq!(
        tab.run("[0, 2].map(k => page.data.trace[k][150])"),
        json!([1501, 151])
    );

    // The axis of evaluations is logarithmic or not.
    let curve = "$('evaluations').toDataURL()";
    let logarithmic = tab.run(curve);
    tab.run("$('log').click()");
    assert_ne!(tab.run(curve), logarithmic);
    assert_eq!(tab.run("page.byEvaluations.x.range[0]"), json!(0));
    tab.run("$('log').click()");
    assert_eq!(tab.run(curve), logarithmic);

    // A drag across the plane selects what is within.
    let before = tab.run("$('scatter').toDataURL()");
    tab.run(
        "(() => { const c = $('scatter'), at = (type, x, y) => c.dispatchEvent(new PointerEvent(type, { clientX: c.getBoundingClientRect().left + x, clientY: c.getBoundingClientRect().top + y, pointerId: 7 }));
         c.setPointerCapture = () => {};
         const p = page.plane, [x0, x1, y0, y1] = [p.px(49.5), p.px(99.5), p.py(2000), p.py(0)];
         at('pointerdown', x0, y1 - 1); at('pointermove', x1, p.top); at('pointerup', x1, p.top); })()",
    );
    assert_eq!(tab.run("page.listed.length"), json!(50));
    assert!(text(&tab.run("$('facts').textContent")).contains("Selected50"));
    assert_ne!(tab.run("$('scatter').toDataURL()"), before);
    let csv = tab.run("page.csv()");
    let lines: Vec<&str> = text(&csv).lines().collect();
    assert_eq!(lines.len(), 51);
    assert_eq!(lines[0], "x0,x1,x2,F,evaluation,seconds");
    assert_eq!(lines[1], "99,901,0.1,1.01,991,0.0099");
    // By the form, as the keyboard does it; then all again.
    tab.run("$('clear').click(), $('faxis').value = 'evaluation', $('until').value = 21, $('filter').requestSubmit()");
    assert_eq!(tab.run("Array.from(page.listed)"), json!([2, 1, 0]));
    tab.run("$('clear').click()");
    assert_eq!(tab.run("page.listed.length"), json!(200));
    assert_eq!(
        tab.run("[window.hacked ?? 0, document.images.length]"),
        json!([0, 0])
    );
    assert_eq!(
        tab.run("document.documentElement.scrollWidth - innerWidth <= 0"),
        json!(true)
    );
    assert_eq!(tab.complaints(), Vec::<String>::new());
    drop(tab);

    // Solutions that are no vectors are texts; those with numbers in the same places have axes as well.
    let mut page = SearchPage::new("texts");
    page.hit(&json!({"a": HOSTILE, "n": [1, [2, 3]]}), 0.5, 1, 0.0);
    page.hit(&json!({"a": "=1+1", "n": [4, [5, 6]]}), 0.25, 2, 0.0);
    let mut odd = SearchPage::new("odd");
    odd.hit(&json!("=1+\"1\""), 0.5, 1, 0.0);
    odd.hit(&json!([1]), 0.25, 2, 0.0);
    for (page, axes) in [
        (page, json!(["n0", "n1.0", "n1.1"])),
        (odd, json!([])),
        (SearchPage::new("none"), json!([])),
    ] {
        fs::write(&file, page.html().unwrap()).unwrap();
        let mut tab = browser.open(&file);
        assert_eq!(
            tab.run("page.data.axes.filter(axis => !axis.own).map(axis => axis.name)"),
            axes
        );
        assert_eq!(
            tab.run("[window.hacked ?? 0, document.images.length]"),
            json!([0, 0])
        );
        assert_eq!(tab.complaints(), Vec::<String>::new());
    }
}

#[test]
fn sources_are_shown_where_there_are_some() {
    let Some(mut browser) = Browser::start(&[]) else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("run.html");
    let mut page = vectors();
    page.sources(["swarms", HOSTILE, "never used"].map(str::to_owned));
    page.source_row(10, &[10, 0, 0], &[1, 0, 0]);
    page.source_row(100, &[40, 60, 0], &[4, 30, 0]);
    fs::write(&file, page.html().unwrap()).unwrap();
    let mut tab = browser.open(&file);
    assert_eq!(
        tab.run("Array.from($('sourcetable').rows, row => Array.from(row.cells, cell => cell.textContent))"),
        json!([
            ["", "source", "candidates", "hits"],
            ["", "swarms", "40", "4"],
            ["", HOSTILE, "60", "30"]
        ])
    );
    // The first ten came from the swarms alone, two of three from the other one afterwards.
    let colour = "(v, y) => { const { shares } = page.data.by, r = shares.canvas.width / shares.canvas.clientWidth;
         return Array.from(shares.to.getImageData(shares.px(v) * r, shares.py(y) * r, 1, 1).data).slice(0, 3); }";
    let tones = json!([[0, 114, 178], [0, 114, 178], [0, 114, 178], [213, 94, 0]]);
    assert_eq!(
        tab.run(&format!(
            "[[3, 0.1], [3, 0.9], [50, 0.2], [50, 0.8]].map(([v, y]) => ({colour})(v, y))"
        )),
        tones
    );
    tab.run("(() => { const { shares } = page.data.by, box = shares.canvas.getBoundingClientRect();
         shares.canvas.dispatchEvent(new PointerEvent('pointermove', { clientX: box.left + shares.px(50), clientY: box.top + 50 })); })()");
    assert_eq!(
        tab.run("Array.from($('tip').children, line => line.textContent)"),
        json!([
            "evaluations 11 to 100",
            format!("{HOSTILE}: 66.7 %, 30 hits so far"),
            "swarms: 33.3 %, 4 hits so far"
        ])
    );
    assert_eq!(
        tab.run("[window.hacked ?? 0, document.images.length, document.documentElement.scrollWidth - innerWidth <= 0]"),
        json!([0, 0, true])
    );
    assert_eq!(tab.complaints(), Vec::<String>::new());
    drop(tab);
    fs::write(&file, vectors().html().unwrap()).unwrap();
    let mut tab = browser.open(&file);
    assert_eq!(tab.run("$('sources').hidden"), json!(true));
}

#[test]
fn engines_are_switched_on_and_off() {
    let Some(mut browser) = Browser::start(&[]) else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("compare.html");
    let mut page = ComparePage::new("Engines");
    page.link("report.html", "the report");
    for title in ["one", HOSTILE] {
        page.problem(title, Some(100), true);
        for seed in 1..=5_u64 {
            for (engine, pace) in [("slow", 1), (HOSTILE, 10)] {
                let points = (1..=10).map(|k| (100 * k, 0.001 * k as f64, (k * pace).min(90 + seed)));
                page.run(engine, seed, points);
            }
        }
    }
    fs::write(&file, page.html().unwrap()).unwrap();
    let mut tab = browser.open(&file);
    assert_eq!(
        tab.run("document.querySelectorAll('canvas.plot').length"),
        json!(4)
    );
    let picture = "document.querySelector('canvas.plot').toDataURL()";
    let both = tab.run(picture);
    tab.run("document.querySelectorAll('#engines input')[0].click()");
    let one = tab.run(picture);
    tab.run("$('seeds').click()");
    let without_seeds = tab.run(picture);
    tab.run("$('none').click()");
    let none = tab.run(picture);
    assert!(both != one && one != without_seeds && without_seeds != none);
    tab.run("$('all').click(), $('seeds').click()");
    assert_eq!(tab.run(picture), both);
    // At the right end the pointer shows the medians at the end, the most hits first.
    tab.run(
        "(() => { const { chart } = page.figures[0], box = chart.canvas.getBoundingClientRect();
         chart.canvas.dispatchEvent(new PointerEvent('pointermove', { clientX: box.left + chart.right - 1, clientY: box.top + 50 })); })()",
    );
    let shown = tab.run("Array.from($('tip').children, line => line.textContent)");
    assert!(
        text(&shown[1]).starts_with(&format!("{HOSTILE}: 93, 93.0 % (quartiles 92 to 94)")),
        "{shown}"
    );
    assert!(text(&shown[2]).starts_with("slow: 10, 10.0 %"), "{shown}");
    assert_eq!(
        tab.run("[window.hacked ?? 0, document.images.length]"),
        json!([0, 0])
    );
    assert_eq!(
        tab.run("document.documentElement.scrollWidth - innerWidth <= 0"),
        json!(true)
    );
    assert_eq!(tab.complaints(), Vec::<String>::new());
}
