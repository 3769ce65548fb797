//! Tests of compressed files and of streams.

use std::fs;
use std::io::Write;

use flate2::Compression;
use flate2::write::GzEncoder;

use super::{OBJ, STL};
use crate::error::Error;
use crate::generate;
use crate::io::{read, read_scene, read_scene_from, write_obj};

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

#[test]
fn compressed_files_and_streams_are_read() {
    let teapot = generate::teapot(2).unwrap();
    let mut text = Vec::new();
    write_obj(&teapot, &mut text).unwrap();
    let folder = tempfile::tempdir().unwrap();
    // Several members are one file, as `cat` of two archives makes it.
    let (head, tail) = text.split_at(text.len() / 2);
    let members = [gzip(head), gzip(tail)].concat();
    for (name, bytes) in [
        ("a.obj.gz", gzip(&text)),
        ("b.OBJ.GZ", members),
        ("c.obj", gzip(&text)),
    ] {
        let path = folder.path().join(name);
        fs::write(&path, bytes).unwrap();
        assert_eq!(read(&path).unwrap(), teapot, "{name}");
    }
    assert_eq!(read_scene(folder.path().join("c.obj")).unwrap()[0].name, "c");
    for bytes in [text.clone(), gzip(&text)] {
        let bodies = read_scene_from(&bytes[..], OBJ, "stdin", ".").unwrap();
        assert_eq!((bodies.len(), &*bodies[0].mesh), (1, &teapot));
    }
    let error = read_scene_from(&text[..], STL, "stdin", ".")
        .unwrap_err()
        .to_string();
    assert!(error.starts_with("-: not a valid STL file"), "{error}");
}

#[test]
fn damaged_archives_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let whole = gzip(b"v 0 0 0\nv 1 0 0\n");
    let mut flipped = whole.clone();
    let checksum = flipped.len() - 6;
    flipped[checksum] ^= 1;
    for (name, bytes) in [
        ("cut.obj.gz", &whole[..whole.len() - 3]),
        ("flipped.obj.gz", &flipped),
    ] {
        let path = folder.path().join(name);
        fs::write(&path, bytes).unwrap();
        assert!(matches!(read(&path), Err(Error::Unreadable { .. })), "{name}");
    }
}
