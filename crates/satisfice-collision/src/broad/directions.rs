//! Candidates for a separating axis of a triangle: its normal, and the normals of its sides inside its plane.

/// Four directions, component by component.
pub(crate) type Directions = [[f32; 4]; 3];

/// The directions of a triangle; zero, which separates nothing, where `f32` has none.
pub(crate) fn of_triangle(triangle: [[f32; 3]; 3]) -> Directions {
    let [a, b, c] = triangle;
    let sub = |p: [f32; 3], q: [f32; 3]| [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
    let cross = |p: [f32; 3], q: [f32; 3]| {
        [
            p[1] * q[2] - p[2] * q[1],
            p[2] * q[0] - p[0] * q[2],
            p[0] * q[1] - p[1] * q[0],
        ]
    };
    let sides = [sub(b, a), sub(c, b), sub(a, c)];
    let normal = cross(sides[0], sides[1]);
    let [p, q, r] = sides.map(|side| cross(normal, side));
    let of: Directions = std::array::from_fn(|k| [normal[k], p[k], q[k], r[k]]);
    // a square above 1e-30 has all its digits, so that the length comes out as 1 within a few roundings
    let scale: [f32; 4] = std::array::from_fn(|l| {
        let square = of[0][l] * of[0][l] + of[1][l] * of[1][l] + of[2][l] * of[2][l];
        if square > 1e-30 { 1.0 / square.sqrt() } else { 0.0 }
    });
    of.map(|component| std::array::from_fn(|l| component[l] * scale[l]))
}
