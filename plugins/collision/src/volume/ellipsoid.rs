//! Ellipsoids: the distance to one, and its image under a linear map.

use bevy::math::{DAffine3, DMat3, DQuat, DVec3};

/// A sphere that was stretched along three axes at right angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ellipsoid {
    /// Its centre.
    pub center: DVec3,
    /// Its radii along its own axes, each above 0.
    pub radii: DVec3,
    /// From its own axes to those that it is given in; of length 1.
    pub rotation: DQuat,
}

impl Ellipsoid {
    /// One whose axes are the coordinate axes.
    #[must_use]
    pub const fn upright(center: DVec3, radii: DVec3) -> Self {
        Self {
            center,
            radii,
            rotation: DQuat::IDENTITY,
        }
    }

    /// Whether all numbers are finite and the radii above 0.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        self.center.is_finite()
            && self.radii.is_finite()
            && self.radii.min_element() > 0.0
            && self.rotation.is_finite()
            && self.rotation.length_squared() > 0.5
    }

    /// From the unit sphere to the ellipsoid around the origin: its columns are the half axes.
    #[inline]
    #[must_use]
    pub fn axes(&self) -> DMat3 {
        DMat3::from_quat(self.rotation) * DMat3::from_diagonal(self.radii)
    }

    /// From the ellipsoid around the origin to the unit sphere.
    #[inline]
    #[must_use]
    pub fn to_unit(&self) -> DMat3 {
        DMat3::from_diagonal(self.radii.recip()) * DMat3::from_quat(self.rotation).transpose()
    }

    /// Half of the size of the box around it: the lengths of the rows of [`Self::axes`].
    #[must_use]
    pub fn half_size(&self) -> DVec3 {
        let axes = self.axes();
        DVec3::new(
            axes.row(0).length(),
            axes.row(1).length(),
            axes.row(2).length(),
        )
    }

    /// Its image under an affine map, which is an ellipsoid again, exactly.
    ///
    /// A map that flattens gives a radius of 0, and so an ellipsoid that is not valid.
    #[must_use]
    pub fn transformed(&self, by: &DAffine3) -> Self {
        let (radii, rotation) = half_axes(by.matrix3 * self.axes());
        Self {
            center: by.transform_point3(self.center),
            radii,
            rotation,
        }
    }

    /// How far a point is from it; 0 inside.
    ///
    /// Relative error below 1e-14 for radii within 1e6 of each other.
    #[must_use]
    pub fn distance(&self, point: DVec3) -> f64 {
        self.outward(point).length()
    }

    /// From its nearest point to `point`; 0 inside.
    ///
    /// The nearest point r²y / (r² + λ), y being the point in the ellipsoid's axes, lies on the surface for one
    /// λ ≥ 0: the root of Σ (r y / (r² + λ))² = 1, a convex function that falls. Newton's method, begun where the
    /// sum's greatest term is 1 and so left of the root, climbs to it without ever passing it (D. Eberly, Distance
    /// from a Point to an Ellipse, an Ellipsoid, or a Hyperellipsoid, 2013, has the same equation).
    #[must_use]
    pub fn outward(&self, point: DVec3) -> DVec3 {
        let y = self.rotation.inverse() * (point - self.center);
        let radii = self.radii;
        let scaled = y / radii;
        if scaled.length_squared() <= 1.0 {
            return DVec3::ZERO;
        }
        let (squares, numerators) = (radii * radii, radii * y.abs());
        let mut lambda = (numerators - squares).max_element().max(0.0);
        // Each step multiplies the digits from where it starts; 40 is far beyond what f64 holds.
        for _ in 0..40 {
            let terms = numerators / (squares + lambda);
            let over = terms.length_squared() - 1.0;
            let slope = 2.0 * (terms * terms / (squares + lambda)).element_sum();
            let next = lambda + over / slope;
            if !(over > 0.0 && next > lambda) {
                break;
            }
            lambda = next;
        }
        self.rotation * (y * (lambda / (squares + lambda)))
    }
}

/// The half axes of the image of the unit sphere under a linear map, as radii and a rotation.
///
/// One-sided Jacobi rotations (M. R. Hestenes, 1958): the columns are turned into each other, two at a time, until
/// they are at right angles. Small axes keep their digits, which eigenvalues of the square would not.
#[must_use]
pub fn half_axes(map: DMat3) -> (DVec3, DQuat) {
    let mut columns = [map.x_axis, map.y_axis, map.z_axis];
    // Some five sweeps reach rounding; the limit is for numbers that are not finite.
    for _ in 0..20 {
        let mut turned = false;
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            let (a, b) = (columns[i], columns[j]);
            let (aa, bb, ab) = (a.length_squared(), b.length_squared(), a.dot(b));
            // Below rounding of their product the angle is right.
            if ab.abs() <= 1e-16 * (aa * bb).sqrt() {
                continue;
            }
            turned = true;
            let zeta = (bb - aa) / (2.0 * ab);
            let tangent = zeta.signum() / (zeta.abs() + (1.0 + zeta * zeta).sqrt());
            let cosine = 1.0 / (1.0 + tangent * tangent).sqrt();
            columns[i] = (a - b * tangent) * cosine;
            columns[j] = (b + a * tangent) * cosine;
        }
        if !turned {
            break;
        }
    }
    let radii = DVec3::from_array(columns.map(DVec3::length));
    // The longest axis is there; those that have no length are completed.
    let longest = (0..3).fold(0, |best, i| if radii[i] > radii[best] { i } else { best });
    let x = columns[longest].normalize_or(DVec3::X);
    let (second, third) = ((longest + 1) % 3, (longest + 2) % 3);
    let (y, z) = if radii[second] >= radii[third] {
        let y = columns[second].reject_from_normalized(x);
        let y = y.normalize_or(x.any_orthonormal_vector());
        (y, x.cross(y))
    } else {
        let z = columns[third].reject_from_normalized(x);
        let z = z.normalize_or(x.any_orthonormal_vector());
        (z.cross(x), z)
    };
    let mut ordered = [DVec3::ZERO; 3];
    ordered[longest] = x;
    ordered[second] = y;
    ordered[third] = z;
    let rotation = DQuat::from_mat3(&DMat3::from_cols(ordered[0], ordered[1], ordered[2]));
    (radii, rotation.normalize())
}
