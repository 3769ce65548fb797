//! Every error of the framework, as data.

/// An error in an input of the framework.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A space without axes.
    #[error("the space has no axis: give at least one")]
    NoAxis,
    /// An axis whose bounds are not usable.
    #[error("axis {axis}: bounds [{}, {}] are not usable: {reason}", short(*lower), short(*upper))]
    Bounds {
        /// Index of the axis, from 0.
        axis: usize,
        /// The lower bound given.
        lower: f64,
        /// The upper bound given.
        upper: f64,
        /// The bounds that are usable.
        reason: &'static str,
    },
    /// The problem's threshold is NaN.
    #[error("the threshold is NaN: no fitness is below it")]
    Threshold,
    /// A number given by the user is outside what is allowed.
    #[error("{parameter} = {value} is not allowed: {allowed}")]
    Parameter {
        /// Name of the parameter.
        parameter: String,
        /// The value given.
        value: String,
        /// The allowed values.
        allowed: String,
    },
    /// A name that is not known.
    #[error("unknown {what} `{name}`{}; known: {}", suggestion(nearest.as_deref()), known.join(", "))]
    Unknown {
        /// The kind of name: `engine`, `problem`, `parameter of …`.
        what: String,
        /// The name given.
        name: String,
        /// The known name that is nearest to it, if any is near and no other one as near.
        nearest: Option<String>,
        /// Every known name.
        known: Vec<String>,
    },
    /// A parameter that the others ask for.
    #[error("{parameter} is missing: {reason}")]
    Missing {
        /// Name of the parameter.
        parameter: String,
        /// What asks for it, and how to give it.
        reason: String,
    },
    /// A file that a parameter names cannot be read.
    #[error("cannot read {path}: {reason}")]
    File {
        /// The file.
        path: String,
        /// The system's message.
        reason: String,
    },
    /// A budget that would never end, or end before it began.
    #[error("the budget is not usable: {0}")]
    Budget(&'static str),
    /// The problem's space is not the one this search has begun with.
    #[error("the space changed from {before} to {now} axes between two slices: start a new search")]
    SpaceChanged {
        /// Number of axes of the first slice.
        before: usize,
        /// Number of axes now.
        now: usize,
    },
    /// `tell` without a matching `ask`, or with another number of values.
    #[error("tell got {got} fitness values, the last ask wanted {wanted}")]
    Tell {
        /// How many values were asked for.
        wanted: usize,
        /// How many were given.
        got: usize,
    },
    /// A ticket that was never given out.
    #[error("ticket {0} was never given out: tell the tickets that `ask` gave")]
    Ticket(u64),
    /// A start point that is not in the space.
    #[error("start point {index}: {reason}")]
    StartPoint {
        /// Which one, from 0.
        index: usize,
        /// The reason.
        reason: String,
    },
    /// A solution from elsewhere that is not in the space.
    #[error("the solution is not in the space: {0}")]
    Solution(String),
    /// A saved state that does not fit.
    #[error("the saved state does not fit: {0}")]
    State(String),
    /// Threads could not be started.
    #[error("cannot start {threads} threads: {reason}")]
    Threads {
        /// How many were wanted.
        threads: usize,
        /// The system's message.
        reason: String,
    },
}

/// A bound in digits that can be read: large and small ones by their power of ten.
fn short(bound: f64) -> String {
    match bound.abs() {
        size if size.is_finite() && size != 0.0 && !(1e-6..1e16).contains(&size) => format!("{bound:e}"),
        _ => bound.to_string(),
    }
}

fn suggestion(nearest: Option<&str>) -> String {
    nearest.map_or_else(String::new, |name| format!(", did you mean `{name}`?"))
}

impl Error {
    /// An [`Error::Unknown`] with the nearest of the known names, if one is near and no other as near, by Damerau-Levenshtein distance;
    /// capitals and hyphens do not count.
    #[must_use]
    pub fn unknown<'a>(what: &str, name: &str, known: impl IntoIterator<Item = &'a str>) -> Self {
        let mut listed = std::collections::BTreeSet::new();
        let known = known.into_iter().filter(|name| listed.insert(*name));
        let known: Vec<String> = known.map(str::to_owned).collect();
        let plain = |name: &str| name.to_lowercase().replace(['-', '_', ' '], "");
        let asked = plain(name);
        let far = |k: &String| {
            let plain = plain(k);
            let distance = strsim::damerau_levenshtein(&asked, &plain);
            // A part of a name is near to it, and nearer to a shorter one.
            let is_part = asked.len() > 2 && plain.contains(&asked);
            (if is_part { distance.min(1) } else { distance }, distance)
        };
        let far: Vec<(usize, usize)> = known.iter().map(far).collect();
        let least = far.iter().min();
        let least = least.filter(|least| least.0 <= 2.max(name.chars().count() / 3));
        let mut nearest = known.iter().zip(&far).filter(|(_, far)| Some(*far) == least);
        let nearest = match (nearest.next(), nearest.next()) {
            (Some((only, _)), None) => Some(only.clone()),
            _ => None,
        };
        Self::Unknown {
            what: what.to_owned(),
            name: name.to_owned(),
            nearest,
            known,
        }
    }

    /// An [`Error::Parameter`].
    #[must_use]
    #[expect(
        clippy::needless_pass_by_value,
        reason = "a number or a text, by value or by reference"
    )]
    pub fn parameter(parameter: impl Into<String>, value: impl ToString, allowed: impl Into<String>) -> Self {
        Self::Parameter {
            parameter: parameter.into(),
            value: value.to_string(),
            allowed: allowed.into(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_misspelt_name_gets_the_nearest_one() {
        let error = Error::unknown("engine", "lastest-hit-qpso", ["pso", "qpso", "latest-hit-qpso"]);
        assert_eq!(
            error.to_string(),
            "unknown engine `lastest-hit-qpso`, did you mean `latest-hit-qpso`?; known: pso, qpso, latest-hit-qpso"
        );
        for (name, wanted) in [
            ("zzzzzz", None),
            ("qps", Some("qpso")),
            ("latest", Some("latest-hit-qpso")),
            ("LatestHit_QPSO", Some("latest-hit-qpso")),
            ("hitqpso", Some("latest-hit-qpso")),
        ] {
            let error = Error::unknown("engine", name, ["latest-hit-qpso", "pso", "qpso"]);
            let Error::Unknown { nearest, .. } = error else {
                panic!("not an unknown name")
            };
            assert_eq!(nearest.as_deref(), wanted, "{name}");
        }
    }

    #[test]
    fn of_several_names_that_are_equally_near_none_is_suggested() {
        let error = Error::unknown("value of `problem`", "g7", ["g01", "g02", "g04"]);
        assert_eq!(
            error.to_string(),
            "unknown value of `problem` `g7`; known: g01, g02, g04"
        );
    }

    #[test]
    fn bounds_are_told_in_few_digits() {
        let told = |lower, upper| {
            let reason = "their difference overflows";
            let axis = 0;
            Error::Bounds {
                axis,
                lower,
                upper,
                reason,
            }
            .to_string()
        };
        assert_eq!(
            told(-1e308, 1e308),
            "axis 0: bounds [-1e308, 1e308] are not usable: their difference overflows"
        );
        assert!(told(-0.25, 1e-300).contains("[-0.25, 1e-300]"));
        assert!(told(0.0, f64::INFINITY).contains("[0, inf]"));
    }

    #[test]
    fn each_known_name_is_listed_once() {
        let error = Error::unknown("problem", "zzzzzz", ["puma", "arm", "puma", "arm"]);
        assert_eq!(error.to_string(), "unknown problem `zzzzzz`; known: puma, arm");
    }
}
