//! More samples where a clip bends.
//!
//! Keys that pass through all samples may still be off between them. Inside of a stretch between two
//! of the file's keys curves are smooth, so the polynomial through up to four samples foretells the
//! middle between two of them to fourth order. Where that middle is off the straight line, it is
//! looked at; where it is not where it was foretold, its two sides are looked at in turn.

use super::grid::Grid;
use super::metric::Leverage;
use super::sample::{Samples, evaluate, morph_weights};
use super::value::{Value, angle};
use crate::error::FbxError;
use crate::model::{Model, Trs};
use crate::options::{Budget, Options};
use crate::read::ShapeKey;
use glam::{DQuat, DVec3};
use ufbx::SceneRoot;

/// A middle that is nearer to the straight line than this share of the bound is not looked at.
const STRAIGHT: f64 = 0.1;

/// A middle that is nearer to where it was foretold than this share of the bound ends the search: the
/// next would be sixteen times nearer.
const FORETOLD: f64 = 0.1;

/// Halvings of the time between two samples at most.
const ROUNDS: usize = 5;

/// What a refinement needs to look at more of a clip.
pub(crate) struct Source<'a, 'o> {
    pub(crate) scene: &'a SceneRoot,
    pub(crate) stack: usize,
    pub(crate) model: &'a Model,
    pub(crate) shapes: &'a [Vec<ShapeKey>],
    pub(crate) options: &'a Options<'o>,
    pub(crate) budget: &'a Budget,
}

/// Adds samples until what lies between them is known to a share of `bound`, metres.
pub(crate) fn refine(
    samples: &mut Samples,
    source: &Source,
    leverage: &[Leverage],
    bound: f64,
) -> Result<(), FbxError> {
    // Gaps that are still asked about.
    let mut open = vec![true; samples.grid.len().saturating_sub(1)];
    for _ in 0..ROUNDS {
        source.budget.in_time("clips")?;
        let grid = &samples.grid;
        let middles: Vec<Middle> = (0..open.len())
            .filter(|&gap| open[gap] && !grid.jumps[gap])
            .filter_map(|gap| Middle::of(grid, gap))
            .filter(|middle| is_bent(samples, middle, source.model, leverage, STRAIGHT * bound))
            .collect();
        if middles.is_empty() || grid.len() + middles.len() > samples.most {
            return Ok(());
        }
        open = add(samples, source, &middles, leverage, FORETOLD * bound)?;
    }
    Ok(())
}

/// The middle of a gap, and how the samples around foretell it.
struct Middle {
    gap: usize,
    time: f64,
    label: f32,
    first: usize,
    count: usize,
    weights: [f64; 4],
}

impl Middle {
    /// `None` where too few samples say anything, or f32 has no number between.
    fn of(grid: &Grid, gap: usize) -> Option<Self> {
        let (a, b) = (grid.labels[gap], grid.labels[gap + 1]);
        let label = a + (b - a) / 2.0;
        let (first, count) = grid.stencil(gap);
        (label > a && label < b && count > 2).then(|| Self {
            gap,
            time: (grid.times[gap] + grid.times[gap + 1]) / 2.0,
            label,
            first,
            count,
            weights: lagrange(grid, gap, first, count),
        })
    }

    fn pose(&self, poses: &[Trs]) -> Trs {
        let stencil = &poses[self.first..self.first + self.count];
        let like = stencil[0].rotation;
        let mut rotation = DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0);
        let (mut translation, mut scale) = (DVec3::ZERO, DVec3::ZERO);
        for (pose, &weight) in stencil.iter().zip(&self.weights) {
            translation += pose.translation * weight;
            scale += pose.scale * weight;
            rotation = rotation + same_side(pose.rotation, like) * weight;
        }
        Trs { translation, rotation: rotation.finish(), scale }
    }

    fn morph(&self, weights: &[f64], targets: usize, target: usize) -> f64 {
        let stencil = (0..self.count).map(|i| weights[(self.first + i) * targets + target]);
        stencil.zip(&self.weights).map(|(value, weight)| value * weight).sum()
    }
}

/// Weights of a stencil's samples in the polynomial's value at the middle of a gap.
fn lagrange(grid: &Grid, gap: usize, first: usize, count: usize) -> [f64; 4] {
    let time = |i: usize| grid.times[first + i];
    let at = (grid.times[gap] + grid.times[gap + 1]) / 2.0;
    let mut out = [0.0; 4];
    for (i, out) in out.iter_mut().enumerate().take(count) {
        *out = 1.0;
        for j in (0..count).filter(|&j| j != i) {
            *out *= (at - time(j)) / (time(i) - time(j));
        }
    }
    out
}

/// How far two poses of a node are apart at most where its lever ends, metres.
fn apart(a: &Trs, b: &Trs, lever: &Leverage) -> f64 {
    ((a.translation - b.translation).length() * lever.translation)
        .max(angle(a.rotation, b.rotation) * lever.rotation)
        .max((a.scale - b.scale).length() * lever.scale)
}

fn is_bent(
    samples: &Samples,
    middle: &Middle,
    model: &Model,
    leverage: &[Leverage],
    near: f64,
) -> bool {
    let gap = middle.gap;
    let of_tracks = samples.tracks.iter().any(|track| {
        let (a, b) = (&track.poses[gap], &track.poses[gap + 1]);
        let straight = Trs {
            translation: a.translation.midpoint(b.translation),
            rotation: (a.rotation + same_side(b.rotation, a.rotation)).finish(),
            scale: a.scale.midpoint(b.scale),
        };
        apart(&middle.pose(&track.poses), &straight, &leverage[track.node]) > near
    });
    of_tracks
        || samples.morphs.iter().any(|morph| {
            let targets = &model.meshes[morph.mesh].targets;
            targets.iter().enumerate().any(|(target, of)| {
                let at = |sample: usize| morph.weights[sample * morph.targets + target];
                let straight = f64::midpoint(at(gap), at(gap + 1));
                let bent = middle.morph(&morph.weights, morph.targets, target);
                (bent - straight).abs() * of.reach > near
            })
        })
}

/// Looks at `middles` and puts them between the samples; says which gaps are still open.
fn add(
    samples: &mut Samples,
    source: &Source,
    middles: &[Middle],
    leverage: &[Leverage],
    near: f64,
) -> Result<Vec<bool>, FbxError> {
    let times: Vec<f64> = middles.iter().map(|middle| middle.time).collect();
    let nodes: Vec<usize> = samples.tracks.iter().map(|track| track.node).collect();
    let looked = evaluate(source.scene, source.stack, &nodes, &times, source.options, source.budget)?;
    let mut missed = vec![false; middles.len()];
    for (track, poses) in samples.tracks.iter_mut().zip(looked) {
        for ((middle, pose), missed) in middles.iter().zip(&poses).zip(&mut missed) {
            *missed |= apart(&middle.pose(&track.poses), pose, &leverage[track.node]) > near;
        }
        track.poses = woven(&track.poses, middles, poses, 1);
    }
    for morph in &mut samples.morphs {
        let stack = &source.scene.anim_stacks[source.stack];
        let looked = morph_weights(source.scene, stack, &source.shapes[morph.mesh], &times);
        let targets = &source.model.meshes[morph.mesh].targets;
        for (i, (middle, missed)) in middles.iter().zip(&mut missed).enumerate() {
            *missed |= targets.iter().enumerate().any(|(target, of)| {
                let foretold = middle.morph(&morph.weights, morph.targets, target);
                (foretold - looked[i * morph.targets + target]).abs() * of.reach > near
            });
        }
        morph.weights = woven(&morph.weights, middles, looked, morph.targets);
    }
    let old = std::mem::take(&mut samples.grid);
    let mut open = Vec::with_capacity(old.len() + middles.len());
    let mut next = middles.iter().zip(&missed).peekable();
    for sample in 0..old.len() {
        samples.grid.push(old.times[sample], old.labels[sample], old.jumps[sample], old.keys[sample]);
        match next.next_if(|(middle, _)| middle.gap == sample) {
            Some((middle, &missed)) => {
                samples.grid.push(middle.time, middle.label, false, false);
                open.extend([missed, missed]);
            }
            None => open.push(false),
        }
    }
    open.truncate(samples.grid.len() - 1);
    Ok(open)
}

/// `new` rows between those of `old`, after the samples that begin their gaps.
fn woven<T: Copy>(old: &[T], middles: &[Middle], new: Vec<T>, width: usize) -> Vec<T> {
    let mut out = Vec::with_capacity(old.len() + new.len());
    let mut from = 0;
    for (middle, row) in middles.iter().zip(new.chunks(width)) {
        let to = (middle.gap + 1) * width;
        out.extend_from_slice(&old[from..to]);
        out.extend_from_slice(row);
        from = to;
    }
    out.extend_from_slice(&old[from..]);
    out
}

fn same_side(q: DQuat, like: DQuat) -> DQuat {
    if q.dot(like) < 0.0 { -q } else { q }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn middles_of_a_cubic_are_exact() {
        let times = [0.0, 0.1, 0.25, 0.4, 0.5];
        let mut grid = Grid::default();
        for (i, &time) in times.iter().enumerate() {
            grid.push(time, time as f32, false, i == 0 || i == 4);
        }
        let cubic = |t: f64| 3.0 * t * t * t - t * t + 0.5;
        for gap in 0..4 {
            let middle = Middle::of(&grid, gap).unwrap();
            assert_eq!(middle.count, 4, "gap {gap}");
            let values = (0..4).map(|i| cubic(times[middle.first + i]));
            let value: f64 = values.zip(middle.weights).map(|(v, w)| v * w).sum();
            assert!((value - cubic(middle.time)).abs() < 1e-14);
        }
    }

    #[test]
    fn no_stencil_reaches_over_a_key() {
        let mut grid = Grid::default();
        for i in 0..9 {
            grid.push(f64::from(i), i as f32, false, i % 2 == 0);
        }
        for gap in 0..8 {
            let (first, count) = grid.stencil(gap);
            assert!((first + 1..first + count - 1).all(|i| !grid.keys[i]), "gap {gap}");
            assert_eq!(count, 3);
        }
    }

    #[test]
    fn rows_are_woven_in_after_their_gaps() {
        let mut grid = Grid::default();
        (0..4).for_each(|i| grid.push(f64::from(i), i as f32, false, false));
        let middles = [Middle::of(&grid, 0).unwrap(), Middle::of(&grid, 2).unwrap()];
        assert_eq!(woven(&[0, 1, 2, 3], &middles, vec![10, 12], 1), [0, 10, 1, 2, 12, 3]);
        let wide = woven(&[0, 0, 1, 1, 2, 2, 3, 3], &middles, vec![10, 10, 12, 12], 2);
        assert_eq!(wide, [0, 0, 10, 10, 1, 1, 2, 2, 12, 12, 3, 3]);
    }
}
