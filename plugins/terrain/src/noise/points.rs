//! Many points of a fractal in f32: any places, in blocks, in native vectors.
//!
//! The 96-bit coordinate products are taken apart into those of 32 bits, which vector units have; hashing, noise
//! and sums run over the lanes. The operations on a sample are those of `scalar`, in the same order, so
//! the bits are the same.

use super::fractal::PreparedFractal;
use super::lattice::{Place, cell_gradients, fade};
use super::octave::{Octave, PreparedWarp};
use super::real::{Real, Wide};
use super::scalar::{displacement_fixed, unwarp};
use super::sum::{Fbm, Kind, STATE, with_kind};
use fearless_simd::{Level, dispatch, prelude::*};

/// Points worked on together; a multiple of every native vector length.
pub(crate) const BLOCK: usize = 64;

/// Positions of a block: x and z, 32.32 fixed-point metres.
pub(crate) type Positions = [[i64; BLOCK]; 2];
/// Value, ∂/∂x, ∂/∂z of a block.
pub(crate) type Block = [[f32; BLOCK]; 3];

/// The block of the places `place(0)` to `place(BLOCK − 1)`.
pub(crate) fn positions(place: impl Fn(usize) -> [i64; 2]) -> Positions {
    let places: [[i64; 2]; BLOCK] = core::array::from_fn(place);
    [places.map(|place| place[0]), places.map(|place| place[1])]
}

/// Evaluates a block of places, warp and all.
pub(crate) fn block(level: Level, fractal: &PreparedFractal, positions: &Positions) -> Block {
    let at = |positions: &Positions| -> Block {
        with_kind!(fractal.sum, K => {
            octaves::<K>(level, &fractal.octaves, fractal.erosion, positions)
        })
    };
    let Some(warp) = &fractal.warp else {
        return at(positions);
    };
    let [x, z] = displacement(level, warp, positions);
    let mut out = at(&moved(positions, &x, &z));
    for i in 0..BLOCK {
        let lane = |block: &Block| [block[0][i], block[1][i], block[2][i]];
        [out[0][i], out[1][i], out[2][i]] = unwarp(lane(&out), lane(&x), lane(&z));
    }
    out
}

/// The displacement of a warp along x and z, with its gradients.
fn displacement(level: Level, warp: &PreparedWarp, positions: &Positions) -> [Block; 2] {
    [&warp.x, &warp.z].map(|table| octaves::<Fbm>(level, table, 0.0, positions))
}

/// The places displaced.
fn moved(positions: &Positions, x: &Block, z: &Block) -> Positions {
    let mut moved = *positions;
    for i in 0..BLOCK {
        moved[0][i] = positions[0][i].wrapping_add(displacement_fixed(x[0][i]));
        moved[1][i] = positions[1][i].wrapping_add(displacement_fixed(z[0][i]));
    }
    moved
}

/// Where a warp takes a block of places.
pub(crate) fn displaced(level: Level, warp: &PreparedWarp, positions: &Positions) -> Positions {
    let [x, z] = displacement(level, warp, positions);
    moved(positions, &x, &z)
}

/// Sums a list of octaves over a block of places.
pub(crate) fn octaves<K: Kind>(
    level: Level,
    octaves: &[Octave],
    erosion: f32,
    positions: &Positions,
) -> Block {
    let mut state: [[f32; BLOCK]; STATE] = K::START.map(|start| [start; BLOCK]);
    let mut places = Places {
        cell: [[0; BLOCK]; 2],
        fraction: [[0.0; BLOCK]; 2],
    };
    for octave in octaves {
        dispatch!(level, simd => {
            places.enter(octave, positions);
            places.add::<_, K>(simd, octave, erosion, &mut state);
        });
    }
    [state[0], state[1], state[2]]
}

/// Where a block of places lies in an octave's lattice: x, z.
struct Places {
    cell: [[u32; BLOCK]; 2],
    fraction: [[f32; BLOCK]; 2],
}

impl Places {
    #[inline(always)]
    fn enter(&mut self, octave: &Octave, positions: &Positions) {
        for (axis, positions) in positions.iter().enumerate() {
            octave.frequency.coordinates(
                positions,
                octave.offset[axis],
                &mut self.cell[axis],
                &mut self.fraction[axis],
            );
        }
    }

    #[inline(always)]
    fn add<S: Simd, K: Kind>(
        &self,
        simd: S,
        octave: &Octave,
        erosion: f32,
        state: &mut [[f32; BLOCK]; STATE],
    ) {
        let zero = S::u32s::splat(simd, 0);
        for i in (0..BLOCK).step_by(S::f32s::LEN) {
            let range = i..i + S::f32s::LEN;
            let x = S::u32s::from_slice(simd, &self.cell[0][range.clone()]);
            let z = S::u32s::from_slice(simd, &self.cell[1][range.clone()]) + octave.seed;
            // The hash of a row is that of a point in column 0 (see `hash`).
            let row0 = Wide::<S>::point_hash(z, zero);
            let row1 = Wide::<S>::point_hash(Wide::<S>::next(z), zero);
            let fx = Wide::<S>(S::f32s::from_slice(simd, &self.fraction[0][range.clone()]));
            let fz = Wide::<S>(S::f32s::from_slice(simd, &self.fraction[1][range.clone()]));
            let ends = cell_gradients::<Wide<S>>(x, row0, row1);
            let place = Place::new(ends, (fx, fade(fx)), (fz, fade(fz)));
            let mut lanes = [fx.like(0.0); STATE];
            for k in 0..K::USED {
                lanes[k] = Wide(S::f32s::from_slice(simd, &state[k][range.clone()]));
            }
            K::step(&mut lanes, &place, &octave.scale, erosion);
            for k in 0..K::USED {
                lanes[k].0.store_slice(&mut state[k][range.clone()]);
            }
        }
    }
}
