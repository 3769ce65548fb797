//! Distances and times as the summaries write them.

/// A distance with six significant digits.
pub(super) fn digits(x: f64) -> String {
    match x.abs() {
        0.0 => "0".to_owned(),
        v if !(1e-3..1e6).contains(&v) => format!("{x:.5e}"),
        v => {
            let decimals = (5.0 - v.log10().floor()).max(0.0) as usize;
            let text = format!("{x:.decimals$}");
            match text.contains('.') {
                true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
                false => text,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_have_six_digits() {
        for (x, text) in [
            (0.0, "0"),
            (0.25, "0.25"),
            (1.0 / 3.0, "0.333333"),
            (12_345.678_9, "12345.7"),
            (100.0, "100"),
            (1e-7, "1.00000e-7"),
            (2.5e9, "2.50000e9"),
        ] {
            assert_eq!(digits(x), text);
        }
    }
}
