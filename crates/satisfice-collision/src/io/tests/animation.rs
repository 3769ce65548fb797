//! Tests of glTF animations: places computed by hand.

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_6};
use std::fs;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};

use super::GLTF;
use super::gltf::{document, near};
use crate::error::Error;
use crate::io::{AnimatedScene, read_scene};

/// Adds numbers as a buffer of their own; returns the accessor.
fn accessor(value: &mut Value, kind: &str, numbers: &[f32]) -> usize {
    let width = match kind {
        "SCALAR" => 1,
        "VEC3" => 3,
        _ => 4,
    };
    let bytes: Vec<u8> = numbers.iter().flat_map(|c| c.to_le_bytes()).collect();
    let mut push = |list: &str, item: Value| {
        let list = value[list].as_array_mut().unwrap();
        list.push(item);
        list.len() - 1
    };
    let uri = format!("data:;base64,{}", STANDARD.encode(&bytes));
    let buffer = push("buffers", json!({ "byteLength": bytes.len(), "uri": uri }));
    let view = push(
        "bufferViews",
        json!({ "buffer": buffer, "byteLength": bytes.len() }),
    );
    push(
        "accessors",
        json!({ "bufferView": view, "componentType": 5126, "count": numbers.len() / width, "type": kind }),
    )
}

/// Keys of a property of a node.
type Keys<'a> = (usize, &'a str, &'a str, &'a [f32], &'a [f32]);

/// Adds an animation of this name.
fn animate(value: &mut Value, name: &str, keys: &[Keys<'_>]) {
    let (mut channels, mut samplers) = (Vec::new(), Vec::new());
    for &(node, path, interpolation, times, values) in keys {
        let input = accessor(value, "SCALAR", times);
        let output = accessor(value, if path == "rotation" { "VEC4" } else { "VEC3" }, values);
        channels.push(json!({ "sampler": samplers.len(), "target": { "node": node, "path": path } }));
        samplers.push(json!({ "input": input, "output": output, "interpolation": interpolation }));
    }
    let animation = json!({ "name": name, "channels": channels, "samplers": samplers });
    match value["animations"].as_array_mut() {
        Some(list) => list.push(animation),
        None => value["animations"] = json!([animation]),
    }
}

/// A quarter turn about z.
const QUARTER: [f32; 4] = [0.0, 0.0, FRAC_1_SQRT_2 as f32, FRAC_1_SQRT_2 as f32];

/// A triangle that makes a quarter turn in a second.
pub(super) fn turning() -> String {
    let mut value = document(json!([{ "name": "lid", "mesh": 0 }]));
    let keys = [[0.0, 0.0, 0.0, 1.0], QUARTER].concat();
    animate(
        &mut value,
        "open",
        &[(0, "rotation", "LINEAR", &[0.0, 1.0], &keys)],
    );
    value.to_string()
}

fn read(value: &Value, animations: &[&str]) -> Result<AnimatedScene, Error> {
    AnimatedScene::read_from(value.to_string().as_bytes(), GLTF, "", ".", animations)
}

/// Where corner `v` of body `k` is.
fn corner(scene: &AnimatedScene, seconds: f64, k: usize, v: u32) -> [f64; 3] {
    scene.at(seconds).unwrap()[k].placed().unwrap().vertex(v)
}

fn close(a: [f64; 3], b: [f64; 3]) -> bool {
    (0..3).all(|k| (a[k] - b[k]).abs() < 1e-7)
}

#[test]
fn keys_are_joined_as_their_interpolation_says() {
    let mut value = document(json!([{ "mesh": 0 }, { "mesh": 0 }, { "mesh": 0 }, { "mesh": 0 }]));
    let line = [0.0, 0.0, 0.0, 4.0, 8.0, 0.0, 4.0, 8.0, 6.0];
    // Before, at and behind each key; the first slope and the last one join nothing.
    let curve = [[9.0; 3], [0.0; 3], [2.0; 3], [-4.0; 3], [8.0; 3], [9.0; 3]].concat();
    animate(
        &mut value,
        "all",
        &[
            (0, "translation", "LINEAR", &[1.0, 3.0, 4.0], &line),
            (1, "translation", "STEP", &[1.0, 3.0, 4.0], &line),
            (2, "translation", "CUBICSPLINE", &[1.0, 3.0], &curve),
            (3, "scale", "LINEAR", &[0.0, 4.0], &[1.0, 1.0, 1.0, 3.0, 5.0, 1.0]),
        ],
    );
    let scene = read(&value, &[]).unwrap();
    assert_eq!(
        (scene.animations(), scene.end()),
        (vec!["all".to_owned()], Some(4.0))
    );
    for (seconds, linear, step, cubic) in [
        (0.0, [0.0; 3], [0.0; 3], 0.0),
        (1.0, [0.0; 3], [0.0; 3], 0.0),
        (1.5, [1.0, 2.0, 0.0], [0.0; 3], 2.1875),
        (2.0, [2.0, 4.0, 0.0], [0.0; 3], 5.5),
        (3.0, [4.0, 8.0, 0.0], [4.0, 8.0, 0.0], 8.0),
        (3.75, [4.0, 8.0, 4.5], [4.0, 8.0, 0.0], 8.0),
        (4.0, [4.0, 8.0, 6.0], [4.0, 8.0, 6.0], 8.0),
        (99.0, [4.0, 8.0, 6.0], [4.0, 8.0, 6.0], 8.0),
    ] {
        assert!(near(corner(&scene, seconds, 0, 0), linear), "{seconds}");
        assert!(near(corner(&scene, seconds, 1, 0), step), "{seconds}");
        assert!(near(corner(&scene, seconds, 2, 0), [cubic; 3]), "{seconds}");
    }
    // A quarter of the way: 1.5 times as wide and twice as high.
    assert!(near(corner(&scene, 1.0, 3, 1), [1.5, 0.0, 0.0]));
    assert!(near(corner(&scene, 1.0, 3, 2), [0.0, 2.0, 0.0]));
    let names = |seconds| {
        let bodies = scene.at(seconds).unwrap();
        bodies.into_iter().map(|body| body.name).collect::<Vec<_>>()
    };
    assert_eq!(names(0.0), names(2.0));
}

#[test]
fn rotations_take_the_shorter_way_at_constant_speed() {
    let opposite = QUARTER.map(|c| -c);
    for end in [QUARTER, opposite] {
        let mut value = document(json!([
            { "mesh": 0, "translation": [1, 0, 0], "children": [1] },
            { "mesh": 0, "translation": [1, 0, 0] },
        ]));
        let keys = [[0.0, 0.0, 0.0, 1.0], end].concat();
        animate(&mut value, "", &[(0, "rotation", "LINEAR", &[0.0, 3.0], &keys)]);
        let scene = read(&value, &["0"]).unwrap();
        assert_eq!(scene.animations(), ["0"]);
        let (s, c) = FRAC_PI_6.sin_cos();
        assert!(close(corner(&scene, 1.0, 0, 1), [1.0 + c, s, 0.0]));
        assert!(close(corner(&scene, 2.0, 0, 1), [1.0 + s, c, 0.0]));
        // The child turns with its parent: its corner 1 is two away from there.
        assert!(close(corner(&scene, 1.0, 1, 1), [1.0 + 2.0 * c, 2.0 * s, 0.0]));
        assert!(close(corner(&scene, 3.0, 1, 1), [1.0, 2.0, 0.0]));
    }
}

#[test]
fn what_keeps_its_keys_rests_exactly() {
    let q = [0.1, 0.2, 0.3, 0.927_361_8];
    let mut value = document(json!([{ "mesh": 0 }, { "mesh": 0 }]));
    let p = [0.1, 0.7, 1.3];
    let spline = [[0.0; 3], p, [0.0; 3], [0.0; 3], p, [0.0; 3]].concat();
    animate(
        &mut value,
        "still",
        &[
            (0, "rotation", "LINEAR", &[0.0, 1.0], &[q, q].concat()),
            (0, "translation", "LINEAR", &[0.0, 1.0], &[p, p].concat()),
            (0, "scale", "LINEAR", &[0.0, 1.0], &[p, p].concat()),
            (1, "translation", "CUBICSPLINE", &[0.0, 1.0], &spline),
        ],
    );
    let scene = read(&value, &[]).unwrap();
    let first = scene.at(0.0).unwrap();
    for k in 1..=100 {
        assert_eq!(scene.at(f64::from(k) / 100.0).unwrap(), first);
    }
}

#[test]
fn animations_are_chosen_by_name_and_played_together() {
    let mut value = document(json!([{ "name": "a", "mesh": 0 }, { "name": "b", "mesh": 0 }]));
    let go = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0];
    animate(
        &mut value,
        "walk",
        &[(0, "translation", "LINEAR", &[0.0, 1.0], &go)],
    );
    animate(
        &mut value,
        "roll",
        &[(1, "translation", "LINEAR", &[0.0, 2.0], &go)],
    );
    let at = |names: &[&str]| {
        let scene = read(&value, names).unwrap();
        ([0, 1].map(|body| corner(&scene, 1.0, body, 0)[0]), scene.end())
    };
    assert_eq!(at(&[]), ([1.0, 0.5], Some(2.0)));
    assert_eq!(at(&["walk"]), ([1.0, 0.0], Some(1.0)));
    assert_eq!(at(&["roll", "walk"]), ([1.0, 0.5], Some(2.0)));
    assert_eq!(at(&["jump"]), ([0.0, 0.0], None));
    animate(
        &mut value,
        "run",
        &[(0, "translation", "LINEAR", &[0.0, 1.0], &go)],
    );
    assert_eq!(
        read(&value, &[]).unwrap_err().to_string(),
        "-: animation run: glTF: the animation walk sets the translation of a as well; choose one of them by its name"
    );
    assert!(read(&value, &["run", "roll"]).is_ok());
    // At rest nothing is played, and nothing is refused.
    assert_eq!(super::gltf::scene(&value).len(), 2);
}

#[test]
fn lists_play_the_animations_of_their_files() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("lid.gltf"), turning()).unwrap();
    let list = json!({ "bodies": [{ "mesh": "lid.gltf" }, { "mesh": "lid.gltf", "name": "high", "at": [0, 0, 5], "scale": 2 }] });
    fs::write(folder.path().join("list.json"), list.to_string()).unwrap();
    let scene = AnimatedScene::read(folder.path().join("list.json"), &["open"]).unwrap();
    assert!(close(corner(&scene, 1.0, 0, 1), [0.0, 1.0, 0.0]));
    assert!(close(corner(&scene, 1.0, 1, 1), [0.0, 2.0, 5.0]));
    let resting = read_scene(folder.path().join("list.json")).unwrap();
    assert_eq!(resting[1].placed().unwrap().vertex(1), [2.0, 0.0, 5.0]);
    assert!(matches!(
        scene.at(f64::NAN),
        Err(Error::Parameter {
            parameter: "seconds",
            ..
        })
    ));
}

#[test]
fn animations_that_cannot_be_played_give_one_clear_error() {
    let say = |change: &dyn Fn(&mut Value), times: &[f32], values: &[f32]| {
        let mut value = document(json!([{ "name": "a", "mesh": 0 }]));
        animate(&mut value, "walk", &[(0, "translation", "LINEAR", times, values)]);
        change(&mut value);
        let played = read(&value, &[]).and_then(|scene| scene.at(0.5));
        let text = played.unwrap_err().to_string();
        assert!(!text.contains('\n'), "{text}");
        text.replace("not a valid glTF file", "invalid")
    };
    let (times, values) = ([0.0, 1.0], [0.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
    let unordered =
        "-: animation walk: invalid: accessor 2: times of keys are finite, not negative, and increase";
    for wrong in [[0.0, f32::NAN], [1.0, 1.0], [-1.0, 1.0], [0.0, f32::INFINITY]] {
        assert_eq!(say(&|_| {}, &wrong, &values), unordered);
    }
    let nan = [0.0, 0.0, f32::NAN, 1.0, 0.0, 0.0];
    assert_eq!(
        say(&|_| {}, &times, &nan),
        "-: animation walk: invalid: accessor 3: a key is not finite"
    );
    assert_eq!(
        say(&|_| {}, &times, &values[..3]),
        "-: animation walk: invalid: accessor 3 has 1 values for 2 keys, which need 1 each"
    );
    type Case<'a> = (&'a dyn Fn(&mut Value), &'a str);
    let cases: [Case<'_>; 13] = [
        (
            &|v| v["animations"][0]["samplers"][0]["input"] = json!(9),
            "-: animation walk: invalid: there is no accessor 9",
        ),
        (
            &|v| v["animations"][0]["samplers"][0]["output"] = json!(2),
            "-: animation walk: invalid: accessor 2 is of type \"SCALAR\", not VEC3",
        ),
        (
            &|v| v["animations"][0]["channels"][0]["sampler"] = json!(1),
            "-: animation walk: invalid: there is no sampler 1",
        ),
        (
            &|v| v["animations"][0]["channels"][0]["target"]["node"] = json!(7),
            "-: animation walk: invalid: there is no node 7",
        ),
        (
            &|v| v["animations"][0]["channels"][0]["target"]["path"] = json!("colour"),
            "-: animation walk: invalid: \"colour\" is no property of a node",
        ),
        (
            &|v| v["animations"][0]["channels"][0]["target"]["path"] = json!("weights"),
            "-: animation walk: glTF: morph targets are not supported, and a has moving ones; apply them before the export",
        ),
        (
            &|v| v["animations"][0]["samplers"][0]["interpolation"] = json!("CUBIC"),
            "-: animation walk: invalid: unknown interpolation \"CUBIC\"",
        ),
        (
            &|v| v["animations"][0]["samplers"][0]["interpolation"] = json!("CUBICSPLINE"),
            "-: animation walk: invalid: accessor 3 has 2 values for 2 keys, which need 3 each",
        ),
        (
            &|v| v["nodes"][0]["matrix"] = json!([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]),
            "a: invalid: an animation moves a node that has a matrix",
        ),
        (
            &|v| {
                let channel = v["animations"][0]["channels"][0].clone();
                v["animations"][0]["channels"]
                    .as_array_mut()
                    .unwrap()
                    .push(channel);
            },
            "-: animation walk: invalid: it sets the translation of a twice",
        ),
        (
            &|v| {
                let input = accessor(v, "SCALAR", &[0.0]);
                let output = accessor(v, "VEC4", &[0.0; 4]);
                v["animations"][0]["samplers"][0] = json!({ "input": input, "output": output });
                v["animations"][0]["channels"][0]["target"]["path"] = json!("rotation");
            },
            "-: animation walk: invalid: a key of a rotation is a quaternion of length 0",
        ),
        (
            // It shrinks to nothing and grows on behind.
            &|v| {
                let output = accessor(v, "VEC3", &[1.0, 1.0, 1.0, -1.0, 1.0, 1.0]);
                v["animations"][0]["samplers"][0]["output"] = json!(output);
                v["animations"][0]["channels"][0]["target"]["path"] = json!("scale");
            },
            "a: scale = [0.0, 1.0, 1.0] is not allowed: finite numbers other than 0",
        ),
        (
            &|v| v["nodes"][0]["skin"] = json!(0),
            "-: a: glTF: skins are not supported; apply the pose before the export",
        ),
    ];
    for (change, expected) in cases {
        assert_eq!(say(change, &times, &values), expected);
    }
    // A channel without a node is passed over.
    let mut value = document(json!([{ "mesh": 0 }]));
    animate(
        &mut value,
        "walk",
        &[(0, "translation", "LINEAR", &times, &values)],
    );
    value["animations"][0]["channels"][0]["target"] = json!({ "path": "translation" });
    assert_eq!(read(&value, &[]).unwrap().end(), None);
}
