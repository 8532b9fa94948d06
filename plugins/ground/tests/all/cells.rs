//! Cells through their passes on whatever adapter there is, on ground of which samples say too little: made and chosen as by the
//! CPU reference, whose own tests hold it to the ground (`src/detail/cell/truth.rs`).

use crate::blocks::support::{by_place, view_at};
use bevy::math::DVec2;
use dolomite_ground::detail::layout::DetailParams;
use dolomite_ground::detail::{DetailCells, DetailView, mesh, select};
use dolomite_terrain::{
    Fractal, GroundPoint, GroundRect, Hill, Layer, Mask, Source, Sum, Terrain, TerrainData,
};
use dolomite_testkit::detail::DetailStage;
use dolomite_testkit::gpu::for_test;
use dolomite_testkit::missed::{islets, on_lattice};

/// Hills that no sample of large cells meets, which open masks of layers of each kind of noise; some of the octaves are hidden.
fn behind_masks() -> Terrain {
    let hill = |x, z| Layer {
        source: Source::Hill(Hill {
            centre: DVec2::new(x, z),
            radius: 3.0,
            height: 4.0,
        }),
        mask: None,
    };
    let behind = |sum, seed| Layer {
        source: Source::Fractal(Fractal {
            sum,
            seed,
            octaves: 5,
            amplitude: 20.0,
            wavelength: 64.0,
            ..Fractal::default()
        }),
        mask: Some(Mask {
            low: -30.0,
            high: 10.0,
        }),
    };
    let sums = [Sum::Fbm, Sum::Ridged, Sum::Billow, Sum::Eroded];
    let noise = sums
        .into_iter()
        .zip(1..)
        .map(|(sum, seed)| behind(sum, seed));
    let hills = [hill(38.4, -25.6), hill(-101.3, 77.7), hill(30.9, 111.1)];
    Terrain::new(TerrainData {
        extent: GroundRect::square(DVec2::ZERO, 2048.0),
        layers: hills.into_iter().chain(noise).collect(),
        base: -2.0,
        sea_level: Some(0.0),
    })
    .expect("valid")
}

/// Triangles of the CPU reference, by place.
fn reference(
    cells: &mut DetailCells,
    view: &DetailView,
) -> std::collections::HashSet<[[i32; 2]; 3]> {
    let selection = select(cells, view, 1 << 20);
    assert_eq!(selection.coarsening, 1.0);
    let drawn = mesh::mesh(cells, &selection);
    let anchor = GroundPoint::from(view.anchor().as_dvec2());
    let at = |k: u32| {
        let vertex = drawn.vertices[k as usize];
        let place = vertex.point.relative_to(anchor);
        [place.x, vertex.height, place.y]
    };
    by_place(drawn.triangles.iter().map(|corners| corners.map(at)))
}

#[test]
fn gpu_cells_of_which_samples_say_too_little_are_chosen_as_on_the_cpu() {
    let Some(gpu) = for_test() else { return };
    let grounds = [
        ("islets", islets(), 2.0),
        // Rough all over: from above it takes more than the pools hold at 2 px.
        ("wet", on_lattice(Some(0.0)), 8.0),
        ("dry", on_lattice(None), 8.0),
        ("masks", behind_masks(), 8.0),
    ];
    for (name, terrain, from_above) in grounds {
        let mut cells = DetailCells::new(terrain.clone(), 0.25);
        let mut stage = DetailStage::new(&gpu, &cells, 1 << 17).expect("passes");
        for (above, turn, pixels) in [(2.0, [0.7, -0.1], 4.0), (300.0, [2.0, -0.5], from_above)] {
            let view = view_at(&terrain, DVec2::new(37.3, -20.5), above, turn, pixels);
            let theirs = reference(&mut cells, &view);
            let params = DetailParams::new(&cells, view, 0, [1 << 17, 1 << 18]);
            let run = stage.run(params).expect("runs");
            assert_eq!(run.coarsening, 1.0);
            let at = |k: u32| run.positions[k as usize];
            let ours = by_place(run.triangles.iter().map(|corners| corners.map(at)));
            let other = ours.symmetric_difference(&theirs).count();
            println!(
                "{name}: {} of {} triangles, {other} other",
                ours.len(),
                theirs.len()
            );
            assert!(theirs.len() > 1000, "{name}: {}", theirs.len());
            // Heights, hence errors, differ by roundings: ratios a hair from a threshold fall on the other side of it.
            assert!(
                other as f64 <= 2e-3 * theirs.len() as f64,
                "{name}: {other} of {}",
                theirs.len()
            );
        }
    }
}
