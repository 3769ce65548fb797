//! Tests of the PLY reader.

use std::fmt::Write as _;

use super::{PLY, SQUARE, message};
use crate::io::parse;

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
            let mesh = parse(PLY, &file).unwrap();
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
    let mesh = parse(PLY, text.as_bytes()).unwrap();
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
            let text = message(PLY, ply(encoding, true, vertices, polygons));
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
                parse(PLY, &whole[..length]).is_err(),
                "{encoding} cut to {length}"
            );
        }
    }
    let head = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n";
    let say = |rest: &str| message(PLY, format!("{head}{rest}"));
    assert_eq!(
        say("end_header\n0 0\n"),
        "not a valid PLY file: its vertices have no number z"
    );
    assert!(say("property list uchar float z\nend_header\n0 0\n").contains("no number z"));
    assert!(
        say("property float z\nend_header\n0 zero 0\n")
            .starts_with("line 8: not a valid PLY file: vertex 0: \"zero\" is not a number")
    );
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
    assert_eq!(
        message(PLY, "plx\n"),
        "line 1: not a valid PLY file: it does not begin with a line \"ply\""
    );
}

/// A file of three vertices and a triangle with this header instead of the usual lines of the element `vertex`.
fn with_header(vertex: &str, body: &str) -> String {
    format!(
        "ply\nformat ascii 1.0\n{vertex}element face 1\nproperty list uchar int vertex_indices\nend_header\n{body}"
    )
}

const VERTEX: &str = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
const BODY: &str = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

#[test]
fn ply_headers_that_contradict_themselves_are_refused() {
    let say = |vertex: &str| message(PLY, with_header(vertex, BODY));
    assert!(parse(PLY, with_header(VERTEX, BODY).as_bytes()).is_ok());
    assert_eq!(
        say(&format!("{VERTEX}element vertex 1\nproperty float x\n")),
        "line 7: not a valid PLY file: a second element \"vertex\""
    );
    assert_eq!(
        say(&format!("{VERTEX}property int x\n")),
        "line 7: not a valid PLY file: a second property \"x\" of the element \"vertex\""
    );
    assert_eq!(
        say("property float x\n"),
        "line 3: not a valid PLY file: a property before the first element"
    );
    assert_eq!(
        say("element vertex -3\n"),
        "line 3: not a valid PLY file: the element \"vertex\" has the count \"-3\""
    );
    assert_eq!(
        say("element vertex 3\nproperty real x\n"),
        "line 4: not a valid PLY file: unknown type \"real\""
    );
    assert_eq!(
        say("element vertex 3\nproperty list float int x\n"),
        "line 4: not a valid PLY file: the list \"x\" is counted by no whole numbers"
    );
    assert_eq!(
        say("elements 3\n"),
        "line 3: not a valid PLY file: unknown keyword \"elements\" in the header"
    );
    assert_eq!(
        say("format ascii 1.0\n"),
        "line 3: not a valid PLY file: a second line \"format\""
    );
    assert_eq!(
        message(PLY, "ply\nelement vertex 0\nend_header\n"),
        "line 3: not a valid PLY file: the header has no line \"format\""
    );
    assert_eq!(
        message(PLY, "ply\nformat ascii 1.0\n"),
        "line 3: not a valid PLY file: the header has no end"
    );
}

#[test]
fn ply_numbers_that_the_header_does_not_announce_are_refused() {
    let say = |body: &str| message(PLY, with_header(VERTEX, body));
    let malformed = "not a valid PLY file: ";
    for (body, expected) in [
        (
            "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 1 2\n",
            "line 14: {}a line follows the last element that the header announces",
        ),
        (
            "0 0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
            "line 10: {}vertex 0: the line has more numbers than the header says",
        ),
        (
            "0 0 0\n1 0\n0 1 0\n3 0 1 2\n",
            "line 11: {}vertex 1: the line has fewer numbers than the header says",
        ),
        (
            "0 0 0\n1 0 0\n0 1 0\n3 0 1\n",
            "line 13: {}face 0: the line has fewer numbers than the header says",
        ),
        (
            "0 0 0\n1 0 0\n0 1 0\n-1\n",
            "line 13: {}face 0: \"-1\" is not a whole number from 0 to 255",
        ),
        (
            "0 0 0\n1 0 0\n0 1 0\n3 0 1 2.5\n",
            "line 13: {}face 0: \"2.5\" is not a whole number from -2147483648 to 2147483647",
        ),
        (
            "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n",
            "line 13: face 0 names vertex 3, but the mesh has 3 vertices (0 to 2)",
        ),
    ] {
        assert_eq!(say(body), expected.replace("{}", malformed));
    }
    for encoding in &ENCODINGS[1..] {
        let mut file = ply(encoding, true, &SQUARE, &[vec![0, 1, 2]]);
        file.extend([0; 13]);
        assert_eq!(
            message(PLY, &file),
            "not a valid PLY file: 13 bytes follow the last element that the header announces"
        );
    }
}

#[test]
fn ply_with_a_byte_order_mark_or_any_end_of_line_is_the_same_mesh() {
    let plain = with_header(VERTEX, BODY);
    let mesh = parse(PLY, plain.as_bytes()).unwrap();
    for end in ["\n", "\r\n", "\r"] {
        let file = plain.replace('\n', end);
        assert_eq!(parse(PLY, file.as_bytes()).unwrap(), mesh, "{end:?}");
        assert_eq!(
            parse(PLY, format!("\u{feff}{file}").as_bytes()).unwrap(),
            mesh,
            "{end:?}"
        );
    }
    // The first byte of binary data may look like a part of the header's last line.
    let header = "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty uchar x\nproperty uchar y\nproperty uchar z\nend_header\n";
    for end in ["\n", "\r\n", "\r"] {
        let mut file = header.replace('\n', end).into_bytes();
        file.extend(b"\n\r\n");
        assert_eq!(
            parse(PLY, &file).unwrap().vertices(),
            [[10.0, 13.0, 10.0]],
            "{end:?}"
        );
    }
}

#[test]
fn ply_lists_and_types_that_are_passed_over_are_checked() {
    let vertex = "element vertex 1\nproperty list char double a\nproperty double x\nproperty double y\nproperty double z\nproperty uchar red\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n";
    let head = format!("ply\nformat ascii 1.0\n{vertex}");
    let file = |line: &str| format!("{head}{line}\n");
    assert_eq!(
        parse(PLY, file("2 1 nan 1 2 3 255").as_bytes())
            .unwrap()
            .vertices(),
        [[1.0, 2.0, 3.0]]
    );
    for (line, reason) in [
        ("0 1 2 3 256", "\"256\" is not a whole number from 0 to 255"),
        ("1 x 1 2 3 0", "\"x\" is not a number"),
        ("-1 1 2 3 0", "a list of -1 members"),
        ("2 1 1 2 3 0", "the line has fewer numbers than the header says"),
    ] {
        assert_eq!(
            message(PLY, file(line)),
            format!("line 12: not a valid PLY file: vertex 0: {reason}")
        );
    }
}

/// A binary file in a shape that is read many members at a time, or, with a list and a number more, one by one.
fn shaped(
    usual: bool,
    big: bool,
    real: &str,
    list: &str,
    vertices: &[[f64; 3]],
    polygons: &[Vec<u32>],
) -> Vec<u8> {
    let encoding = if big {
        "binary_big_endian"
    } else {
        "binary_little_endian"
    };
    let [count, item] = [0, 1].map(|k| list.split(' ').nth(k).unwrap());
    let mut file = format!(
        "ply\nformat {encoding} 1.0\nelement vertex {}\nproperty short flag\nproperty {real} z\nproperty {real} x\n{}property {real} y\n\
         element face {}\nproperty list {count} {item} vertex_index\n{}end_header\n",
        vertices.len(),
        if usual { "" } else { "property list uchar uchar none\n" },
        polygons.len(),
        if usual { "" } else { "property uchar shade\n" },
    )
    .into_bytes();
    let mut put = |little: &[u8]| match big {
        true => file.extend(little.iter().rev()),
        false => file.extend(little),
    };
    for &[x, y, z] in vertices {
        put(&7_i16.to_le_bytes());
        for (c, ends) in [(z, false), (x, true), (y, false)] {
            match real {
                "float" => put(&(c as f32).to_le_bytes()),
                _ => put(&c.to_le_bytes()),
            }
            if ends && !usual {
                put(&[0]);
            }
        }
    }
    for polygon in polygons {
        match count {
            "uchar" => put(&[polygon.len() as u8]),
            _ => put(&(polygon.len() as u32).to_le_bytes()),
        }
        polygon.iter().for_each(|v| put(&v.to_le_bytes()));
        if !usual {
            put(&[9]);
        }
    }
    file
}

#[test]
fn ply_members_read_many_at_a_time_are_those_read_one_by_one() {
    let vertices: Vec<[f64; 3]> = (0..9)
        .map(|k| [f64::from(k) * 0.1, -1.5, 2.0 - f64::from(k)])
        .collect();
    let spoilt = |k: usize, axis: usize, to: f64| {
        let mut vertices = vertices.clone();
        vertices[k][axis] = to;
        vertices
    };
    let triangles: Vec<Vec<u32>> = (0..7).map(|k| vec![k, k + 1, k + 2]).collect();
    let with = |k: usize, polygon: &[u32]| {
        let mut polygons = triangles.clone();
        polygons[k] = polygon.to_vec();
        polygons
    };
    let mut cases = vec![(vertices.clone(), triangles.clone())];
    for k in [0, 3, 6] {
        for polygon in [
            &[][..],
            &[4],
            &[0, 8],
            &[0, 1, 2, 3],
            &[8, 8, 8],
            &[0, 9, 1],
            &[0, 1, u32::MAX],
            &[1 << 31, 0, 1],
        ] {
            cases.push((vertices.clone(), with(k, polygon)));
        }
        for to in [f64::NAN, f64::INFINITY] {
            cases.push((spoilt(k, k % 3, to), triangles.clone()));
        }
    }
    for (vertices, polygons) in &cases {
        for big in [false, true] {
            for real in ["float", "double"] {
                for list in ["uchar int", "uchar uint", "int int", "uint uint"] {
                    let [usual, other] = [true, false].map(|usual| {
                        let file = shaped(usual, big, real, list, vertices, polygons);
                        let whole = parse(PLY, &file).map_err(|error| error.to_string());
                        (whole, parse(PLY, &file[..file.len() - 1]).is_err())
                    });
                    assert_eq!(usual, other, "{real} {list} {vertices:?} {polygons:?}");
                    assert!(usual.1);
                }
            }
        }
    }
}
