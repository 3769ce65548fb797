//! Tests of the OFF reader.

use super::{OFF, SQUARE, message};
use crate::io::parse;

const FACES: &str = "4 0 1 2 3\n";

fn vertices() -> String {
    SQUARE.map(|[x, y, z]| format!("{x} {y} {z}\n")).concat()
}

#[test]
fn off_in_all_its_manners_is_the_same_mesh() {
    let plain = vertices();
    let coloured = SQUARE
        .map(|[x, y, z]| format!("{x} {y} {z} 255 128 0 255\n"))
        .concat();
    for file in [
        format!("OFF\n4 1 4\n{plain}{FACES}"),
        format!("OFF 4 1 4\n{plain}{FACES}"),
        format!("OFF4 1\n{plain}{FACES}"),
        format!("4 1 0\n{plain}{FACES}"),
        format!("\u{feff}# a square\nOFF # format\n\n4 1 0\n\n{plain}# faces\n{FACES}\n# end\n"),
        format!("COFF\n4 1 0\n{coloured}4 0 1 2 3 0.5 0.5 0.5\n"),
        format!("OFF\n4 1 0\n{plain}{FACES}").replace('\n', "\r"),
    ] {
        let mesh = parse(OFF, file.as_bytes()).unwrap();
        assert_eq!(mesh.vertices(), SQUARE, "{file}");
        assert_eq!(mesh.triangles(), [[0, 1, 2], [0, 2, 3]]);
    }
}

#[test]
fn off_errors_name_the_line() {
    let say = |text: &str| message(OFF, text);
    let plain = vertices();
    let malformed = "not a valid OFF file:";
    assert_eq!(say(""), format!("line 1: {malformed} it has no line of counts"));
    assert_eq!(
        say("OFF\n4 1\n0 0 0\n"),
        format!("line 3: {malformed} it ends before vertex 1 of 4")
    );
    assert_eq!(
        say(&format!("OFF\n4 1\n{plain}")),
        format!("line 6: {malformed} it ends before face 0 of 1")
    );
    assert_eq!(
        say(&format!("OFF\n4 1\n{plain}{FACES}{FACES}")),
        format!("line 8: {malformed} a line follows the last face that the counts announce")
    );
    assert_eq!(
        say(&format!("OFF\n4 1\n{plain}3 0 1 4\n")),
        "line 7: face 0 names vertex 4, but the mesh has 4 vertices (0 to 3)"
    );
    assert_eq!(
        say(&format!("OFF\n4 1\n{plain}3 0 1\n")),
        format!("line 7: {malformed} face 0 has \"\" where a vertex number belongs")
    );
    assert_eq!(
        say(&format!("OFF\n4 1\n{plain}3 0 1 2 1 2 3 4 5\n")),
        format!("line 7: {malformed} face 0 has more words than 3 corners and a colour")
    );
    assert_eq!(
        say("OFF\n1 0\n0 nan 0\n"),
        "line 3: vertex 0 has y = NaN; coordinates must be finite"
    );
    assert_eq!(
        say("OFF\n1 0\n0 1\n"),
        format!("line 3: {malformed} vertex 0 has 2 numbers")
    );
    assert!(say("OFF\n1 0\n0 1 x\n").ends_with("vertex 0 has \"x\" for a number"));
    assert!(say("OFF\n-1 0\n").ends_with("where the numbers of vertices, faces and edges belong"));
    assert!(say("OFX\n1 0\n").ends_with("\"OFX\" where OFF belongs"));
    assert!(say("4OFF\n1 0\n").contains("of three dimensions"));
    assert!(say("OFF BINARY\n").contains("binary variant"));
    assert_eq!(say("OFF\n0 0 0\n"), "the mesh is empty: it has no vertex");
}
