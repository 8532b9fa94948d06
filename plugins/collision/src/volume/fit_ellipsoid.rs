//! Small ellipsoids around points.

use super::ellipsoid::{Ellipsoid, half_axes};
use super::fit::{FitError, check, grown, spread};
use bevy::math::{DMat3, DMat4, DQuat, DVec3, DVec4};

/// How near to the smallest an ellipsoid's κ must be: its volume is then below (1 + this)² of it.
const NEAR: f64 = 1e-3;

/// The least radius that a fitted ellipsoid gets, as a part of the points' extent: flat points have none.
const THINNEST: f64 = 1e-6;

impl Ellipsoid {
    /// An ellipsoid around points, whose volume is within 0.2 % of the smallest. Flat points get a thickness of
    /// 10⁻⁶ of their extent.
    ///
    /// Khachiyan's method with steps away from points that turn out not to matter (M. J. Todd, E. A. Yıldırım, On
    /// Khachiyan's algorithm for the computation of minimum-volume enclosing ellipsoids, 2007).
    ///
    /// # Errors
    /// [`FitError`].
    pub fn fit(points: &[DVec3]) -> Result<Self, FitError> {
        check(points)?;
        let frame = Frame::of(points);
        let mut scaled: Vec<DVec3> = points.iter().map(|&point| frame.inward(point)).collect();
        for axis in (0..3).filter(|&axis| frame.flat[axis]) {
            scaled.extend([DVec3::AXES[axis], -DVec3::AXES[axis]]);
        }
        let weights = weights(&scaled);
        let center = sum(&scaled, &weights);
        let shape = scaled
            .iter()
            .zip(&weights)
            .fold(DMat3::ZERO, |all, (&point, &weight)| {
                let (p, q) = (point - center, (point - center) * weight);
                all + DMat3::from_cols(p * q.x, p * q.y, p * q.z)
            });
        // The half axes of a symmetric matrix are its eigenvalues: squares of radii.
        let (squares, turn) = half_axes(shape * 3.0);
        let radii = DVec3::from_array(squares.to_array().map(f64::sqrt));
        let map = DMat3::from_quat(turn) * DMat3::from_diagonal(radii);
        let outward = DMat3::from_quat(frame.turn) * DMat3::from_diagonal(frame.size);
        let (radii, rotation) = half_axes(outward * map);
        let mut ellipsoid = Self {
            center: frame.origin + frame.turn * (center * frame.size),
            radii,
            rotation,
        };
        ellipsoid.radii = ellipsoid.radii.max(DVec3::splat(frame.finest));
        // The scale by which all are inside, and once more for the rounding of that.
        for _ in 0..8 {
            let inverse = rotation.inverse();
            let reach = points
                .iter()
                .map(|&point| (inverse * (point - ellipsoid.center) / ellipsoid.radii).length())
                .fold(0.0, f64::max);
            if reach <= 1.0 {
                break;
            }
            ellipsoid.radii *= grown(reach);
        }
        Ok(ellipsoid)
    }
}

/// Where points are as wide as a box of half size 1: sums of squares keep their digits there.
struct Frame {
    origin: DVec3,
    turn: DQuat,
    size: DVec3,
    /// Along which axes there is no extent.
    flat: [bool; 3],
    /// The least that a radius may be: below it the points' own rounding is greater.
    finest: f64,
}

impl Frame {
    fn of(points: &[DVec3]) -> Self {
        let middle = points.iter().map(|&point| point - points[0]).sum::<DVec3>();
        let origin = points[0] + middle / points.len() as f64;
        let (_, turn) = half_axes(spread(points, origin));
        let inverse = turn.inverse();
        let size = points.iter().fold(DVec3::ZERO, |size, &point| {
            size.max((inverse * (point - origin)).abs())
        });
        let far = points
            .iter()
            .map(|point| point.abs().max_element())
            .fold(0.0, f64::max);
        let thin = (size.max_element() * THINNEST)
            .max(8.0 * f64::EPSILON * far)
            // All points are the origin.
            .max(f64::MIN_POSITIVE.sqrt());
        Self {
            origin,
            turn,
            size: size.max(DVec3::splat(thin)),
            flat: size.to_array().map(|size| size < thin),
            finest: thin,
        }
    }

    fn inward(&self, point: DVec3) -> DVec3 {
        self.turn.inverse() * (point - self.origin) / self.size
    }
}

fn sum(points: &[DVec3], weights: &[f64]) -> DVec3 {
    let parts = points.iter().zip(weights);
    parts.fold(DVec3::ZERO, |all, (&point, &weight)| all + point * weight)
}

/// The weights of points in the smallest ellipsoid's centre and shape.
fn weights(points: &[DVec3]) -> Vec<f64> {
    let count = points.len();
    let mut weights = vec![1.0 / count as f64; count];
    let lifted = |point: DVec3| point.extend(1.0);
    // Converges linearly; the limit is beyond what any set of points was seen to need.
    for _ in 0..20_000 {
        let matrix = points
            .iter()
            .zip(&weights)
            .fold(DMat4::ZERO, |all, (&point, &weight)| {
                let (p, q) = (lifted(point), lifted(point) * weight);
                all + DMat4::from_cols(p * q.x, p * q.y, p * q.z, p * q.w)
            });
        let inverse = matrix.inverse();
        let (mut most, mut least) = ((0, 0.0), (0, f64::INFINITY));
        for (i, &point) in points.iter().enumerate() {
            let p: DVec4 = lifted(point);
            let kappa = p.dot(inverse * p);
            if kappa > most.1 {
                most = (i, kappa);
            }
            if weights[i] > 0.0 && kappa < least.1 {
                least = (i, kappa);
            }
        }
        let (over, under) = (most.1 / 4.0 - 1.0, 1.0 - least.1 / 4.0);
        if !(over.is_finite() && over.max(under) > NEAR) {
            break;
        }
        let (index, kappa) = if over > under { most } else { least };
        let mut step = (kappa - 4.0) / (4.0 * (kappa - 1.0));
        if over <= under {
            let all = -weights[index] / (1.0 - weights[index]);
            // κ may be below 1 for points deep inside; they lose all of their weight.
            step = if kappa > 1.0 { step.max(all) } else { all };
        }
        for weight in &mut weights {
            *weight *= 1.0 - step;
        }
        weights[index] = (weights[index] + step).max(0.0);
    }
    weights
}
