//! Edits of the landscape: by a call, taken back, saved beside the scene's file, and taken over by all that stands on it.

use std::path::PathBuf;
use std::sync::Arc;

use bevy::ecs::change_detection::DetectChangesMut;
use bevy::math::{DVec2, DVec3};
use bevy::prelude::*;
use dolomite::collision::rapier::GroundTiles;
use dolomite::terrain::editing::{self, Edited};
use dolomite::terrain::{
    Edit, EditError, EditFileError, Edits, Ground, GroundRect, Terrain, TerrainEdits,
};
use thiserror::Error;

use super::Landscape;
use super::figure::{Figure, settle_within};
use super::things::Bed;
use crate::scene::{CurrentScene, Pose, edits_file};

/// Why the landscape was not edited; it is as it was.
#[derive(Debug, Error)]
pub enum LandscapeError {
    /// The edit was refused.
    #[error(transparent)]
    Edit(#[from] EditError),
    /// The file was refused.
    #[error(transparent)]
    File(#[from] EditFileError),
    /// There is no landscape: the scene draws itself.
    #[error("the scene has no landscape that can be edited")]
    NoLandscape,
    /// No step.
    #[error("nothing to {0}")]
    NoStep(&'static str),
    /// Nowhere to save.
    #[error("the scene has no folder: name a file")]
    NoFolder,
}

/// The landscape takes edits over. Nothing runs while it does not change.
pub struct EditsPlugin;

impl Plugin for EditsPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(
            PreUpdate,
            follow.run_if(any_match_filter::<(With<Landscape>, Changed<Terrain>)>),
        );
    }
}

/// Figures, stones and the scene stand on what the landscape is.
fn follow(
    landscape: Query<&Terrain, (With<Landscape>, Changed<Terrain>)>,
    mut scene: ResMut<CurrentScene>,
    mut beds: Query<&mut GroundTiles, With<Bed>>,
    mut figures: Query<&mut Figure>,
) {
    let Some(terrain) = landscape.iter().next() else {
        return;
    };
    let Some(rects) = terrain
        .changed_since(&scene.terrain)
        .filter(|rects| !rects.is_empty())
    else {
        return;
    };
    // Not another scene: what is made when one comes stays.
    scene.bypass_change_detection().0.terrain = terrain.clone();
    for mut tiles in &mut beds {
        tiles.set_ground(Arc::new(terrain.clone()));
    }
    let within = |place: DVec2| rects.iter().any(|rect: &GroundRect| rect.contains(place));
    for mut figure in &mut figures {
        settle_within(&mut figure, terrain, within);
    }
}

/// The landscape with what was edited of it; the history is made when it is first needed.
fn with_landscape<T>(
    world: &mut World,
    change: impl FnOnce(&mut TerrainEdits, &Terrain) -> Result<(Option<Terrain>, T), LandscapeError>,
) -> Result<T, LandscapeError> {
    let mut landscapes = world.query_filtered::<(Entity, &Terrain), With<Landscape>>();
    let (entity, terrain) = landscapes
        .iter(world)
        .next()
        .map(|(entity, terrain)| (entity, terrain.clone()))
        .ok_or(LandscapeError::NoLandscape)?;
    if world.resource::<CurrentScene>().own.is_some() {
        return Err(LandscapeError::NoLandscape);
    }
    let mut landscape = world.entity_mut(entity);
    if !landscape.contains::<TerrainEdits>() {
        landscape.insert(TerrainEdits::new(&terrain)?);
    }
    let Some(mut edits) = landscape.get_mut::<TerrainEdits>() else {
        return Err(LandscapeError::NoLandscape);
    };
    let (now, result) = change(&mut edits, &terrain)?;
    if let Some(now) = now.filter(|now| !now.same(&terrain)) {
        landscape.insert(now);
    }
    Ok(result)
}

/// Edits the landscape; `goes_on` for the next edits of a stroke, which are undone with its first.
///
/// # Errors
/// [`LandscapeError`].
pub fn edit(world: &mut World, brush: &Edit, goes_on: bool) -> Result<Edited, LandscapeError> {
    with_landscape(world, |edits, terrain| {
        let made = if goes_on {
            edits.apply_to_last(terrain, brush)
        } else {
            edits.apply(terrain, brush)
        }?;
        Ok((Some(made.terrain.clone()), made))
    })
}

/// Takes the last step back.
///
/// # Errors
/// [`LandscapeError`].
pub fn undo(world: &mut World) -> Result<(), LandscapeError> {
    with_landscape(world, |edits, terrain| {
        let now = edits.undo(terrain).ok_or(LandscapeError::NoStep("undo"))?;
        Ok((Some(now), ()))
    })
}

/// Makes the last step again that was taken back.
///
/// # Errors
/// [`LandscapeError`].
pub fn redo(world: &mut World) -> Result<(), LandscapeError> {
    with_landscape(world, |edits, terrain| {
        let now = edits.redo(terrain).ok_or(LandscapeError::NoStep("redo"))?;
        Ok((Some(now), ()))
    })
}

/// The file that is meant: the one named, or that of the scene.
fn file(world: &World, named: Option<PathBuf>) -> Result<PathBuf, LandscapeError> {
    named
        .or_else(|| edits_file(&world.resource::<CurrentScene>().files))
        .ok_or(LandscapeError::NoFolder)
}

/// Saves what was edited: beside the scene's file, or where it is said. Where to.
///
/// # Errors
/// [`LandscapeError`].
pub fn save(world: &mut World, named: Option<PathBuf>) -> Result<PathBuf, LandscapeError> {
    let path = file(world, named)?;
    with_landscape(world, |edits, terrain| {
        let none = Edits::none(*edits.lattice());
        editing::save(&path, terrain.edits().unwrap_or(&none))?;
        Ok((None, ()))
    })?;
    Ok(path)
}

/// Loads what was saved, in place of all edits: one step.
///
/// # Errors
/// [`LandscapeError`].
pub fn load(world: &mut World, named: Option<PathBuf>) -> Result<PathBuf, LandscapeError> {
    let path = file(world, named)?;
    with_landscape(world, |edits, terrain| {
        let loaded = editing::load(&path, edits.lattice())?;
        edits.replaced(terrain)?;
        Ok((Some(terrain.with_edits(Some(loaded))), ()))
    })?;
    Ok(path)
}

/// Where a ray from the camera meets the ground, (x, z), metres; `None` where it meets none within `far` metres.
#[must_use]
pub fn seen(ground: &impl Ground, from: DVec3, along: DVec3, far: f64) -> Option<DVec2> {
    let along = along.normalize_or_zero();
    let above = |t: f64| {
        let at = from + along * t;
        at.y - ground.height(DVec2::new(at.x, at.z))
    };
    let (mut last, mut height) = (0.0, above(0.0));
    while last < far && height > 0.0 {
        // No steeper than 63° is missed by more than a part of the step.
        let next = last + (0.4 * height).clamp(0.25, 50.0);
        let there = above(next);
        if there <= 0.0 {
            let (mut low, mut high) = (last, next);
            for _ in 0..40 {
                let middle = 0.5 * (low + high);
                if above(middle) > 0.0 {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            let at = from + along * high;
            return Some(DVec2::new(at.x, at.z));
        }
        (last, height) = (next, there);
    }
    None
}

/// Where a camera looks at the ground, else below it.
#[must_use]
pub fn looked_at(ground: &impl Ground, pose: &Pose) -> DVec2 {
    let along = (pose.rotation() * Vec3::NEG_Z).as_dvec3();
    seen(ground, pose.position, along, 20_000.0)
        .unwrap_or(DVec2::new(pose.position.x, pose.position.z))
}

#[cfg(test)]
mod tests {
    use super::*;
    use dolomite::terrain::GroundSample;

    #[test]
    fn rays_meet_slopes_where_they_are() {
        struct Slope;
        impl Ground for Slope {
            fn sample(&self, xz: DVec2) -> GroundSample {
                GroundSample {
                    height: 0.5 * xz.x,
                    gradient: DVec2::new(0.5, 0.0),
                }
            }
        }
        let from = DVec3::new(0.0, 30.0, 7.0);
        // 30 − t/√2 = t/(2√2): x = 20.
        let at = seen(&Slope, from, DVec3::new(1.0, -1.0, 0.0), 1000.0).expect("met");
        assert!(at.distance(DVec2::new(20.0, 7.0)) < 1e-6, "{at}");
        assert_eq!(seen(&Slope, from, DVec3::Y, 1000.0), None);
        assert_eq!(seen(&Slope, from, DVec3::NAN, 1000.0), None);
    }
}
