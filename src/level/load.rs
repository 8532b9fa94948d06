//! From a level's name to a level that can be played.

use std::path::Path;
use std::sync::Arc;

use bevy::math::{DVec2, IVec2, Vec2};
use dolomite::logic::movement::WalkGrid;

use super::error::LevelError;
use super::file::{LevelFile, Refused, quoted, refuse};
use super::ground;
use super::parts::Level;
use super::town::{self, Built, Fault};
use crate::play::figure::{WADING_DEPTH, depth};
use crate::scene::{self, LoadedScene, SceneRequest};

/// The levels that can be played, with the text of their files as built in.
pub const LEVELS: &[(&str, &str)] = &[
    ("mountain", include_str!("../../assets/levels/mountain.ron")),
    ("city", include_str!("../../assets/levels/city.ron")),
];

const SOLDIER: &str = include_str!("../../assets/levels/soldier.ron");

/// The name of a level, if it can be played.
///
/// # Errors
/// [`LevelError::NotThere`].
pub fn find(name: &str) -> Result<&'static str, LevelError> {
    let known = LEVELS.iter().find(|(known, _)| *known == name);
    known
        .map(|(name, _)| *name)
        .ok_or_else(|| LevelError::NotThere {
            name: name.to_owned(),
            there: LEVELS.iter().map(|(name, _)| *name).collect(),
        })
}

/// Loads a level and its scene. Files in the assets folder come before those that are built in.
///
/// # Errors
/// [`LevelError`], naming the file and the line.
pub fn load(name: &str, seed: u64, assets: &Path) -> Result<(Level, LoadedScene), LevelError> {
    let name = find(name)?;
    let path = assets.join("levels").join(format!("{name}.ron"));
    let built_in = LEVELS.iter().find(|(known, _)| *known == name);
    let text = read_or(&path, built_in.map_or("", |(_, text)| text))?;
    let behaviour = read_or(&assets.join("levels/soldier.ron"), SOLDIER)?;
    let file = LevelFile::parse(&text, &path)?;
    let scene = scene::load(&SceneRequest::new(file.scene.clone()), assets)?;
    let level = make(name, file, behaviour, seed, &scene)?;
    let level = level.map_err(|refused| refuse(&text, &path, refused))?;
    Ok((level, scene))
}

fn read_or(path: &Path, built_in: &str) -> Result<String, LevelError> {
    if !path.is_file() {
        return Ok(built_in.to_owned());
    }
    std::fs::read_to_string(path).map_err(|source| LevelError::Read {
        path: path.to_owned(),
        source,
    })
}

/// Over a ground: every place has to be where somebody can be.
fn make(
    name: &'static str,
    file: LevelFile,
    behaviour: String,
    seed: u64,
    scene: &LoadedScene,
) -> Result<Result<Level, Refused>, LevelError> {
    let terrain = &scene.terrain;
    let (mut grid, built) = match &scene.city {
        Some(city) => match town::build(city, &file) {
            Ok(built) => built,
            Err(Fault::Refused(refused)) => return Ok(Err(refused)),
            Err(Fault::Grid(error)) => return Err(error.into()),
        },
        None => {
            if let Some(refused) = needs_city(&file) {
                return Ok(Err(refused));
            }
            let middle = DVec2::new(f64::from(file.area.middle.0), f64::from(file.area.middle.1));
            let grid = ground::walk_grid(terrain, middle, file.area.side)?;
            (grid, Built::default())
        }
    };
    let start = Vec2::new(file.start.0, file.start.1);
    if !join(&mut grid, start) {
        let reason = format!("the player starts at {start}, where nobody can walk");
        return Ok(Err(("start:".into(), reason)));
    }
    let town = !built.hides.is_empty();
    let roofs = file.beacons.iter().zip(&built.roofs);
    let roofs: Vec<_> = roofs
        .filter_map(|(beacon, roof)| Some((&beacon.name, roof.as_ref()?)))
        .collect();
    for (name, place) in file.places() {
        // A roof is come to by its lift.
        let roof = roofs.iter().find(|(of, _)| **of == name);
        let place = roof.map_or(place, |(_, roof)| roof.before());
        let wet = depth(place.as_dvec2(), terrain) > WADING_DEPTH;
        // A place on a rock is the open ground beside it; what is lit has to be in reach from there.
        let far = match town && roof.is_none() && file.beacons.iter().any(|b| b.name == name) {
            true => file.reach,
            false => f32::INFINITY,
        };
        let open = grid.nearest_open(place, 4);
        if wet || open.is_none_or(|open| open.distance(place) > far) {
            let reason = format!("nobody can come to {place} of `{name}`");
            return Ok(Err((quoted(&name), reason)));
        }
    }
    Ok(Ok(Level {
        name,
        file: Arc::new(file),
        behaviour: behaviour.into(),
        grid: Arc::new(grid),
        built: Arc::new(built),
        seed,
    }))
}

/// What of a level needs a city, if anything does.
fn needs_city(file: &LevelFile) -> Option<Refused> {
    if file.gate.is_some() {
        let reason = "a `gate` needs a scene with a city: its wall stands on level ground";
        return Some(("gate:".into(), reason.into()));
    }
    let roof = file.beacons.iter().find(|beacon| beacon.lift.is_some())?;
    let reason = format!("the lift of `{}` needs a scene with a city", roof.name);
    Some((quoted(&roof.name), reason))
}

/// Closes every cell that cannot be reached from a place; whether there is such a place.
fn join(grid: &mut WalkGrid, from: Vec2) -> bool {
    let Some(open) = grid.nearest_open(from, 4) else {
        return false;
    };
    let size = grid.size().as_ivec2();
    let number = |cell: IVec2| (cell.y * size.x + cell.x) as usize;
    let mut reached = vec![false; (size.x * size.y) as usize];
    let first = grid.cell_of(open);
    reached[number(first)] = true;
    let mut front = vec![first];
    while let Some(cell) = front.pop() {
        for side in [IVec2::X, IVec2::NEG_X, IVec2::Y, IVec2::NEG_Y] {
            let next = cell + side;
            if grid.is_walkable(next) && !reached[number(next)] {
                reached[number(next)] = true;
                front.push(next);
            }
        }
    }
    for z in 0..size.y {
        for x in 0..size.x {
            let cell = IVec2::new(x, z);
            if !reached[number(cell)] {
                grid.set(cell, false);
            }
        }
    }
    true
}
