//! The walls of a city: boxes that stop the figure, of the blocks around it alone.

use bevy::math::{DVec2, Vec3};
use bevy::prelude::*;
use dolomite::city::streets::{cell_at, has_cell};
use dolomite::city::{Block, Surface};
use dolomite::collision::{Blocker, CollisionSystems};

use super::figure::{Figure, FigureSystems};
use crate::scene::CurrentScene;
use crate::scene::city::CityScene;

/// Cells around the figure's each way whose walls are there.
const REACH: i32 = 1;

/// How far hedges and houses reach into the ground, metres.
const FOOT: f32 = 0.5;

/// A wall or hedge.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
pub struct CityWall;

/// Which city, and around which cell.
#[derive(Resource, Default, PartialEq)]
struct Standing(Option<(CityScene, [i32; 2])>);

/// Puts walls around figures. Needs no renderer.
pub struct CityWallsPlugin;

impl Plugin for CityWallsPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Standing>().add_systems(
            FixedUpdate,
            stand
                .run_if(|scene: Res<CurrentScene>, standing: Res<Standing>| {
                    scene.city.is_some() || standing.0.is_some()
                })
                .before(FigureSystems)
                .before(CollisionSystems::Gather),
        );
    }
}

/// Middle and half of the size of an upright box of a cell: `centre` and `half` are (east, south) of its corner.
fn upright(
    city: &CityScene,
    cell: [i32; 2],
    centre: [f32; 2],
    half: [f32; 2],
    height: f32,
) -> (Vec3, Vec3) {
    let pitch = f64::from(city.rules.pitch);
    let corner = [0, 1].map(|k| f64::from(cell[k]) * pitch);
    let x = city.origin.x + corner[0] + f64::from(centre[0]);
    let z = city.origin.z + corner[1] + f64::from(centre[1]);
    let middle = Vec3::new(
        x as f32,
        city.origin.y as f32 + 0.5 * (height - FOOT),
        z as f32,
    );
    (middle, Vec3::new(half[0], 0.5 * (height + FOOT), half[1]))
}

/// Middle and half of the size of each house in a cell: a box up to the roof's top, as wide as its walls bulge.
pub fn houses(city: &CityScene, cell: [i32; 2]) -> Vec<(Vec3, Vec3)> {
    let rules = &city.rules;
    let block = Block::new(rules, cell);
    let houses = block.buildings(rules).map(|house| {
        let half = house.half + house.walls.amplitude(rules);
        upright(city, cell, house.centre, [half; 2], house.top)
    });
    houses.collect()
}

/// The same of each hedge.
pub fn hedges(city: &CityScene, cell: [i32; 2]) -> Vec<(Vec3, Vec3)> {
    let rules = &city.rules;
    let leaves = Surface::Leaves.amplitude(rules);
    let block = Block::new(rules, cell);
    let hedges = block.hedges(rules).map(|hedge| {
        let half = hedge.half.map(|half| half + leaves);
        upright(city, cell, hedge.centre, half, hedge.height)
    });
    hedges.collect()
}

fn stand(
    mut commands: Commands,
    scene: Res<CurrentScene>,
    mut standing: ResMut<Standing>,
    figures: Query<&Figure>,
    old: Query<Entity, With<CityWall>>,
) {
    let next = scene.city.as_ref().and_then(|city| {
        let figure = figures.iter().next()?;
        let place = figure.now.place - DVec2::new(city.origin.x, city.origin.z);
        let cell = cell_at(&city.rules, place.to_array())?;
        Some((city.clone(), cell))
    });
    if standing.0 == next {
        return;
    }
    for wall in &old {
        commands.entity(wall).despawn();
    }
    if let Some((city, [x, z])) = &next {
        for cell in (x - REACH..=x + REACH)
            .flat_map(|x| (z - REACH..=z + REACH).map(move |z| [x, z]))
            .filter(|cell| has_cell(&city.rules, *cell))
        {
            for (middle, half_size) in [houses(city, cell), hedges(city, cell)].concat() {
                commands.spawn((
                    CityWall,
                    Blocker { half_size },
                    Transform::from_translation(middle),
                ));
            }
        }
    }
    standing.0 = next;
}
