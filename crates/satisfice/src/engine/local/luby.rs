//! The universal restart sequence.

/// The `i`-th term, from 1, of the universal restart sequence 1, 1, 2, 1, 1, 2, 4, …: within a logarithm of the best fixed
/// limit, whatever that is (Luby, Sinclair, Zuckerman 1993, doi 10.1016/0020-0190(93)90029-9).
pub(in crate::engine) fn luby(i: u64) -> u64 {
    let mut i = i.max(1);
    loop {
        let bits = u64::BITS - i.leading_zeros();
        if i == (1 << bits) - 1 {
            return 1 << (bits - 1);
        }
        i -= (1 << (bits - 1)) - 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_restart_sequence() {
        let terms: Vec<_> = (1..=15).map(luby).collect();
        assert_eq!(terms, [1, 1, 2, 1, 1, 2, 4, 1, 1, 2, 1, 1, 2, 4, 8]);
    }
}
