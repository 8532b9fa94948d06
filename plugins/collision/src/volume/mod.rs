//! Sphere, box, ellipsoid and capsule: from points, transformed, against each other, triangles and rays.
//!
//! Conventions: metres, f64, right-handed. Volumes are closed: what touches overlaps. A volume with a number that
//! is not finite, a box whose corners are exchanged, or a radius that is negative is not valid and overlaps
//! nothing; neither does an ellipsoid with a radius of 0. A sphere or a capsule of radius 0 is a point or a segment.

mod ellipsoid;
mod fit;
mod fit_ellipsoid;
mod meet;
mod ray;
mod shape;
mod triangle;

pub use ellipsoid::Ellipsoid;
pub use fit::FitError;
pub use ray::{Ray, RayError};
pub use shape::{Aabb, Capsule, Sphere, Volume};
