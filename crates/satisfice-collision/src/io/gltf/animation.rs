//! Animations of a glTF document: keys of the translation, rotation and scale of nodes.

use std::collections::BTreeMap;

use super::buffers::Buffers;
use super::document::{self, Document};
use super::{NAME, malformed};
use crate::error::Error;
use crate::io::animated::Play;

/// What the chosen animations do to the nodes.
#[derive(Default)]
pub(super) struct PlayedAnimations {
    nodes: BTreeMap<usize, NodeTracks>,
    /// The time of the last key.
    pub(super) end: Option<f64>,
}

/// The properties of a node that move, each with the number of the animation that moves it.
#[derive(Default)]
pub(super) struct NodeTracks {
    pub(super) translation: Option<(usize, Track<3>)>,
    /// Quaternions x, y, z, w.
    pub(super) rotation: Option<(usize, Track<4>)>,
    pub(super) scale: Option<(usize, Track<3>)>,
}

/// The values of a property at increasing times.
pub(super) struct Track<const N: usize> {
    times: Vec<f64>,
    /// One for each time; three for cubic splines: the slope before the key, its value, the slope behind it.
    values: Vec<[f64; N]>,
    interpolation: Interpolation,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Interpolation {
    Linear,
    Step,
    CubicSpline,
}

impl PlayedAnimations {
    pub(super) fn read(
        document: &Document,
        buffers: &mut Buffers<'_>,
        play: Play<'_>,
    ) -> Result<Self, Error> {
        let mut motion = Self::default();
        for (index, animation) in document.animations.iter().enumerate() {
            let name = document.animation_name(index);
            if play.has(&name) {
                for channel in &animation.channels {
                    motion
                        .add(document, buffers, index, channel)
                        .map_err(|error| error.in_body(format!("animation {name}")))?;
                }
            }
        }
        Ok(motion)
    }

    pub(super) fn of_node(&self, node: usize) -> Option<&NodeTracks> {
        self.nodes.get(&node)
    }

    fn add(
        &mut self,
        document: &Document,
        buffers: &mut Buffers<'_>,
        index: usize,
        channel: &document::Channel,
    ) -> Result<(), Error> {
        let unsupported = |what: String| Err(Error::unsupported(NAME, what));
        let path = channel.target.path.as_str();
        if path == "pointer" {
            return unsupported("animations by pointers are not supported; export without them".to_owned());
        }
        // The format lets players pass over a channel without a node.
        let Some(node) = channel.target.node else {
            return Ok(());
        };
        if node >= document.nodes.len() {
            return Err(malformed(format!("there is no node {node}")));
        }
        let animation = &document.animations[index];
        let sampler = animation.samplers.get(channel.sampler);
        let sampler = sampler.ok_or_else(|| malformed(format!("there is no sampler {}", channel.sampler)))?;
        let tracks = self.nodes.entry(node).or_default();
        let (before, last) = match path {
            "translation" => Track::put(&mut tracks.translation, index, sampler, buffers)?,
            "scale" => Track::put(&mut tracks.scale, index, sampler, buffers)?,
            "rotation" => {
                let put = Track::put(&mut tracks.rotation, index, sampler, buffers)?;
                if tracks
                    .rotation
                    .as_ref()
                    .is_some_and(|(_, track)| track.has_zero())
                {
                    return Err(malformed("a key of a rotation is a quaternion of length 0"));
                }
                put
            }
            "weights" => {
                let node = document.node_name(node);
                return unsupported(format!(
                    "morph targets are not supported, and {node} has moving ones; apply them before the export"
                ));
            }
            other => return Err(malformed(format!("{other:?} is no property of a node"))),
        };
        let node = document.node_name(node);
        match before {
            Some(before) if before == index => {
                return Err(malformed(format!("it sets the {path} of {node} twice")));
            }
            Some(before) => {
                let before = document.animation_name(before);
                return unsupported(format!(
                    "the animation {before} sets the {path} of {node} as well; choose one of them by its name"
                ));
            }
            None => {}
        }
        self.end = Some(self.end.map_or(last, |end| end.max(last)));
        Ok(())
    }
}

impl<const N: usize> Track<N> {
    /// Puts the track of a sampler into its place; returns the animation that has taken it before, and the time of the last key.
    fn put(
        slot: &mut Option<(usize, Self)>,
        animation: usize,
        sampler: &document::Sampler,
        buffers: &mut Buffers<'_>,
    ) -> Result<(Option<usize>, f64), Error> {
        let track = Self::read(sampler, buffers)?;
        let last = track.times.last().copied().unwrap_or_default();
        let before = slot.replace((animation, track));
        Ok((before.map(|(animation, _)| animation), last))
    }

    fn read(sampler: &document::Sampler, buffers: &mut Buffers<'_>) -> Result<Self, Error> {
        let interpolation = match sampler.interpolation.as_deref() {
            None | Some("LINEAR") => Interpolation::Linear,
            Some("STEP") => Interpolation::Step,
            Some("CUBICSPLINE") => Interpolation::CubicSpline,
            Some(other) => return Err(malformed(format!("unknown interpolation {other:?}"))),
        };
        let times: Vec<f64> = buffers.vectors::<1>(sampler.input)?.concat();
        let values = buffers.vectors::<N>(sampler.output)?;
        let (input, output) = (sampler.input, sampler.output);
        if times.is_empty() {
            return Err(malformed(format!("accessor {input} has no times of keys")));
        }
        let is_ordered = times.is_sorted_by(|a, b| a < b);
        if !is_ordered || !times.iter().all(|time| time.is_finite() && *time >= 0.0) {
            return Err(malformed(format!(
                "accessor {input}: times of keys are finite, not negative, and increase"
            )));
        }
        let each = if interpolation == Interpolation::CubicSpline {
            3
        } else {
            1
        };
        if values.len() != each * times.len() {
            let (keys, values) = (times.len(), values.len());
            return Err(malformed(format!(
                "accessor {output} has {values} values for {keys} keys, which need {each} each"
            )));
        }
        if !values.as_flattened().iter().all(|value| value.is_finite()) {
            return Err(malformed(format!("accessor {output}: a key is not finite")));
        }
        Ok(Self {
            times,
            values,
            interpolation,
        })
    }

    /// The value at a time; `between` says what lies between two keys of linear interpolation.
    fn at(&self, time: f64, between: fn([f64; N], [f64; N], f64) -> [f64; N]) -> [f64; N] {
        let next = self.times.partition_point(|key| *key <= time);
        let last = self.times.len() - 1;
        if next == 0 || next > last {
            return self.key(if next == 0 { 0 } else { last });
        }
        let (k, span) = (next - 1, self.times[next] - self.times[next - 1]);
        let u = (time - self.times[k]) / span;
        let (from, to) = (self.key(k), self.key(next));
        match self.interpolation {
            Interpolation::Step => from,
            Interpolation::Linear => between(from, to, u),
            Interpolation::CubicSpline => {
                let (leaving, arriving) = (self.values[3 * k + 2], self.values[3 * next]);
                // Equal keys without slopes give their value without rounding, so that what rests does not tremble.
                std::array::from_fn(|i| {
                    let slopes = u * (1.0 - u) * ((1.0 - u) * leaving[i] - u * arriving[i]);
                    from[i] + u * u * (3.0 - 2.0 * u) * (to[i] - from[i]) + span * slopes
                })
            }
        }
    }

    fn key(&self, key: usize) -> [f64; N] {
        match self.interpolation {
            Interpolation::CubicSpline => self.values[3 * key + 1],
            _ => self.values[key],
        }
    }

    fn has_zero(&self) -> bool {
        (0..self.times.len()).any(|key| self.key(key) == [0.0; N])
    }
}

impl NodeTracks {
    pub(super) fn translation(&self, time: f64) -> Option<[f64; 3]> {
        self.translation
            .as_ref()
            .map(|(_, track)| track.at(time, straight))
    }

    pub(super) fn rotation(&self, time: f64) -> Option<[f64; 4]> {
        self.rotation.as_ref().map(|(_, track)| track.at(time, turned))
    }

    pub(super) fn scale(&self, time: f64) -> Option<[f64; 3]> {
        self.scale.as_ref().map(|(_, track)| track.at(time, straight))
    }
}

fn straight<const N: usize>(a: [f64; N], b: [f64; N], u: f64) -> [f64; N] {
    std::array::from_fn(|i| a[i] + u * (b[i] - a[i]))
}

/// The shorter way from one rotation to another at constant speed (Shoemake 1985, <https://doi.org/10.1145/325165.325242>).
fn turned(a: [f64; 4], b: [f64; 4], u: f64) -> [f64; 4] {
    if a == b {
        return a;
    }
    let length = |q: [f64; 4]| q.iter().map(|c| c * c).sum::<f64>().sqrt();
    let unit = |q: [f64; 4]| q.map(|c| c / length(q));
    let (a, mut b) = (unit(a), unit(b));
    if a.iter().zip(&b).map(|(p, q)| p * q).sum::<f64>() < 0.0 {
        b = b.map(|c| -c);
    }
    let apart = length(std::array::from_fn(|i| a[i] - b[i]));
    let angle = 2.0 * apart.atan2(length(std::array::from_fn(|i| a[i] + b[i])));
    if angle == 0.0 {
        return a;
    }
    let (p, q) = (((1.0 - u) * angle).sin(), (u * angle).sin());
    std::array::from_fn(|i| (p * a[i] + q * b[i]) / angle.sin())
}
