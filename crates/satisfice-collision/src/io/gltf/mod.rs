//! glTF 2.0: the nodes of a scene that have meshes, as bodies, and the animations that move them.

mod animation;
mod buffers;
mod document;
mod nodes;
mod shapes;

use std::sync::Arc;

use animation::PlayedAnimations;
use buffers::Buffers;
use document::{Document, NodeObject};

use super::animated::{Frames, Play};
use super::format::{Format, Reader};
use super::scene::PlacedMesh;
use super::source::Folder;
use super::text::without_mark;
use super::transform::Instances;
use crate::error::Error;
use crate::mesh::Mesh;

const NAME: &str = "glTF";
const MAGIC: &[u8] = b"glTF";
const JSON: &[u8] = b"JSON";
const BINARY: &[u8] = b"BIN\0";
/// Extensions that a file may require because they leave positions and placements alone.
const HARMLESS: [&str; 6] = [
    "KHR_materials_",
    "KHR_texture_",
    "EXT_texture_",
    "KHR_lights_",
    "EXT_lights_",
    "KHR_mesh_quantization",
];

pub(super) const FORMAT: Format = Format {
    name: "gltf",
    extensions: &["gltf", "glb"],
    summary: "glTF 2.0: nodes with meshes become bodies; instances share a mesh; animations move them",
    reader: Reader::Scene(parse),
};

fn malformed(reason: impl std::fmt::Display) -> Error {
    Error::malformed(NAME, reason)
}

fn parse(bytes: &[u8], folder: &Folder, play: Play<'_>) -> Result<Box<dyn Frames>, Error> {
    let (text, binary) = if bytes.starts_with(MAGIC) {
        let (text, binary) = container(bytes)?;
        (text, binary)
    } else {
        (without_mark(NAME, bytes)?, None)
    };
    let mut document: Document = serde_json::from_slice(text).map_err(malformed)?;
    check(&document)?;
    let mut buffers = Buffers::new(&document, folder, binary);
    let mut meshes: Vec<Option<Option<Arc<Mesh>>>> = document.meshes.iter().map(|_| None).collect();
    for index in nodes::with_meshes(&document)? {
        read_mesh(&document, &document.nodes[index], &mut buffers, &mut meshes)
            .map_err(|error| error.in_body(document.node_name(index)))?;
    }
    let motion = PlayedAnimations::read(&document, &mut buffers, play)?;
    // They may hold the data of the file as text.
    document.buffers.clear();
    Ok(Box::new(Scene {
        document,
        meshes: meshes.into_iter().map(Option::flatten).collect(),
        motion,
    }))
}

/// The JSON and the binary chunk of a `.glb` file.
fn container(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), Error> {
    let word = |at: usize| {
        let bytes = bytes.get(at..).and_then(<[u8]>::first_chunk);
        bytes.map(|word| u32::from_le_bytes(*word))
    };
    let too_short = || malformed("the file ends too early");
    match word(4).ok_or_else(too_short)? {
        2 => {}
        version => {
            return Err(Error::unsupported(
                NAME,
                format!("version {version} of .glb is not supported, only version 2"),
            ));
        }
    }
    let announced = word(8).ok_or_else(too_short)? as usize;
    if announced != bytes.len() {
        let has = bytes.len();
        return Err(malformed(format!("it announces {announced} bytes but has {has}")));
    }
    let mut chunks: [Option<&[u8]>; 2] = [None; 2];
    let mut at = 12;
    while at < bytes.len() {
        let length = word(at).ok_or_else(too_short)? as usize;
        let kind = bytes.get(at + 4..at + 8).ok_or_else(too_short)?;
        let chunk = bytes
            .get(at + 8..)
            .and_then(|rest| rest.get(..length))
            .ok_or_else(too_short)?;
        for (slot, name) in chunks.iter_mut().zip([JSON, BINARY]) {
            if name == kind && slot.is_none() {
                *slot = Some(chunk);
            }
        }
        at += 8 + length;
    }
    let text = chunks[0].ok_or_else(|| malformed("it has no JSON chunk"))?;
    Ok((text, chunks[1]))
}

/// Refuses what would change the geometry if it were passed over.
fn check(document: &Document) -> Result<(), Error> {
    let version = &document.asset.version;
    if !version.starts_with("2.") {
        return Err(Error::unsupported(
            NAME,
            format!("version {version:?} is not supported, only 2.0"),
        ));
    }
    let required = document.extensions_required.iter();
    let instancing = |name: &&String| *name == "EXT_mesh_gpu_instancing";
    let mut refused = required
        .filter(|name| !HARMLESS.iter().any(|harmless| name.starts_with(harmless)))
        .chain(document.extensions_used.iter().filter(instancing));
    match refused.next() {
        None => Ok(()),
        Some(name) => Err(Error::unsupported(
            NAME,
            format!("the extension {name:?} is not supported; export without it"),
        )),
    }
}

/// Reads the mesh of a node if it has not been read for another one: `None` inside for a mesh without vertices.
fn read_mesh(
    document: &Document,
    node: &NodeObject,
    buffers: &mut Buffers<'_>,
    meshes: &mut [Option<Option<Arc<Mesh>>>],
) -> Result<(), Error> {
    let Some(index) = node.mesh else {
        return Ok(());
    };
    let mesh = document.meshes.get(index);
    let mesh = mesh.ok_or_else(|| malformed(format!("there is no mesh {index}")))?;
    if node.skin.is_some() {
        return Err(Error::unsupported(
            NAME,
            "skins are not supported; apply the pose before the export",
        ));
    }
    if node
        .weights
        .iter()
        .chain(&mesh.weights)
        .any(|weight| *weight != 0.0)
    {
        return Err(Error::unsupported(
            NAME,
            "morph targets are not supported; apply them before the export",
        ));
    }
    if meshes[index].is_none() {
        meshes[index] = Some(shapes::body(mesh, buffers)?.map(Arc::new));
    }
    Ok(())
}

struct Scene {
    document: Document,
    /// `None` for those that the scene does not use, and those without vertices.
    meshes: Vec<Option<Arc<Mesh>>>,
    motion: PlayedAnimations,
}

impl Frames for Scene {
    fn animations(&self) -> Vec<String> {
        (0..self.document.animations.len())
            .map(|index| self.document.animation_name(index))
            .collect()
    }

    fn end(&self) -> Option<f64> {
        self.motion.end
    }

    fn at(&self, seconds: Option<f64>) -> Result<Vec<PlacedMesh>, Error> {
        let moment = seconds.map(|seconds| (&self.motion, seconds));
        let mut instances = Instances::default();
        let mut bodies = Vec::new();
        for (index, transform) in nodes::placed(&self.document, moment)? {
            let mesh = self.document.nodes[index].mesh;
            let Some(shape) = mesh.and_then(|mesh| self.meshes[mesh].as_ref()) else {
                continue;
            };
            let name = self.document.node_name(index);
            let (mesh, placement) = instances
                .instance(shape, &transform)
                .map_err(|error| error.in_body(name.clone()))?;
            bodies.push(PlacedMesh {
                name,
                mesh,
                placement,
            });
        }
        Ok(bodies)
    }
}
