//! What the page of a scene is made of; `scene.js` fills it.

use maud::{Markup, html};

/// Keys and what they do.
const KEYS: [(&str, &str); 9] = [
    ("arrows", "turn (with Shift: move)"),
    ("+ -", "closer, farther"),
    ("Space", "play"),
    (", .", "frame before, frame after"),
    ("[ ]", "back and forth in the time of the search"),
    ("n p", "next contact, contact before"),
    ("f", "look at the contact that is picked"),
    ("r", "everything in view again"),
    ("Esc", "pick nothing"),
];

pub(super) fn markup(title: &str) -> Markup {
    html! {
        header { h1 { (title) } p #about {} }
        main {
            div #view {
                canvas #canvas tabindex="0" role="application" aria-label="The scene; turn it with the arrow keys. The contacts are in the table below." {}
                p #status {}
                button #everything type="button" hidden {}
                p #message hidden {}
            }
            div #panel {
                dl #facts aria-live="polite" {}
                (slider("frame", "Frame"))
                (slider("time", "Time of the search"))
                div.row #looks {
                    label { "Bodies " select #mode {
                        option value="edges" { "with edges" }
                        option value="shaded" { "shaded" }
                        option value="lines" { "hidden lines removed" }
                        option value="clear" { "transparent" }
                    } }
                    label { "Colour " select #colour {} }
                    button #reset type="button" { "All in view" }
                }
                div #scale aria-hidden="true" { span #least {} span #ramp {} span #most {} }
                label #missing hidden { input #missed type="checkbox" checked; " " span #missedtext {} }
                section #picked hidden aria-live="polite" {
                    h2 { "Contact" }
                    dl #pickedfacts {}
                    div.row {
                        button #before type="button" { "Before" }
                        button #after type="button" { "Next" }
                        button #closer type="button" { "Look at it" }
                        button #forget type="button" { "Close" }
                    }
                }
                p #hint { "Pick a contact to see what it is." }
                details #bodiesfold { summary { "Bodies" } ul #bodies {} }
                details { summary { "Keys" } dl.keys { @for (key, what) in KEYS { dt { kbd { (key) } } dd { (what) } } } }
            }
        }
        section #list {
            h2 { "Contacts" }
            p #listed {}
            div.wide { table #contacts {} }
            div.row #pages { button #back type="button" { "Back" } button #more type="button" { "More" } }
        }
    }
}

fn slider(id: &str, label: &str) -> Markup {
    html! {
        div.slider id={ (id) "s" } hidden {
            @if id == "time" { canvas #growth height="56" aria-hidden="true" {} }
            div.row {
                button id={ "play" (id) } type="button" aria-label={ "Play: " (label) } { "▶" }
                input id=(id) type="range" min="0" aria-label=(label);
            }
            p id={ (id) "text" } {}
        }
    }
}
