//! The options of `satisfice collide`.

use std::path::PathBuf;

use anyhow::{Context, bail};
use clap::{Args, ValueEnum, ValueHint};
use satisfice::StopReason;

use super::inputs::{self, At};
use crate::arguments::SearchArguments;
use crate::quantity;

/// Find the pairs of mesh features that are closer than a threshold.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  satisfice collide left.obj right.ply --threshold 0.01
      All pairs of vertices, one of each mesh, with a distance below 0.01 in the unit of the meshes.
  satisfice collide A.obj B.obj --threshold 0.01 \\
          --pairs triangle-triangle --json - --picture contacts.png
      All pairs of triangles (distance 0 where they intersect) as JSON on stdout, and a picture of them.
  satisfice collide cloth.ply --self --pairs edge-edge --ring-width 1 \\
          --threshold 0.005 --out pairs.csv
      Pairs of edges of one mesh; edges that share a vertex, or that a third edge joins, are no pairs.
  satisfice collide a.stl b.stl --threshold 0.5 --method latest-hit-qpso \\
          --time 100ms --json -
      As many pairs as a search engine finds in 100 ms, and what share of all that is.
  satisfice collide *.obj --threshold 0.1 --pairs triangle-triangle --touching
      Only which bodies touch, with one pair of triangles that shows it for each pair of bodies.
  satisfice collide a.obj b.obj --closest 1 --pairs triangle-triangle \\
          --witnesses
      How far apart two bodies are, and where.
  satisfice collide housing.stl part.stl --solid --threshold 0.1 \\
          --pairs triangle-triangle
      Also whether one body lies inside the other, how deep they overlap, and along which way they come apart.
  satisfice collide factory.glb --threshold 0.01 \\
          --pairs triangle-triangle --touching
      Which nodes of a scene touch, by their names.
  satisfice collide --from cloth92.ply --to cloth93.ply --self \\
          --threshold 0 --out impacts.csv
      What touches while every vertex moves along a straight line from the one frame to the other, the earliest impact first.
  satisfice collide --from robot0.glb wall.stl --to robot1.glb wall.stl \\
          --threshold 0.01 --first --time 10ms
      The earliest time at which two bodies are closer than 0.01, with bounds; proved, or what is known after 10 ms.
  satisfice collide robot.glb hall.stl --from 0.5s --to 0.6s \\
          --threshold 0.01 --pairs edge-edge
      The same between two times of a glTF animation; choose small steps, since vertices move straight from one time to the other.
  curl example.com/scan.ply.gz | satisfice collide - tool.stl \\
          --format ply --at tool:0,0,12.5,90,0,0 --threshold 0.2
      A mesh from standard input, and another one turned about x and lifted.

Meshes are .obj, .ply, .stl and .off files; scenes are .gltf and .glb files (a body for each node with a mesh) and lists of meshes:
  [[bodies]]                 # or in JSON: {\"bodies\": [{\"mesh\": \"arm.obj\", ...}]}
  mesh = \"arm.obj\"           # relative to the list
  name = \"left arm\"
  at = [0, 0, 2.5]           # also rotate = [degrees about x, then y, then z] and scale = 2
All may be compressed (.gz). Features are numbered from 0: vertices and triangles as in the file, edges in the order of their lower, then their higher vertex. `Touch` means: features of the kind of --pairs closer than the threshold; a body inside another touches nothing unless --solid is given. Ctrl-C keeps the pairs found so far.

Exit codes: 0 a pair was found (with --solid, or bodies that overlap), 1 none was (for certain if `answer` is Proved), 2 an error.")]
pub(crate) struct CollideArguments {
    /// Files of meshes or scenes: .obj, .ply, .stl, .off, .gltf, .glb, .json or .toml; `-` is standard input.
    #[arg(value_name = "MESH", required_unless_present = "from", value_hint = ValueHint::FilePath)]
    pub(crate) meshes: Vec<PathBuf>,

    /// The bodies at the start of a step: find what comes near while they move. May be repeated or take several files. Or, for
    /// MESHes with glTF animations, a time from their start, e.g. 0.5s; MESHes without one rest.
    #[arg(long, value_name = "MESH|TIME", num_args = 1.., requires = "to", value_hint = ValueHint::FilePath)]
    pub(crate) from: Vec<PathBuf>,

    /// The same bodies, in the same order, at the end of the step. Every vertex moves along a straight line at constant speed;
    /// times are parts of the step, from 0 to 1. Or a time of the animations, at most that of their last key; one before --from
    /// plays them backwards.
    #[arg(long, value_name = "MESH|TIME", num_args = 1.., requires = "from", value_hint = ValueHint::FilePath)]
    pub(crate) to: Vec<PathBuf>,

    /// Play this animation, by its name, or its number from 0 if it has none. May be repeated [default: all of the files; two that
    /// set the same property of a node are an error].
    #[arg(long, value_name = "NAME", requires = "from")]
    pub(crate) animation: Vec<String>,

    /// The format of standard input: obj, ply, stl, off, gltf, json or toml.
    #[arg(long, value_name = "FORMAT")]
    pub(crate) format: Option<String>,

    /// Place a body: scale it about the origin, turn it about x, then y, then z by degrees, and move it. BODY is a number
    /// from 0 or a name, which is that of the file without its extension. May be repeated.
    /// A body of a list or of a scene is first where that places it.
    #[arg(long, value_name = "BODY:x,y,z[,rx,ry,rz[,scale]]", value_parser = inputs::at, allow_hyphen_values = true)]
    pub(crate) at: Vec<At>,

    /// Join vertices of a body that are equal or closer than D, in the unit of the meshes, so that seams make no pairs
    /// within it. Vertices are then renumbered in the order of the file.
    #[arg(long, value_name = "D", value_parser = quantity::not_negative, allow_hyphen_values = true)]
    pub(crate) weld: Option<f64>,

    /// A pair is found if its distance is below this, in the unit of the meshes. With --from, below it at some time of the step;
    /// 0 then asks for pairs that touch.
    /// --closest needs none.
    #[arg(long, value_name = "D", required_unless_present = "closest", value_parser = quantity::not_negative, allow_hyphen_values = true)]
    threshold: Option<f64>,

    /// Which features make pairs [default: vertex-vertex; with --from all in which the bodies first meet, which for surfaces are
    /// vertex-triangle and edge-edge]. With --from not edge-triangle and triangle-triangle: surfaces first meet in pairs of the other
    /// kinds.
    #[arg(long, value_name = "KIND")]
    pub(crate) pairs: Option<PairKind>,

    /// Look for pairs within each mesh as well, except features that share a vertex, and vertices that an edge joins (--ring-width).
    #[arg(long = "self")]
    pub(crate) within: bool,

    /// Within a mesh, leave out features with two vertices at most K edges apart
    /// [default: 1 for vertex-vertex, otherwise 0].
    #[arg(long, value_name = "K", value_parser = quantity::width, requires = "within", allow_hyphen_values = true)]
    pub(crate) ring_width: Option<usize>,

    /// Take bodies as solids, with all that their surfaces enclose: also say which lie inside others, and how deep bodies
    /// overlap: how far one has to be moved until no point of one is inside the other. Meshes must be closed.
    #[arg(long, conflicts_with = "from")]
    pub(crate) solid: bool,

    #[command(flatten)]
    pub(crate) find: FindArguments,

    /// `exact` finds every pair by the cheapest method; `tree`, `grid` (vertices only) and `brute-force` use that one;
    /// an engine, by its name, searches until the budget ends.
    #[arg(long, value_name = "exact|ENGINE", default_value = "exact")]
    pub(crate) method: String,

    /// Keep an engine out of regions that bounds (boxes around the features) prove to be without pairs.
    #[arg(long)]
    pub(crate) prune: bool,

    #[command(flatten)]
    pub(crate) search: SearchArguments,

    /// List at most N pairs. All are counted, in memory that does not grow with them.
    #[arg(long, value_name = "N", default_value = "10000000", value_parser = quantity::count, allow_hyphen_values = true)]
    pub(crate) max_pairs: u64,

    /// Report the closest points of each pair, the normal from a to b (none where they meet), and the corner, edge or face
    /// they are on. With --from, points and normals, also from a to b, are always reported.
    #[arg(long)]
    pub(crate) witnesses: bool,

    /// Write the report as JSON; `-` is stdout and replaces the summary. Its `answer` says whether what was asked for is proved,
    /// `completeness` whether all pairs are listed.
    #[arg(long, value_name = "FILE|-", value_hint = ValueHint::FilePath)]
    pub(crate) json: Option<PathBuf>,

    /// Write the pairs as CSV, whatever the file is called; `-` is stdout and replaces the summary. Columns are body and feature of a,
    /// body and feature of b, distance; then what --witnesses adds, and names of bodies if a file holds several.
    #[arg(long, value_name = "FILE|-", value_hint = ValueHint::FilePath)]
    pub(crate) out: Option<PathBuf>,

    /// Draw the bodies with the pairs marked where they are closest, and their triangles highlighted. Not with --from: --page shows
    /// bodies that move.
    #[arg(long, value_name = "FILE.png", value_hint = ValueHint::FilePath)]
    pub(crate) picture: Option<PathBuf>,

    /// Write a page to look into: the bodies and pairs in three dimensions, in the order found, as one file that works offline.
    #[arg(long, value_name = "FILE.html", value_hint = ValueHint::FilePath)]
    pub(crate) page: Option<PathBuf>,

    /// Which axis points upwards in the picture and the page [default: y, or z if the first mesh is an STL file].
    #[arg(long, value_name = "AXIS")]
    pub(crate) up: Option<Axis>,
}

impl CollideArguments {
    /// The threshold; infinite without one.
    pub(super) fn threshold(&self) -> f64 {
        self.threshold.unwrap_or(f64::INFINITY)
    }

    /// The kind of pairs of bodies at rest.
    pub(super) fn pairs_at_rest(&self) -> PairKind {
        self.pairs.unwrap_or(PairKind::VertexVertex)
    }
}

/// An axis of the world.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Axis {
    /// The first coordinate.
    X,
    /// The second.
    Y,
    /// The third.
    Z,
}

/// What is asked for instead of all pairs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Args)]
#[group(multiple = false)]
pub(crate) struct FindArguments {
    /// Only which bodies touch (have a pair of the kind of --pairs; triangle-triangle for surfaces): stop at the first pair of each two bodies. Not with --from.
    #[arg(long)]
    touching: bool,

    /// Stop at the first pair of all; with --from, find the earliest impact.
    #[arg(long)]
    first: bool,

    /// Only the K closest pairs, nearest first; at any distance, unless --threshold limits it. Not with --from.
    #[arg(long, value_name = "K", value_parser = quantity::count, allow_hyphen_values = true)]
    closest: Option<u64>,
}

/// What is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Find {
    All,
    Touching,
    First,
    Closest(u64),
}

impl FindArguments {
    pub(crate) fn find(self) -> Find {
        match self {
            Self { closest: Some(k), .. } => Find::Closest(k),
            Self { touching: true, .. } => Find::Touching,
            Self { first: true, .. } => Find::First,
            _ => Find::All,
        }
    }
}

impl Find {
    /// How a report calls it.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::All => "all",
            Self::Touching => "touching",
            Self::First => "first",
            Self::Closest(_) => "closest",
        }
    }

    /// The question that a report calls so; `closest` is the number of closest pairs.
    pub(super) fn of_name(name: &str, closest: Option<u64>) -> anyhow::Result<Self> {
        Ok(match name {
            "all" => Self::All,
            "touching" => Self::Touching,
            "first" => Self::First,
            "closest" => Self::Closest(closest.context("it has no number `closest`")?),
            _ => bail!("`find` is none of all, touching, first and closest"),
        })
    }

    /// Whether so many pairs of an exact method answer the question for certain; `complete` if they are all pairs.
    pub(super) fn is_answered(self, pairs: u64, complete: bool, stop: StopReason) -> bool {
        complete
            || match self {
                Self::All => false,
                Self::First => pairs > 0,
                Self::Touching | Self::Closest(_) => {
                    !matches!(stop, StopReason::Cancelled | StopReason::Time)
                }
            }
    }
}

/// The kinds of pairs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum PairKind {
    /// Two vertices.
    VertexVertex,
    /// A vertex of one, an edge of the other.
    VertexEdge,
    /// A vertex of one, a triangle of the other.
    VertexTriangle,
    /// Two edges.
    EdgeEdge,
    /// An edge of one, a triangle of the other.
    EdgeTriangle,
    /// Two triangles.
    TriangleTriangle,
}

impl From<PairKind> for satisfice_collision::distance::PairKind {
    fn from(kind: PairKind) -> Self {
        match kind {
            PairKind::VertexVertex => Self::VertexVertex,
            PairKind::VertexEdge => Self::VertexEdge,
            PairKind::VertexTriangle => Self::VertexTriangle,
            PairKind::EdgeEdge => Self::EdgeEdge,
            PairKind::EdgeTriangle => Self::EdgeTriangle,
            PairKind::TriangleTriangle => Self::TriangleTriangle,
        }
    }
}
