//! Pages of scenes, examined and worked with in a browser.

#![allow(clippy::unwrap_used, missing_docs)]

mod browser;

use std::fs;
use std::path::Path;

use browser::Browser;
use satisfice_page::{Contact, Error, Feature, FeatureKind, ScenePage};
use serde_json::{Value, json};

const HOSTILE: &str = "</script><img src=x onerror=\"window.hacked=1\"><script>window.hacked=1</script>";

/// A square sheet of n times n cells at a height.
fn sheet(n: u32, height: f64) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let place = |k: u32| f64::from(k) / f64::from(n);
    let vertices = (0..=n).flat_map(|j| (0..=n).map(move |i| [place(i), place(j), height]));
    let corner = |i: u32, j: u32| j * (n + 1) + i;
    let cells = (0..n).flat_map(|j| (0..n).map(move |i| (i, j)));
    let triangles = cells.flat_map(|(i, j)| {
        let [a, b, c, d] = [
            corner(i, j),
            corner(i + 1, j),
            corner(i, j + 1),
            corner(i + 1, j + 1),
        ];
        [[a, b, c], [b, d, c]]
    });
    (vertices.collect(), triangles.collect())
}

/// Two sheets above each other; contacts join vertex k with vertex k. The upper one rises in the second frame.
fn film(n: u32, contacts: u32) -> ScenePage {
    let ((low, triangles), (high, _)) = (sheet(n, 0.0), sheet(n, 0.02));
    let mut page = ScenePage::new(format!("Sheets {HOSTILE}"));
    page.threshold(0.05);
    page.method(format!("engine {HOSTILE}"));
    page.fact("Completeness", HOSTILE);
    let a = page.body(HOSTILE, &low, &triangles, &[]);
    let b = page.body("upper", &high, &triangles, &[]);
    page.frame("closed");
    let pair = |number: u32| {
        [a, b].map(|body| Feature {
            body,
            kind: FeatureKind::Vertex,
            number,
        })
    };
    let ends = |k: u32| [low[k as usize], high[k as usize]];
    let every = (low.len() as u32 / contacts.max(1)).max(1);
    for k in 0..contacts {
        let number = k * every;
        let order = f64::from(k) / f64::from(contacts);
        let contact = Contact::new(pair(number), ends(number)).distance(0.02 * (1.0 + order));
        page.contact(contact.found(u64::from(10 * k + 1), 0.1 * order));
    }
    page.contact(Contact::new(pair(low.len() as u32 - 1), ends(low.len() as u32 - 1)).missed());
    page.counts(None, Some(u64::from(contacts) + 1));
    page.frame("open");
    page.move_body(b, &sheet(n, 0.4).0).unwrap();
    page
}

fn written(page: &ScenePage, folder: &Path, name: &str) -> std::path::PathBuf {
    let path = folder.join(name);
    fs::write(&path, page.html().unwrap()).unwrap();
    path
}

/// Counts pixels of the view by what they show.
const LOOK: &str = r"
window.look = () => {
  page.moving = false; page.draw();
  const { gl, canvas } = page.stage, { width: w, height: h } = canvas, pixels = new Uint8Array(4 * w * h);
  gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  const seen = { body: 0, mark: 0, other: 0, sum: 0 };
  const paper = [0, 1, 2].map(k => pixels[k]);
  for (let k = 0; k < pixels.length; k += 4) {
    const [r, g, b] = [pixels[k], pixels[k + 1], pixels[k + 2]];
    seen.sum = (seen.sum * 31 + r + 256 * g + 65536 * b) % 1000003;
    if (Math.abs(r - paper[0]) + Math.abs(g - paper[1]) + Math.abs(b - paper[2]) < 6) continue;
    if (Math.max(r, g, b) - Math.min(r, g, b) > 110) seen.mark++; else seen.body++;
  }
  return seen;
};";

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is a number"))
}

#[test]
fn frames_time_and_picking_do_what_they_say() {
    let Some(mut browser) = Browser::start(&[]) else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let file = written(&film(20, 100), folder.path(), "film.html");
    let mut tab = browser.open(&file);
    tab.run(LOOK);
    let first = tab.run("look()");
    assert!(number(&first["body"]) > 20_000.0, "{first}");
    assert!(number(&first["mark"]) > 500.0, "{first}");

    // Hits come in the order found: fewer marks at half of the time, none before the first.
    tab.run("$('time').value = 500; $('time').oninput()");
    assert_eq!(tab.run("page.found()"), json!(50));
    assert_eq!(
        tab.run("page.pick(60), page.setTime(page.time), page.picked"),
        json!(-1),
        "a contact that is not found yet is not picked"
    );
    let half = tab.run("look()");
    assert!(
        number(&half["mark"]) < 0.8 * number(&first["mark"]),
        "{half} {first}"
    );
    assert_eq!(
        tab.run("$('facts').textContent.includes('Hits by then50 of 101 (49.5 %)')"),
        json!(true)
    );
    tab.run("page.setTime(Infinity)");

    // The second frame has no contacts, and the sheet is elsewhere.
    tab.run("$('frame').value = 1; $('frame').oninput()");
    let open = tab.run("look()");
    assert!(number(&open["mark"]) < 0.1 * number(&first["mark"]), "{open}");
    assert!(
        (number(&open["body"]) / number(&first["body"]) - 1.0).abs() > 0.05,
        "{open} {first}"
    );
    tab.run("$('frame').value = 0; $('frame').oninput()");
    assert_eq!(tab.run("look()"), first, "the first frame is what it was");

    // A click on a contact picks it, and the panel says which pair it is.
    tab.run("page.camera.elevation = 1; page.reset(); page.draw()");
    for wanted in [0, 37, 99] {
        let place = tab.run(&format!(
            "(() => {{ const c = $('canvas'), k = 6 * {wanted}, e = page.scene.contacts.ends, box = c.getBoundingClientRect();
               const p = page.camera.project(e.subarray(k + 3, k + 6), c.clientWidth, c.clientHeight); return [box.left + p[0], box.top + p[1]]; }})()"
        ));
        tab.click(number(&place[0]), number(&place[1]));
        assert_eq!(tab.run("page.picked"), json!(wanted));
        let text = tab.run("$('pickedfacts').textContent");
        let text = text.as_str().unwrap();
        let distance = format!("Distance{}", f64::from(200 + 2 * wanted) / 10_000.0);
        let expected = [
            format!("{HOSTILE}vertex {}", 4 * wanted),
            format!("uppervertex {}", 4 * wanted),
            distance,
            format!("engine {HOSTILE}"),
        ];
        for part in expected {
            assert!(text.contains(&part), "{part}: {text}");
        }
    }
    tab.press("n");
    assert_eq!(
        tab.run("page.picked"),
        json!(0),
        "after the last contact comes the first"
    );
    tab.press("Escape");
    assert_eq!(tab.run("[page.picked, $('picked').hidden]"), json!([-1, true]));

    // The table has the same pairs, the closest first, and picks them too.
    assert_eq!(
        tab.run("document.querySelectorAll('#contacts tr').length"),
        json!(101)
    );
    let row = "document.querySelectorAll('#contacts tr')[3]";
    assert_eq!(tab.run(&format!("{row}.cells[1].textContent")), json!("vertex 8"));
    tab.run(&format!("{row}.click()"));
    assert_eq!(tab.run("page.picked"), json!(2));

    // Turning, and every way to draw, change the picture.
    let before = tab.run("page.pick(-1), look()");
    tab.run("page.camera.turn(0.5, 0.2)");
    let mut sums = vec![before["sum"].clone(), tab.run("look()")["sum"].clone()];
    for mode in ["shaded", "lines", "clear"] {
        tab.run(&format!("$('mode').value = '{mode}'; $('mode').onchange()"));
        sums.push(tab.run("look()")["sum"].clone());
    }
    for k in 0..sums.len() {
        assert!(
            !sums[..k].contains(&sums[k]),
            "picture {k} is as one before: {sums:?}"
        );
    }
    assert_eq!(tab.run("window.hacked ?? 0"), json!(0));
    assert_eq!(tab.run("document.images.length"), json!(0));
    assert_eq!(
        tab.run("document.documentElement.scrollWidth - innerWidth <= 0"),
        json!(true)
    );
    assert_eq!(tab.complaints(), Vec::<String>::new());
}

#[test]
fn the_largest_scenes_move_or_say_what_is_left_out() {
    let Some(mut browser) = Browser::start(&[]) else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let file = written(&film(500, 100_000), folder.path(), "large.html");
    let mut tab = browser.open(&file);
    assert_eq!(tab.run("page.triangles"), json!(1_000_000));
    assert_eq!(tab.run("page.found()"), json!(100_000));
    let took = number(&tab.run("page.move(), Math.min(page.took(), page.took(), page.took())"));
    let status = tab.run("$('status').textContent");
    let status = status.as_str().unwrap();
    let first = number(&tab.run("performance.getEntriesByName('first picture')[0].startTime"));
    eprintln!("first picture after {first:.0} ms, {took:.1} ms a picture while it moves: {status}");
    let says = status.contains(" of 1,000,000 triangles") || status.contains(" of 100,001 contacts");
    assert!(took < 50.0 || says, "{took} ms: {status}");
    // Asked to, it draws everything.
    let drawn = tab.run("$('everything').hidden || $('everything').click(), page.moving = false, page.status(), $('status').textContent");
    assert_eq!(drawn, json!("1,000,000 triangles, 100,001 contacts"));
    assert_eq!(tab.complaints(), Vec::<String>::new());
}

#[test]
fn without_webgl_there_is_a_message_and_the_table() {
    let Some(mut browser) = Browser::start(&["--disable-3d-apis"]) else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let file = written(&film(4, 10), folder.path(), "film.html");
    let mut tab = browser.open(&file);
    let message = tab.run("$('message').hidden ? '' : $('message').textContent");
    assert!(message.as_str().unwrap().contains("WebGL 2"), "{message}");
    assert_eq!(
        tab.run("document.querySelectorAll('#contacts tr').length"),
        json!(11)
    );
    tab.run("document.querySelectorAll('#contacts tr')[3].click()");
    let text = tab.run("$('pickedfacts').textContent");
    assert!(text.as_str().unwrap().contains("uppervertex 4"), "{text}");
    for key in ["n", "f", "r", ".", "["] {
        tab.press(key);
    }
    let thrown: Vec<_> = tab
        .complaints()
        .into_iter()
        .filter(|c| c.contains("exceptionThrown"))
        .collect();
    assert_eq!(thrown, Vec::<String>::new());
}

#[test]
fn pairs_that_are_still_to_come_are_not_missing() {
    let Some(mut browser) = Browser::start(&[]) else {
        return;
    };
    let (low, triangles) = sheet(1, 0.0);
    let mut page = ScenePage::new("A step");
    let bodies = ["\u{202e}sdrawkcab", "upper"].map(|name| page.body(name, &low, &triangles, &[]));
    let pair = bodies.map(|body| Feature {
        body,
        kind: FeatureKind::Vertex,
        number: 0,
    });
    for frame in 0..=2 {
        page.frame(format!("{frame} of 2"));
        for _ in 0..frame {
            page.contact(Contact::new(pair, [low[0]; 2]).impact(0.5));
        }
        page.counts(Some(frame), Some(2));
    }
    let folder = tempfile::tempdir().unwrap();
    let mut tab = browser.open(&written(&page, folder.path(), "step.html"));
    let shown = "[$('facts').textContent, $('status').textContent]";
    assert_eq!(
        tab.run(shown),
        json!(["Hits by then0 of 2", "4 triangles, 0 contacts"])
    );
    tab.run("page.setFrame(1), page.draw()");
    assert_eq!(
        tab.run(shown),
        json!(["Hits by then1 of 2", "4 triangles, 1 contact"])
    );
    // A name from right to left ends where it ends.
    assert_eq!(
        tab.run("document.querySelector('#bodies bdi').nextSibling.textContent"),
        json!(": 2 triangles")
    );
    assert_eq!(tab.complaints(), Vec::<String>::new());
}

#[test]
fn pages_are_small_and_carry_nothing_from_outside() {
    let html = film(20, 100).html().unwrap();
    assert!(html.len() < 60_000 + 10_000, "{} bytes", html.len());
    for outside in ["http:", "https:", "@import", "url(", "import("] {
        assert!(!html.contains(outside), "{outside}");
    }
    assert_eq!(html, film(20, 100).html().unwrap(), "the same page twice");
}

#[test]
fn what_does_not_exist_is_an_error() {
    let mut page = ScenePage::new("");
    let body = page.body("one", &[[0.0; 3]], &[], &[]);
    assert!(page.html().is_ok(), "a page without contacts");
    let feature = |body, kind, number| Feature { body, kind, number };
    let (vertex, triangle) = (FeatureKind::Vertex, FeatureKind::Triangle);
    for (features, text) in [
        (
            [feature(0, vertex, 0), feature(1, vertex, 0)],
            "the page has no body 1: it has 1",
        ),
        (
            [feature(0, vertex, 0), feature(0, triangle, 0)],
            "the page has no triangle 0: it has 0",
        ),
        (
            [feature(0, vertex, 1), feature(0, vertex, 0)],
            "the page has no vertex 1: it has 1",
        ),
    ] {
        let mut page = page.clone();
        page.contact(Contact::new(features, [[0.0; 3]; 2]));
        assert_eq!(page.html().unwrap_err().to_string(), text);
    }
    assert!(matches!(page.move_body(3, &[]), Err(Error::Unknown { .. })));
    page.move_body(body, &[]).unwrap();
    assert!(matches!(page.html(), Err(Error::Vertices { .. }) | Ok(_)));
    page.body("two", &[[f64::NAN, 0.0, 0.0]], &[], &[]);
    assert!(page.html().is_err());
    let mut page = ScenePage::new("");
    page.body("one", &[[0.0; 3]], &[[0, 0, 7]], &[]);
    assert_eq!(
        page.html().unwrap_err().to_string(),
        "the page has no vertex 7: it has 1"
    );
}
