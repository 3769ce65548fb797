//! Enclosures against integers of any size: every `f64` is one over a power of two, and so are sums and products.

use num_bigint::BigInt;

use super::*;
use crate::SearchRng;

/// `digits * 2^exponent`, exactly.
#[derive(Debug, Clone)]
struct Dyadic {
    digits: BigInt,
    exponent: i64,
}

impl Dyadic {
    fn of(x: f64) -> Self {
        let bits = x.to_bits();
        let (biased, fraction) = ((bits >> 52 & 0x7ff) as i64, bits & ((1 << 52) - 1));
        assert!(biased != 0x7ff, "{x} is not finite");
        let digits = if biased == 0 { fraction } else { fraction | 1 << 52 };
        let digits = BigInt::from(digits);
        Self {
            digits: if x < 0.0 { -digits } else { digits },
            exponent: biased.max(1) - 1075,
        }
    }
    fn at(&self, exponent: i64) -> BigInt {
        &self.digits << u32::try_from(self.exponent - exponent).unwrap()
    }
    fn plus(&self, other: &Self) -> Self {
        let exponent = self.exponent.min(other.exponent);
        Self {
            digits: self.at(exponent) + other.at(exponent),
            exponent,
        }
    }
    fn times(&self, other: &Self) -> Self {
        Self {
            digits: &self.digits * &other.digits,
            exponent: self.exponent + other.exponent,
        }
    }
    fn at_most(&self, other: &Self) -> bool {
        let exponent = self.exponent.min(other.exponent);
        self.at(exponent) <= other.at(exponent)
    }
}

fn encloses(interval: Interval, exact: &Dyadic) -> bool {
    Dyadic::of(interval.inf()).at_most(exact) && exact.at_most(&Dyadic::of(interval.sup()))
}

/// A number of any magnitude up to 2^60, often with few digits, so that exact results occur as well.
fn number(rng: &mut SearchRng) -> f64 {
    let x = (rng.uniform() - 0.5) * 2.0_f64.powi(rng.below(120) as i32 - 60);
    if rng.below(4) == 0 { f64::from(x as f32) } else { x }
}

#[test]
fn sums_products_and_quotients_round_outward() {
    let mut rng = SearchRng::new(11);
    for _ in 0..20_000 {
        let (a, b) = (number(&mut rng), number(&mut rng));
        let (x, y) = (Interval::new(a, a), Interval::new(b, b));
        let (da, db) = (Dyadic::of(a), Dyadic::of(b));
        assert!(encloses(x + y, &da.plus(&db)), "{a} + {b}");
        assert!(encloses(x - y, &da.plus(&Dyadic::of(-b))), "{a} - {b}");
        assert!(encloses(x * y, &da.times(&db)), "{a} * {b}");
        assert!(encloses(x.sqr(), &da.times(&da)), "{a}^2");
        assert!(encloses(x.pown(3), &da.times(&da).times(&da)), "{a}^3");
        if b > 0.0 {
            // inf <= a / b <= sup, multiplied by b.
            let quotient = x / y;
            assert!(Dyadic::of(quotient.inf()).times(&db).at_most(&da), "{a} / {b}");
            assert!(da.at_most(&Dyadic::of(quotient.sup()).times(&db)), "{a} / {b}");
            // inf^2 <= b <= sup^2.
            let root = y.sqrt();
            let (low, high) = (Dyadic::of(root.inf()), Dyadic::of(root.sup()));
            assert!(
                low.times(&low).at_most(&db) && db.at_most(&high.times(&high)),
                "root of {b}"
            );
        }
        for z in [x + y, x - y, x * y] {
            assert!(z.sup() <= z.inf().next_up(), "no wider than one unit: {z:?}");
        }
    }
}

/// sin x and exp x for |x| <= 4 in fixed point with 200 binary digits after the point, by their series: |error| < 2^-150.
fn series(x: f64) -> (BigInt, BigInt) {
    const DIGITS: i64 = 200;
    let x = Dyadic::of(x);
    let x = if x.exponent + DIGITS >= 0 {
        x.digits << u32::try_from(x.exponent + DIGITS).unwrap()
    } else {
        x.digits >> u32::try_from(-x.exponent - DIGITS).unwrap()
    };
    let (mut term, mut sine, mut exponential) = (BigInt::from(1) << 200_u32, BigInt::ZERO, BigInt::ZERO);
    for n in 0..120_u32 {
        exponential += &term;
        match n % 4 {
            1 => sine += &term,
            3 => sine -= &term,
            _ => {}
        }
        term = ((term * &x) >> 200_u32) / (n + 1);
    }
    (sine, exponential)
}

#[test]
fn elementary_functions_round_outward() {
    let mut rng = SearchRng::new(12);
    // The fixed-point value is off by less than 2^50 of its units of 2^-200, far below a unit of any result here.
    let holds = |interval: Interval, value: &BigInt| {
        let slack = BigInt::from(1) << 50_u32;
        let exact = |digits: BigInt| Dyadic {
            digits,
            exponent: -200,
        };
        Dyadic::of(interval.inf()).at_most(&exact(value + &slack))
            && exact(value - &slack).at_most(&Dyadic::of(interval.sup()))
    };
    for _ in 0..5_000 {
        let x = 8.0 * rng.uniform() - 4.0;
        let (sine, exponential) = series(x);
        let point = Interval::new(x, x);
        assert!(holds(point.sin(), &sine), "sin {x}");
        assert!(holds(point.exp(), &exponential), "exp {x}");
        // What the standard library computes lies inside once widened.
        for (enclosure, computed) in [
            (point.sin(), x.sin()),
            (point.cos(), x.cos()),
            (point.exp(), x.exp()),
        ] {
            assert!(
                widened(enclosure, 2).contains(computed),
                "{x}: {computed} in {enclosure:?}"
            );
        }
    }
}

#[test]
fn an_enclosure_holds_every_computed_value_of_its_region() {
    let mut rng = SearchRng::new(13);
    for _ in 0..2_000 {
        let mut corner = || 10.0 * rng.uniform() - 5.0;
        let (a, b, c, d) = (corner(), corner(), corner(), corner());
        let region = Region {
            lower: vec![a.min(b), c.min(d)],
            upper: vec![a.max(b), c.max(d)],
        };
        let [x, y] = sides(&region).unwrap();
        let enclosure = (x.sqr() + y - 11.0).sqr() + widened((x * y).sin(), 2).abs() * y.abs().sqrt()
            - x / (y.sqr() + 1.0);
        let bound: f64 = lower_bound(enclosure).unwrap();
        let bound_f32: f32 = lower_bound(enclosure).unwrap();
        assert!(f64::from(bound_f32) <= bound && bound <= f64::from(bound_f32.next_up()));
        for _ in 0..50 {
            let at = |axis: usize, share: f64| {
                (region.lower[axis] + share * (region.upper[axis] - region.lower[axis]))
                    .min(region.upper[axis])
            };
            let (x, y) = (at(0, rng.uniform()), at(1, rng.uniform()));
            let first = x * x + y - 11.0;
            let fitness = first * first + (x * y).sin().abs() * y.abs().sqrt() - x / (y * y + 1.0);
            assert!(
                bound <= fitness && fitness <= enclosure.sup(),
                "{fitness} in {enclosure:?}"
            );
        }
    }
}

#[test]
fn of_nothing_nothing_follows() {
    assert_eq!(lower_bound::<f64>(Interval::EMPTY), None);
    assert_eq!(lower_bound(Interval::ENTIRE), Some(f64::NEG_INFINITY));
    assert!(widened(Interval::EMPTY, 3).inf() > 0.0);
    let region = Region {
        lower: vec![0.0_f32],
        upper: vec![1.0],
    };
    assert!(sides::<2, f32>(&region).is_none());
    assert_eq!(lower_bound::<f64>(side(&region, 7)), None);
}
