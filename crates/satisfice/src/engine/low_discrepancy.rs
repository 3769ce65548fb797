//! Points that cover the unit cube evenly, however many are drawn.

/// Coordinates of point `index` of the additive recurrence `x_j = frac(shift_j + index * phi^-j)`, `phi` being the root of
/// `phi^(d+1) = phi + 1` above 1.
///
/// Generalised golden ratios: Roberts 2018, The Unreasonable Effectiveness of Quasirandom Sequences.
#[expect(clippy::cast_precision_loss, reason = "indices are below 2^53")]
pub(super) fn point(index: u64, shift: &[f64]) -> impl Iterator<Item = f64> {
    let phi = generalised_golden_ratio(shift.len());
    let mut step = 1.0;
    shift.iter().map(move |shift| {
        step /= phi;
        (shift + index as f64 * step).fract()
    })
}

#[expect(clippy::cast_precision_loss, reason = "a number of axes")]
fn generalised_golden_ratio(axes: usize) -> f64 {
    let mut phi = 2.0_f64;
    for _ in 0..40 {
        phi = (1.0 + phi).powf(1.0 / (axes as f64 + 1.0));
    }
    phi
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_part_of_a_square_has_its_share() {
        let mut counts = [0; 16];
        for index in 0..160 {
            let x: Vec<f64> = point(index, &[0.3, 0.8]).collect();
            counts[(x[0] * 4.0) as usize * 4 + (x[1] * 4.0) as usize] += 1;
        }
        assert!(counts.iter().all(|count| (8..=12).contains(count)), "{counts:?}");
    }

    #[test]
    fn one_axis_has_the_golden_ratio() {
        approx::assert_relative_eq!(
            generalised_golden_ratio(1),
            1.618_033_988_749_895,
            max_relative = 1e-12
        );
    }
}
