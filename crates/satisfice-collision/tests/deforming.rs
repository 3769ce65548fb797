//! Deforming bodies over many frames against brute force over all pairs: data kept from frame to frame must not lose or
//! invent a contact.

#![allow(clippy::unwrap_used, reason = "a test")]

use satisfice_collision::distance::{PairKind, Threshold};
use satisfice_collision::scene::{Body, Contact, World};
use satisfice_collision::{Mesh, generate, oracle};

type Point = [f64; 3];

/// The contacts as `(body, feature)` pairs, sorted; the sheet is body 0 and the ball body 1.
fn contacts(world: &mut World, is_sheet: impl Fn(&Contact) -> [bool; 2]) -> Vec<[(u8, u32); 2]> {
    world.update().unwrap();
    let side = |sheet: bool, feature: u32| (u8::from(!sheet), feature);
    let mut found: Vec<_> = world
        .contacts()
        .map(|contact| {
            let [a, b] = is_sheet(&contact);
            let mut pair = [side(a, contact.a), side(b, contact.b)];
            pair.sort_unstable();
            pair
        })
        .collect();
    found.sort_unstable();
    found
}

/// A sheet that falls, ripples, folds over itself and jumps, over a ball that stays.
#[test]
fn a_folding_sheet_over_a_ball() {
    let sheet = generate::cloth(2.0, 2.0, 25, 25).unwrap();
    let spacing = 2.0 / 24.0;
    let ball = generate::icosphere(0.6, 3).unwrap();
    for (ball_first, scale, shift) in [(false, 1.0, 0.0), (true, 1e-9, 0.0), (false, 1e6, 1e9)] {
        let to_scale = |p: &Point| p.map(|c| scale * c + shift);
        let place = |mesh: &Mesh| {
            mesh.with_vertices(mesh.vertices().iter().map(to_scale).collect())
                .unwrap()
        };
        let fixed = place(&ball);
        let threshold = Threshold::new(0.95 * spacing * scale).unwrap();
        let mut world = World::new(PairKind::VertexVertex, threshold);
        let excluded = sheet.adjacency().rings(1);
        if ball_first {
            world.add(Body::fixed(fixed.clone())).unwrap();
        }
        let mut posed = place(&sheet);
        let cloth = world.add(Body::deforming(posed.clone()).beyond_ring(1)).unwrap();
        if !ball_first {
            world.add(Body::fixed(fixed.clone())).unwrap();
        }
        let mut total = 0;
        for frame in 0..60 {
            let t = f64::from(frame);
            // Folded in half, slowly except for some frames, with growing ripples and a flapping edge. It falls all the time,
            // jumps twice, and once with one half only.
            let fold = 0.002 * t + 0.15 * (t - 20.0).clamp(0.0, 20.0);
            let jump = if frame == 10 || frame == 50 { 0.4 } else { 0.0 };
            let moved = sheet.vertices().iter().map(|&[x, y, _]| {
                let ripple = 2e-4 * t * (9.0 * x + 7.0 * y + 0.2 * t).sin();
                let flap = if x < -0.99 { 0.05 * (0.3 * t).sin() } else { 0.0 };
                let half = if frame == 56 && y > 0.0 { 0.05 } else { 0.0 };
                let (along, up) = if x > 0.0 {
                    (x * fold.cos(), x * fold.sin())
                } else {
                    (x, 0.0)
                };
                to_scale(&[along, y + jump, up + ripple + flap + half + 1.2 - 0.03 * t])
            });
            posed = posed.with_vertices(moved.collect()).unwrap();
            world.deform(cloth, posed.vertices()).unwrap();
            let found = contacts(&mut world, |contact| {
                [contact.body_a == cloth, contact.body_b == cloth]
            });
            let own = oracle::pairs_within(posed.vertices(), &excluded, threshold);
            let other = oracle::pairs_between(posed.vertices(), fixed.vertices(), threshold);
            let own = own.into_iter().map(|[a, b]| [(0, a), (0, b)]);
            let other = other.into_iter().map(|[a, b]| [(0, a), (1, b)]);
            let mut expected: Vec<_> = own.chain(other).collect();
            expected.sort_unstable();
            assert!(
                found == expected,
                "frame {frame}: {} of {}",
                found.len(),
                expected.len()
            );
            total += expected.len();
        }
        assert!(total > 2000, "{total} contacts");
    }
}

/// A sheet that churns, and from frame 8 on is somewhere else altogether.
#[test]
fn a_churning_sheet() {
    let sheet = generate::cloth(2.0, 2.0, 30, 30).unwrap();
    let threshold = Threshold::new(0.06).unwrap();
    let excluded = sheet.adjacency().rings(1);
    let mut world = World::new(PairKind::VertexVertex, threshold);
    let cloth = world.add(Body::deforming(sheet.clone()).beyond_ring(1)).unwrap();
    let mut total = 0;
    for frame in 0..12 {
        let t = f64::from(frame);
        let moved: Vec<Point> = (0..)
            .zip(sheet.vertices())
            .map(|(i, &[x, y, _])| {
                if frame < 8 {
                    return [x, y.abs(), 0.1 * (5.0 * x + t).sin() + 0.02 * y.signum()];
                }
                let k = f64::from(i * 7 % 900);
                [(k * 0.618 + 0.01 * t).fract(), (k * 0.414).fract(), 0.001 * k]
            })
            .collect();
        world.deform(cloth, &moved).unwrap();
        let found = contacts(&mut world, |_| [true, true]);
        let mut expected: Vec<_> = oracle::pairs_within(&moved, &excluded, threshold)
            .into_iter()
            .map(|[a, b]| [(0, a), (0, b)])
            .collect();
        expected.sort_unstable();
        assert!(
            found == expected,
            "frame {frame}: {} of {}",
            found.len(),
            expected.len()
        );
        total += found.len();
    }
    assert!(total > 500, "{total}");
}
