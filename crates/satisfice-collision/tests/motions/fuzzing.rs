//! Body of the fuzz target: it takes any bytes and panics if a promise is broken.

use satisfice_collision::continuous::Separation;

use super::{Kind, Query};
use crate::stress::Point;

/// A motion from the bytes, the rest 0. The first byte chooses the kind of pair and how the bytes are read: as arbitrary bit patterns, as
/// small integers, or as numbers of nearby exponents.
pub fn check(data: &[u8]) {
    let Some((&mode, data)) = data.split_first() else {
        return;
    };
    let word = |k: usize| {
        let mut bytes = [0; 8];
        for (to, from) in bytes.iter_mut().zip(data.iter().skip(8 * k)) {
            *to = *from;
        }
        u64::from_le_bytes(bytes)
    };
    let number = |k: usize| match mode / 4 % 3 {
        0 => f64::from_bits(word(k)),
        1 => f64::from(data.get(k).copied().unwrap_or(0) as i8 / 16),
        _ => f64::from_bits(word(k) & !(0x7f0 << 52) | 0x3f0 << 52),
    };
    let kind = Kind::ALL[usize::from(mode % 4)];
    let count = kind.sizes().0 + kind.sizes().1;
    let point = |k: usize| -> Point { std::array::from_fn(|axis| number(3 * k + axis)) };
    let query = Query {
        kind,
        from: (0..count).map(point).collect(),
        to: (count..2 * count).map(point).collect(),
        first_touch: None,
    };
    let delta = number(6 * count).abs();
    let is_finite = query
        .from
        .iter()
        .chain(&query.to)
        .flatten()
        .all(|x| x.is_finite());
    let touches = query.touches();
    if !is_finite {
        assert!(!touches && query.impact(0.0, 1e-6).is_none(), "{query:?}");
        return;
    }
    for variant in query.variants() {
        assert_eq!(variant.touches(), touches, "{variant:?}");
    }
    check_impact(&query, 0.0, touches);
    if Separation::new(delta).is_ok() && delta > 0.0 {
        let hit = query.is_hit(delta);
        assert!(hit || !touches, "{query:?}");
        for variant in query.variants() {
            assert_eq!(variant.is_hit(delta), hit, "{variant:?} {delta:e}");
        }
        check_impact(&query, delta, hit);
    }
}

fn check_impact(query: &Query, delta: f64, hit: bool) {
    let impact = query.impact(delta, 1e-6);
    assert_eq!(impact.is_some(), hit, "{query:?}");
    if let Some(impact) = impact {
        let [low, high] = impact.time;
        assert!(
            0.0 <= low && low <= high && high <= 1.0 && high - low <= 1e-6,
            "{impact:?}"
        );
    }
}
