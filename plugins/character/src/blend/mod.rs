//! Blends: the weighted mean of any number of poses, joint by joint.
//!
//! Translations and scales are weighted means. Of rotations it is the direction of the weighted sum of
//! the quaternions (Markley, Cheng, Crassidis, Oshman, *Averaging Quaternions*, 2007, whose mean it is for
//! rotations close to each other), where each is taken with the sign that is nearer to the sum of those
//! before it. A fold of spherical interpolations would depend on the order of its inputs; here they are
//! put in an order of their own first, the heaviest in front, and equal weights by the bits of the poses.
//! So the bits of the result do not depend on the order in which they are handed in.
//!
//! Weights need no sum: each joint divides by its own. A joint that no input moves is at rest.

mod additive;
mod fade;
mod mask;

pub use additive::{Additive, make_additive};
pub use fade::Fade;
pub(crate) use fade::smooth;
pub use mask::Mask;

use crate::pose::{Joints8, Lane, Pose};
use crate::simd::{Quat8, dot, lerp, load, normalise, store};
use core::cmp::Ordering;
use fearless_simd::{Level, dispatch, f32x8, prelude::*};

/// A pose and how much of it.
#[derive(Clone, Copy, Debug)]
pub struct Layer<'a> {
    /// The pose.
    pub pose: &'a Pose,
    /// Its weight; what is negative or no number counts as 0.
    pub weight: f32,
    /// Joint by joint, multiplied by `weight`; all joints alike if there is none.
    pub mask: Option<&'a Mask>,
}

/// What blending works with. Holds memory only: its history changes no result.
#[derive(Clone, Debug)]
pub struct Blender {
    level: Level,
    order: Vec<u32>,
}

impl Default for Blender {
    fn default() -> Self {
        Self {
            level: Level::new(),
            order: Vec::new(),
        }
    }
}

/// A joint whose weights sum to no more than this is at rest: less than 1e-6 of a whole input, and f32
/// would begin to lose the digits of the mean below 1e-30.
const LEAST: f32 = 1e-6;

impl Blender {
    /// A blender.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// The mean of `layers`, into `out`, which is made as long as `rest`.
    ///
    /// # Panics
    /// If a pose or mask has another number of joints than `rest`.
    pub fn blend(&mut self, rest: &Pose, layers: &[Layer], out: &mut Pose) {
        out.resize(rest.len());
        for layer in layers {
            assert_eq!(layer.pose.len(), rest.len(), "a pose of another skeleton");
            let masked = layer.mask.is_none_or(|mask| mask.len() == rest.len());
            assert!(masked, "a mask of another skeleton");
        }
        self.order.clear();
        self.order.extend(0..layers.len() as u32);
        self.order
            .retain(|index| layers[*index as usize].weight > 0.0);
        self.order
            .sort_unstable_by(|a, b| before(&layers[*a as usize], &layers[*b as usize]));
        let order = &self.order[..];
        let (rest, out) = (rest.blocks(), out.blocks_mut());
        dispatch!(self.level, simd => mean(simd, rest, layers, order, out));
    }
}

impl Blender {
    /// Lays `layer` over `pose`: where it weighs 1 it hides what is beneath, where it weighs 0 it is not
    /// seen. Weights above 1 count as 1.
    ///
    /// # Panics
    /// If the layer or its mask has another number of joints.
    pub fn lay_over(&mut self, layer: &Layer, pose: &mut Pose) {
        assert_eq!(layer.pose.len(), pose.len(), "a pose of another skeleton");
        let masked = layer.mask.is_none_or(|mask| mask.len() == pose.len());
        assert!(masked, "a mask of another skeleton");
        if layer.weight > 0.0 {
            let blocks = pose.blocks_mut();
            dispatch!(self.level, simd => cover(simd, layer, blocks));
        }
    }
}

#[inline(always)]
fn cover<S: Simd>(simd: S, layer: &Layer, blocks: &mut [Joints8]) {
    let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
    for (index, block) in blocks.iter_mut().enumerate() {
        let over = &layer.pose.blocks()[index];
        let weight = weights(simd, layer, index).min(one);
        let beneath: Quat8<S> = load(simd, &block.rotation);
        let above: Quat8<S> = load(simd, &over.rotation);
        let signed = dot(&beneath, &above)
            .simd_lt(zero)
            .select(zero - weight, weight);
        let sum = core::array::from_fn(|i| beneath[i] * (one - weight) + above[i] * signed);
        store(&normalise(&sum), &mut block.rotation);
        let pairs = [
            (&mut block.translation, &over.translation),
            (&mut block.scale, &over.scale),
        ];
        for (under, over) in pairs {
            let (a, b): ([f32x8<S>; 3], [f32x8<S>; 3]) = (load(simd, under), load(simd, over));
            store(&lerp(&a, &b, weight), under);
        }
    }
}

/// The order of their own: heavier first. The bits decide between equal weights, so that only inputs which
/// are equal altogether may stand either way.
fn before(a: &Layer, b: &Layer) -> Ordering {
    b.weight
        .total_cmp(&a.weight)
        .then_with(|| compare_poses(a.pose, b.pose))
        .then_with(|| match (a.mask, b.mask) {
            (Some(a), Some(b)) => compare(a.lanes().iter().flatten(), b.lanes().iter().flatten()),
            (a, b) => a.is_some().cmp(&b.is_some()),
        })
}

fn compare_poses(a: &Pose, b: &Pose) -> Ordering {
    if core::ptr::eq(a, b) {
        return Ordering::Equal;
    }
    fn numbers(block: &Joints8) -> impl Iterator<Item = &f32> {
        let vectors = block
            .rotation
            .iter()
            .chain(&block.translation)
            .chain(&block.scale);
        vectors.flatten()
    }
    compare(
        a.blocks().iter().flat_map(numbers),
        b.blocks().iter().flat_map(numbers),
    )
}

fn compare<'a>(a: impl Iterator<Item = &'a f32>, b: impl Iterator<Item = &'a f32>) -> Ordering {
    a.zip(b)
        .map(|(a, b)| a.total_cmp(b))
        .find(|order| order.is_ne())
        .unwrap_or(Ordering::Equal)
}

#[inline(always)]
fn mean<S: Simd>(simd: S, rest: &[Joints8], layers: &[Layer], order: &[u32], out: &mut [Joints8]) {
    for (index, out) in out.iter_mut().enumerate() {
        mean_of_block(simd, index, &rest[index], layers, order, out);
    }
}

#[inline(always)]
fn mean_of_block<S: Simd>(
    simd: S,
    index: usize,
    rest: &Joints8,
    layers: &[Layer],
    order: &[u32],
    out: &mut Joints8,
) {
    let zero = f32x8::splat(simd, 0.0);
    let one = f32x8::splat(simd, 1.0);
    let mut translation = [zero; 3];
    let mut rotation: Quat8<S> = [zero; 4];
    let mut scale = [zero; 3];
    let mut total = zero;
    for layer in order.iter().map(|layer| &layers[*layer as usize]) {
        let block = &layer.pose.blocks()[index];
        let weight = weights(simd, layer, index);
        let q: Quat8<S> = load(simd, &block.rotation);
        let signed = dot(&rotation, &q)
            .simd_lt(zero)
            .select(zero - weight, weight);
        for i in 0..4 {
            rotation[i] += q[i] * signed;
        }
        add(&mut translation, &load(simd, &block.translation), weight);
        add(&mut scale, &load(simd, &block.scale), weight);
        total += weight;
    }
    let there = total.simd_gt(f32x8::splat(simd, LEAST));
    let inverse = one / there.select(total, one);
    let q = normalise(&rotation);
    store(
        &pick::<S, 4>(simd, there, &q, &rest.rotation),
        &mut out.rotation,
    );
    let translation = translation.map(|sum| sum * inverse);
    store(
        &pick::<S, 3>(simd, there, &translation, &rest.translation),
        &mut out.translation,
    );
    let scale = scale.map(|sum| sum * inverse);
    store(
        &pick::<S, 3>(simd, there, &scale, &rest.scale),
        &mut out.scale,
    );
}

/// The weights of a layer in the lanes of block `index`.
#[inline(always)]
pub(crate) fn weights<S: Simd>(simd: S, layer: &Layer, index: usize) -> f32x8<S> {
    let weight = f32x8::splat(simd, layer.weight);
    match layer.mask {
        Some(mask) => weight * f32x8::from_slice(simd, &mask.lanes()[index]),
        None => weight,
    }
}

#[inline(always)]
fn add<S: Simd>(sum: &mut [f32x8<S>; 3], value: &[f32x8<S>; 3], weight: f32x8<S>) {
    for i in 0..3 {
        sum[i] += value[i] * weight;
    }
}

#[inline(always)]
fn pick<S: Simd, const N: usize>(
    simd: S,
    there: <f32x8<S> as SimdBase<S>>::Mask,
    value: &[f32x8<S>; N],
    rest: &[Lane; N],
) -> [f32x8<S>; N] {
    let rest = load(simd, rest);
    core::array::from_fn(|i| there.select(value[i], rest[i]))
}
