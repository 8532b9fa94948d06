//! What several tests need: random views of a cover, and the search for cracks.

use std::collections::HashMap;

use bevy::math::{DMat4, DVec2, DVec3, DVec4};
use dolomite_terrain::{Fractal, GroundRect, Layer, Source, Sum, Terrain, TerrainData};
use dolomite_tessellation::cover::{Cover, Lattice};
use dolomite_tessellation::layout::{NONE, Vertex, ViewParams};

/// PCG (O'Neill 2014).
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u32 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 32) as u32
    }

    /// 0 up to 1.
    pub fn unit(&mut self) -> f64 {
        f64::from(self.bits()) / 4_294_967_296.0
    }

    pub fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }
}

/// A rough 4 km ground with a sea, far from the origin so that fixed point matters.
pub fn terrain(octaves: u32) -> Terrain {
    let fractal = Fractal {
        sum: Sum::Fbm,
        octaves,
        amplitude: 200.0,
        wavelength: 900.0,
        ..Fractal::default()
    };
    Terrain::new(TerrainData {
        extent: GroundRect::square(DVec2::new(100_000.0, -70_000.0), 4096.0),
        layers: vec![Layer {
            source: Source::Fractal(fractal),
            mask: None,
        }],
        base: 20.0,
        sea_level: Some(0.0),
    })
    .expect("the parameters are in range")
}

/// A cover and its view for a random camera over the terrain.
pub fn random_view(random: &mut Random, terrain: &Terrain, finest: f64) -> (Cover, ViewParams) {
    let extent = terrain.extent();
    let margin = extent.size() * 0.2;
    let focus = DVec2::new(
        random.within(extent.min.x - margin.x, extent.max.x + margin.x),
        random.within(extent.min.y - margin.y, extent.max.y + margin.y),
    );
    // Squared: near the ground more often than high above it.
    let height = random.within(1.0, 63.0);
    let height = height * height;
    let lattice = Lattice::new(extent, finest);
    let leaves = lattice.leaves(focus, height, random.within(1.5, 3.0));
    let bounds = terrain.bounds(&extent);
    let cover = Cover::new(&lattice, &leaves, |_| (bounds.min, bounds.max));
    let eye = DVec3::new(focus.x, 100.0 + height, focus.y);
    let pixels = random.within(4.0, 40.0);
    let params = params(
        &cover,
        eye,
        random.within(0.0, 6.3),
        random.within(-1.5, 0.5),
        pixels,
    );
    (cover, params)
}

/// A 1280 × 720 view with a vertical field of view of 60 degrees.
pub fn params(cover: &Cover, eye: DVec3, yaw: f64, pitch: f64, pixels_per_edge: f64) -> ViewParams {
    let anchor = DVec2::new(eye.x, eye.z).floor();
    // 1 / tan 30°.
    let focal = 3.0_f64.sqrt();
    let relative = eye - DVec3::new(anchor.x, 0.0, anchor.y);
    let view_from_anchor = (DMat4::from_translation(relative)
        * DMat4::from_rotation_y(yaw)
        * DMat4::from_rotation_x(pitch))
    .inverse();
    // Infinite reverse-z perspective, near plane 0.1 m.
    let clip = DMat4::from_cols(
        DVec4::new(focal * 720.0 / 1280.0, 0.0, 0.0, 0.0),
        DVec4::new(0.0, focal, 0.0, 0.0),
        DVec4::new(0.0, 0.0, 0.0, -1.0),
        DVec4::new(0.0, 0.0, 0.1, 0.0),
    ) * view_from_anchor;
    let rows = clip.transpose();
    let (x, y, z, w) = (rows.x_axis, rows.y_axis, rows.z_axis, rows.w_axis);
    let planes = [w + x, w - x, w + y, w - y, w - z, z].map(|plane| plane.as_vec4().to_array());
    ViewParams {
        planes,
        sweep: [0.0; 4],
        eye: relative.as_vec3().to_array(),
        segments_per_radian: (360.0 * focal / pixels_per_edge) as f32,
        anchor: anchor.as_ivec2().to_array(),
        corner_count: cover.corners.len() as u32,
        edge_count: cover.edges.len() as u32,
        patch_count: cover.patches.len() as u32,
        max_vertices: 1 << 20,
        max_triangles: 1 << 21,
        sea_level: 0.0,
    }
}

/// Segments of the mesh's border, by the bits of their positions, that lie between two drawn
/// patches: each is a crack. `None` if a triangle uses a vertex that was never written.
pub fn cracks(cover: &Cover, vertices: &[Vertex], indices: &[u32]) -> Option<usize> {
    let bits = |index: u32| {
        let vertex = vertices.get(index as usize)?;
        let [x, y, z] = vertex.position.map(f32::to_bits);
        (!vertex.position.iter().any(|c| c.is_nan())).then_some([x, y, z])
    };
    let mut open: HashMap<([u32; 3], [u32; 3]), i32> = HashMap::with_capacity(indices.len());
    for corners in indices.chunks_exact(3) {
        let [a, b, c] = [bits(corners[0])?, bits(corners[1])?, bits(corners[2])?];
        for (from, to) in [(a, b), (b, c), (c, a)] {
            *open.entry((from, to)).or_default() += 1;
        }
    }
    let mut border = 0;
    for ((from, to), count) in &open {
        let back = open.get(&(*to, *from)).copied().unwrap_or(0);
        border += usize::try_from(count - back).unwrap_or(0);
    }
    // The border that there has to be: edges with one drawn patch beside them.
    let drawn = |patch: u32| patch != NONE && cover.patches[patch as usize].drawn();
    let due: usize = cover
        .edges
        .iter()
        .filter(|edge| drawn(edge.patches[0]) != drawn(edge.patches[1]))
        .map(|edge| edge.level as usize)
        .sum();
    Some(border.abs_diff(due))
}
