//! Tests of the glTF reader.

use std::fmt::Write as _;
use std::fs;
use std::sync::Arc;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};

use super::{GLTF, message};
use crate::error::Error;
use crate::io::{PlacedMesh, parse, read, read_scene, read_scene_from};

/// A unit right triangle as 9 floats and three indices of 16 bits.
pub(super) fn data() -> Vec<u8> {
    let positions = [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let mut bytes: Vec<u8> = positions.iter().flat_map(|c| c.to_le_bytes()).collect();
    bytes.extend([0_u16, 1, 2].iter().flat_map(|v| v.to_le_bytes()));
    bytes
}

/// A document with one triangle as mesh 0 and these nodes.
#[expect(
    clippy::needless_pass_by_value,
    reason = "every caller makes the nodes on the spot"
)]
pub(super) fn document(nodes: Value) -> Value {
    let uri = format!("data:application/octet-stream;base64,{}", STANDARD.encode(data()));
    json!({
        "asset": { "version": "2.0" },
        "nodes": nodes,
        "meshes": [{ "name": "triangle", "primitives": [{ "attributes": { "POSITION": 0, "NORMAL": 0 }, "indices": 1 }] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" },
            { "bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR" },
        ],
        "bufferViews": [
            { "buffer": 0, "byteLength": 36 },
            { "buffer": 0, "byteOffset": 36, "byteLength": 6 },
        ],
        "buffers": [{ "byteLength": 42, "uri": uri }],
    })
}

pub(super) fn two_triangles() -> String {
    document(json!([{ "mesh": 0, "children": [1] }, { "mesh": 0, "translation": [2, 0, 0] }])).to_string()
}

pub(super) fn glb(text: &str, binary: &[u8]) -> Vec<u8> {
    let mut file = b"glTF\x02\0\0\0".to_vec();
    let chunk = |kind: &[u8], bytes: &[u8]| [&(bytes.len() as u32).to_le_bytes(), kind, bytes].concat();
    let chunks = [chunk(b"JSON", text.as_bytes()), chunk(b"BIN\0", binary)].concat();
    file.extend((12 + chunks.len() as u32).to_le_bytes());
    file.extend(chunks);
    file
}

pub(super) fn scene(document: &Value) -> Vec<PlacedMesh> {
    read_scene_from(document.to_string().as_bytes(), GLTF, "", ".").unwrap()
}

fn say(document: &Value) -> String {
    let error = read_scene_from(document.to_string().as_bytes(), GLTF, "", ".")
        .unwrap_err()
        .to_string();
    assert!(!error.contains('\n'), "{error}");
    error.strip_prefix("-: ").unwrap().to_owned()
}

pub(super) fn near(a: [f64; 3], b: [f64; 3]) -> bool {
    (0..3).all(|k| (a[k] - b[k]).abs() < 1e-12)
}

#[test]
fn gltf_nodes_are_bodies_that_share_meshes() {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let bodies = scene(&document(json!([
        { "name": "group", "translation": [10, 0, 0], "children": [1, 2, 3] },
        { "name": "left", "mesh": 0, "translation": [-1, 0, 0] },
        { "name": "right", "mesh": 0, "rotation": [0, 0, half, half], "children": [4] },
        // A quarter turn about x as a matrix, column by column, and a translation.
        { "mesh": 0, "matrix": [1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, 5, 1] },
        { "name": "right", "mesh": 0, "translation": [2, 0, 0], "scale": [2, 2, 2] },
        { "name": "empty" },
        { "name": "sheared", "mesh": 0, "scale": [1, 3, 1] },
        { "name": "twice", "mesh": 0, "scale": [2, 2, 2] },
    ])));
    let names: Vec<&str> = bodies.iter().map(|body| body.name.as_str()).collect();
    assert_eq!(
        names,
        ["left", "right", "right.2", "triangle", "sheared", "twice"]
    );
    let corner = |k: usize, v: u32| bodies[k].placed().unwrap().vertex(v);
    assert!(near(corner(0, 1), [10.0, 0.0, 0.0]));
    assert!(near(corner(1, 1), [10.0, 1.0, 0.0]));
    assert!(near(corner(2, 1), [10.0, 4.0, 0.0]));
    assert!(near(corner(3, 2), [10.0, 0.0, 6.0]));
    assert!(near(corner(4, 2), [0.0, 3.0, 0.0]));
    assert!(Arc::ptr_eq(&bodies[0].mesh, &bodies[1].mesh) && Arc::ptr_eq(&bodies[0].mesh, &bodies[3].mesh));
    assert!(Arc::ptr_eq(&bodies[2].mesh, &bodies[5].mesh) && !Arc::ptr_eq(&bodies[0].mesh, &bodies[2].mesh));
    assert!(bodies[0].mesh.same_body(&bodies[4].mesh));
}

#[test]
fn gltf_transforms_keep_the_digits_of_json() {
    let bodies = scene(&document(
        json!([{ "mesh": 0, "translation": [123456.789, 0.1, 0] }]),
    ));
    assert_eq!(bodies[0].placement.translation(), [123_456.789, 0.1, 0.0]);
}

#[test]
fn gltf_buffers_are_found_inside_and_beside_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let mut value = document(json!([{ "mesh": 0 }]));
    let expected = parse(GLTF, value.to_string().as_bytes()).unwrap();
    assert_eq!(
        (expected.vertices().len(), expected.triangles()),
        (3, &[[0, 1, 2]][..])
    );

    value["buffers"][0]["uri"] = json!("my%20data.bin");
    fs::write(folder.path().join("my data.bin"), data()).unwrap();
    fs::write(folder.path().join("a.gltf"), value.to_string()).unwrap();
    assert_eq!(read(folder.path().join("a.gltf")).unwrap(), expected);

    value["buffers"][0]["uri"] = Value::Null;
    fs::write(folder.path().join("b.glb"), glb(&value.to_string(), &data())).unwrap();
    assert_eq!(
        read_scene(folder.path().join("b.glb")).unwrap()[0].name,
        "triangle"
    );
    assert_eq!(read(folder.path().join("b.glb")).unwrap(), expected);
}

#[test]
fn gltf_primitives_of_every_mode() {
    let modes = [(0, 0, 0), (1, 2, 0), (2, 4, 0), (3, 3, 0), (5, 0, 2), (6, 0, 2)];
    for (mode, lines, triangles) in modes {
        let mut value = document(json!([{ "mesh": 0 }]));
        value["meshes"][0]["primitives"] =
            json!([{ "attributes": { "POSITION": 0 }, "indices": 1, "mode": mode }]);
        value["accessors"][1] =
            json!({ "bufferView": 1, "componentType": 5121, "count": 4, "type": "SCALAR" });
        value["bufferViews"][1] = json!({ "buffer": 1, "byteLength": 4 });
        let uri = format!("data:;base64,{}", STANDARD.encode([0, 1, 2, 1]));
        value["buffers"]
            .as_array_mut()
            .unwrap()
            .push(json!({ "byteLength": 4, "uri": uri }));
        let body = &scene(&value)[0];
        // A strip of 0, 1, 2 and 1, 2, 1 has one triangle that is not flat; a fan 0 1 2, 0 2 1 has two.
        let triangles = if mode == 5 { 1 } else { triangles };
        assert_eq!(
            (body.mesh.lines().len(), body.mesh.triangles().len()),
            (lines, triangles),
            "mode {mode}"
        );
    }
}

#[test]
fn gltf_quantised_strided_and_sparse_accessors() {
    let mut value = document(json!([{ "mesh": 0, "scale": [2, 2, 2] }]));
    // Three normalised vectors of 16 bits, each followed by two bytes, the last one replaced.
    let vectors: [[i16; 4]; 3] = [[0, 0, 0, 9], [32_767, 0, 0, 9], [1, 1, 1, 9]];
    let mut bytes: Vec<u8> = vectors
        .as_flattened()
        .iter()
        .flat_map(|c| c.to_le_bytes())
        .collect();
    bytes.extend([2, 0]);
    bytes.extend([0_i16, -32_768, 0].iter().flat_map(|c| c.to_le_bytes()));
    value["buffers"][0] =
        json!({ "byteLength": 32, "uri": format!("data:a/b;base64,{}", STANDARD.encode(&bytes)) });
    value["bufferViews"] = json!([
        { "buffer": 0, "byteLength": 24, "byteStride": 8 },
        { "buffer": 0, "byteOffset": 24, "byteLength": 8 },
    ]);
    value["accessors"] = json!([{
        "bufferView": 0, "componentType": 5122, "normalized": true, "count": 3, "type": "VEC3",
        "sparse": {
            "count": 1,
            "indices": { "bufferView": 1, "componentType": 5121 },
            "values": { "bufferView": 1, "byteOffset": 2 },
        },
    }]);
    value["meshes"][0]["primitives"] = json!([{ "attributes": { "POSITION": 0 } }]);
    value["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    assert_eq!(
        scene(&value)[0].placed().unwrap().vertices(),
        [[0.0; 3], [2.0, 0.0, 0.0], [0.0, -2.0, 0.0]]
    );
}

#[test]
fn gltf_that_is_incomplete_or_contradicts_itself_gives_one_clear_error() {
    let malformed = "not a valid glTF file:";
    let with = |change: &dyn Fn(&mut Value)| {
        let mut value = document(json!([{ "name": "a", "mesh": 0 }]));
        change(&mut value);
        say(&value)
    };
    type Case<'a> = (&'a dyn Fn(&mut Value), &'a str);
    let cases: [Case<'_>; 14] = [
        (
            &|v| v["buffers"][0]["uri"] = json!("missing.bin"),
            "a: cannot read ./missing.bin: No such file or directory (os error 2)",
        ),
        (
            &|v| v["buffers"][0]["uri"] = Value::Null,
            "a: {} buffer 0 is missing: it names no file",
        ),
        (&|v| v["buffers"] = json!([]), "a: {} there is no buffer 0"),
        (
            &|v| v["buffers"][0]["byteLength"] = json!(43),
            "a: {} buffer 0 has 42 bytes of the 43 that it announces",
        ),
        (
            &|v| v["bufferViews"][1]["byteLength"] = json!(7),
            "a: {} buffer view 1 ends beyond its buffer",
        ),
        (
            &|v| v["bufferViews"] = json!([]),
            "a: {} there is no buffer view 0",
        ),
        (
            &|v| v["accessors"][0]["count"] = json!(4),
            "a: {} an accessor ends beyond buffer view 0",
        ),
        (
            &|v| v["accessors"][0]["count"] = json!(usize::MAX),
            "a: {} an accessor ends beyond buffer view 0",
        ),
        (
            &|v| v["accessors"][0]["type"] = json!("VEC2"),
            "a: {} accessor 0 is of type \"VEC2\", not VEC3",
        ),
        (&|v| v["accessors"] = json!([]), "a: {} there is no accessor 0"),
        (&|v| v["meshes"] = json!([]), "a: {} there is no mesh 0"),
        (&|v| v["scene"] = json!(3), "{} there is no scene 3"),
        (
            &|v| v["nodes"][0]["scale"] = json!([1, 0, 1]),
            "a: scale = [1.0, 0.0, 1.0] is not allowed: finite numbers other than 0",
        ),
        (
            &|v| v["asset"]["version"] = json!("1.0"),
            "glTF: version \"1.0\" is not supported, only 2.0",
        ),
    ];
    for (change, expected) in cases {
        assert_eq!(with(change), expected.replace("{}", malformed));
    }
    assert!(with(&|v| v["nodes"][0]["skin"] = json!(0)).contains("skins"));
    assert!(with(&|v| v["nodes"][0]["weights"] = json!([0.5])).contains("morph targets"));
    assert!(with(&|v| v["extensionsRequired"] = json!(["KHR_draco_mesh_compression"])).contains("draco"));
    assert!(with(&|v| v["nodes"][0]["name"] = json!(7)).contains("invalid type"));
    // Corner 2 names a vertex that is not there.
    let fewer = with(&|v| v["accessors"][0]["count"] = json!(2));
    assert_eq!(
        fewer,
        "a: corner 2 names vertex 2, but the mesh has 2 vertices (0 to 1)"
    );
}

#[test]
fn gltf_nodes_that_are_not_trees_are_refused() {
    let cycle = document(json!([{ "mesh": 0, "children": [1] }, { "children": [0] }]));
    assert!(say(&cycle).contains("is its own ancestor"));
    let own = document(json!([{ "mesh": 0 }, { "children": [1] }]));
    assert!(say(&own).contains("node 1 is its own ancestor"));
    let shared = document(json!([{ "children": [2] }, { "children": [2] }, { "mesh": 0 }]));
    assert!(say(&shared).contains("node 2 is a child twice"));
    let missing = document(json!([{ "children": [9] }]));
    assert!(say(&missing).contains("there is no node 9"));
    let mut twice = document(json!([{ "mesh": 0 }]));
    twice["scenes"] = json!([{ "nodes": [0, 0] }]);
    assert!(say(&twice).contains("names a node twice"));
}

#[test]
fn gltf_of_too_many_nodes_is_refused_and_a_deep_one_read() {
    let chain = |n: usize| {
        let mut nodes = String::new();
        for k in 1..n {
            write!(nodes, "{{\"children\":[{k}]}},").unwrap();
        }
        let mut value = document(json!(["nodes"])).to_string();
        value = value.replace(
            "\"nodes\":[\"nodes\"]",
            &format!("\"nodes\":[{nodes}{{\"mesh\":0}}]"),
        );
        read_scene_from(value.as_bytes(), GLTF, "", ".")
    };
    assert_eq!(chain(50_000).unwrap().len(), 1);
    let error = chain(1_000_000).unwrap_err();
    assert!(matches!(error.root(), Error::Unsupported { .. }));
    assert!(
        error
            .to_string()
            .contains("1000000 nodes; at most 500000 are read"),
        "{error}"
    );
}

#[test]
fn glb_containers_are_checked() {
    let whole = glb(&two_triangles(), b"");
    assert_eq!(read_scene_from(&whole[..], GLTF, "", ".").unwrap().len(), 2);
    for cut in 0..whole.len() {
        assert!(parse(GLTF, &whole[..cut]).is_err(), "{cut}");
    }
    assert!(message(GLTF, &whole[..40]).contains("but has 40"));
    let mut version = whole.clone();
    version[4] = 1;
    assert!(message(GLTF, &version).contains("version 1 of .glb"));
    let several = message(GLTF, &whole);
    assert!(
        several.contains("the scene has 2 bodies, but one mesh is asked for"),
        "{several}"
    );
}
