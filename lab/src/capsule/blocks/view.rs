//! A ground, and a view of it in which no rounding decides.

use bevy::math::{DQuat, DVec2, DVec3, EulerRot, UVec2};
use dolomite_ground::detail::{
    DetailCells, DetailMesh, DetailView, Lens, Metric, Selection, TerrainLod, mesh, select,
};
use dolomite_terrain::{Fractal, GroundRect, Hill, Layer, Mask, Source, Terrain, TerrainData};
use dolomite_testkit::random::Random;

/// Room for vertices and triangles.
pub(super) const POOLS: [u32; 2] = [1 << 12, 1 << 13];
/// By which factor of 1 the tolerance may change without another triangle.
const MARGIN: f32 = 5e-4;
/// Views that are tried.
const TRIES: u32 = 64;

/// Hills on rough ground, a sea, at 10⁵ m from the origin.
pub(super) fn terrain() -> Terrain {
    let fractal = |seed, octaves, amplitude, wavelength| {
        Source::Fractal(Fractal {
            seed,
            octaves,
            amplitude,
            wavelength,
            ..Fractal::default()
        })
    };
    let centre = DVec2::new(1e5, -1e5);
    let half = DVec2::new(512.0, 256.0);
    let hill = Hill {
        centre: centre + DVec2::new(60.0, 40.0),
        radius: 50.0,
        height: 30.0,
    };
    let rough = Mask {
        low: 5.0,
        high: 40.0,
    };
    let layers = [
        (fractal(1, 8, 120.0, 600.0), None),
        (Source::Hill(hill), None),
        (fractal(2, 3, 3.0, 60.0), Some(rough)),
    ];
    Terrain::new(TerrainData {
        extent: GroundRect::new(centre - half, centre + half),
        layers: Vec::from(layers.map(|(source, mask)| Layer { source, mask })),
        base: 10.0,
        sea_level: Some(0.0),
    })
    .expect("valid")
}

/// A view from somewhere over the ground, and the height that its heights are relative to.
fn view(terrain: &Terrain, metric: Metric, random: &mut Random) -> (DetailView, f32) {
    let centre = DVec2::new(1e5, -1e5);
    let place = DVec2::new(random.signed_unit() * 400.0, random.signed_unit() * 200.0);
    let xz = centre + place;
    let ground = terrain.sample_f64(xz).height.max(0.0);
    let eye = DVec3::new(xz.x, ground + 2.0 + 60.0 * random.unit(), xz.y);
    let turn = DQuat::from_euler(EulerRot::YXZ, 6.3 * random.unit(), -0.3, 0.0);
    let size = UVec2::new(960, 540);
    let mut view = DetailView::new(eye, turn, Lens::Perspective(0.6), size, 0.1);
    view.set_metric(&TerrainLod {
        metric,
        ..TerrainLod::default()
    });
    (view, eye.y.floor() as f32)
}

/// A view, what is chosen for it, and the triangles of that.
pub(super) struct Chosen {
    pub view: DetailView,
    pub anchor_height: f32,
    pub selection: Selection,
    pub mesh: DetailMesh,
}

/// The places of a mesh's triangles, sorted, each from its least corner on.
fn triangles(mesh: &DetailMesh) -> Vec<[[i64; 2]; 3]> {
    let mut all: Vec<_> = mesh
        .triangles
        .iter()
        .map(|triangle| {
            let corners = triangle.map(|k| mesh.vertices[k as usize].point.to_fixed());
            let least = (0..3).min_by_key(|&k| corners[k]).expect("three");
            [0, 1, 2].map(|k| corners[(least + k) % 3])
        })
        .collect();
    all.sort_unstable();
    all
}

/// The first view of a seed that roundings do not decide in.
pub(super) fn chosen(cells: &mut DetailCells, metric: Metric, seed: u32) -> Option<Chosen> {
    let mut random = Random::new(seed);
    let terrain = cells.terrain().clone();
    (0..TRIES).find_map(|_| {
        let (view, anchor_height) = view(&terrain, metric, &mut random);
        let mut meshed = |factor: f32| {
            let mut view = view;
            view.inverse_tolerance *= factor;
            let selection = select(cells, &view, POOLS[0]);
            let mesh = mesh::mesh(cells, &selection);
            (selection, mesh)
        };
        let (selection, mesh) = meshed(1.0);
        let own = triangles(&mesh);
        let fits = selection.coarsening == 1.0 && (200..4000).contains(&own.len());
        let same = |(_, other): (_, DetailMesh)| triangles(&other) == own;
        (fits && same(meshed(1.0 - MARGIN)) && same(meshed(1.0 + MARGIN))).then_some(Chosen {
            view,
            anchor_height,
            selection,
            mesh,
        })
    })
}
