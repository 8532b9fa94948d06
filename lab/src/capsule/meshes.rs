//! The patches that capsules of the stage are made of.

use dolomite_tessellation::layout::StageView;
use dolomite_tessellation::patches::WHOLE;
use dolomite_tessellation::tables::Instance;
use dolomite_tessellation::{
    Domain, Drawing, PatchLayout, PatchMesh, Spacing, Tessellator, shapes,
};
use dolomite_testkit::random::Random;

use super::globe;
use super::stage::{StageCase, Tolerance, open_view};

/// Patches whose sums of products are exact: unit cells, and an octahedron cut in halves.
pub(super) fn mesh_of(domain: Domain, seed: u32, most: f32) -> PatchMesh {
    let mut random = Random::new(seed);
    let mut level = || random.range(0.3, most);
    if domain == Domain::Triangles {
        let mesh = shapes::octahedron(2);
        let points = mesh
            .points()
            .iter()
            .map(|[x, y, z, _]| [*x, *y, *z, level()]);
        let points = points.collect();
        return PatchMesh::new(PatchLayout::TRIANGLE, points, mesh.indices().to_vec())
            .expect("whole triangles");
    }
    let layout = match domain {
        Domain::Isolines => PatchLayout::lines(4),
        _ => PatchLayout::QUAD,
    };
    let side = 4_u32;
    let points = (0..=side)
        .flat_map(|y| (0..=side).map(move |x| [x as f32, y as f32]))
        .map(|[x, y]| [x, y, 0.0, level()])
        .collect();
    let corner = |x: u32, y: u32| y * (side + 1) + x;
    let indices = (0..side)
        .flat_map(|y| (0..side).map(move |x| (x, y)))
        .flat_map(|(x, y)| {
            [
                corner(x, y),
                corner(x + 1, y),
                corner(x + 1, y + 1),
                corner(x, y + 1),
            ]
        })
        .collect();
    PatchMesh::new(layout, points, indices).expect("whole quads")
}

/// A quad above two of half its size.
pub(super) fn split_mesh() -> PatchMesh {
    let places: [[f32; 3]; 8] = [
        [0.0, 0.0, 9.4],
        [1.0, 0.0, 3.1],
        [2.0, 0.0, 8.2],
        [0.0, 2.0, 5.3],
        [2.0, 2.0, 6.6],
        [0.0, -1.0, 1.2],
        [1.0, -1.0, 2.7],
        [2.0, -1.0, 0.9],
    ];
    let points = places.map(|[x, y, w]| [x, y, 0.0, w]).to_vec();
    let indices = vec![0, 2, 4, 3, 5, 6, 1, 0, 6, 7, 2, 1];
    let middles = [[WHOLE, 1, WHOLE, WHOLE], [WHOLE; 4], [WHOLE; 4]];
    let layout = PatchLayout::QUAD.with_split_sides();
    PatchMesh::with_middles(layout, points, indices, &middles).expect("halves lie along the side")
}

/// Corners whose levels discard, and one that is beyond all bounds.
pub(super) fn hostile_mesh() -> PatchMesh {
    let mesh = shapes::octahedron(2);
    let mut points: Vec<_> = mesh
        .points()
        .iter()
        .map(|[x, y, z, _]| [*x, *y, *z, 2.5])
        .collect();
    for (k, level) in [(0, f32::NAN), (4, f32::NEG_INFINITY), (9, 31.0), (14, -1e9)] {
        points[k][3] = level;
    }
    PatchMesh::new(PatchLayout::TRIANGLE, points, mesh.indices().to_vec()).expect("whole triangles")
}

/// A sphere in front of a camera, whose levels are no whole numbers: an octahedron with `parts` parts a side, edges of so
/// many pixels.
pub(super) fn globe_case(parts: u32, pools: [u32; 2], pixels_per_edge: f32) -> StageCase<'static> {
    let tessellator = Tessellator {
        spacing: Spacing::Equal,
        ..Default::default()
    };
    let mut instance = Instance::IDENTITY;
    instance.rows = [
        [1.5, 0.0, 0.0, 100.25],
        [0.0, 1.5, 0.0, 2.0],
        [0.0, 0.0, 1.5, -7.5],
    ];
    instance.params[0][0] = 3.0;
    let view = StageView {
        eye: [0.5, 0.75, 5.0],
        anchor: [100.0, 2.0, -8.0],
        pixels_per_radian: 800.0,
        pixels_per_edge,
        camera: 1.0,
        ..open_view()
    };
    StageCase {
        tessellator,
        mesh: shapes::octahedron(parts),
        instance,
        pools,
        view,
        drawing: Drawing::Stored,
        amplified: 0,
        functions: Some(globe::FUNCTIONS),
        reference: &globe::Globe,
        // `normalize` is 1 / inverseSqrt of a sum of three squares: 2 for the root, 1.5 for the squares'
        // halved relative error, 1 for the product; then 1.5 times that and a sum of two terms.
        tolerance: Tolerance {
            ulp: 8.0,
            scale: 1.5,
            steps: 1,
        },
    }
}
