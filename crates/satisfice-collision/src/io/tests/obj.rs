//! Tests of the OBJ reader and writer.

use proptest::prelude::*;

use super::{OBJ, SQUARE, message};
use crate::Mesh;
use crate::io::{parse, write_obj};

fn obj(text: &str) -> Mesh {
    parse(OBJ, text.as_bytes()).unwrap()
}

#[test]
fn obj_keeps_every_vertex_in_the_order_of_the_file() {
    let mesh = obj("v 0 0 0\nv 9 9 9\nv 1 0 0\nv 0 1 0\nf 4 1 3\n");
    assert_eq!(
        mesh.vertices(),
        [[0.0; 3], [9.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
    );
    assert_eq!(mesh.triangles(), [[3, 0, 2]]);
    assert_eq!(obj("v 1 2 3\nv 4 5 6").vertices().len(), 2);
}

#[test]
fn obj_points_lines_and_polylines() {
    let mesh = obj("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\np 1 2\nl 1 2 3\nl -1 -2\nf 1 2\n");
    assert_eq!(mesh.lines(), [[0, 1], [1, 2], [3, 2], [0, 1]]);
    assert!(mesh.triangles().is_empty());
}

#[test]
fn obj_polygons_become_fans_about_their_first_corner() {
    let mesh = obj("v 0 0 0\nv 1 0 0\nv 2 1 0\nv 1 2 0\nv 0 1 0\nf 1 2 3 4 5\nf 2 3 4 5");
    assert_eq!(
        mesh.triangles(),
        [[0, 1, 2], [0, 2, 3], [0, 3, 4], [1, 2, 3], [1, 3, 4]]
    );
}

#[test]
fn obj_of_the_wild() {
    // A byte order mark, carriage returns, texture and normal indices (out of range, too), objects and materials that
    // share vertices, colours on some vertices only, a weight, a continued line, comments, an index before its vertex.
    let mesh = obj(
        "\u{feff}# made by hand\r\nmtllib missing.mtl\r\no one\r\nv 0 0 0 0.5 0.5 0.5\r\nv 2 0 0 2\r\n\
         v 1 1 0\r\nvt 0 0\r\nvn 0 0 1\r\ng a b\r\nusemtl red\r\nf 1/1/1 2//9 \\\r\n 3/7\r\no two # again\r\n\
         f 1 2 4 # forward\r\nv 0 1 0 0.1 0.2 0.3 0.4\r\ns off\r\n",
    );
    assert_eq!(mesh.vertices(), SQUARE);
    assert_eq!(mesh.triangles(), [[0, 1, 2], [0, 1, 3]]);
    // Latin-1 in a comment.
    assert!(parse(OBJ, b"# caf\xe9\nv 0 0 0\n").is_ok());
}

#[test]
fn obj_with_every_end_of_line_is_the_same_mesh() {
    let unix = "# made by hand\nv 0 0 0\nv 1 0 0\n\nv 1 1 0\nv 0 1 0\nf 1 2 \\\n3 4\n";
    for end in ["\n", "\r\n", "\r"] {
        let mesh = obj(&unix.replace('\n', end));
        assert_eq!(mesh.vertices(), SQUARE, "{end:?}");
        assert_eq!(mesh.triangles(), [[0, 1, 2], [0, 2, 3]]);
        let error = message(OBJ, format!("{unix}f 1 2 5").replace('\n', end));
        assert!(error.starts_with("line 9: face 1 names vertex 5"), "{error}");
    }
}

#[test]
fn obj_vertices_have_positions_weights_or_colours_and_nothing_else() {
    for good in [
        "1 2 3",
        "2 4 6 2",
        "1 2 3 0.5 0.5 0.5",
        "1 2 3 0 .5 1 1 # colour",
        "+1 2. 3e0",
    ] {
        assert_eq!(obj(&format!("v {good}")).vertices(), [[1.0, 2.0, 3.0]], "{good}");
    }
    for junk in [
        "",
        "1",
        "1 2",
        "1 2 3 4 5",
        "1 2 3 4 5 6 7 8",
        "1 2 3 a b c",
        "1 2 3 4 5 x",
        "1,2,3",
        "1 2 3 0 0 0 z",
    ] {
        let error = message(OBJ, format!("v 0 0 0\nv {junk}\n"));
        assert!(
            error.starts_with("line 2: not a valid OBJ file: a vertex "),
            "{junk}: {error}"
        );
    }
}

#[test]
fn obj_statements_that_are_not_understood_are_refused() {
    let say = |line: &str| message(OBJ, format!("v 0 0 0\n{line}\n"));
    assert_eq!(
        say("V 1 1 1"),
        "line 2: not a valid OBJ file: unknown keyword \"V\""
    );
    assert_eq!(
        say("PK\x03\x04"),
        "line 2: not a valid OBJ file: unknown keyword \"PK\\u{3}\\u{4}\""
    );
    assert_eq!(
        say("surf 0 1 0 1 1 2 3 4"),
        "line 2: OBJ: free-form curves and surfaces are not supported; export the object as polygons"
    );
    for corner in ["1/x", "1/1/1/1", "1.0", "/1", "1//y"] {
        let error = say(&format!("f 1 {corner} 1"));
        assert!(
            error.starts_with("line 2: not a valid OBJ file: face 0 has \""),
            "{corner}: {error}"
        );
    }
    assert_eq!(
        say("l 1"),
        "line 2: not a valid OBJ file: edge 0 is one of fewer than two vertices"
    );
    // UTF-16 text would be one unknown keyword.
    let error = parse(OBJ, b"\xff\xfev\0 \x000\0").unwrap_err().to_string();
    assert!(error.contains("UTF-16"), "{error}");
}

#[test]
fn obj_is_read_in_double_precision() {
    let mesh = obj("v 0.1 1e-300 123456789.123456789");
    assert_eq!(mesh.vertex(0), [0.1, 1e-300, 123_456_789.123_456_79]);
}

#[test]
fn obj_errors_name_the_line_and_the_element() {
    let say = |text: &str| message(OBJ, text);
    assert_eq!(say(""), "the mesh is empty: it has no vertex");
    assert_eq!(
        say("# nothing\nvn 0 0 1\n"),
        "the mesh is empty: it has no vertex"
    );
    assert_eq!(
        say("v 0 0 0\nv 1 0 0\nf 1 2 3\n"),
        "line 3: face 0 names vertex 3, but the mesh has 2 vertices (1 to 2)"
    );
    assert_eq!(
        say("v 0 0 0\nl 1 1\nl 1 -2"),
        "line 3: not a valid OBJ file: edge 1 names vertex -2, counted backwards, but only 1 vertex stands before it"
    );
    assert_eq!(
        say("v 0 0 0\np -2"),
        "line 2: not a valid OBJ file: point 0 names vertex -2, counted backwards, but only 1 vertex stands before it"
    );
    assert_eq!(
        say("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 -4"),
        "line 4: not a valid OBJ file: face 0 names vertex -4, counted backwards, but only 3 vertices stand before it"
    );
    assert_eq!(
        say("v 0 0 0\nf 1 x 1"),
        "line 2: not a valid OBJ file: face 0 has \"x\" where a vertex number belongs"
    );
    assert_eq!(
        say("v 0 0 0\nf"),
        "line 2: not a valid OBJ file: face 0 is one without vertices"
    );
    assert_eq!(
        say("v 0 0 0\n\nv 1 2\nv 1 1 1"),
        "line 3: not a valid OBJ file: a vertex of 2 numbers: 3 are a position, a 4th is its weight, 6 or 7 end with a colour"
    );
    assert_eq!(
        say("v 1 1 1 0"),
        "line 1: not a valid OBJ file: a vertex has the weight 0"
    );
    assert_eq!(
        say("v 0 0 0\nv 0 -inf 0"),
        "line 2: vertex 1 has y = -inf; coordinates must be finite"
    );
    assert_eq!(
        say("v 0 0 0\nv 0 -1e400 0"),
        "line 2: not a valid OBJ file: vertex 1 has y = \"-1e400\", which is too large"
    );
    assert_eq!(
        say("v 0 0 0\nl 1 0"),
        "line 2: not a valid OBJ file: edge 0 names vertex 0: OBJ counts vertices from 1"
    );
    let huge = "v 0 0 0\nf 99999999999999999999 1 1";
    assert!(say(huge).contains("has \"99999999999999999999\" where a vertex number belongs"));
    assert!(say("v 0 0 0\nf 9223372036854775807 1 1").contains("names vertex 9223372036854775807"));
    assert!(say("v 0 0 0\nf -9223372036854775808 1 1").contains("face 0 names vertex"));
}

proptest! {
    #[test]
    fn obj_written_and_read_is_the_same_to_the_bit(
        bits in prop::collection::vec(prop::array::uniform3(any::<f64>()), 1..20),
        raw_lines in prop::collection::vec(prop::array::uniform2(any::<u32>()), 0..8),
        raw_triangles in prop::collection::vec(prop::array::uniform3(any::<u32>()), 0..8),
    ) {
        let vertices: Vec<[f64; 3]> =
            bits.iter().map(|p| p.map(|c| if c.is_finite() { c } else { -0.0 })).collect();
        let n = vertices.len() as u32;
        let lines = raw_lines.iter().map(|l| l.map(|v| v % n)).collect();
        let triangles = raw_triangles.iter().map(|t| t.map(|v| v % n)).collect();
        let mesh = Mesh::new(vertices, lines, triangles).unwrap();
        let mut file = Vec::new();
        write_obj(&mesh, &mut file).unwrap();
        let back = parse(OBJ, &file).unwrap();
        prop_assert_eq!(&back, &mesh);
        for (a, b) in back.vertices().iter().zip(mesh.vertices()) {
            prop_assert_eq!(a.map(f64::to_bits), b.map(f64::to_bits));
        }
    }
}
