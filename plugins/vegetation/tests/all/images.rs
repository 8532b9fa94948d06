//! Pictures of a meadow, as a person sees it: written where `DOLOMITE_PICTURES` is set, and held to what is surely wrong.

use std::path::Path;
use std::sync::Arc;

use bevy::camera::Hdr;
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::math::DVec2;
use bevy::prelude::*;
use dolomite_ground::{GroundCanopy, GroundMaterial, GroundPlugin, TerrainView};
use dolomite_sky::{Sky, SkyPlugin, Sun};
use dolomite_terrain::{Fractal, GroundRect, Layer, Source, Sum, Terrain, TerrainData};
use dolomite_vegetation::render::VegetationStats;
use dolomite_vegetation::{Kinds, Vegetation, VegetationPlugin, VegetationView, Wind};

use crate::app;

/// The kinds of the game's mountain without trees and rocks, whose files this crate does not have.
fn kinds() -> Kinds {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/plants/mountain.ron");
    let mut kinds = Kinds::read(&path).expect("the game's kinds");
    kinds
        .kinds
        .retain(|kind| !matches!(kind.shape, dolomite_vegetation::Shape::Mesh(_)));
    for kind in &mut kinds.kinds {
        kind.keeps_off.clear();
    }
    kinds
}

/// Of the pictures, pixels.
const SIZE: [u32; 2] = [640, 360];

/// What is seen `above` the ground, looking up by `up`, radians.
fn meadow(above: f32, up: f32, [width, height]: [u32; 2]) -> Option<Image> {
    let mut app = app::app(|app| {
        app::bevys(app);
        app.insert_resource(bevy::pbr::DefaultOpaqueRendererMethod::deferred())
            .add_plugins((GroundPlugin::default(), SkyPlugin, VegetationPlugin));
    })?;
    let hills = Fractal {
        sum: Sum::Fbm,
        seed: 11,
        amplitude: 16.0,
        wavelength: 240.0,
        octaves: 7,
        ..default()
    };
    let terrain = Terrain::new(TerrainData {
        extent: GroundRect::square(DVec2::ZERO, 2000.0),
        layers: vec![Layer {
            source: Source::Fractal(hills),
            mask: None,
        }],
        base: 90.0,
        sea_level: None,
    })
    .expect("in range");
    let ground = terrain.sample_f64(DVec2::ZERO).height as f32;
    let world = app.world_mut();
    world.spawn((
        terrain,
        GroundMaterial::default(),
        Vegetation {
            kinds: Arc::new(kinds()),
            ..default()
        },
        Wind::default(),
    ));
    world.spawn(Sun {
        azimuth: 290.0,
        elevation: 32.0,
    });
    world.spawn((
        Camera3d::default(),
        Msaa::Off,
        Hdr,
        Tonemapping::AgX,
        TerrainView,
        VegetationView,
        Sky::default(),
        Transform::from_xyz(0.0, ground + above, 0.0).with_rotation(Quat::from_euler(
            EulerRot::YXZ,
            0.6,
            up,
            0.0,
        )),
    ));
    let target = app::target(&mut app, [width, height]);
    app::retarget(&mut app, &target);
    let stats = |app: &App| app.world().resource::<VegetationStats>().get();
    for _ in 0..300 {
        let before = stats(&app).dispatches;
        app::frames(&mut app, 4);
        let mut canopies = app.world_mut().query::<&GroundCanopy>();
        let is_known = canopies.iter(app.world()).next().is_some();
        if stats(&app).dispatches == before && before > 0 && is_known {
            println!("{:?}", stats(&app));
            return Some(app::picture(&mut app, &target));
        }
    }
    panic!("it does not come to rest");
}

/// By day a meadow is green, nowhere black, and its lower half is neither of one colour nor of noise alone: rows differ less
/// from each other than pixels do.
#[test]
fn a_meadow_by_day() {
    for (above, up, name) in [
        (1.7, -0.12, "meadow.png"),
        (8.0, -0.25, "meadow_8.png"),
        (60.0, -0.45, "meadow_60.png"),
    ] {
        let Some(picture) = meadow(above, up, SIZE) else {
            return;
        };
        let (mut sum, mut squares, mut dark) = (Vec3::ZERO, 0.0, 0);
        let [width, height] = SIZE;
        let lower = (height * 5 / 9..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let mut all = 0;
        for (x, y) in lower {
            let seen = picture.get_color_at(x, y).expect("within").to_linear();
            let seen = Vec3::new(seen.red, seen.green, seen.blue);
            sum += seen;
            squares += seen.y * seen.y;
            dark += u32::from(seen.max_element() < 0.004);
            all += 1;
        }
        let mean = sum / all as f32;
        let spread = (squares / all as f32 - mean.y * mean.y).max(0.0).sqrt();
        println!("{name}: mean {mean}, spread {spread}, dark {dark} of {all}");
        app::keep(picture, name);
        assert!(mean.y > mean.x && mean.x > mean.z, "green: {mean}");
        assert!((0.03..0.5).contains(&mean.y), "by day: {mean}");
        assert!(
            spread > 0.05 * mean.y && spread < mean.y,
            "{spread} of {mean}"
        );
        // Between the nearest blades it is dark.
        assert!(20 * dark < all, "{dark} of {all} are black");
    }
}
