//! Tests of the STL reader.

use std::fmt::Write as _;

use super::{STL, message};
use crate::io::parse;

pub(super) fn ascii_stl(triangles: &[[[f32; 3]; 3]]) -> String {
    let mut file = String::from("solid\n");
    for t in triangles {
        file.push_str("  facet normal nan nan nan\n    outer loop\n");
        for v in t {
            writeln!(file, "      vertex {:?} {:?} {:?}", v[0], v[1], v[2]).unwrap();
        }
        file.push_str("    endloop\n  endfacet\n");
    }
    file.push_str("endsolid\n");
    file
}

pub(super) fn binary_stl(header: &[u8], triangles: &[[[f32; 3]; 3]]) -> Vec<u8> {
    let mut file = header.to_vec();
    file.resize(80, b' ');
    file.extend(u32::try_from(triangles.len()).unwrap().to_le_bytes());
    for t in triangles {
        file.extend([0; 12]);
        t.iter().flatten().for_each(|c| file.extend(c.to_le_bytes()));
        file.extend([0; 2]);
    }
    file
}

pub(super) const TWO: [[[f32; 3]; 3]; 2] = [
    [[0.0, 0.0, 0.0], [1.1, 0.0, 0.0], [1.0, 1.0, 0.0]],
    [[-0.0, 0.0, 0.0], [1.0, 1.0, -0.0], [0.0, 1.0, 0.0]],
];

#[test]
fn stl_ascii_and_binary_are_welded_alike() {
    let ascii = parse(STL, ascii_stl(&TWO).as_bytes()).unwrap();
    assert_eq!(ascii.vertices()[1], [f64::from(1.1_f32), 0.0, 0.0]);
    assert_eq!(
        (ascii.vertices().len(), ascii.triangles()),
        (4, &[[0, 1, 2], [0, 2, 3]][..])
    );
    for header in [&b""[..], b"solid made by a binary exporter", b"solid\n"] {
        assert_eq!(parse(STL, &binary_stl(header, &TWO)).unwrap(), ascii);
    }
    let shouted = ascii_stl(&TWO).to_uppercase().replace('\n', "\r\n");
    assert_eq!(parse(STL, shouted.as_bytes()).unwrap(), ascii);
}

#[test]
fn stl_files_of_several_solids_are_read_whole() {
    let file = ascii_stl(&TWO[..1]) + &ascii_stl(&TWO[1..]);
    assert_eq!(parse(STL, file.as_bytes()).unwrap().triangles().len(), 2);
}

#[test]
fn stl_errors_name_what_is_wrong() {
    let say = |file: &[u8]| message(STL, file);
    assert!(say(b"").contains("0 bytes are neither ASCII"));
    assert_eq!(
        say(b"solid a\nendsolid a\n"),
        "the mesh is empty: it has no vertex"
    );
    assert_eq!(say(&binary_stl(b"", &[])), "the mesh is empty: it has no vertex");
    let mut bad = TWO;
    bad[1][0][2] = f32::NAN;
    assert_eq!(
        say(&binary_stl(b"solid", &bad)),
        "vertex 3 has z = NaN; coordinates must be finite"
    );
    assert_eq!(
        say(ascii_stl(&bad).as_bytes()),
        "line 11: vertex 3 has z = NaN; coordinates must be finite"
    );
    let whole = binary_stl(b"solid", &TWO);
    assert_eq!(
        say(&whole[..100]),
        "not a valid STL file: its binary header announces 2 triangles, which take 184 bytes, but it has 100"
    );
    let text = ascii_stl(&TWO);
    assert_eq!(
        say(&text.as_bytes()[..text.find("    endloop").unwrap()]),
        "line 6: not a valid STL file: the file ends inside a solid"
    );
    assert_eq!(
        say(format!("{text}facet normal 0 0 0\n").as_bytes()),
        "line 17: not a valid STL file: \"facet\" where solid is expected"
    );
    assert_eq!(
        say(text.replace("vertex 1.1 ", "vertex 1,1 ").as_bytes()),
        "line 5: not a valid STL file: vertex 1 has \"1,1\" for a number"
    );
    assert_eq!(
        say(text.replacen("    endloop\n", "", 1).as_bytes()),
        "line 7: not a valid STL file: facet 1: \"endfacet\" where endloop is expected"
    );
    assert_eq!(
        say(text.replacen("0.0\n", "0.0 7\n", 1).as_bytes()),
        "line 4: not a valid STL file: \"7\" is one word too many"
    );
}

#[test]
fn stl_binary_counts_that_do_not_fit_the_file_are_refused() {
    for header in [&b""[..], b"solid like ascii"] {
        let whole = binary_stl(header, &TWO);
        for count in [0_u32, 1, 3, u32::MAX] {
            let mut file = whole.clone();
            file[80..84].copy_from_slice(&count.to_le_bytes());
            let error = message(STL, &file);
            assert!(
                error.starts_with(&format!(
                    "not a valid STL file: its binary header announces {count} triangles"
                )),
                "{error}"
            );
            assert!(error.ends_with("but it has 184"), "{error}");
        }
        let mut padded = whole;
        padded.push(0);
        assert!(message(STL, &padded).ends_with("but it has 185"));
    }
}

#[test]
fn stl_with_a_byte_order_mark_or_any_end_of_line_is_the_same_mesh() {
    let text = ascii_stl(&TWO);
    let mesh = parse(STL, text.as_bytes()).unwrap();
    for end in ["\n", "\r\n", "\r"] {
        let file = format!("\u{feff}{}", text.replace('\n', end));
        assert_eq!(parse(STL, file.as_bytes()).unwrap(), mesh, "{end:?}");
    }
}
