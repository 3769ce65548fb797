//! The two ends of a step: files of bodies at each, or two times of animations.

use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use satisfice_catalogue::{Settings, quantity};
use satisfice_collision::io::AnimatedScene;
use serde_json::{Value, json};

use super::super::arguments::CollideArguments;
use super::super::body::NamedBody;
use super::super::inputs::{self, Inputs};
use super::bent::bent;

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Ends {
    /// The bodies at each end.
    Files { from: Inputs, to: Inputs },
    /// The bodies of the same files at two times.
    Times(Times),
}

/// A part of animations.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Times {
    inputs: Inputs,
    /// From the start of the animations.
    pub(super) seconds: [f64; 2],
    /// Their names; all if there is none.
    animations: Vec<String>,
}

/// What both ends are read to.
pub(super) struct EndsRead {
    /// At the start and at the end.
    pub(super) bodies: [Vec<NamedBody>; 2],
    /// Every file that was read for them.
    pub(super) files: Vec<PathBuf>,
    /// What is to be said if bodies do not move straight from the one end to the other.
    pub(super) bent: Option<String>,
}

impl Times {
    /// The time of the animations at a part of the step, in seconds.
    pub(super) fn at(&self, part: f64) -> f64 {
        let [from, to] = self.seconds;
        from * (1.0 - part) + to * part
    }
}

impl Ends {
    pub(super) fn of_arguments(arguments: &CollideArguments) -> anyhow::Result<Self> {
        let CollideArguments { from, to, .. } = arguments;
        let inputs = |paths: Vec<PathBuf>| Inputs {
            paths,
            format: arguments.format.clone(),
            at: arguments.at.clone(),
            weld: None,
        };
        let (from_times, from_files) = parted(from)?;
        let (to_times, to_files) = parted(to)?;
        match (&from_times[..], &to_times[..]) {
            (&[from], &[to]) => Ok(Self::Times(Times {
                inputs: inputs([arguments.meshes.clone(), from_files, to_files].concat()),
                seconds: [from, to],
                animations: arguments.animation.clone(),
            })),
            ([], []) if !arguments.meshes.is_empty() => bail!(
                "--from and --to name the bodies at both ends of a step, or two times of the animation of the meshes named before, e.g. --from 0.5s --to 0.6s"
            ),
            ([], []) if !arguments.animation.is_empty() => {
                bail!("--animation needs two times of it: --from and --to, e.g. --from 0.5s --to 0.6s")
            }
            ([], []) => Ok(Self::Files {
                from: inputs(from_files),
                to: inputs(to_files),
            }),
            _ => bail!(
                "--from and --to take one time each, e.g. --from 0.5s --to 0.6s, or the bodies at each end"
            ),
        }
    }

    pub(super) fn of_settings(settings: &Settings) -> anyhow::Result<Self> {
        let value = |name: &str| settings.get(name).cloned().unwrap_or(Value::Null);
        let inputs = |name: &str| -> anyhow::Result<Inputs> {
            let inputs = Inputs {
                paths: serde_json::from_value(value(name))
                    .with_context(|| format!("`{name}` is no list of files"))?,
                at: serde_json::from_value::<Option<_>>(value("at"))
                    .context("`at` is no list of placements")?
                    .unwrap_or_default(),
                ..Inputs::default()
            };
            if inputs.reads_stdin() {
                bail!("a mesh was read from standard input, which cannot be read again");
            }
            Ok(inputs)
        };
        let (Some(from), Some(to)) = (value("from").as_f64(), value("to").as_f64()) else {
            return Ok(Self::Files {
                from: inputs("from")?,
                to: inputs("to")?,
            });
        };
        Ok(Self::Times(Times {
            inputs: inputs("meshes")?,
            seconds: [from, to],
            animations: serde_json::from_value::<Option<_>>(value("animations"))
                .context("`animations` is no list of names")?
                .unwrap_or_default(),
        }))
    }

    /// What a report repeats.
    pub(super) fn describe(&self, settings: &mut Settings) {
        let files = |paths: &[PathBuf]| -> Vec<Value> {
            paths.iter().map(|path| path.to_string_lossy().into()).collect()
        };
        let at = match self {
            Self::Files { from, to } => {
                settings.set("from", files(&from.paths));
                settings.set("to", files(&to.paths));
                &from.at
            }
            Self::Times(times) => {
                settings.set("meshes", files(&times.inputs.paths));
                let [from, to] = times.seconds;
                settings.set("from", from);
                settings.set("to", to);
                if !times.animations.is_empty() {
                    settings.set("animations", times.animations.clone());
                }
                &times.inputs.at
            }
        };
        if !at.is_empty() {
            settings.set("at", at.iter().map(|at| json!(at)).collect::<Vec<Value>>());
        }
    }

    /// How many files the bodies at an end come from.
    pub(super) fn files(&self) -> [usize; 2] {
        match self {
            Self::Files { from, to } => [from.paths.len(), to.paths.len()],
            Self::Times(times) => [times.inputs.paths.len(); 2],
        }
    }

    /// The times of the ends, if they are times.
    pub(super) fn times(&self) -> Option<&Times> {
        match self {
            Self::Files { .. } => None,
            Self::Times(times) => Some(times),
        }
    }

    pub(super) fn read(&self) -> anyhow::Result<EndsRead> {
        match self {
            Self::Files { from, to } => {
                if from.reads_stdin() && to.reads_stdin() {
                    bail!("standard input can be read once only: name files for --from or for --to");
                }
                let (start, mut files) = from.read().context("--from")?;
                let (end, others) = to.read().context("--to")?;
                files.extend(others);
                Ok(EndsRead {
                    bodies: [start, end],
                    files,
                    bent: None,
                })
            }
            Self::Times(times) => times.read(),
        }
    }
}

impl Times {
    fn read(&self) -> anyhow::Result<EndsRead> {
        let names: Vec<&str> = self.animations.iter().map(String::as_str).collect();
        let scenes = self.inputs.scenes(&names)?;
        self.check(&scenes)?;
        let [from, to] = self.seconds;
        let start = self.inputs.at_time(&scenes, from).context("--from")?;
        let end = self.inputs.at_time(&scenes, to).context("--to")?;
        let at = |seconds| self.inputs.at_time(&scenes, seconds);
        Ok(EndsRead {
            bent: bent([&start, &end], self.seconds, at)?,
            bodies: [start, end],
            files: inputs::files(&scenes),
        })
    }

    /// The animations must exist and reach the times: behind its end nothing moves, which nobody asks for on purpose.
    fn check(&self, scenes: &[(PathBuf, AnimatedScene)]) -> anyhow::Result<()> {
        let known: Vec<String> = scenes.iter().flat_map(|(_, scene)| scene.animations()).collect();
        if known.is_empty() {
            bail!(
                "--from and --to are times, but no file has an animation: name the bodies at each end instead"
            );
        }
        if let Some(unknown) = self.animations.iter().find(|name| !known.contains(name)) {
            bail!("there is no animation {unknown}; there are: {}", known.join(", "));
        }
        let end = scenes
            .iter()
            .filter_map(|(_, scene)| scene.end())
            .reduce(f64::max);
        let Some(end) = end else {
            bail!("the animation moves no node: choose another one by --animation");
        };
        // Files keep times in single precision.
        #[expect(
            clippy::cast_possible_truncation,
            reason = "compared at the precision of the file"
        )]
        let is_behind = |seconds: f64| seconds as f32 > end as f32;
        for (option, seconds) in ["--from", "--to"].into_iter().zip(self.seconds) {
            if is_behind(seconds) {
                #[expect(clippy::cast_possible_truncation, reason = "shown as the file has it")]
                let end = end as f32;
                bail!("{option}: {seconds} s is behind the end of the animation at {end} s");
            }
        }
        Ok(())
    }
}

/// The times among the values of an option, in seconds, and the files. A file cannot be taken for a time: it has an extension.
fn parted(values: &[PathBuf]) -> anyhow::Result<(Vec<f64>, Vec<PathBuf>)> {
    let (mut times, mut files) = (Vec::new(), Vec::new());
    for value in values {
        match seconds(value) {
            Some(time) => times.push(time.map_err(|error| anyhow::anyhow!("{}: {error}", value.display()))?),
            None => files.push(value.clone()),
        }
    }
    Ok((times, files))
}

/// A value that begins like a time, in seconds.
fn seconds(value: &Path) -> Option<Result<f64, String>> {
    let text = value.to_str()?;
    let number: f64 = text.trim_end_matches(char::is_alphabetic).trim().parse().ok()?;
    // The start of an animation is a time, though no duration.
    Some(match number {
        0.0 => Ok(0.0),
        _ if number < 0.0 => {
            Err("an animation begins at 0s: name a time from there on, such as 0.5s".to_owned())
        }
        _ => quantity::time(text).map(|time| time.as_secs_f64()),
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    #[test]
    fn times_and_files_are_told_apart() {
        for (text, expected) in [
            ("0.5s", 0.5),
            ("0", 0.0),
            ("0s", 0.0),
            ("40ms", 0.04),
            ("1e1s", 10.0),
        ] {
            assert_eq!(seconds(Path::new(text)), Some(Ok(expected)), "{text}");
        }
        for text in ["1", "2parsec", "-1s"] {
            assert!(seconds(Path::new(text)).unwrap().is_err(), "{text}");
        }
        for text in ["-1s", "-1"] {
            let error = seconds(Path::new(text)).unwrap().unwrap_err();
            assert!(error.starts_with("an animation begins at 0s"), "{error}");
        }
        for text in ["-", "1s.obj", "a.glb", "s", "inf", "5/a.obj"] {
            assert_eq!(seconds(Path::new(text)), None, "{text}");
        }
    }
}
