//! From degrees to metres, for elevation data on a geographic grid.

use bevy::math::DVec2;

/// Length of one degree of longitude and of latitude on the WGS 84 ellipsoid, metres, at a
/// latitude in degrees (−90..=90); see [`dolomite_elevation::metres_per_degree`].
#[must_use]
pub fn metres_per_degree(latitude: f64) -> DVec2 {
    DVec2::from_array(dolomite_elevation::metres_per_degree(latitude))
}
