//! Sampling: all joints at one moment.

use super::axis::Span;
use super::{AT_REST, Block, Clip, Interpolation, LaneKeys, Track, stride};
use crate::pose::{Joints8, LANES, Lane, Pose};
use crate::simd::{hermite, lerp, load, load_flat, normalise, slerp, store};
use fearless_simd::{Level, dispatch, f32x8, prelude::*};

/// What sampling works with. Holds memory only: its history changes no result.
#[derive(Clone, Debug)]
pub struct Sampler {
    level: Level,
    spans: Vec<Span>,
}

impl Default for Sampler {
    fn default() -> Self {
        Self {
            level: Level::new(),
            spans: Vec::new(),
        }
    }
}

impl Sampler {
    /// A sampler.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// All joints of `clip` at `time` seconds; `pose` is made as long as it has to be.
    ///
    /// Before the first key of a channel the joint is as at the first, after the last as at the last.
    /// A time that is no number counts as before.
    pub fn sample(&mut self, clip: &Clip, time: f32, pose: &mut Pose) {
        pose.resize(clip.joints);
        self.spans.clear();
        self.spans
            .extend(clip.axes.iter().map(|axis| axis.find(time)));
        let spans = &self.spans[..];
        let blocks = pose.blocks_mut();
        dispatch!(self.level, simd => all(simd, clip, spans, blocks));
    }
}

#[inline(always)]
fn all<S: Simd>(simd: S, clip: &Clip, spans: &[Span], blocks: &mut [Joints8]) {
    for (index, block) in blocks.iter_mut().enumerate() {
        translate(
            simd,
            &clip.translations,
            index,
            spans,
            &mut block.translation,
        );
        rotate(simd, &clip.rotations, index, spans, &mut block.rotation);
        translate(simd, &clip.scales, index, spans, &mut block.scale);
    }
}

/// Translations and scales of one block.
#[inline(always)]
fn translate<S: Simd>(
    simd: S,
    track: &Track<3>,
    index: usize,
    spans: &[Span],
    out: &mut [Lane; 3],
) {
    match &track.blocks[index] {
        Block::Constant(value) => *out = *value,
        Block::Uniform {
            axis,
            interpolation,
            at,
        } => {
            let keys = Keys::new(
                spans[*axis as usize],
                *interpolation,
                *at,
                stride::<3>(*interpolation),
            );
            let result = match interpolation {
                Interpolation::Cubic => spline(simd, &track.keys, &keys),
                _ => lerp(
                    &load_flat(simd, &track.keys, keys.from),
                    &load_flat(simd, &track.keys, keys.to),
                    f32x8::splat(simd, keys.part),
                ),
            };
            store(&result, out);
        }
        Block::Mixed { at } => {
            let ends = gather(
                &track.keys,
                &track.lanes[*at as usize..][..LANES],
                spans,
                |_| {},
            );
            let result = lerp(
                &load(simd, &ends.from),
                &load(simd, &ends.to),
                f32x8::from_slice(simd, &ends.part),
            );
            store(&result, out);
        }
    }
}

/// Rotations of one block.
#[inline(always)]
fn rotate<S: Simd>(simd: S, track: &Track<4>, index: usize, spans: &[Span], out: &mut [Lane; 4]) {
    match &track.blocks[index] {
        Block::Constant(value) => *out = *value,
        Block::Uniform {
            axis,
            interpolation,
            at,
        } => {
            let keys = Keys::new(
                spans[*axis as usize],
                *interpolation,
                *at,
                stride::<4>(*interpolation),
            );
            let result = match interpolation {
                Interpolation::Cubic => normalise(&spline(simd, &track.keys, &keys)),
                _ => slerp(
                    &load_flat(simd, &track.keys, keys.from),
                    &load_flat(simd, &track.keys, keys.to),
                    f32x8::splat(simd, keys.part),
                ),
            };
            store(&result, out);
        }
        Block::Mixed { at } => {
            let ends = gather(
                &track.keys,
                &track.lanes[*at as usize..][..LANES],
                spans,
                unit,
            );
            let result = slerp(
                &load(simd, &ends.from),
                &load(simd, &ends.to),
                f32x8::from_slice(simd, &ends.part),
            );
            store(&result, out);
        }
    }
}

/// The two keys of a uniform block.
struct Keys {
    from: usize,
    to: usize,
    part: f32,
    length: f32,
}

impl Keys {
    #[inline(always)]
    fn new(span: Span, interpolation: Interpolation, at: u32, stride: usize) -> Self {
        let from = at as usize + span.key as usize * stride;
        Self {
            from,
            to: from + stride,
            part: step(span.part, interpolation),
            length: span.length,
        }
    }
}

/// A step stays at its first key until the second is reached.
#[inline(always)]
fn step(part: f32, interpolation: Interpolation) -> f32 {
    if interpolation == Interpolation::Step && part < 1.0 {
        0.0
    } else {
        part
    }
}

#[inline(always)]
fn spline<S: Simd, const N: usize>(simd: S, flat: &[f32], keys: &Keys) -> [f32x8<S>; N] {
    let part = N * LANES;
    hermite(
        &load_flat(simd, flat, keys.from + part),
        &load_flat(simd, flat, keys.from + 2 * part),
        &load_flat(simd, flat, keys.to + part),
        &load_flat(simd, flat, keys.to),
        f32x8::splat(simd, keys.part),
        f32x8::splat(simd, keys.length),
    )
}

/// Both keys of every lane of a mixed block.
struct Ends<const N: usize> {
    from: [Lane; N],
    to: [Lane; N],
    part: Lane,
}

/// Lanes whose keys lie anywhere. A spline's value is found here, lane by lane, finished by `finish`, and
/// stands at both ends.
#[inline(always)]
fn gather<const N: usize>(
    keys: &[f32],
    lanes: &[LaneKeys],
    spans: &[Span],
    finish: impl Fn(&mut [f32; N]),
) -> Ends<N> {
    let mut ends = Ends {
        from: [[0.0; LANES]; N],
        to: [[0.0; LANES]; N],
        part: [0.0; LANES],
    };
    for (lane, source) in lanes.iter().enumerate() {
        let (mut from, mut to) = (source.at as usize, source.at as usize);
        if source.axis != AT_REST {
            let span = spans[source.axis as usize];
            if source.interpolation == Interpolation::Cubic {
                let mut value =
                    lane_spline(&keys[from + span.key as usize * 3 * N..][..6 * N], span);
                finish(&mut value);
                for (i, number) in value.into_iter().enumerate() {
                    ends.from[i][lane] = number;
                    ends.to[i][lane] = number;
                }
                continue;
            }
            from += span.key as usize * N;
            to = from + N;
            ends.part[lane] = step(span.part, source.interpolation);
        }
        let (from, to) = (&keys[from..from + N], &keys[to..to + N]);
        for i in 0..N {
            ends.from[i][lane] = from[i];
            ends.to[i][lane] = to[i];
        }
    }
    ends
}

/// `hermite` of one lane; `two` keys of three parts each.
#[inline(always)]
fn lane_spline<const N: usize>(two: &[f32], span: Span) -> [f32; N] {
    let (u, dt) = (span.part, span.length);
    let (v, u2) = (1.0 - u, u * u);
    let of_a = v * v * (u * 2.0 + 1.0);
    let of_b = u2 * (3.0 - u * 2.0);
    let of_out = u * v * v * dt;
    let of_in = 0.0 - u2 * v * dt;
    core::array::from_fn(|i| {
        (two[N + i] * of_a + two[4 * N + i] * of_b)
            + (two[2 * N + i] * of_out + two[3 * N + i] * of_in)
    })
}

/// Makes a unit quaternion, as `normalise` does.
#[inline(always)]
fn unit(q: &mut [f32; 4]) {
    let square = (q[0] * q[0] + q[1] * q[1]) + (q[2] * q[2] + q[3] * q[3]);
    if square > 1e-30 {
        let inverse = 1.0 / square.sqrt();
        *q = q.map(|x| x * inverse);
    } else {
        *q = [0.0, 0.0, 0.0, 1.0];
    }
}
