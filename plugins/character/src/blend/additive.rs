//! Additive poses: what a clip adds to whatever it is laid on.
//!
//! An additive pose has, for each joint, the translation that is added, the rotation that is applied in
//! the joint's own frame (`base · delta`), and the factors of the scale. Several are summed before they
//! are applied, so their order does not matter either:
//! translation + Σ wᵢ tᵢ, rotation · direction of (1 + Σ wᵢ (δᵢ − 1)), scale · (1 + Σ wᵢ (sᵢ − 1)).

use super::{Blender, Layer, before, weights};
use crate::pose::{Joints8, Pose};
use crate::simd::{Quat8, load, normalise, store};
use fearless_simd::{Level, dispatch, f32x8, prelude::*};

/// A pose that is added: [`make_additive`] makes it.
pub type Additive = Pose;

/// How `pose` differs from `reference`, which has as many joints.
///
/// # Panics
/// If the numbers of joints differ.
pub fn make_additive(pose: &Pose, reference: &Pose, out: &mut Additive) {
    assert_eq!(pose.len(), reference.len(), "poses of two skeletons");
    out.resize(pose.len());
    let pairs = pose.blocks().iter().zip(reference.blocks());
    for ((pose, reference), out) in pairs.zip(out.blocks_mut()) {
        dispatch!(Level::new(), simd => difference(simd, pose, reference, out));
    }
}

impl Blender {
    /// Adds `layers` of additive poses to `pose`.
    ///
    /// # Panics
    /// If an additive pose or its mask has another number of joints.
    pub fn add(&mut self, layers: &[Layer], pose: &mut Pose) {
        for layer in layers {
            assert_eq!(layer.pose.len(), pose.len(), "a pose of another skeleton");
            let masked = layer.mask.is_none_or(|mask| mask.len() == pose.len());
            assert!(masked, "a mask of another skeleton");
        }
        self.order.clear();
        self.order.extend(0..layers.len() as u32);
        self.order
            .retain(|index| layers[*index as usize].weight > 0.0);
        self.order
            .sort_unstable_by(|a, b| before(&layers[*a as usize], &layers[*b as usize]));
        let order = &self.order[..];
        if order.is_empty() {
            return;
        }
        for (index, block) in pose.blocks_mut().iter_mut().enumerate() {
            dispatch!(self.level, simd => apply(simd, index, layers, order, block));
        }
    }
}

/// a · b.
#[inline(always)]
fn product<S: Simd>(a: &Quat8<S>, b: &Quat8<S>) -> Quat8<S> {
    let ([ax, ay, az, aw], [bx, by, bz, bw]) = (*a, *b);
    [
        (aw * bx + ax * bw) + (ay * bz - az * by),
        (aw * by + ay * bw) + (az * bx - ax * bz),
        (aw * bz + az * bw) + (ax * by - ay * bx),
        (aw * bw - ax * bx) - (ay * by + az * bz),
    ]
}

#[inline(always)]
fn difference<S: Simd>(simd: S, pose: &Joints8, reference: &Joints8, out: &mut Joints8) {
    let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
    let (p, r): ([f32x8<S>; 3], [f32x8<S>; 3]) = (
        load(simd, &pose.translation),
        load(simd, &reference.translation),
    );
    store(
        &core::array::from_fn::<_, 3, _>(|i| p[i] - r[i]),
        &mut out.translation,
    );
    let [x, y, z, w] = load(simd, &reference.rotation);
    let delta = product(
        &[zero - x, zero - y, zero - z, w],
        &load(simd, &pose.rotation),
    );
    // The shorter way.
    let far = delta[3].simd_lt(zero);
    store(&delta.map(|c| far.select(zero - c, c)), &mut out.rotation);
    let (p, r): ([f32x8<S>; 3], [f32x8<S>; 3]) =
        (load(simd, &pose.scale), load(simd, &reference.scale));
    let ratio = core::array::from_fn::<_, 3, _>(|i| {
        // A reference of no size has no factor that makes it the pose.
        let flat = r[i].simd_eq(zero);
        flat.select(one, p[i] / flat.select(one, r[i]))
    });
    store(&ratio, &mut out.scale);
}

#[inline(always)]
fn apply<S: Simd>(simd: S, index: usize, layers: &[Layer], order: &[u32], block: &mut Joints8) {
    let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
    let mut translation: [f32x8<S>; 3] = load(simd, &block.translation);
    let mut rotation: Quat8<S> = [zero, zero, zero, one];
    let mut scale = [one; 3];
    for layer in order.iter().map(|layer| &layers[*layer as usize]) {
        let added = &layer.pose.blocks()[index];
        let weight = weights(simd, layer, index);
        let (t, s): ([f32x8<S>; 3], [f32x8<S>; 3]) =
            (load(simd, &added.translation), load(simd, &added.scale));
        let q: Quat8<S> = load(simd, &added.rotation);
        for i in 0..3 {
            translation[i] += t[i] * weight;
            scale[i] += (s[i] - one) * weight;
            rotation[i] += q[i] * weight;
        }
        rotation[3] += (q[3] - one) * weight;
    }
    store(&translation, &mut block.translation);
    let base: Quat8<S> = load(simd, &block.rotation);
    store(
        &normalise(&product(&base, &normalise(&rotation))),
        &mut block.rotation,
    );
    let old: [f32x8<S>; 3] = load(simd, &block.scale);
    store(
        &core::array::from_fn::<_, 3, _>(|i| old[i] * scale[i]),
        &mut block.scale,
    );
}
