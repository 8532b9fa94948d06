#define_import_path dolomite::terrain::noise

// Gradient noise on the square lattice: value, gradient and Hessian in one evaluation. CPU reference:
// plugins/terrain/src/noise/lattice.rs, where the formulas are derived. Lengths are in cells:
// fx, fz in 0 up to 1; the value lies in -1..1.

#import dolomite::terrain::hash::{pcg, halves}

// Quintic fade (Perlin 2002) and its first two derivatives, about the middle of the cell.
fn fade(t: f32) -> vec3<f32> {
    let s = t - 0.5;
    let s2 = s * s;
    let value = s * (1.875 - s2 * (5.0 - s2 * 6.0)) + 0.5;
    let q = t * (1.0 - t);
    return vec3(value, q * q * 30.0, q * 60.0 * (1.0 - (t + t)));
}

// Gradients of the four lattice points of a cell: x0, z0 at the lower z, x1, z1 at the upper.
struct CellGradients {
    west: vec4<f32>,
    east: vec4<f32>,
}

fn cell_gradients(x: u32, z: u32, seed: u32) -> CellGradients {
    let row0 = pcg(z + seed);
    let row1 = pcg(z + 1u + seed);
    return CellGradients(
        vec4(halves(pcg(x + row0)), halves(pcg(x + row1))),
        vec4(halves(pcg(x + 1u + row0)), halves(pcg(x + 1u + row1))),
    );
}

// What a lattice column contributes at a given fz: slope, rise, and their derivatives along z.
fn column(ends: vec4<f32>, fz: f32, w: vec3<f32>) -> vec4<f32> {
    let turn = ends.z - ends.x;
    let rise0 = ends.y * fz;
    let lift = ends.w * (fz - 1.0) - rise0;
    return vec4(
        ends.x + w.x * turn,
        rise0 + w.x * lift,
        w.y * turn,
        (ends.y + w.x * (ends.w - ends.y)) + w.y * lift,
    );
}

// Second derivatives along z of slope and rise.
fn column_bend(ends: vec4<f32>, fz: f32, w: vec3<f32>) -> vec2<f32> {
    let lift = ends.w * (fz - 1.0) - ends.y * fz;
    return vec2(
        w.z * (ends.z - ends.x),
        (w.y + w.y) * (ends.w - ends.y) + w.z * lift,
    );
}

struct NoiseSample {
    // Value, d/dx, d/dz.
    first: vec3<f32>,
    // d2/dx2, d2/dxdz, d2/dz2.
    second: vec3<f32>,
}

// Value and gradient.
fn cell_noise(ends: CellGradients, fx: f32, fz: f32) -> vec3<f32> {
    let u = fade(fx);
    let w = fade(fz);
    let a = column(ends.west, fz, w);
    let b = column(ends.east, fz, w);
    let gx = fx - 1.0;
    let left = a.x * fx + a.y;
    let step = (b.x * gx + b.y) - left;
    let left_z = a.z * fx + a.w;
    let right_z = b.z * gx + b.w;
    return vec3(
        left + u.x * step,
        (a.x + u.x * (b.x - a.x)) + u.y * step,
        left_z + u.x * (right_z - left_z),
    );
}

// Value, gradient and Hessian.
fn cell_noise_bent(ends: CellGradients, fx: f32, fz: f32) -> NoiseSample {
    let u = fade(fx);
    let w = fade(fz);
    let a = column(ends.west, fz, w);
    let b = column(ends.east, fz, w);
    let a2 = column_bend(ends.west, fz, w);
    let b2 = column_bend(ends.east, fz, w);
    let gx = fx - 1.0;
    let step = (b.x * gx + b.y) - (a.x * fx + a.y);
    let step_z = (b.z * gx + b.w) - (a.z * fx + a.w);
    let left_zz = a2.x * fx + a2.y;
    let right_zz = b2.x * gx + b2.y;
    let hessian = vec3(
        (u.y + u.y) * (b.x - a.x) + u.z * step,
        (a.z + u.x * (b.z - a.z)) + u.y * step_z,
        left_zz + u.x * (right_zz - left_zz),
    );
    return NoiseSample(cell_noise(ends, fx, fz), hessian);
}
