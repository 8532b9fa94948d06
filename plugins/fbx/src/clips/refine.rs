//! More samples where a clip bends.
//!
//! Keys that pass through all samples may still be off between them. Inside of a stretch between two
//! of the file's keys curves are smooth, so the polynomial through up to four samples predicts the
//! middle between two of them to fourth order. Where that middle is off the straight line, it is
//! looked at; where it is not where it was predicted, its two sides are looked at in turn.

use super::grid::{Grid, Plan};
use super::metric::Leverage;
use super::sample::{Samples, Take, between};
use super::value::{Value, angle};
use crate::error::FbxError;
use crate::model::{Model, Trs};
use crate::options::{Budget, Options};
use crate::verify::Bodies;
use glam::{DQuat, DVec3};
use std::ops::Range;

/// How near what lies between samples is known, as a share of the bound: a middle that is nearer than this
/// to the straight line is not looked at, and one that is nearer to where it was predicted ends
/// the search, for the next would be sixteen times nearer.
pub(super) const KNOWN_TO: f64 = 0.2;

/// Halvings of the time between two samples at most.
const ROUNDS: usize = 5;

/// What a clip is made of.
#[derive(Clone, Copy)]
pub(crate) struct Source<'a, 'o> {
    pub(crate) take: &'a Take<'a>,
    pub(crate) model: &'a Model,
    pub(crate) options: &'a Options<'o>,
    pub(crate) budget: &'a Budget,
    pub(crate) bodies: &'a Bodies,
}

impl Source<'_, '_> {
    /// Samples through a range of a plan's marks.
    pub(super) fn sample(&self, plan: &Plan, window: Range<usize>) -> Result<Samples, FbxError> {
        self.take
            .sample(plan, window, self.model, self.options, self.budget)
    }
}

/// Adds samples until what lies between them is known to a share of `bound`, metres, or the budget's work is done. Says
/// whether memory allowed it.
pub(crate) fn refine(
    samples: &mut Samples,
    source: &Source,
    leverage: &[Leverage],
    bound: f64,
) -> bool {
    let near = KNOWN_TO * bound;
    // Gaps that are still asked about.
    let mut open = vec![true; samples.grid.len().saturating_sub(1)];
    for _ in 0..ROUNDS {
        let grid = &samples.grid;
        let middles: Vec<Middle> = (0..open.len())
            .filter(|&gap| open[gap] && !grid.jumps[gap])
            .filter_map(|gap| Middle::of(grid, gap))
            .filter(|middle| is_bent(samples, middle, source.model, leverage, near))
            .collect();
        if middles.is_empty() {
            break;
        }
        if grid.len() + middles.len() > source.take.most {
            return false;
        }
        // What is not looked at, the check bounds.
        if !source.budget.pays(source.take.columns() * middles.len()) {
            break;
        }
        open = add(samples, source, &middles, leverage, near);
    }
    predict(samples, source.take.most);
    true
}

/// Puts the predicted middle into every gap, so that keys are held to what lies between samples too.
fn predict(samples: &mut Samples, most: usize) {
    let grid = &samples.grid;
    let gaps = 0..grid.len().saturating_sub(1);
    let middles: Vec<Middle> = gaps
        .filter(|&gap| !grid.jumps[gap])
        .filter_map(|gap| Middle::of(grid, gap))
        .collect();
    if grid.len() + middles.len() > most {
        samples.stops = (0..grid.len()).collect();
        return;
    }
    for track in &mut samples.tracks {
        let poses = middles
            .iter()
            .map(|middle| middle.pose(&track.poses))
            .collect();
        track.poses = woven(&track.poses, &middles, poses, 1);
    }
    for morph in &mut samples.morphs {
        let of = |middle: &Middle| {
            (0..morph.targets)
                .map(|target| middle.morph(&morph.weights, morph.targets, target))
                .collect::<Vec<_>>()
        };
        let weights = middles.iter().flat_map(of).collect();
        morph.weights = woven(&morph.weights, &middles, weights, morph.targets);
    }
    let count = samples.grid.len();
    weave_grid(samples, &middles);
    // Every sample that was there stays where a key may stand; the gaps tell which those are.
    let mut stops = Vec::with_capacity(count);
    let mut next = middles.iter().peekable();
    let mut at = 0;
    for sample in 0..count {
        stops.push(at);
        at += 1 + usize::from(next.next_if(|middle| middle.gap == sample).is_some());
    }
    samples.stops = stops;
}

/// Puts middles between the samples' times; says for each gap after that which middle began it.
fn weave_grid(samples: &mut Samples, middles: &[Middle]) -> Vec<Option<usize>> {
    let old = std::mem::take(&mut samples.grid);
    let mut from = Vec::with_capacity(old.len() + middles.len());
    let mut next = 0;
    for sample in 0..old.len() {
        samples.grid.push(
            old.times[sample],
            old.labels[sample],
            old.jumps[sample],
            old.keys[sample],
        );
        if let Some(whole) = samples.grid.whole.last_mut() {
            *whole = old.whole[sample];
        }
        samples.grid.set_within(old.within[sample]);
        match middles.get(next).filter(|middle| middle.gap == sample) {
            Some(middle) => {
                samples.grid.push(middle.time, middle.label, false, false);
                samples.grid.set_within(old.within[sample]);
                from.extend([Some(next), Some(next)]);
                next += 1;
            }
            None => from.push(None),
        }
    }
    from.truncate(samples.grid.len().saturating_sub(1));
    from
}

/// The middle of a gap, and how the samples around predict it.
struct Middle {
    gap: usize,
    time: f64,
    label: f32,
    /// Samples that predict it, and their weights.
    stencil: Vec<(usize, f64)>,
}

impl Middle {
    /// `None` where too few samples say anything, or f32 has no number between.
    fn of(grid: &Grid, gap: usize) -> Option<Self> {
        if !grid.whole[gap] {
            return None;
        }
        let (a, b) = (grid.labels[gap], grid.labels[gap + 1]);
        let label = a + (b - a) / 2.0;
        // At the time that glTF can say.
        let time = grid.times[gap] + (f64::from(label) - f64::from(a));
        (label > a && label < b).then(|| Self {
            gap,
            time,
            label,
            stencil: lagrange(grid, gap, time),
        })
    }

    fn pose(&self, poses: &[Trs]) -> Trs {
        let like = poses[self.gap].rotation;
        let mut rotation = DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0);
        let (mut translation, mut scale) = (DVec3::ZERO, DVec3::ZERO);
        for &(sample, weight) in &self.stencil {
            let pose = &poses[sample];
            translation += pose.translation * weight;
            scale += pose.scale * weight;
            rotation += same_side(pose.rotation, like) * weight;
        }
        Trs {
            translation,
            rotation: rotation.finish(),
            scale,
        }
    }

    fn morph(&self, weights: &[f64], targets: usize, target: usize) -> f64 {
        let part = |&(sample, weight): &(usize, f64)| weights[sample * targets + target] * weight;
        self.stencil.iter().map(part).sum()
    }
}

/// A stencil's samples and their weights in the polynomial's value at a time in a gap.
fn lagrange(grid: &Grid, gap: usize, at: f64) -> Vec<(usize, f64)> {
    let stencil = grid.stencil(gap);
    let weight = |&i: &usize| {
        let others = stencil.iter().filter(|&&j| j != i);
        others
            .map(|&j| (at - grid.times[j]) / (grid.times[i] - grid.times[j]))
            .product()
    };
    stencil.iter().map(|i| (*i, weight(i))).collect()
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
    if middle.stencil.len() < 3 {
        return false;
    }
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
) -> Vec<bool> {
    let times: Vec<f64> = middles.iter().map(|middle| middle.time).collect();
    let mut looked = source.take.poses(&times, source.options);
    let mut missed = vec![false; middles.len()];
    for (track, poses) in samples.tracks.iter_mut().zip(&mut looked) {
        if !track.spins {
            let within = |(middle, _): &(&Middle, &mut Trs)| samples.grid.within[middle.gap];
            for (middle, pose) in middles.iter().zip(poses.iter_mut()).filter(within) {
                *pose = between(&track.poses[middle.gap], &track.poses[middle.gap + 1], 0.5);
            }
        }
        for ((middle, pose), missed) in middles.iter().zip(poses.iter()).zip(&mut missed) {
            *missed |= apart(&middle.pose(&track.poses), pose, &leverage[track.node]) > near;
        }
        track.poses = woven(&track.poses, middles, std::mem::take(poses), 1);
    }
    for morph in &mut samples.morphs {
        let looked = source.take.weights(morph.mesh, &times);
        let targets = &source.model.meshes[morph.mesh].targets;
        for (i, (middle, missed)) in middles.iter().zip(&mut missed).enumerate() {
            *missed |= targets.iter().enumerate().any(|(target, of)| {
                let predicted = middle.morph(&morph.weights, morph.targets, target);
                (predicted - looked[i * morph.targets + target]).abs() * of.reach > near
            });
        }
        morph.weights = woven(&morph.weights, middles, looked, morph.targets);
    }
    let from = weave_grid(samples, middles);
    from.into_iter()
        .map(|middle| middle.is_some_and(|middle| missed[middle]))
        .collect()
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
            assert_eq!(middle.stencil.len(), 4, "gap {gap}");
            let value: f64 = middle
                .stencil
                .iter()
                .map(|&(i, weight)| cubic(times[i]) * weight)
                .sum();
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
            let stencil = grid.stencil(gap);
            let span = *stencil.iter().min().unwrap()..*stencil.iter().max().unwrap();
            assert!(
                (span.start + 1..span.end).all(|i| !grid.keys[i]),
                "gap {gap}"
            );
            assert_eq!(stencil.len(), 3);
        }
    }

    #[test]
    fn rows_are_woven_in_after_their_gaps() {
        let mut grid = Grid::default();
        (0..4).for_each(|i| grid.push(f64::from(i), i as f32, false, false));
        let middles = [Middle::of(&grid, 0).unwrap(), Middle::of(&grid, 2).unwrap()];
        assert_eq!(
            woven(&[0, 1, 2, 3], &middles, vec![10, 12], 1),
            [0, 10, 1, 2, 12, 3]
        );
        let wide = woven(&[0, 0, 1, 1, 2, 2, 3, 3], &middles, vec![10, 10, 12, 12], 2);
        assert_eq!(wide, [0, 0, 10, 10, 1, 1, 2, 2, 12, 12, 3, 3]);
    }
}
