//! The frame of every page: its head, its style, its data and its scripts.

use maud::{DOCTYPE, Markup, PreEscaped, html};

const STYLE: &str = include_str!("web/page.css");
const READ: &str = include_str!("web/read.js");
/// Nothing is fetched, whatever the texts of a page say.
const POLICY: &str =
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:";

/// A whole page. `data` is Base64 from [`Pack`](crate::pack::Pack), `scripts` are files of `web`.
pub(crate) fn page(title: &str, kind: &str, body: &Markup, data: &str, scripts: &[&str]) -> String {
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta http-equiv="Content-Security-Policy" content=(POLICY);
                meta name="color-scheme" content="light dark";
                title { (title) }
                style { (PreEscaped(STYLE)) }
            }
            body class=(kind) {
                (body)
                noscript { p.note { "This page draws by JavaScript, which is switched off." } }
                script type="text/plain" id="data" { (PreEscaped(data)) }
                script { (PreEscaped(READ)) }
                @for script in scripts { script { (PreEscaped(script)) } }
            }
        }
    }
    .into_string()
}
