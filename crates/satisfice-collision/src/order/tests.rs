//! Tests of the orders. Referees: the curve's defining property for Hilbert, bit by bit interleaving for Morton.
#![allow(clippy::unwrap_used)]

use proptest::prelude::*;

use super::*;
use crate::generate;

fn grid(bits: u32) -> impl Iterator<Item = [u32; 3]> {
    let n = 1_u32 << bits;
    (0..n * n * n).map(move |i| [i / (n * n), i / n % n, i % n])
}

/// A curve that visits every cell once, each step to a cell that shares a face: exactly what Hilbert's curve promises.
#[test]
fn hilbert_visits_every_cell_in_steps_of_one() {
    for bits in 0..=5 {
        let mut visited: Vec<(u64, [u32; 3])> = grid(bits).map(|c| (hilbert_key(c, bits), c)).collect();
        visited.sort_unstable();
        for (k, (key, _)) in visited.iter().enumerate() {
            assert_eq!(*key, k as u64);
        }
        for step in visited.windows(2) {
            let steps: u32 = (0..3).map(|k| step[0].1[k].abs_diff(step[1].1[k])).sum();
            assert_eq!(steps, 1, "{:?} {:?}", step[0], step[1]);
        }
        assert_eq!(visited[0].1, [0, 0, 0]);
    }
}

/// Aligned blocks of 2^3 and 4^3 cells are visited in one run each.
#[test]
fn hilbert_nests() {
    let bits = 5;
    for c in grid(bits) {
        for (level, mask) in [(1, !1), (2, !3)] {
            let corner = hilbert_key(c.map(|x| x & mask), bits);
            assert_eq!(hilbert_key(c, bits) >> (3 * level), corner >> (3 * level));
        }
    }
}

#[test]
fn hilbert_keeps_near_numbers_near() {
    let mesh = generate::teapot(13).unwrap();
    let mean_step = |order: VertexOrder| {
        let p = order.permutation(mesh.vertices());
        let steps: f64 = p
            .windows(2)
            .map(|w| {
                let (a, b) = (mesh.vertex(w[0]), mesh.vertex(w[1]));
                (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
            })
            .sum();
        steps / (p.len() - 1) as f64
    };
    let hilbert = mean_step(VertexOrder::Hilbert);
    assert!(hilbert < mean_step(VertexOrder::Morton));
    assert!(20.0 * hilbert < mean_step(VertexOrder::Random { seed: 1 }));
}

/// A thin sheet is ordered by its place, not by the noise in its thickness.
#[test]
fn noise_across_a_sheet_does_not_rule_its_order() {
    let noise = sampling::permutation(1024, 3);
    let sheet = |thickness: f64| -> Vec<[f64; 3]> {
        (0..1024_u32)
            .map(|i| {
                [
                    f64::from(i % 32),
                    f64::from(i / 32),
                    f64::from(noise[i as usize]) * thickness,
                ]
            })
            .collect()
    };
    for order in [VertexOrder::Morton, VertexOrder::Hilbert] {
        assert_eq!(order.permutation(&sheet(1e-9)), order.permutation(&sheet(0.0)));
    }
}

#[test]
fn names_are_read_back_and_others_refused() {
    for name in VertexOrder::NAMES {
        assert_eq!(name.parse::<VertexOrder>().unwrap().to_string(), name);
    }
    assert_eq!(
        "random".parse::<VertexOrder>().unwrap().with_seed(7),
        VertexOrder::Random { seed: 7 }
    );
    let error = "zorder".parse::<VertexOrder>().unwrap_err();
    assert_eq!(
        error.to_string(),
        "order = zorder is not allowed: file, random, morton or hilbert"
    );
}

#[test]
fn bodies_without_extent_and_of_immense_extent_are_ordered() {
    for order in [VertexOrder::Morton, VertexOrder::Hilbert] {
        assert!(order.permutation(&[]).is_empty());
        assert_eq!(order.permutation(&[[7.0; 3]; 3]), [0, 1, 2]);
        let far = [[1.7e308; 3], [-1.7e308; 3], [0.0; 3]];
        assert_eq!(order.permutation(&far)[0], 1);
    }
}

fn naive_morton(cell: [u32; 3], bits: u32) -> u64 {
    let mut key = 0;
    for b in (0..bits).rev() {
        for c in cell {
            key = key << 1 | u64::from(c >> b & 1);
        }
    }
    key
}

proptest! {
    #[test]
    fn morton_agrees_with_interleaving_bit_by_bit(cell in prop::array::uniform3(any::<u32>()), bits in 0_u32..=21) {
        prop_assert_eq!(morton_key(cell, bits), naive_morton(cell, bits));
    }

    /// At full depth, too: a step of one on the curve is a step to a neighbouring cell. The cell before or after is
    /// among the six neighbours.
    #[test]
    fn hilbert_steps_to_a_neighbour_at_full_depth(cell in prop::array::uniform3(1_u32..(1 << BITS) - 1)) {
        let key = hilbert_key(cell, BITS);
        let around: Vec<u64> = (0..3).flat_map(|k| {
            [cell[k] - 1, cell[k] + 1].map(|c| {
                let mut other = cell;
                other[k] = c;
                hilbert_key(other, BITS)
            })
        }).collect();
        prop_assert!(around.contains(&(key + 1)));
        prop_assert!(around.contains(&(key - 1)));
    }

    #[test]
    fn every_order_is_a_permutation(
        points in prop::collection::vec(prop::array::uniform3(-1e3..1e3_f64), 0..60),
        seed in any::<u64>(),
    ) {
        for order in [VertexOrder::File, VertexOrder::Random { seed }, VertexOrder::Morton, VertexOrder::Hilbert] {
            let mut p = order.permutation(&points);
            p.sort_unstable();
            prop_assert_eq!(p, (0..points.len() as u32).collect::<Vec<_>>());
        }
    }
}
