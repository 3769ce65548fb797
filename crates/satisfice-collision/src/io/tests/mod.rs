//! Tests of the readers: files by name, and bytes without meaning, which give an error or a mesh, never a panic.
#![allow(clippy::unwrap_used)]

mod animation;
mod gltf;
mod list;
mod obj;
mod off;
mod ply;
mod polygons;
mod stl;
mod streams;

use std::fs;
use std::path::Path;

use proptest::prelude::*;

use self::ply::{ENCODINGS, ply};
use self::stl::{TWO, ascii_stl, binary_stl};
use super::*;
use crate::error::Element;
use crate::generate;

const OBJ: Format = super::obj::FORMAT;
const PLY: Format = super::ply::FORMAT;
const STL: Format = super::stl::FORMAT;
const OFF: Format = super::off::FORMAT;
const GLTF: Format = super::gltf::FORMAT;

fn message(format: Format, bytes: impl AsRef<[u8]>) -> String {
    let text = parse(format, bytes.as_ref()).unwrap_err().to_string();
    assert!(!text.contains('\n'), "{text:?}");
    text
}

const SQUARE: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];

#[test]
fn files_go_by_their_extension() {
    let folder = tempfile::tempdir().unwrap();
    let teapot = generate::teapot(2).unwrap();
    let path = folder.path().join("teapot.OBJ");
    save_obj(&teapot, &path).unwrap();
    assert_eq!(read(&path).unwrap(), teapot);

    for name in ["teapot.blend", "teapot", ".obj", "teapot.gz", ".obj.gz"] {
        let error = read(folder.path().join(name)).unwrap_err();
        assert!(matches!(error, Error::UnknownFormat { .. }));
        assert!(
            error.to_string().ends_with(
                "the known extensions are obj, ply, stl, off, gltf, glb, json, toml, each also with .gz"
            ),
            "{error}"
        );
    }
    let missing = read(folder.path().join("missing.ply")).unwrap_err();
    assert!(matches!(missing, Error::Unreadable { .. }) && missing.to_string().contains("missing.ply"));
    fs::create_dir(folder.path().join("folder.stl")).unwrap();
    let error = read(folder.path().join("folder.stl")).unwrap_err();
    assert!(
        matches!(error, Error::Unreadable { .. }) && error.to_string().ends_with("name the mesh files in it"),
        "{error}"
    );
    assert!(matches!(
        save_obj(&teapot, folder.path().join("no/teapot.obj")),
        Err(Error::Unwritable { .. })
    ));

    fs::write(folder.path().join("bad.obj"), "v 0 0 0\nf 1 2 3").unwrap();
    let error = read(folder.path().join("bad.obj")).unwrap_err();
    assert!(
        error
            .to_string()
            .ends_with("bad.obj: line 2: face 0 names vertex 2, but the mesh has 1 vertex (1)")
    );
    assert!(matches!(
        error.root(),
        Error::IndexOutOfRange {
            element: Element::Face,
            vertex: 1,
            ..
        }
    ));
}

/// Real files, where there are some: set `SATISFICE_DATA` to a folder with `bunny.obj` and `cloth_ball92.ply`.
#[test]
fn files_from_elsewhere() {
    let Some(folder) = std::env::var_os("SATISFICE_DATA") else {
        eprintln!("skipped: SATISFICE_DATA is not set");
        return;
    };
    let folder = Path::new(&folder);
    for (name, vertices, triangles) in [("bunny.obj", 1839, 3674), ("cloth_ball92.ply", 46_598, 92_230)] {
        let path = folder.join(name);
        if !path.exists() {
            eprintln!("skipped: {} does not exist", path.display());
            continue;
        }
        let mesh = read(path).unwrap();
        assert_eq!(
            (mesh.vertices().len(), mesh.triangles().len()),
            (vertices, triangles)
        );
    }
}

fn samples() -> Vec<(Format, Vec<u8>)> {
    let mut file = Vec::new();
    write_obj(
        &Mesh::new(SQUARE.to_vec(), vec![[0, 3]], vec![[0, 1, 2]]).unwrap(),
        &mut file,
    )
    .unwrap();
    file.extend(b"vt 0 0\nvn 0 0 1\nf 1/1/1 -2/-1/-1 3/1/1\nl 1 2 3\np 1\no x\nusemtl y\n");
    let mut samples = vec![
        (OBJ, file),
        (STL, ascii_stl(&TWO).into_bytes()),
        (STL, binary_stl(b"solid", &TWO)),
        (
            OFF,
            b"OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3 255 0 0\n".to_vec(),
        ),
        (GLTF, gltf::two_triangles().into_bytes()),
        (GLTF, gltf::glb(&gltf::two_triangles(), b"")),
        (GLTF, animation::turning().into_bytes()),
    ];
    for encoding in ENCODINGS {
        for double in [true, false] {
            samples.push((
                PLY,
                ply(encoding, double, &SQUARE, &[vec![0, 1, 2, 3], vec![0, 2, 1]]),
            ));
        }
    }
    samples
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]
    #[test]
    fn random_bytes_do_no_harm(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        for format in Format::ALL {
            let _ = parse(format, &bytes);
        }
    }

    #[test]
    fn damaged_files_do_no_harm(
        which in 0_usize..13,
        damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        digits in any::<bool>(),
        cut in any::<prop::sample::Index>(),
        inserted in "[-+.0-9eE/ \n]{0,24}",
        at in any::<prop::sample::Index>(),
    ) {
        let (format, mut bytes) = samples().swap_remove(which);
        for (place, value) in damage {
            let k = place.index(bytes.len());
            bytes[k] = if digits { b"-0123456789 \n./"[usize::from(value) % 15] } else { value };
        }
        let k = at.index(bytes.len());
        bytes.splice(k..k, inserted.bytes());
        let _ = parse(format, &bytes);
        let _ = AnimatedScene::read_from(&bytes[..], format, "", ".", &[]).and_then(|scene| scene.at(0.5));
        let _ = parse(format, &bytes[..cut.index(bytes.len())]);
    }
}
