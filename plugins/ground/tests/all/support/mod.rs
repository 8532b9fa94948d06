//! What several tests need: random views of the ground, and the search for cracks.

use std::collections::HashMap;

use bevy::math::{DMat4, DVec2, DVec3, DVec4, Vec2};
use dolomite_ground::cover::GroundPatches;
use dolomite_ground::cover::functions::{GroundFunctions, GroundVertex};
use dolomite_ground::cover::lattice::{Lattice, Node};
use dolomite_terrain::{
    Fractal, GroundPoint, GroundRect, Layer, Source, Sum, Terrain, TerrainData,
};
use dolomite_tessellation::layout::StageView;
use dolomite_tessellation::patches::{REVERSED, WHOLE};
use dolomite_tessellation::{Domain, MeshTessellation, Mode, Spacing, Tessellator, Winding};

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

/// How the ground is tessellated.
pub const TESSELLATOR: Tessellator = Tessellator {
    domain: Domain::Quads,
    spacing: Spacing::FractionalOdd,
    winding: Winding::Ccw,
    mode: Mode::Exact,
};

/// Pools of the game.
pub const POOLS: [u32; 2] = [1 << 20, 1 << 21];

/// The ground in a random view.
pub struct Scene {
    pub terrain: Terrain,
    pub patches: GroundPatches,
    pub view: StageView,
    pub relief: f32,
}

impl Scene {
    pub fn functions(&self) -> GroundFunctions<'_> {
        GroundFunctions {
            patches: &self.patches,
            terrain: &self.terrain,
            view: &self.view,
            relief: self.relief,
        }
    }

    pub fn tessellate(&self, pools: [u32; 2]) -> MeshTessellation {
        let functions = self.functions();
        TESSELLATOR.tessellate_mesh(&self.patches.mesh, |patch| functions.control(patch), pools)
    }

    pub fn vertices(&self, mesh: &MeshTessellation) -> Vec<GroundVertex> {
        let functions = self.functions();
        let unit = 1.0 / (1 << 24) as f32;
        mesh.vertices
            .iter()
            .map(|vertex| {
                let at = Vec2::new(vertex.at[0] as f32, vertex.at[1] as f32) * unit;
                functions.evaluate(vertex.patch, at)
            })
            .collect()
    }
}

pub fn heights(terrain: &Terrain, points: &[GroundPoint]) -> Vec<f32> {
    points
        .iter()
        .map(|point| terrain.sample(*point).value)
        .collect()
}

pub fn cover(terrain: &Terrain, lattice: &Lattice, leaves: &[Node]) -> GroundPatches {
    let bounds = terrain.bounds(&terrain.extent());
    let heights = |points: &[GroundPoint]| heights(terrain, points);
    GroundPatches::new(lattice, leaves, |_| (bounds.min, bounds.max), heights)
        .expect("a balanced quadtree")
}

/// The patches and the view of a random camera over the terrain.
pub fn random_scene(random: &mut Random, terrain: &Terrain, finest: f64) -> Scene {
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
    let eye = DVec3::new(focus.x, 100.0 + height, focus.y);
    let pixels = random.within(4.0, 40.0);
    let (yaw, pitch) = (random.within(0.0, 6.3), random.within(-1.5, 0.5));
    let bounds = terrain.bounds(&extent);
    Scene {
        patches: cover(terrain, &lattice, &leaves),
        view: view(eye, yaw, pitch, pixels),
        relief: bounds.max - bounds.min,
        terrain: terrain.clone(),
    }
}

/// A 1280 × 720 view with a vertical field of view of 60 degrees, without shadows.
pub fn view(eye: DVec3, yaw: f64, pitch: f64, pixels_per_edge: f64) -> StageView {
    let anchor = eye.floor();
    // 1 / tan 30°.
    let focal = 3.0_f64.sqrt();
    let relative = eye - anchor;
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
    StageView {
        planes: [w + x, w - x, w + y, w - y, w - z, z].map(|plane| plane.as_vec4().to_array()),
        sweep: [0.0; 4],
        eye: relative.as_vec3().to_array(),
        pixels_per_radian: (360.0 * focal) as f32,
        anchor: anchor.as_vec3().to_array(),
        pixels_per_edge: pixels_per_edge as f32,
        time: 0.0,
        previous_time: 0.0,
        orthographic: 0.0,
        camera: 1.0,
    }
}

/// How far the mesh's border, by the bits of its positions, differs from the edges that only one drawn
/// patch has: each edge too many is a crack. `None` if a triangle uses a vertex that was never written.
///
/// `drawn` says of each patch whether it is, `segments` how many every edge has.
pub fn cracks(
    patches: &GroundPatches,
    drawn: &[bool],
    segments: &[u32],
    positions: &[[f32; 3]],
    triangles: &[[u32; 3]],
) -> Option<usize> {
    let bits = |index: u32| {
        let position = positions.get(index as usize)?;
        (!position.iter().any(|c| c.is_nan())).then_some(position.map(f32::to_bits))
    };
    let mut open: HashMap<([u32; 3], [u32; 3]), i32> = HashMap::with_capacity(3 * triangles.len());
    for corners in triangles {
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
    let topology = patches.mesh.topology();
    let mut beside = vec![0; topology.edges.len()];
    for ((patch, halves), drawn) in topology.patches.iter().zip(&topology.halves).zip(drawn) {
        let seconds = halves[4..].iter().filter(|word| **word != WHOLE);
        for word in patch[4..].iter().chain(seconds) {
            beside[(word & !REVERSED) as usize] += usize::from(*drawn);
        }
    }
    let due: usize = segments
        .iter()
        .zip(beside)
        .filter(|(_, beside)| *beside == 1)
        .map(|(segments, _)| *segments as usize)
        .sum();
    Some(border.abs_diff(due))
}
