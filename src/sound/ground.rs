//! Which step belongs to what somebody stands on.

use bevy::math::DVec2;
use dolomite::city::streets::{cell_at, has_cell};
use dolomite::ground::GroundMaterial;
use dolomite::sound::{SoundId, built_in};

use crate::scene::LoadedScene;

/// Water that is shallower than this does not splash, metres.
const WET: f64 = 0.04;

/// What the ground of a scene is made of.
#[must_use]
pub fn material(scene: &LoadedScene) -> GroundMaterial {
    let own = scene.material.clone();
    own.unwrap_or_else(|| scene.bands.into())
}

/// The step of somebody at a place of the ground: water before paving before the layer that is seen there. Layers are
/// told by their names; what is none of ours is rock.
#[must_use]
pub fn step_on(scene: &LoadedScene, material: &GroundMaterial, place: DVec2) -> SoundId {
    let sample = scene.terrain.sample_f64(place);
    let above_sea = scene
        .terrain
        .sea_level()
        .map(|sea| sample.height - f64::from(sea));
    if above_sea.is_some_and(|above| above < -WET) {
        return built_in::STEP_WATER;
    }
    let paved = scene.city.as_ref().is_some_and(|city| {
        let from = place - DVec2::new(city.origin.x, city.origin.z);
        cell_at(&city.rules, from.to_array()).is_some_and(|cell| has_cell(&city.rules, cell))
    });
    if paved {
        return built_in::STEP_ROAD;
    }
    let slope = sample.gradient.length() as f32;
    let above = above_sea.map(|above| above as f32);
    let layer = material.layer_at(sample.height as f32, above, slope);
    match layer.map(|layer| layer.name.as_str()) {
        Some("grass") => built_in::STEP_GRASS,
        Some("sand") => built_in::STEP_SAND,
        Some("snow") => built_in::STEP_SNOW,
        _ => built_in::STEP_ROCK,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{SceneRequest, load};
    use crate::settings::paths::assets_dir;

    fn scene(name: &str) -> LoadedScene {
        load(&SceneRequest::new(name), &assets_dir().unwrap()).unwrap()
    }

    /// On the island there is each kind of ground, and where it is agrees with height and slope.
    #[test]
    fn the_mountain_sounds_as_it_looks() {
        let scene = scene("mountain");
        let material = material(&scene);
        let mut found = [0; 6];
        for x in -60..=60 {
            for z in -60..=60 {
                let place = DVec2::new(f64::from(x), f64::from(z)) * 90.0;
                let step = step_on(&scene, &material, place);
                let ground = scene.terrain.sample_f64(place);
                let flat = ground.gradient.length() < 0.2;
                match step {
                    built_in::STEP_WATER => assert!(ground.height < 0.0),
                    built_in::STEP_SNOW => assert!(ground.height > 800.0, "{ground:?}"),
                    built_in::STEP_SAND => assert!(ground.height < 10.0, "{ground:?}"),
                    built_in::STEP_GRASS => assert!(ground.height < 720.0, "{ground:?}"),
                    built_in::STEP_ROCK => assert!(!flat || ground.height > 400.0, "{ground:?}"),
                    other => panic!("{other:?} at {place}"),
                }
                found[step.0 as usize] += 1;
            }
        }
        println!("rock, grass, sand, snow, road, water: {found:?}");
        for (kind, count) in found.iter().enumerate() {
            assert_eq!(
                *count > 10,
                kind != built_in::STEP_ROAD.0 as usize,
                "{found:?}"
            );
        }
    }

    #[test]
    fn streets_are_paved() {
        let scene = scene("city");
        let material = material(&scene);
        assert_eq!(
            step_on(&scene, &material, scene.figure),
            built_in::STEP_ROAD
        );
    }
}
