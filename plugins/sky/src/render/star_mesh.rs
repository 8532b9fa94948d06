//! The mesh of the stars: octahedra whose control points say which star and which corner.

use dolomite_tessellation::{PatchLayout, PatchMesh, PatchMeshError, shapes};

use crate::star_catalogue::{CatalogueStar, class};

/// The stars as octahedra of eight triangle patches, six control points each: the direction of the
/// star, and its class times eight plus the number of the corner, as `star.wgsl` reads them.
///
/// # Errors
/// [`PatchMeshError`]; none for fewer than some hundred thousand stars.
pub(crate) fn mesh(stars: &[CatalogueStar]) -> Result<PatchMesh, PatchMeshError> {
    let one = shapes::octahedron(1);
    let corners = one.points();
    let mut points = Vec::with_capacity(stars.len() * corners.len());
    let mut indices = Vec::with_capacity(stars.len() * one.indices().len());
    for star in stars {
        let first = points.len() as u32;
        let [x, y, z] = star.direction.to_array();
        let code = class(star) * 8;
        points.extend(
            corners
                .iter()
                .map(|corner| [x, y, z, (code + corner_number(*corner)) as f32]),
        );
        indices.extend(one.indices().iter().map(|index| first + index));
    }
    PatchMesh::new(PatchLayout::TRIANGLE, points, indices)
}

/// Twice the axis of a corner of the octahedron, plus one on its negative side.
fn corner_number([x, y, z, _]: [f32; 4]) -> u32 {
    let axis = if x != 0.0 {
        0
    } else if y != 0.0 {
        1
    } else {
        2
    };
    2 * axis + u32::from(x + y + z < 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::star_catalogue::catalogue;

    #[test]
    fn the_mesh_is_an_octahedron_a_star() {
        let stars = &catalogue()[..3];
        let mesh = mesh(stars).unwrap();
        assert_eq!((mesh.patches(), mesh.points().len()), (24, 18));
        // Closed: each star shares its twelve edges and six corners, and none with another.
        let topology = mesh.topology();
        assert_eq!((topology.corners.len(), topology.edges.len()), (18, 36));
        let corners: Vec<u32> = mesh.points()[..6]
            .iter()
            .map(|point| point[3] as u32 % 8)
            .collect();
        let mut sorted = corners.clone();
        sorted.sort_unstable();
        assert_eq!(sorted, [0, 1, 2, 3, 4, 5]);
    }
}
