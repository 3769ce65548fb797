//! Every combination of the values of a sweep.

/// Names with the values to try.
type Axes = [(String, Vec<String>)];

/// The number of combinations; `u64::MAX` stands for more.
#[must_use]
pub(super) fn size(axes: &Axes) -> u64 {
    axes.iter()
        .fold(1, |size, (_, values)| size.saturating_mul(values.len() as u64))
}

/// Every combination as `(name, value)`; the last name changes fastest.
pub(super) fn combinations(axes: &Axes) -> impl Iterator<Item = Vec<(String, String)>> + '_ {
    (0..size(axes)).map(|index| {
        let mut rest = index;
        let mut combination: Vec<(String, String)> = axes
            .iter()
            .rev()
            .map(|(name, values)| {
                let count = values.len() as u64;
                let at = usize::try_from(rest % count).unwrap_or(0);
                rest /= count;
                (name.clone(), values[at].clone())
            })
            .collect();
        combination.reverse();
        combination
    })
}

/// A name with the values that were chosen for it: `rastrigin dimension=2`.
#[must_use]
pub(super) fn label(name: &str, combination: &[(String, String)]) -> String {
    let values = combination.iter().map(|(name, value)| format!(" {name}={value}"));
    std::iter::once(name.to_owned()).chain(values).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_name_changes_fastest() {
        let axes = [("a", vec!["1", "2"]), ("b", vec!["x", "y", "z"])].map(|(name, values)| {
            let values = values.into_iter().map(str::to_owned).collect();
            (name.to_owned(), values)
        });
        let labels: Vec<String> = combinations(&axes).map(|values| label("c", &values)).collect();
        assert_eq!(size(&axes), 6);
        assert_eq!(labels[0], "c a=1 b=x");
        assert_eq!(labels[1], "c a=1 b=y");
        assert_eq!(labels[3], "c a=2 b=x");
        assert_eq!(labels.len(), 6);
        assert_eq!(combinations(&[]).count(), 1);
    }
}
