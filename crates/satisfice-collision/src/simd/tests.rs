//! Every unit against plain arithmetic in double precision.

use super::{Eight, Lanes, Portable, Work, dispatch};

/// Numbers between -1 and 1 that look random.
fn numbers(seed: u64) -> impl FnMut() -> f32 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(1);
        (state >> 40) as f32 / (1_u64 << 23) as f32 - 1.0
    }
}

fn three(mut number: impl FnMut() -> f32) -> [Eight; 3] {
    std::array::from_fn(|_| std::array::from_fn(|_| number()))
}

struct AllAtOnce {
    a: [Eight; 3],
    b: [Eight; 3],
}

impl Work for AllAtOnce {
    type Output = (u64, u64, [Eight; 3], u32, u32, u32);

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) -> Self::Output {
        let Self { a, b } = self;
        let of = |c: &[Eight; 3], pick: fn(f32) -> f32| c.map(|axis| axis.map(pick));
        let (lower, upper) = (of(&b, |c| c - 0.1), of(&b, |c| c + 0.2));
        let (min, max) = (of(&a, |c| c - 0.2), of(&a, |c| c + 0.1));
        let rows = std::array::from_fn(|i| [a[0][i], a[1][i], a[2][i], b[0][i]]);
        (
            lanes.all_closer([&b[0], &b[1], &b[2]], &a, 0.5),
            lanes.boxes_within(
                [&lower[0], &lower[1], &lower[2]],
                [&upper[0], &upper[1], &upper[2]],
                &min,
                &max,
                0.2,
            ),
            lanes.columns(&rows),
            lanes.closer([&b[0], &b[1], &b[2]], [0.1, 0.2, 0.3], 0.5),
            lanes.inside([&b[0], &b[1], &b[2]], [-0.7; 3], [0.6; 3]),
            lanes.equal_ids(&b[0].map(|x| (x.abs() * 4.0) as u32), 2),
        )
    }
}

#[test]
fn every_unit_says_what_plain_arithmetic_says() {
    let mut number = numbers(7);
    let point = |c: &[Eight; 3], lane: usize| c.map(|axis| f64::from(axis[lane]));
    let (mut near, mut boxes_near) = (0, 0);
    for _ in 0..500 {
        let (a, b) = (three(&mut number), three(&mut number));
        let all = dispatch(AllAtOnce { a, b });
        assert_eq!(all, AllAtOnce { a, b }.run(Portable));
        let (points, boxes, columns, ..) = all;
        assert_eq!(columns, a);
        for i in 0..8 {
            for j in 0..8 {
                let (p, q) = (point(&a, i), point(&b, j));
                let way: [f64; 3] = std::array::from_fn(|k| p[k] - q[k]);
                let square: f64 = way.iter().map(|d| d * d).sum();
                // a's box ends .2 below and .1 above its point, b's .1 below and .2 above
                let reach = |d: &f64| if *d > 0.0 { d - 0.4 } else { -d - 0.2 };
                let gap: f64 = way.iter().map(|d| reach(d).max(0.0).powi(2)).sum();
                let bit = |mask: u64| mask >> (8 * i + j) & 1 == 1;
                assert!((square - 0.5).abs() < 1e-5 || bit(points) == (square < 0.5));
                assert!((gap - 0.2).abs() < 1e-5 || bit(boxes) == (gap <= 0.2));
                near += u32::from(bit(points));
                boxes_near += u32::from(bit(boxes));
            }
        }
    }
    assert!(
        (1000..31_000).contains(&near) && (1000..31_000).contains(&boxes_near),
        "both answers occur"
    );
}
