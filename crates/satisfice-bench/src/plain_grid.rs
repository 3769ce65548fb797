//! The baseline: a plain uniform grid without special cases, in `f32`. Points are clipped to the overlap of the inflated
//! boxes, cells are as wide as the radius (wider if there would be more than four per point), one counting sort, structure of arrays,
//! 27 cells as nine contiguous rows, half the stencil inside one body. Independent of the crate it is compared with.

#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    clippy::cast_sign_loss,
    reason = "an afternoon's grid: cells and numbers are small"
)]

type Point = [f32; 3];

struct Grid {
    lower: Point,
    inverse: f32,
    count: [usize; 3],
    start: Vec<u32>,
    x: Vec<f32>,
    y: Vec<f32>,
    z: Vec<f32>,
    id: Vec<u32>,
}

fn bounds(points: &[Point]) -> (Point, Point) {
    let (mut lower, mut upper) = ([f32::MAX; 3], [f32::MIN; 3]);
    for p in points {
        for k in 0..3 {
            lower[k] = if p[k] < lower[k] { p[k] } else { lower[k] };
            upper[k] = if p[k] > upper[k] { p[k] } else { upper[k] };
        }
    }
    (lower, upper)
}

impl Grid {
    fn new(points: &[Point], chosen: &[u32], lower: Point, upper: Point, r: f32) -> Self {
        let mut edge = r;
        let most = (4 * chosen.len() + 64) as f32;
        while (0..3)
            .map(|k| (upper[k] - lower[k]) / edge + 1.0)
            .product::<f32>()
            > most
        {
            edge *= 1.1;
        }
        let count = std::array::from_fn(|k| ((upper[k] - lower[k]) / edge) as usize + 1);
        let n = chosen.len();
        let mut grid = Self {
            lower,
            inverse: 1.0 / edge,
            count,
            start: vec![0; count.iter().product::<usize>() + 1],
            x: vec![0.0; n],
            y: vec![0.0; n],
            z: vec![0.0; n],
            id: vec![0; n],
        };
        for &i in chosen {
            let cell = grid.index(grid.cell(&points[i as usize]));
            grid.start[cell + 1] += 1;
        }
        for cell in 1..grid.start.len() {
            grid.start[cell] += grid.start[cell - 1];
        }
        let mut next = grid.start.clone();
        for &i in chosen {
            let p = &points[i as usize];
            let at = &mut next[grid.index(grid.cell(p))];
            let to = *at as usize;
            *at += 1;
            (grid.x[to], grid.y[to], grid.z[to], grid.id[to]) = (p[0], p[1], p[2], i);
        }
        grid
    }

    fn cell(&self, p: &Point) -> [usize; 3] {
        std::array::from_fn(|k| {
            (((p[k] - self.lower[k]) * self.inverse).floor() as usize).min(self.count[k] - 1)
        })
    }

    fn index(&self, cell: [usize; 3]) -> usize {
        (cell[2] * self.count[1] + cell[1]) * self.count[0] + cell[0]
    }

    /// The points of a row of cells.
    fn row(&self, y: usize, z: usize, from: usize, to: usize) -> std::ops::Range<usize> {
        let row = (z * self.count[1] + y) * self.count[0];
        self.start[row + from] as usize..self.start[row + to + 1] as usize
    }

    fn test(&self, p: &Point, range: std::ops::Range<usize>, square: f32, mut hit: impl FnMut(u32)) {
        for k in range {
            let (x, y, z) = (self.x[k] - p[0], self.y[k] - p[1], self.z[k] - p[2]);
            if x * x + y * y + z * z < square {
                hit(self.id[k]);
            }
        }
    }
}

/// Pairs of two bodies within `r`, in no order.
#[must_use]
pub fn between(a: &[Point], b: &[Point], r: f32) -> Vec<(u32, u32)> {
    let ((lower_a, upper_a), (lower_b, upper_b)) = (bounds(a), bounds(b));
    let lower: Point = std::array::from_fn(|k| lower_a[k].max(lower_b[k]) - r);
    let upper: Point = std::array::from_fn(|k| upper_a[k].min(upper_b[k]) + r);
    let mut pairs = Vec::new();
    if (0..3).any(|k| lower[k] > upper[k]) {
        return pairs;
    }
    let inside = |p: &Point| (0..3).all(|k| lower[k] <= p[k] && p[k] <= upper[k]);
    let chosen: Vec<u32> = (0..b.len() as u32).filter(|&i| inside(&b[i as usize])).collect();
    let grid = Grid::new(b, &chosen, lower, upper, r);
    for (i, p) in a.iter().enumerate().filter(|(_, p)| inside(p)) {
        let [x, y, z] = grid.cell(p);
        let last = grid.count.map(|n| n - 1);
        for z in z.saturating_sub(1)..=(z + 1).min(last[2]) {
            for y in y.saturating_sub(1)..=(y + 1).min(last[1]) {
                let row = grid.row(y, z, x.saturating_sub(1), (x + 1).min(last[0]));
                grid.test(p, row, r * r, |j| pairs.push((i as u32, j)));
            }
        }
    }
    pairs
}

/// Pairs inside one body within `r`, lower number first, in no order.
#[must_use]
pub fn within(points: &[Point], r: f32) -> Vec<(u32, u32)> {
    let (lower, upper) = bounds(points);
    let all: Vec<u32> = (0..points.len() as u32).collect();
    let grid = Grid::new(points, &all, lower, upper, r);
    let [nx, ny, nz] = grid.count;
    let mut pairs = Vec::new();
    for z in 0..nz {
        for y in 0..ny {
            for x in 0..nx {
                let cell = grid.index([x, y, z]);
                for at in grid.start[cell] as usize..grid.start[cell + 1] as usize {
                    let (p, i) = ([grid.x[at], grid.y[at], grid.z[at]], grid.id[at]);
                    let mut hit = |j: u32| pairs.push((i.min(j), i.max(j)));
                    let own = grid.row(y, z, x, (x + 1).min(nx - 1));
                    grid.test(&p, at + 1..own.end, r * r, &mut hit);
                    let (from, to) = (x.saturating_sub(1), (x + 1).min(nx - 1));
                    if y + 1 < ny {
                        grid.test(&p, grid.row(y + 1, z, from, to), r * r, &mut hit);
                    }
                    if z + 1 < nz {
                        for y in y.saturating_sub(1)..=(y + 1).min(ny - 1) {
                            grid.test(&p, grid.row(y, z + 1, from, to), r * r, &mut hit);
                        }
                    }
                }
            }
        }
    }
    pairs
}
