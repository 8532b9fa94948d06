//! How far the drawn ground of a camera has come: what a picture waits for.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use bevy::prelude::*;

/// The ground that a camera has drawn, as of the newest frame that was recorded.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DrawnGround {
    /// Something of it is drawn, however coarse.
    pub drawn: bool,
    /// What is drawn is what this frame's view and settings ask for, and nothing of it is still to be made.
    pub settled: bool,
    /// The bound that the drawn ground keeps, in the unit of its metric (pixels): what was asked for, or more where
    /// its room or the smallest cell did not allow that. None until it has come back from the GPU, two or three
    /// frames after the ground was chosen, and for a metric without a bound.
    pub held: Option<f32>,
}

/// What each camera has drawn of the ground; the same resource in the main world and in the render world.
#[derive(Resource, Clone, Default)]
pub struct GroundProgress(Arc<Mutex<Frames>>);

#[derive(Default)]
struct Frames {
    /// Of the newest frame that was recorded.
    newest: HashMap<Entity, DrawnGround>,
    /// What its kinds of ground have told so far.
    told: HashMap<Entity, DrawnGround>,
}

/// Schedule `Render`, in `RenderSystems::Cleanup`: every kind of ground tells of its views; after it all can be asked.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Telling;

impl GroundProgress {
    /// Of one camera (an entity of the main world); `None` where it sees no ground.
    #[must_use]
    pub fn of(&self, camera: Entity) -> Option<DrawnGround> {
        self.with(|all| all.newest.get(&camera).copied())
    }

    /// Of all cameras together: drawn where any has something, settled where all are, the greatest bound. `None`
    /// where no camera sees ground.
    #[must_use]
    pub fn all(&self) -> Option<DrawnGround> {
        self.with(|all| {
            all.newest.values().copied().reduce(|a, b| DrawnGround {
                drawn: a.drawn || b.drawn,
                settled: a.settled && b.settled,
                held: a.held.zip(b.held).map(|(a, b)| a.max(b)),
            })
        })
    }

    /// Adds a ground of a camera to what the frame has so far: a camera may see several.
    pub(super) fn add(&self, camera: Entity, ground: DrawnGround) {
        self.with(|all| {
            let known = all.told.entry(camera);
            known
                .and_modify(|known| {
                    known.drawn |= ground.drawn;
                    known.settled &= ground.settled;
                    known.held = known.held.zip(ground.held).map(|(a, b)| a.max(b));
                })
                .or_insert(ground);
        });
    }

    /// Ends a frame: what was told of it is the newest.
    fn end(&self) {
        self.with(|all| {
            std::mem::swap(&mut all.newest, &mut all.told);
            all.told.clear();
        });
    }

    fn with<T>(&self, f: impl FnOnce(&mut Frames) -> T) -> T {
        // Plain numbers: a panic elsewhere cannot leave them half-written.
        f(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// Ends a frame.
pub(super) fn end(progress: Res<GroundProgress>) {
    progress.end();
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ground(drawn: bool, settled: bool, held: Option<f32>) -> DrawnGround {
        DrawnGround {
            drawn,
            settled,
            held,
        }
    }

    #[test]
    fn grounds_of_a_camera_and_cameras_of_an_app_are_summed() {
        let progress = GroundProgress::default();
        assert_eq!(progress.all(), None);
        let [one, two] = [1, 2].map(|index| Entity::from_raw_u32(index).unwrap());
        progress.add(one, ground(true, true, Some(1.0)));
        progress.add(one, ground(false, true, Some(2.0)));
        assert_eq!(progress.of(one), None, "the frame has not ended");
        progress.end();
        assert_eq!(progress.of(one), Some(ground(true, true, Some(2.0))));
        assert_eq!(progress.of(two), None);
        progress.add(one, ground(true, true, Some(2.0)));
        progress.add(two, ground(true, false, None));
        progress.end();
        // One camera's bound is unknown: so is that of all.
        assert_eq!(progress.all(), Some(ground(true, false, None)));
        progress.end();
        assert_eq!(progress.of(one), None);
    }
}
