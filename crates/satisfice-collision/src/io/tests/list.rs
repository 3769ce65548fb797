//! Tests of lists of meshes.

use std::fs;
use std::sync::Arc;

use super::SQUARE;
use crate::Mesh;
use crate::io::{AnimatedScene, Format, read_scene, save_obj};

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let square = Mesh::new(SQUARE.to_vec(), vec![], vec![[0, 1, 2], [0, 2, 3]]).unwrap();
    save_obj(&square, folder.path().join("square.obj")).unwrap();
    folder
}

#[test]
fn lists_in_json_and_toml_name_and_place_meshes() {
    let folder = folder();
    let toml = "[[bodies]]\nmesh = \"square.obj\"\n\n[[bodies]]\nmesh = \"square.obj\"\nname = \"big\"\nat = [1, 2.5, 3]\n\
                rotate = [0, 0, 90]\nscale = 2\n\n[[bodies]]\nmesh = \"square.obj\"\nat = [9, 0, 0]\n";
    let json = r#"{"bodies": [
        {"mesh": "square.obj"},
        {"mesh": "square.obj", "name": "big", "at": [1, 2.5, 3], "rotate": [0, 0, 90], "scale": 2},
        {"mesh": "square.obj", "at": [9, 0, 0]}
    ]}"#;
    for (name, text) in [("scene.toml", toml), ("scene.json", json)] {
        let path = folder.path().join(name);
        fs::write(&path, text).unwrap();
        let bodies = read_scene(&path).unwrap();
        let names: Vec<&str> = bodies.iter().map(|body| body.name.as_str()).collect();
        assert_eq!(names, ["square", "big", "square.2"]);
        assert!(Arc::ptr_eq(&bodies[0].mesh, &bodies[2].mesh));
        assert_eq!(bodies[0].placed().unwrap().vertices(), SQUARE);
        let [x, y, z] = bodies[1].placed().unwrap().vertex(1);
        assert!(
            (x - 1.0).abs() < 1e-15 && (y - 4.5).abs() < 1e-15 && z == 3.0,
            "{x} {y} {z}"
        );
        assert_eq!(bodies[2].placed().unwrap().vertex(2), [10.0, 1.0, 0.0]);
    }
}

#[test]
fn list_errors_name_the_body() {
    let folder = folder();
    let say = |name: &str, text: &str| {
        let path = folder.path().join(name);
        fs::write(&path, text).unwrap();
        let error = read_scene(&path).unwrap_err().to_string();
        assert!(!error.contains('\n'), "{error}");
        error.replace(&format!("{}/", folder.path().display()), "")
    };
    assert_eq!(
        say("a.json", r#"{"bodies": [{"mesh": "square.obj", "scale": 0}]}"#),
        "a.json: body 0: scale = [0.0, 0.0, 0.0] is not allowed: finite numbers other than 0"
    );
    assert!(
        say("a.json", r#"{"bodies": [{"mesh": "none.obj"}]}"#).starts_with("a.json: cannot read none.obj: ")
    );
    assert_eq!(
        say("a.json", r#"{"bodies": [{"mesh": "a.json"}]}"#),
        "a.json: list of meshes: a list within a list is not supported"
    );
    assert!(say("a.json", r#"{"bodies": [{"mash": "a.obj"}]}"#).contains("unknown field `mash`"));
    assert!(say("a.json", "[]").starts_with("a.json: not a valid list of meshes file: "));
    let error = say("a.toml", "[[bodies]]\nmesh = \"square.obj\"\nat = [1, 2]\n");
    assert!(
        error.starts_with("a.toml: line 3: not a valid list of meshes file: "),
        "{error}"
    );
    assert!(say("a.toml", "[[bodies]]\nmesh = 3\n").contains("line 2"));
}

#[test]
fn a_scene_tells_every_file_that_it_was_read_from() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("triangle.bin"), super::gltf::data()).unwrap();
    let mut document = super::gltf::document(serde_json::json!([{ "mesh": 0 }]));
    document["buffers"][0]["uri"] = "triangle.bin".into();
    fs::write(at("node.gltf"), document.to_string()).unwrap();
    let list = r#"{"bodies": [{"mesh": "square.obj"}, {"mesh": "node.gltf"}, {"mesh": "square.obj"}]}"#;
    fs::write(at("list.json"), list).unwrap();
    let names = ["list.json", "square.obj", "node.gltf", "triangle.bin"].map(at);
    assert_eq!(AnimatedScene::read_resting(&names[0]).unwrap().files(), names);
    assert_eq!(AnimatedScene::read(&names[2], &[]).unwrap().files(), &names[2..]);
    let stream =
        AnimatedScene::read_resting_from(list.as_bytes(), Format::named("json").unwrap(), "", folder.path());
    assert_eq!(stream.unwrap().files(), &names[1..]);
}
