//! The nodes of a glTF document: which are in the scene, and where.

use super::animation::{NodeTracks, PlayedAnimations};
use super::document::{Document, NodeObject};
use super::malformed;
use crate::error::Error;
use crate::io::transform::Transform;

/// More nodes are refused.
const MOST_NODES: usize = 500_000;

/// Every node of the scene that has a mesh, with its place in the scene, in the order of a depth-first walk.
pub(super) fn placed(
    document: &Document,
    moment: Option<(&PlayedAnimations, f64)>,
) -> Result<Vec<(usize, Transform)>, Error> {
    walk(document, |index, node| {
        let tracks = moment.and_then(|(motion, time)| Some((motion.of_node(index)?, time)));
        local(node, tracks)
    })
}

/// Every node of the scene that has a mesh, in the same order.
pub(super) fn with_meshes(document: &Document) -> Result<Vec<usize>, Error> {
    let nodes = walk(document, |_, _| Ok(Transform::IDENTITY))?;
    Ok(nodes.into_iter().map(|(index, _)| index).collect())
}

fn walk(
    document: &Document,
    local: impl Fn(usize, &NodeObject) -> Result<Transform, Error>,
) -> Result<Vec<(usize, Transform)>, Error> {
    let nodes = &document.nodes;
    if nodes.len() > MOST_NODES {
        let what = format!("{} nodes; at most {MOST_NODES} are read", nodes.len());
        return Err(Error::unsupported(super::NAME, what));
    }
    check_forest(nodes)?;
    let mut placed = Vec::new();
    let mut open: Vec<(usize, Transform)> = Vec::new();
    for &root in roots(document)?.iter().rev() {
        open.push((root, Transform::IDENTITY));
    }
    while let Some((index, parent)) = open.pop() {
        let node = nodes.get(index).ok_or_else(|| no_node(index))?;
        let transform = local(index, node)
            .and_then(|local| local.then(&parent))
            .map_err(|error| error.in_body(document.node_name(index)))?;
        if node.mesh.is_some() {
            placed.push((index, transform));
        }
        open.extend(node.children.iter().rev().map(|&child| (child, transform)));
        if open.len() + placed.len() > 2 * MOST_NODES {
            return Err(malformed("a scene names a node several times"));
        }
    }
    Ok(placed)
}

/// The roots of the default scene, or of the first one; without scenes all nodes that are no children.
fn roots(document: &Document) -> Result<Vec<usize>, Error> {
    let chosen = document.scene.unwrap_or(0);
    match document.scenes.get(chosen) {
        Some(scene) => {
            let mut roots = scene.nodes.clone();
            roots.sort_unstable();
            roots.dedup();
            match roots.len() == scene.nodes.len() {
                true => Ok(scene.nodes.clone()),
                false => Err(malformed(format!("scene {chosen} names a node twice"))),
            }
        }
        None if document.scenes.is_empty() && document.scene.is_none() => {
            let mut is_child = vec![false; document.nodes.len()];
            for &child in document.nodes.iter().flat_map(|node| &node.children) {
                is_child[child] = true;
            }
            Ok((0..document.nodes.len()).filter(|&k| !is_child[k]).collect())
        }
        None => Err(malformed(format!("there is no scene {chosen}"))),
    }
}

/// Every node must have at most one parent, and none may be its own ancestor.
fn check_forest(nodes: &[NodeObject]) -> Result<(), Error> {
    let mut parent = vec![None; nodes.len()];
    for (index, node) in nodes.iter().enumerate() {
        for &child in &node.children {
            let slot = parent.get_mut(child).ok_or_else(|| no_node(child))?;
            if slot.replace(index).is_some() {
                return Err(malformed(format!("node {child} is a child twice")));
            }
        }
    }
    let mut open: Vec<usize> = (0..nodes.len()).filter(|&k| parent[k].is_none()).collect();
    let mut reached = vec![false; nodes.len()];
    while let Some(index) = open.pop() {
        reached[index] = true;
        open.extend(&nodes[index].children);
    }
    match reached.iter().position(|reached| !reached) {
        None => Ok(()),
        Some(index) => Err(malformed(format!(
            "node {index} is its own ancestor, or below such a node"
        ))),
    }
}

fn no_node(index: usize) -> Error {
    malformed(format!("there is no node {index}"))
}

/// The place of a node relative to its parent; the tracks of an animation replace parts of it.
fn local(node: &NodeObject, tracks: Option<(&NodeTracks, f64)>) -> Result<Transform, Error> {
    let Some(m) = node.matrix else {
        let translation = tracks.and_then(|(tracks, time)| tracks.translation(time));
        let rotation = tracks.and_then(|(tracks, time)| tracks.rotation(time));
        let scale = tracks.and_then(|(tracks, time)| tracks.scale(time));
        let [x, y, z, w] = rotation.or(node.rotation).unwrap_or([0.0, 0.0, 0.0, 1.0]);
        return Transform::new(
            scale.or(node.scale).unwrap_or([1.0; 3]),
            [w, x, y, z],
            translation.or(node.translation).unwrap_or_default(),
        );
    };
    if node.translation.is_some() || node.rotation.is_some() || node.scale.is_some() {
        return Err(malformed("a node has both a matrix and parts of one"));
    }
    if tracks.is_some() {
        return Err(malformed("an animation moves a node that has a matrix"));
    }
    if [m[3], m[7], m[11], m[15]] != [0.0, 0.0, 0.0, 1.0] {
        return Err(malformed("the last row of a matrix is not 0, 0, 0, 1"));
    }
    let linear = [0, 1, 2].map(|row| [m[row], m[4 + row], m[8 + row]]);
    Transform::from_matrix(linear, [m[12], m[13], m[14]])
}
