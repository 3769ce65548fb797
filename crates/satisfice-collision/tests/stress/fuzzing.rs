//! Bodies of the fuzz targets: they take any bytes and panic if a promise is broken.

use satisfice_collision::distance::{DecidedBy, PairKind, Threshold, TriangleBatch};
use satisfice_collision::io::{Format, parse, write_obj};

use super::referee::squared_distance;
use super::{Point, decide, orders, proximity, sizes};

/// Two triangles and a threshold from the bytes, the rest 0. The first byte chooses how they are read: as arbitrary bit
/// patterns, as small integers, or as numbers of nearby exponents.
pub fn distance(data: &[u8]) {
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
    let number = |k: usize| match mode % 3 {
        0 => f64::from_bits(word(k)),
        1 => f64::from(data.get(k).copied().unwrap_or(0) as i8),
        _ => f64::from_bits(word(k) & !(0x7f0 << 52) | 0x3f0 << 52),
    };
    let triangle =
        |from: usize| [0, 3, 6].map(|k| [number(from + k), number(from + k + 1), number(from + k + 2)]);
    let (a, b, delta): ([Point; 3], [Point; 3], f64) = (triangle(0), triangle(9), number(18));
    for kind in PairKind::ALL {
        let (m, n) = sizes(kind);
        check(kind, &a[..m], &b[..n], delta);
    }
}

fn check(kind: PairKind, a: &[Point], b: &[Point], delta: f64) {
    let near = proximity(kind, a, b);
    if !a.iter().chain(b).flatten().all(|x| x.is_finite()) {
        assert!(near.distance.is_nan() && near.by == DecidedBy::NotFinite);
        assert_eq!(decide(kind, a, b, 1.0).by, DecidedBy::NotFinite);
        assert!(!decide(kind, a, b, 1.0).within);
        return;
    }
    let truth = squared_distance(a, b);
    assert!(
        truth.error_in_ulp(near.distance) <= 1.0,
        "{kind} {a:?} {b:?} {near:?}"
    );
    for delta in [delta, near.distance, near.distance.next_up()] {
        let Ok(threshold) = Threshold::new(delta) else {
            continue;
        };
        let expected = truth.is_below(delta);
        for (p, q) in orders(a).iter().zip(orders(b).iter().rev()) {
            assert_eq!(
                decide(kind, p, q, delta).within,
                expected,
                "{kind} {p:?} {q:?} {delta:e}"
            );
        }
        if let (Ok(a), Ok(b)) = (<&[Point; 3]>::try_from(a), <&[Point; 3]>::try_from(b)) {
            let mut batch = TriangleBatch::new(threshold);
            batch.push(a, b, (), |(), _| unreachable!("one pair does not fill a batch"));
            batch.finish(|(), decision| assert_eq!(decision.within, expected, "{a:?} {b:?} {delta:e}"));
        }
    }
}

/// Every reader on the bytes: an error or a mesh whose promises hold, and which comes back from OBJ unchanged.
pub fn mesh(data: &[u8]) {
    // Lists only name other files.
    for format in ["obj", "ply", "stl", "off", "gltf"].map(|name| Format::named(name).unwrap()) {
        let Ok(mesh) = parse(format, data) else { continue };
        assert!(!mesh.vertices().is_empty());
        assert!(mesh.vertices().iter().flatten().all(|x| x.is_finite()));
        let vertices = mesh.vertices().len();
        assert!(
            mesh.triangles()
                .iter()
                .flatten()
                .all(|&v| (v as usize) < vertices)
        );
        let mut text = Vec::new();
        write_obj(&mesh, &mut text).unwrap();
        let again = parse(Format::named("obj").unwrap(), &text).unwrap();
        assert_eq!(again.vertices(), mesh.vertices());
        assert_eq!(again.triangles(), mesh.triangles());
    }
}
