//! How a scene joins that is no landscape: it has a name and a view of its own.
//!
//! The game draws landscapes. What is loaded and drawn otherwise, such as a scene to compare methods on,
//! registers a [`NamedScene`] in the [`SceneRequest`](super::SceneRequest) and gives its
//! [`LoadedScene`] an [`OwnView`]; nothing else in the game knows of it.

use std::error::Error;
use std::sync::Arc;

use bevy::app::App;

use super::{LoadedScene, Pose};

/// A scene that is found by its name.
#[derive(Clone)]
pub struct NamedScene {
    /// What it is asked for by.
    pub name: &'static str,
    /// Reads it.
    pub load: Arc<dyn Fn() -> Result<LoadedScene, Box<dyn Error + Send + Sync>> + Send + Sync>,
}

/// What shows a scene in place of the game's own view. Such a scene has no figure to follow, and its
/// camera goes through hills.
pub trait OwnView: Send + Sync + 'static {
    /// Adds all that is drawn: the camera's components too. The app has the simulation already.
    fn build(&self, app: &mut App);

    /// Where the camera of the bench's path `orbit` is after `seconds`.
    fn orbit(&self, seconds: f32) -> Pose;
}
