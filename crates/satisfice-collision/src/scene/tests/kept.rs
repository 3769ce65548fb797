//! What is kept of a deforming body from frame to frame, against brute force over all pairs.

use super::*;
use crate::FeatureKind;

/// A sheet that falls, ripples, folds over itself and jumps, over a ball that stays: what is kept from frame to frame against
/// brute force over all pairs.
#[test]
fn what_follows_a_deforming_body_misses_nothing() {
    let sheet = generate::cloth(2.0, 2.0, 25, 25).unwrap();
    let spacing = 2.0 / 24.0;
    let ball = generate::icosphere(0.6, 3).unwrap();
    for (ball_first, scale, shift) in [(false, 1.0, 0.0), (true, 1e-9, 0.0), (false, 1e6, 1e9)] {
        let delta = 0.95 * spacing * scale;
        let to_scale = |p: &Point| p.map(|c| scale * c + shift);
        let place = |mesh: &Mesh| {
            mesh.with_vertices(mesh.vertices().iter().map(to_scale).collect())
                .unwrap()
        };
        let (mut posed, mut at, mut lists) = (place(&sheet), 0, 0);
        let fixed = place(&ball);
        let threshold = Threshold::new(delta).unwrap();
        let mut scene = Scene::new(PairKind::VertexVertex, threshold);
        let excluded = sheet.adjacency().rings(1);
        if ball_first {
            scene.add(Body::fixed(fixed.clone()));
            at = 1;
        }
        let cloth = scene.add(Body::deforming(posed.clone()).beyond_ring(1));
        assert_eq!(cloth, at);
        if !ball_first {
            scene.add(Body::fixed(fixed.clone()));
        }
        let mut total = 0;
        for frame in 0..60 {
            let t = f64::from(frame);
            // folded in half, slowly but for some frames, with ripples that grow and an edge that flaps; it falls all the time,
            // jumps twice, and once with one half only
            let fold = 0.002 * t + 0.15 * (t - 20.0).clamp(0.0, 20.0);
            let jump = if frame == 10 || frame == 50 { 0.4 } else { 0.0 };
            let moved = sheet.vertices().iter().map(|&[x, y, _]| {
                let ripple = 2e-4 * t * (9.0 * x + 7.0 * y + 0.2 * t).sin();
                let flap = if x < -0.99 { 0.05 * (0.3 * t).sin() } else { 0.0 };
                let half = if frame == 56 && y > 0.0 { 0.05 } else { 0.0 };
                let (along, up) = match x > 0.0 {
                    true => (x * fold.cos(), x * fold.sin()),
                    false => (x, 0.0),
                };
                to_scale(&[along, y + jump, up + ripple + flap + half + 1.2 - 0.03 * t])
            });
            posed = posed.with_vertices(moved.collect()).unwrap();
            scene.deform(cloth, posed.vertices()).unwrap();
            let answer = scene.contacts().unwrap();
            lists += answer.skips.skin_lists;
            let own = oracle::pairs_within(posed.vertices(), &excluded, threshold);
            let other = oracle::pairs_between(posed.vertices(), fixed.vertices(), threshold);
            let contact = |body_a, body_b, a, b| Contact { body_a, body_b, a, b };
            let own = own.into_iter().map(|[a, b]| contact(cloth, cloth, a, b));
            let other = other.into_iter().map(|[a, b]| match ball_first {
                true => contact(0, 1, b, a),
                false => contact(0, 1, a, b),
            });
            let mut expected: Vec<Contact> = own.chain(other).collect();
            expected.sort_unstable();
            assert!(
                answer.contacts == expected,
                "frame {frame}: {} of {}",
                answer.contacts.len(),
                expected.len()
            );
            total += expected.len();
        }
        assert!(
            total > 2000 && (15..45).contains(&lists),
            "{total} contacts, {lists} lists"
        );
    }
}

/// A sheet that churns: after some frames a tree takes the place of the grids, and is built anew when the sheet is crumpled.
#[test]
fn a_tree_follows_a_churning_body_and_is_built_anew_when_it_is_loose() {
    let sheet = generate::cloth(2.0, 2.0, 30, 30).unwrap();
    let threshold = Threshold::new(0.06).unwrap();
    let excluded = sheet.adjacency().rings(1);
    let mut scene = Scene::new(PairKind::VertexVertex, threshold);
    let cloth = scene.add(Body::deforming(sheet.clone()).beyond_ring(1));
    let mut total = 0;
    for frame in 0..12 {
        let t = f64::from(frame);
        // a wave of half the threshold a frame; from frame 8 on every vertex is somewhere else altogether
        let moved: Vec<Point> = (0..)
            .zip(sheet.vertices())
            .map(|(i, &[x, y, _])| match frame {
                0..8 => [x, y.abs(), 0.1 * (5.0 * x + t).sin() + 0.02 * y.signum()],
                _ => {
                    let k = f64::from(i * 7 % 900);
                    [(k * 0.618 + 0.01 * t).fract(), (k * 0.414).fract(), 0.001 * k]
                }
            })
            .collect();
        scene.deform(cloth, &moved).unwrap();
        let answer = scene.contacts().unwrap();
        let own = oracle::pairs_within(&moved, &excluded, threshold);
        let expected: Vec<[u32; 2]> = own.into_iter().collect();
        let found: Vec<[u32; 2]> = answer
            .contacts
            .iter()
            .map(|contact| [contact.a, contact.b])
            .collect();
        assert!(
            found == expected,
            "frame {frame}: {} of {}",
            found.len(),
            expected.len()
        );
        let tree = scene.states[cloth].tree(FeatureKind::Vertex);
        assert_eq!(tree.is_some(), frame >= 3, "frame {frame}");
        assert!(tree.is_none_or(|tree| !tree.is_loose()), "frame {frame}");
        total += found.len();
    }
    assert!(total > 500, "{total}");
}
