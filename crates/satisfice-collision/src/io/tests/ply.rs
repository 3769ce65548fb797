//! Tests of the PLY reader.

use std::fmt::Write as _;

use super::{SQUARE, message};
use crate::io::{Format, parse};

/// A PLY file of triangles, written here byte by byte.
pub(super) fn ply(format: &str, double: bool, vertices: &[[f64; 3]], polygons: &[Vec<i32>]) -> Vec<u8> {
    let real = if double { "double" } else { "float" };
    let mut file = format!(
        "ply\nformat {format} 1.0\ncomment a\nelement vertex {}\nproperty {real} x\nproperty {real} y\n\
         property {real} z\nproperty uchar red\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
        vertices.len(),
        polygons.len()
    )
    .into_bytes();
    let order = |little: Vec<u8>| -> Vec<u8> {
        if format == "binary_big_endian" {
            little.into_iter().rev().collect()
        } else {
            little
        }
    };
    for v in vertices {
        if format == "ascii" {
            file.extend(format!("{:?} {:?} {:?} 200\n", v[0], v[1], v[2]).bytes());
            continue;
        }
        for &c in v {
            let bytes = if double {
                c.to_le_bytes().to_vec()
            } else {
                (c as f32).to_le_bytes().to_vec()
            };
            file.extend(order(bytes));
        }
        file.push(200);
    }
    for p in polygons {
        if format == "ascii" {
            let mut line = p.len().to_string();
            p.iter().for_each(|i| write!(line, " {i}").unwrap());
            file.extend(line.bytes());
            file.push(b'\n');
            continue;
        }
        file.push(u8::try_from(p.len()).unwrap());
        p.iter()
            .for_each(|i| file.extend(order(i.to_le_bytes().to_vec())));
    }
    file
}

pub(super) const ENCODINGS: [&str; 3] = ["ascii", "binary_little_endian", "binary_big_endian"];

#[test]
fn ply_in_every_encoding_and_precision() {
    let vertices = [
        [0.1, -2.5, 3e-20],
        [1.0, 0.25, 0.0],
        [7.0, 8.0, 9.0],
        [-1.0, 1e10, 0.3],
    ];
    for encoding in ENCODINGS {
        for double in [true, false] {
            let file = ply(
                encoding,
                double,
                &vertices,
                &[vec![0, 1, 2], vec![3, 2, 1, 0], vec![0, 1]],
            );
            let mesh = parse(Format::Ply, &file).unwrap();
            let expected = if double {
                vertices
            } else {
                vertices.map(|p| p.map(|c| f64::from(c as f32)))
            };
            assert_eq!(mesh.vertices(), expected, "{encoding} {double}");
            assert_eq!(mesh.triangles(), [[0, 1, 2], [3, 2, 1], [3, 1, 0]]);
            assert_eq!(mesh.lines(), [[0, 1]]);
        }
    }
}

#[test]
fn ply_with_other_elements_edges_types_and_manners() {
    let text = "ply\r\nformat ascii 1.0\r\nobj_info 3\r\nelement empty 18446744073709551615\r\n\
        element material 1\r\nproperty float shine\r\nelement vertex 4\r\nproperty float nx\r\n\
        property list uchar float weights\r\nproperty short x\r\nproperty float64 y\r\nproperty float32 z\r\n\
        element edge 2\r\nproperty uchar vertex1\r\nproperty ushort vertex2\r\n\
        element face 1\r\nproperty list uint8 uint32 vertex_index\r\nend_header\r\n\
        nan\r\nNaN 0 0 0 0\r\n .5 2 1. nan 1 0 0\r\n\r\n0 0 1 1.0e0 0.\r\n0 0 0 1 -.0\r\n0 2\r\n3 1\r\n3 0 1 2\r\n";
    let mesh = parse(Format::Ply, text.as_bytes()).unwrap();
    assert_eq!(mesh.vertices(), SQUARE);
    assert_eq!(
        (mesh.lines(), mesh.triangles()),
        (&[[0, 2], [3, 1]][..], &[[0, 1, 2]][..])
    );
}

#[test]
fn ply_errors_name_what_is_wrong() {
    let square = SQUARE.to_vec();
    for encoding in ENCODINGS {
        let say = |vertices: &[[f64; 3]], polygons: &[Vec<i32>]| {
            let text = message(Format::Ply, ply(encoding, true, vertices, polygons));
            text.split_once(": ")
                .filter(|(l, _)| l.starts_with("line"))
                .map_or(text.clone(), |(_, t)| t.into())
        };
        assert_eq!(say(&[], &[]), "the mesh is empty: it has no vertex");
        for (value, text) in [
            (f64::NAN, "NaN"),
            (f64::INFINITY, "inf"),
            (f64::NEG_INFINITY, "-inf"),
        ] {
            let mut bad = square.clone();
            bad[2][1] = value;
            assert_eq!(
                say(&bad, &[]),
                format!("vertex 2 has y = {text}; coordinates must be finite")
            );
        }
        assert_eq!(
            say(&square, &[vec![0, 1, 2], vec![0, 1, 4]]),
            "face 1 names vertex 4, but the mesh has 4 vertices (0 to 3)"
        );
        assert_eq!(
            say(&square, &[vec![0, 1, -1]]),
            "face 0 names vertex -1, but the mesh has 4 vertices (0 to 3)"
        );
        let whole = ply(encoding, true, &square, &[vec![0, 1, 2]]);
        for length in 0..whole.len() - 1 {
            assert!(
                parse(Format::Ply, &whole[..length]).is_err(),
                "{encoding} cut to {length}"
            );
        }
    }
    let head = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n";
    let say = |rest: &str| message(Format::Ply, format!("{head}{rest}"));
    assert_eq!(
        say("end_header\n0 0\n"),
        "not a valid PLY file: its vertices have no number z"
    );
    assert!(say("property list uchar float z\nend_header\n0 0\n").contains("no number z"));
    assert!(say("property float z\nend_header\n0 zero 0\n").starts_with("line 8: not a valid PLY file:"));
    assert_eq!(
        say("property float z\nend_header\n0 0 nan\n"),
        "line 8: vertex 0 has z = NaN; coordinates must be finite"
    );
    assert_eq!(
        say(
            "property float z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0\n"
        ),
        "not a valid PLY file: it ends after 1 of 2 members of the element \"face\""
    );
    assert!(say("property float z\nelement face 0\nend_header\n0 0 0\n").contains("no list vertex_indices"));
    assert!(say("property float z\nelement edge 0\nend_header\n0 0 0\n").contains("vertex1 and vertex2"));
    assert!(
        say("property float z\nelement tristrips 0\nend_header\n0 0 0\n")
            .contains("strips are not supported")
    );
    assert!(message(Format::Ply, "plx\n").starts_with("line 1: not a valid PLY file: Expected magic number"));
}
