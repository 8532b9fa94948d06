//! Heights without a window: the ground at a place that is asked for, under an entity that walks, and over a
//! whole tile, which a picture then shows in relief.
//! `cargo run --release -p dolomite_terrain --example height -- relief.png`.

use bevy::MinimalPlugins;
use bevy::math::DVec2;
use bevy::prelude::*;
use dolomite_terrain::{
    Fractal, Ground, GroundPoint, GroundProbe, GroundRect, HeightTile, Layer, Planes, Source, Sum,
    Terrain, TerrainData, TerrainPlugin,
};

fn main() -> Result {
    let ridges = Fractal {
        sum: Sum::Eroded,
        amplitude: 400.0,
        wavelength: 1200.0,
        octaves: 12,
        ..default()
    };
    let terrain = Terrain::new(TerrainData {
        extent: GroundRect::square(DVec2::ZERO, 4000.0),
        layers: vec![Layer {
            source: Source::Fractal(ridges),
            mask: None,
        }],
        base: 0.0,
        sea_level: None,
    })?;

    // One place, in f64.
    let place = DVec2::new(120.0, -75.0);
    println!("at {place}: {:.3} m", terrain.height(place));

    // Under an entity, in every frame.
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TerrainPlugin));
    app.world_mut().spawn(terrain.clone());
    let walker = (GroundProbe::default(), Transform::default());
    let walker = app.world_mut().spawn(walker).id();
    app.add_systems(
        Update,
        |mut walker: Single<&mut Transform, With<GroundProbe>>| {
            walker.translation.x += 1.5;
        },
    );
    for _ in 0..3 {
        app.update();
        let probe = app.world().get::<GroundProbe>(walker);
        println!(
            "under the walker: {:?}",
            probe.and_then(|probe| probe.sample)
        );
    }

    // A tile of samples, lit from the north-west.
    if let Some(path) = std::env::args().nth(1) {
        let side = 640;
        let [mut value, mut dx, mut dz] = [(); 3].map(|()| vec![0.0_f32; side * side]);
        let tile = HeightTile {
            origin: GroundPoint::new(terrain.extent().min),
            spacing: DVec2::splat(4000.0 / side as f64),
            width: side,
            height: side,
        };
        terrain.fill_tile_parallel(
            &tile,
            Planes {
                value: &mut value,
                dx: &mut dx,
                dz: &mut dz,
            },
        )?;
        let lit = |(dx, dz): (&f32, &f32)| {
            let normal = Vec3::new(-dx, 1.0, -dz).normalize();
            (255.0 * normal.dot(Vec3::new(-0.5, 0.7, -0.5)).max(0.0)) as u8
        };
        let grey: Vec<u8> = dx.iter().zip(&dz).map(lit).collect();
        image::save_buffer(&path, &grey, side as u32, side as u32, image::ColorType::L8)?;
        println!("{side} × {side} samples in {path}");
    }
    Ok(())
}
