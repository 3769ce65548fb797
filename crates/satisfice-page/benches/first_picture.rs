//! How soon a page shows its first picture: `cargo bench -p satisfice-page [-- PAGE]`; the page of the teapots if none is named.
//!
//! Each round opens the page in a new tab of a headless Chromium that draws in software, and prints milliseconds since the file was asked for:
//! the page's own note, made in the frame callback after drawing, and the time at which the pixels of that picture can be read.

#![allow(clippy::unwrap_used, reason = "a browser that fails ends the bench")]

use std::path::PathBuf;

#[path = "../tests/browser/mod.rs"]
mod browser;

use browser::Browser;

const ROUNDS: usize = 7;

/// Reads a pixel as soon as the page has noted its first picture, which waits until it is drawn.
const SEEN: &str = "new Promise(done => {
    const look = () => {
        const noted = performance.getEntriesByName('first picture')[0];
        if (!noted) return requestAnimationFrame(look);
        const gl = document.querySelector('canvas').getContext('webgl2');
        gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
        done([noted.startTime, performance.now()]);
    };
    look();
})";

fn main() {
    let named = std::env::args().skip(1).find(|word| !word.starts_with("--"));
    let page = named.map_or_else(
        || {
            PathBuf::from(concat!(
                env!("CARGO_MANIFEST_DIR"),
                "/../../docs/pages/teapots.html"
            ))
        },
        PathBuf::from,
    );
    let page = match page.canonicalize() {
        Ok(page) => page,
        Err(error) => {
            eprintln!("{}: {error}", page.display());
            std::process::exit(2);
        }
    };
    // As a test, one round shows that it works.
    let rounds = if std::env::args().any(|word| word == "--bench") {
        ROUNDS
    } else {
        1
    };
    let Some(mut browser) = Browser::start(&[]) else {
        return;
    };
    let mut times = Vec::new();
    for _ in 0..rounds {
        let mut tab = browser.navigate(&page);
        let seen = tab.run(SEEN);
        times.push([&seen[0], &seen[1]].map(|time| time.as_f64().expect("milliseconds")));
    }
    for (name, which) in [("noted", 0), ("seen", 1)] {
        let mut sorted: Vec<f64> = times.iter().map(|both| both[which]).collect();
        sorted.sort_by(f64::total_cmp);
        println!(
            "first picture {name}: median {:.0} ms, from {:.0} to {:.0} in {rounds} rounds",
            sorted[rounds / 2],
            sorted[0],
            sorted[rounds - 1]
        );
    }
}
