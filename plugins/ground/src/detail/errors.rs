//! How far the meshes that bisection makes of a cell are from its samples; the CPU reference of
//! `shaders/src/detail/errors.wgsl`.
//!
//! A mesh interpolates between corners: what it draws at a sample is a sum of corners by weights that depend
//! on the sample's place alone. For the larger squares these weights are tables, so that the loops are plain
//! sums of products over all samples; in the smallest ones few samples lie between, and each of them in the
//! middle of two others.

/// Steps between samples along a side of a cell, a power of two of at least 4.
pub const STEPS: usize = 8;
/// Samples along a side of a cell.
pub const SAMPLES: usize = STEPS + 1;
/// Samples of a cell, rows of constant z.
pub const COUNT: usize = SAMPLES * SAMPLES;

/// Samples of a cell in whole vectors of eight; those that fill up have no weight.
const PADDED: usize = COUNT.next_multiple_of(8);
/// Steps along a side of a cell's quarter, samples along it, and all of them, in whole vectors.
const HALF: usize = STEPS / 2;
const HALF_PADDED: usize = ((HALF + 1) * (HALF + 1)).next_multiple_of(8);

/// Largest distances of samples from meshes of a cell, in the unit of the samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MeshErrors {
    /// Of the cell cut by its diagonal alone.
    pub halves: f32,
    /// Of the cell cut into four by its centre, at each side. What lies on a line between two of these
    /// triangles counts for one of them; it is in `finer` too, as it lies on diagonals there.
    pub quarters: [f32; 4],
    /// Of all meshes that are finer, down to triangles of two samples a side.
    pub finer: f32,
    /// Of the finest of them: the largest second difference of neighbouring samples along rows and columns.
    pub finest: f32,
}

impl MeshErrors {
    /// What two surfaces err by together, the other counted by a share: the larger of each.
    #[must_use]
    pub fn or(&self, other: &Self, share: f32) -> Self {
        let larger = |a: f32, b: f32| if b * share > a { b * share } else { a };
        Self {
            halves: larger(self.halves, other.halves),
            quarters: std::array::from_fn(|k| larger(self.quarters[k], other.quarters[k])),
            finer: larger(self.finer, other.finer),
            finest: larger(self.finest, other.finest),
        }
    }

    /// The same where second differences of neighbouring samples are as large as `bend` at least.
    #[must_use]
    pub const fn bent(self, bend: f32) -> Self {
        Self {
            finer: greater(self.finer, bend),
            finest: greater(self.finest, bend),
            ..self
        }
    }
}

/// The largest second difference of neighbouring samples along rows and columns, in the unit of the samples.
#[must_use]
pub fn bend(samples: &[f32; COUNT]) -> f32 {
    second_differences(samples).0
}

/// Errors of a cell whose diagonal goes through corner `outer`.
///
/// Samples should be taken relative to one of them: then what they are rounded by is small where the cell
/// is. What is not a number counts as no error.
#[must_use]
pub fn mesh_errors(samples: &[f32; COUNT], outer: usize) -> MeshErrors {
    let mut padded = [0.0; PADDED];
    padded[..COUNT].copy_from_slice(samples);
    let at = |i: usize, j: usize| samples[j * SAMPLES + i];
    let corners = [at(0, 0), at(STEPS, 0), at(STEPS, STEPS), at(0, STEPS)];
    let mut errors = MeshErrors {
        halves: largest(&HALVES[outer & 1].off(&padded, corners, 0.0)),
        ..MeshErrors::default()
    };
    let off = QUARTERS.off(&padded, corners, at(HALF, HALF));
    for (&side, &off) in SIDES.iter().zip(&off) {
        let own = &mut errors.quarters[side as usize];
        *own = greater(*own, off);
    }
    for j in 0..2 {
        for i in 0..2 {
            let all = quarter_errors(samples, i, j);
            errors.finer = greater(errors.finer, all);
        }
    }
    let (sides, centres) = second_differences(samples);
    errors.finest = sides;
    errors.finer = greater(errors.finer, greater(sides, centres));
    errors
}

/// At which corner of the square of two the square (i, j) lies.
const fn quarter_of(i: usize, j: usize) -> usize {
    match (i % 2, j % 2) {
        (0, 0) => 0,
        (1, 0) => 1,
        (1, _) => 2,
        _ => 3,
    }
}

/// The greater; what is not a number counts as nothing.
const fn greater(a: f32, b: f32) -> f32 {
    if b > a { b } else { a }
}

/// The largest, lane by lane first, so that eight are compared at once.
fn largest(off: &[f32]) -> f32 {
    let mut lanes = [0.0; 8];
    for eight in off.chunks_exact(8) {
        for (lane, &off) in lanes.iter_mut().zip(eight) {
            *lane = greater(*lane, off);
        }
    }
    lanes.into_iter().fold(0.0, greater)
}

/// Of a quarter of the cell, cut by its diagonal and into four.
fn quarter_errors(samples: &[f32; COUNT], i: usize, j: usize) -> f32 {
    let mut own = [0.0; HALF_PADDED];
    for z in 0..=HALF {
        let from = (j * HALF + z) * SAMPLES + i * HALF;
        own[z * (HALF + 1)..(z + 1) * (HALF + 1)].copy_from_slice(&samples[from..=from + HALF]);
    }
    let at = |x: usize, z: usize| own[z * (HALF + 1) + x];
    let corners = [at(0, 0), at(HALF, 0), at(HALF, HALF), at(0, HALF)];
    let halves = HALF_HALVES[quarter_of(i, j) & 1].off(&own, corners, 0.0);
    let quarters = HALF_QUARTERS.off(&own, corners, at(HALF / 2, HALF / 2));
    greater(largest(&halves), largest(&quarters))
}

/// Of the squares of two steps: how far the middles of their sides lie between the ends, and their centres
/// between the ends of their diagonals.
fn second_differences(samples: &[f32; COUNT]) -> (f32, f32) {
    let at = |i: usize, j: usize| samples[j * SAMPLES + i];
    let off = |middle: f32, a: f32, b: f32| (middle - 0.5 * (a + b)).abs();
    let (mut sides, mut centres) = (0.0, 0.0);
    for even in (0..=STEPS).step_by(2) {
        for odd in (1..STEPS).step_by(2) {
            let along = off(at(odd, even), at(odd - 1, even), at(odd + 1, even));
            let across = off(at(even, odd), at(even, odd - 1), at(even, odd + 1));
            sides = greater(sides, greater(along, across));
        }
    }
    for j in (1..STEPS).step_by(2) {
        for i in (1..STEPS).step_by(2) {
            let even = quarter_of(i / 2, j / 2).is_multiple_of(2);
            let (low, high) = if even { (j - 1, j + 1) } else { (j + 1, j - 1) };
            let centre = off(at(i, j), at(i - 1, low), at(i + 1, high));
            centres = greater(centres, centre);
        }
    }
    (sides, centres)
}

/// How much the corners of a square, and its middle, count at each of its samples.
struct Weights<const L: usize> {
    corners: [[f32; L]; 4],
    middle: [f32; L],
}

static HALVES: [Weights<PADDED>; 2] = [Weights::halves(STEPS, 0), Weights::halves(STEPS, 1)];
static QUARTERS: Weights<PADDED> = Weights::quarters(STEPS);
static HALF_HALVES: [Weights<HALF_PADDED>; 2] =
    [Weights::halves(HALF, 0), Weights::halves(HALF, 1)];
static HALF_QUARTERS: Weights<HALF_PADDED> = Weights::quarters(HALF);
/// At which side's triangle each sample of a cell lies.
static SIDES: [u8; COUNT] = sides();

/// The side at whose triangle a place lies; the place about the middle, in half steps. On a line between
/// triangles both draw the same.
const fn side_of(dx: i32, dz: i32) -> usize {
    if dx.abs() > dz.abs() {
        if dx < 0 { 0 } else { 2 }
    } else if dz < 0 {
        1
    } else {
        3
    }
}

const fn sides() -> [u8; COUNT] {
    let mut sides = [0; COUNT];
    let mut k = 0;
    while k < COUNT {
        let (x, z) = ((k % SAMPLES) as i32, (k / SAMPLES) as i32);
        let steps = STEPS as i32;
        sides[k] = side_of(2 * x - steps, 2 * z - steps) as u8;
        k += 1;
    }
    sides
}

impl<const L: usize> Weights<L> {
    const NONE: Self = Self {
        corners: [[0.0; L]; 4],
        middle: [0.0; L],
    };

    /// Of two triangles, for squares of `n` steps whose diagonal goes through corner `outer`.
    const fn halves(n: usize, outer: usize) -> Self {
        let mut weights = Self::NONE;
        let mut k = 0;
        while k < (n + 1) * (n + 1) {
            let (x, z) = (k % (n + 1), k / (n + 1));
            let (u, v) = (x as f32 / n as f32, z as f32 / n as f32);
            let corners = &mut weights.corners;
            if outer.is_multiple_of(2) {
                // Diagonal from corner 0 to corner 2, by corner 1 or corner 3.
                let (more, less) = if x > z { (u, v) } else { (v, u) };
                corners[0][k] = 1.0 - more;
                corners[if x > z { 1 } else { 3 }][k] = more - less;
                corners[2][k] = less;
            } else {
                // From corner 1 to corner 3, by corner 0 or corner 2.
                let before = x + z < n;
                let (more, less) = if before { (1.0 - u, v) } else { (v, 1.0 - u) };
                corners[1][k] = 1.0 - more;
                corners[if before { 0 } else { 2 }][k] = more - less;
                corners[3][k] = less;
            }
            k += 1;
        }
        weights
    }

    /// Of four triangles about the middle.
    const fn quarters(n: usize) -> Self {
        let mut weights = Self::NONE;
        let mut k = 0;
        while k < (n + 1) * (n + 1) {
            let (x, z) = ((k % (n + 1)) as i32, (k / (n + 1)) as i32);
            let (dx, dz) = (2 * x - n as i32, 2 * z - n as i32);
            let side = side_of(dx, dz);
            let unit = n as f32;
            let out = if dx.abs() > dz.abs() { dx } else { dz }.abs() as f32 / unit;
            // Along the side from corner k − 1 to corner k, −out to out.
            let along = [-dz, dx, dz, -dx][side] as f32 / unit;
            weights.middle[k] = 1.0 - out;
            weights.corners[(side + 3) % 4][k] = 0.5 * (out - along);
            weights.corners[side][k] = 0.5 * (out + along);
            k += 1;
        }
        weights
    }

    /// How far samples are off the mesh.
    fn off(&self, samples: &[f32; L], corners: [f32; 4], middle: f32) -> [f32; L] {
        let [a, b, c, d] = &self.corners;
        let mut off = [0.0; L];
        for (k, off) in off.iter_mut().enumerate() {
            let drawn = (corners[0] * a[k] + corners[1] * b[k])
                + (corners[2] * c[k] + corners[3] * d[k])
                + middle * self.middle[k];
            *off = (samples[k] - drawn).abs();
        }
        off
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(surface: impl Fn(f64, f64) -> f64) -> [f32; COUNT] {
        let at = |k: usize| k as f64 / STEPS as f64;
        std::array::from_fn(|k| surface(at(k % SAMPLES), at(k / SAMPLES)) as f32)
    }

    /// The largest error of every mesh, from triangles: f64, barycentric, nothing shared with the tables.
    fn by_triangles(samples: &[f32; COUNT], outer: usize) -> MeshErrors {
        let at = |i: usize, j: usize| f64::from(samples[j * SAMPLES + i]);
        let over = |triangles: &[[(usize, usize); 3]]| {
            let mut worst = 0.0_f64;
            for &[a, b, c] in triangles {
                let area = |p: (usize, usize), q: (usize, usize), r: (usize, usize)| {
                    let of = |p: (usize, usize)| (p.0 as f64, p.1 as f64);
                    let (p, q, r) = (of(p), of(q), of(r));
                    (q.0 - p.0) * (r.1 - p.1) - (q.1 - p.1) * (r.0 - p.0)
                };
                let whole = area(a, b, c);
                for p in (0..COUNT).map(|k| (k % SAMPLES, k / SAMPLES)) {
                    let weights = [area(p, b, c), area(a, p, c), area(a, b, p)].map(|w| w / whole);
                    if weights.iter().all(|&w| w >= 0.0) {
                        let corners = [a, b, c].map(|(i, j)| at(i, j));
                        let drawn: f64 = (0..3).map(|k| weights[k] * corners[k]).sum();
                        worst = worst.max((at(p.0, p.1) - drawn).abs());
                    }
                }
            }
            worst as f32
        };
        let corners =
            |i: usize, j: usize, n: usize| [(i, j), (i + n, j), (i + n, j + n), (i, j + n)];
        let halves = |i, j, n, outer: usize| {
            let c = corners(i, j, n);
            [0, 2].map(|k| [c[outer % 2], c[(outer + 1 + k) % 4], c[(outer % 2) + 2]])
        };
        let quarter = |i: usize, j: usize, n: usize, side: usize| {
            let c = corners(i, j, n);
            [(i + n / 2, j + n / 2), c[(side + 3) % 4], c[side]]
        };
        let mut errors = MeshErrors {
            halves: over(&halves(0, 0, STEPS, outer)),
            quarters: std::array::from_fn(|side| over(&[quarter(0, 0, STEPS, side)])),
            ..MeshErrors::default()
        };
        for n in [4, 2] {
            for (i, j) in (0..STEPS / n).flat_map(|j| (0..STEPS / n).map(move |i| (i, j))) {
                let own = quarter_of(i, j);
                let cut = over(&halves(i * n, j * n, n, own));
                let four = (0..4).map(|side| over(&[quarter(i * n, j * n, n, side)]));
                let four = four.fold(0.0, f32::max);
                errors.finer = errors.finer.max(cut).max(four);
                if n == 2 {
                    errors.finest = errors.finest.max(four);
                }
            }
        }
        errors
    }

    #[test]
    fn tables_err_as_triangles_do() {
        let mut state = 1_u32;
        for round in 0..64 {
            let samples: [f32; COUNT] = std::array::from_fn(|_| {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                (state >> 8) as f32 / 16_777_216.0 - 0.5
            });
            for outer in 0..4 {
                let (found, expected) =
                    (mesh_errors(&samples, outer), by_triangles(&samples, outer));
                // A sample on the line between two triangles counts for one of them, and once more in what
                // is finer, whose diagonals lie there.
                let all = |e: &MeshErrors| {
                    let [a, b, c, d] = e.quarters.map(|own| own.max(e.finer));
                    [e.halves, a, b, c, d, e.finer, e.finest]
                };
                for (found, expected) in all(&found).into_iter().zip(all(&expected)) {
                    // Five roundings of numbers below 1.
                    assert!(
                        (found - expected).abs() < 4e-7,
                        "{round}: {found} {expected}"
                    );
                }
            }
        }
    }

    #[test]
    fn what_is_not_a_number_is_no_error() {
        let mut samples = grid(|u, v| u * v);
        let before = mesh_errors(&samples, 0);
        samples[SAMPLES + 1] = f32::NAN;
        let after = mesh_errors(&samples, 0);
        assert_eq!(before.halves, after.halves);
        assert!(after.finer.is_finite() && after.quarters.iter().all(|q| q.is_finite()));
    }
}
