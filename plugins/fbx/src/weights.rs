//! Few weights a vertex, fitted to the deformation that all of them give over the clips.
//!
//! A vertex at `v` that follows joints with matrices `M_i(p)` in pose `p` should come to `t(p)`. With
//! `a_i(p) = M_i(p) v - t(p)`, weights `x` that sum to 1 leave it off by `sum x_i a_i(p)`. Over all
//! poses the squares of that sum to `x' G x` with `G = sum_p a_i(p) . a_j(p)`, a small quadratic
//! program on the simplex for each choice of joints. The worst pose counts more than the mean, so the
//! best choice is fitted again with poses weighted by their error (Lawson's iteration).

use crate::read::Influence;
use glam::{DAffine3, DVec3};

/// Joints that a choice is made from at most: those with the largest weights.
const CANDIDATES: usize = 9;

/// Rounds of weighting poses by their error.
const ROUNDS: usize = 5;

/// Choices of joints that are fitted so.
const FINALISTS: usize = 2;

/// A small symmetric matrix.
type Gram = [[f64; CANDIDATES]; CANDIDATES];

/// How much the file's own weights are preferred where poses do not tell joints apart, as a share of
/// what joints are apart.
const PREFERENCE: f64 = 1e-7;

/// How a fit went, metres.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Fit {
    /// Largest distance from the target over all poses.
    pub(crate) error: f64,
    /// The same of the largest weights renormalised.
    pub(crate) largest: f64,
}

/// At most `count` influences that bring `position` to `targets` (one a pose) as well as they can.
/// `matrices(pose, joint)` is from the mesh to the world; `influences` go from the largest down. A fit
/// that is off by no more than `enough` metres is not improved.
pub(crate) fn fit(
    influences: &[Influence],
    count: usize,
    position: DVec3,
    targets: &[DVec3],
    enough: f64,
    matrices: impl Fn(usize, usize) -> DAffine3,
) -> (Vec<Influence>, Fit) {
    let candidates = &influences[..influences.len().min(CANDIDATES)];
    let largest = renormalised(&candidates[..candidates.len().min(count)]);
    // Row p, column i: a_i(p).
    let offsets: Vec<[DVec3; CANDIDATES]> = targets
        .iter()
        .enumerate()
        .map(|(pose, &target)| {
            let mut row = [DVec3::ZERO; CANDIDATES];
            for (slot, i) in row.iter_mut().zip(candidates) {
                *slot = matrices(pose, i.joint).transform_point3(position) - target;
            }
            row
        })
        .collect();
    let worst = |weights: &[f64]| worst_of(&offsets, weights).0;
    let kept: Vec<f64> = (0..candidates.len())
        .map(|i| largest.get(i).map_or(0.0, |influence| influence.weight))
        .collect();
    let mut best = (worst(&kept), kept);
    let mut fit = Fit {
        error: best.0,
        largest: best.0,
    };
    let own: Vec<f64> = renormalised(candidates).iter().map(|i| i.weight).collect();
    let gram = gram(&offsets, &vec![1.0; targets.len()], &own, Subset::MAX);
    // The joints with the largest weights, if other weights make them do.
    let first = (1 << candidates.len().min(count)) - 1;
    let weights = on_simplex(&gram, first, candidates.len());
    let error = worst(&weights[..candidates.len()]);
    if error < best.0 {
        best = (error, weights[..candidates.len()].to_vec());
    }
    // The best choices, best first.
    let mut finalists: Vec<(f64, Subset)> = Vec::with_capacity(FINALISTS + 1);
    for subset in subsets(candidates.len(), count) {
        if best.0 <= enough {
            break;
        }
        let weights = on_simplex(&gram, subset, candidates.len());
        let value = form(&gram, &weights[..candidates.len()]);
        let at = finalists
            .iter()
            .take_while(|(other, _)| *other <= value)
            .count();
        if at < FINALISTS {
            finalists.insert(at, (value, subset));
            finalists.truncate(FINALISTS);
        }
    }
    for &(_, subset) in &finalists {
        if best.0 <= enough {
            break;
        }
        let mut importance = vec![1.0; targets.len()];
        for _ in 0..ROUNDS {
            let gram = self::gram(&offsets, &importance, &own, subset);
            let weights = on_simplex(&gram, subset, candidates.len());
            let weights = &weights[..candidates.len()];
            let (error, errors) = worst_of(&offsets, weights);
            if error < best.0 {
                best = (error, weights.to_vec());
            }
            if error <= enough.max(1e-12) {
                break;
            }
            for (importance, own) in importance.iter_mut().zip(&errors) {
                *importance *= own / error + 1e-3;
            }
            let most = importance.iter().copied().fold(0.0, f64::max);
            importance.iter_mut().for_each(|i| *i /= most);
        }
    }
    fit.error = best.0;
    let mut kept: Vec<Influence> = candidates
        .iter()
        .zip(&best.1)
        .filter(|(_, weight)| **weight > 0.0)
        .map(|(influence, &weight)| Influence {
            joint: influence.joint,
            weight,
        })
        .collect();
    kept.sort_by(|a, b| b.weight.total_cmp(&a.weight).then(a.joint.cmp(&b.joint)));
    (kept, fit)
}

/// The same influences with a sum of 1.
pub(crate) fn renormalised(influences: &[Influence]) -> Vec<Influence> {
    let sum: f64 = influences.iter().map(|influence| influence.weight).sum();
    influences
        .iter()
        .map(|influence| Influence {
            joint: influence.joint,
            weight: influence.weight / sum,
        })
        .collect()
}

/// Largest distance over the poses, and that of each pose.
fn worst_of(offsets: &[[DVec3; CANDIDATES]], weights: &[f64]) -> (f64, Vec<f64>) {
    let errors: Vec<f64> = offsets
        .iter()
        .map(|row| {
            let sum: DVec3 = row.iter().zip(weights).map(|(a, &w)| *a * w).sum();
            sum.length()
        })
        .collect();
    (errors.iter().copied().fold(0.0, f64::max), errors)
}

/// `G`, with poses weighted, and a little of `|x - own|^2`, which is quadratic too where `x` sums to 1. Of pairs of joints outside of
/// `subset` nothing is asked.
fn gram(offsets: &[[DVec3; CANDIDATES]], importance: &[f64], own: &[f64], subset: Subset) -> Gram {
    let n = own.len();
    let mut gram = [[0.0; CANDIDATES]; CANDIDATES];
    let asked = |joint: usize| subset >> joint & 1 == 1;
    for i in 0..n {
        for j in (0..=i).filter(|&j| i == j || asked(i) && asked(j)) {
            let poses = offsets.iter().zip(importance);
            gram[i][j] = poses.fold(0.0, |sum, (row, importance)| {
                sum + importance * row[i].dot(row[j])
            });
        }
    }
    let trace: f64 = (0..n).map(|i| gram[i][i]).sum();
    let much = PREFERENCE * trace / n as f64 + 1e-18;
    let length: f64 = own.iter().map(|w| w * w).sum();
    for i in 0..n {
        for j in 0..=i {
            let same = if i == j { 1.0 } else { 0.0 };
            gram[i][j] += much * (same - own[i] - own[j] + length);
            gram[j][i] = gram[i][j];
        }
    }
    gram
}

fn form(gram: &Gram, x: &[f64]) -> f64 {
    let row = |(row, xi): (&[f64; CANDIDATES], &f64)| {
        xi * row.iter().zip(x).map(|(g, x)| g * x).sum::<f64>()
    };
    gram.iter().zip(x).map(row).sum()
}

/// Joints by bit.
type Subset = u32;

/// All choices of `count` of `n`, in order.
fn subsets(n: usize, count: usize) -> impl Iterator<Item = Subset> {
    let count = count.min(n) as u32;
    (0..1_u32 << n).filter(move |subset| subset.count_ones() == count)
}

/// Minimises `x' G x` with `sum x = 1` and `x >= 0` outside of which `subset` x is 0: joints whose
/// weight would be negative leave, the most negative first.
fn on_simplex(gram: &Gram, subset: Subset, n: usize) -> [f64; CANDIDATES] {
    let mut active = subset;
    loop {
        let solved = solve(gram, active, n);
        let of = |&i: &usize| active >> i & 1 == 1;
        let least = (0..n)
            .filter(of)
            .min_by(|&a, &b| solved[a].total_cmp(&solved[b]));
        match least.filter(|&i| solved[i] < 0.0 && active.count_ones() > 1) {
            Some(i) => active &= !(1 << i),
            None => return solved,
        }
    }
}

/// `G x = 1` on `active`, scaled to a sum of 1: the minimum without bounds. `G` is positive definite
/// (see [`gram`]), so Cholesky's method works.
fn solve(gram: &Gram, active: Subset, joints: usize) -> [f64; CANDIDATES] {
    let mut at = [0; CANDIDATES];
    let mut n = 0;
    for joint in (0..joints).filter(|&joint| active >> joint & 1 == 1) {
        at[n] = joint;
        n += 1;
    }
    let mut l = [[0.0; CANDIDATES]; CANDIDATES];
    for i in 0..n {
        for j in 0..=i {
            let mut sum: f64 = gram[at[i]][at[j]];
            for (a, b) in l[i][..j].iter().zip(&l[j][..j]) {
                sum -= a * b;
            }
            l[i][j] = match i == j {
                true => sum.max(1e-30).sqrt(),
                false => sum / l[j][j],
            };
        }
    }
    let mut y = [0.0; CANDIDATES];
    for i in 0..n {
        let known: f64 = (0..i).map(|k| l[i][k] * y[k]).sum();
        y[i] = (1.0 - known) / l[i][i];
    }
    for i in (0..n).rev() {
        let known: f64 = (i + 1..n).map(|k| l[k][i] * y[k]).sum();
        y[i] = (y[i] - known) / l[i][i];
    }
    let sum: f64 = y[..n].iter().sum();
    let mut out = [0.0; CANDIDATES];
    for i in 0..n {
        out[at[i]] = match sum.is_finite() && sum > 0.0 {
            true => y[i] / sum,
            false => 1.0 / n as f64,
        };
    }
    out
}

/// Lists of four joints and weights, as many as `count` needs, in f32: the largest takes up what
/// rounding leaves of 1.
pub(crate) fn packed(influences: &[Influence], count: usize) -> Vec<([u16; 4], [f32; 4])> {
    let mut out = vec![([0; 4], [0.0; 4]); count / 4];
    for (i, influence) in influences.iter().take(count).enumerate() {
        let weight = influence.weight as f32;
        if weight > 0.0 {
            out[i / 4].0[i % 4] = influence.joint as u16;
            out[i / 4].1[i % 4] = weight;
        }
    }
    let rest: f32 = out.iter().flat_map(|(_, w)| w).skip(1).sum();
    out[0].1[0] = 1.0 - rest;
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn influences(weights: &[f64]) -> Vec<Influence> {
        let each = weights.iter().enumerate();
        each.map(|(joint, &weight)| Influence { joint, weight })
            .collect()
    }

    /// Joint `i` in pose `p` is turned about an axis of its own.
    fn matrix(pose: usize, joint: usize) -> DAffine3 {
        let axis =
            DVec3::new(1.0 + joint as f64, 2.0 - joint as f64, 0.5 * joint as f64).normalize();
        let angle = 0.3 * pose as f64 * (1.0 + 0.1 * joint as f64);
        DAffine3::from_axis_angle(axis, angle)
    }

    fn target(list: &[Influence], position: DVec3, pose: usize) -> DVec3 {
        let part = |i: &Influence| matrix(pose, i.joint).transform_point3(position) * i.weight;
        list.iter().map(part).sum()
    }

    #[test]
    fn fitted_weights_are_nearer_than_the_largest() {
        let list = influences(&[0.3, 0.25, 0.2, 0.15, 0.1]);
        let position = DVec3::new(0.4, 0.7, -0.2);
        let targets: Vec<DVec3> = (0..8).map(|pose| target(&list, position, pose)).collect();
        let (kept, fit) = fit(&list, 4, position, &targets, 0.0, matrix);
        assert_eq!(kept.len(), 4);
        assert!((kept.iter().map(|i| i.weight).sum::<f64>() - 1.0).abs() < 1e-12);
        assert!(kept.iter().all(|i| i.weight > 0.0));
        assert!(fit.error < 0.5 * fit.largest, "{fit:?}");
        // The error that is claimed is the error there is.
        let far = targets
            .iter()
            .enumerate()
            .map(|(pose, t)| (target(&kept, position, pose) - *t).length());
        assert!((far.fold(0.0, f64::max) - fit.error).abs() < 1e-12);
    }

    #[test]
    fn without_poses_the_largest_stay() {
        let list = influences(&[0.4, 0.3, 0.2, 0.06, 0.04]);
        let (kept, _) = fit(&list, 4, DVec3::ONE, &[], 0.0, matrix);
        assert_eq!(kept, renormalised(&list[..4]));
    }

    #[test]
    fn joints_that_move_alike_keep_the_files_weights() {
        let list = influences(&[0.5, 0.3, 0.2]);
        let same = |pose: usize, _: usize| matrix(pose, 0);
        let targets: Vec<DVec3> = (0..4)
            .map(|p| same(p, 0).transform_point3(DVec3::X))
            .collect();
        let (kept, fit) = fit(&list, 4, DVec3::X, &targets, 0.0, same);
        assert!(fit.error < 1e-12);
        for (a, b) in kept.iter().zip(&list) {
            assert!((a.weight - b.weight).abs() < 1e-6, "{kept:?}");
        }
    }

    #[test]
    fn every_choice_is_made_once() {
        let all: Vec<Subset> = subsets(6, 4).collect();
        assert_eq!(all.len(), 15);
        assert_eq!((all[0], all[14]), (0b1111, 0b11_1100));
        assert_eq!(subsets(3, 4).collect::<Vec<_>>(), [0b111]);
    }

    #[test]
    fn packed_weights_sum_to_one() {
        let packed = packed(&influences(&[0.4, 0.3, 0.2, 0.06, 0.04]), 8);
        let sum: f32 = packed.iter().flat_map(|(_, w)| w).sum();
        assert_eq!(sum, 1.0);
        assert_eq!(packed[1].0, [4, 0, 0, 0]);
        assert_eq!(packed[1].1[1..], [0.0; 3]);
    }
}
