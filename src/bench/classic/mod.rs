//! The scene `classic` in the game and the bench: one surface and one path, to compare methods.
//!
//! The scene itself is the crate `dolomite_classic`. The game knows it as a
//! [`NamedScene`] with a view of its own, and as nothing else.
//!
//! | file | concern |
//! |---|---|
//! | [`methods`], [`args`] | the ways to make its triangles; what the command line says of them |
//! | [`view`] | how it is drawn |
//! | [`mod@matrix`] | the bench over all ways to make triangles |

pub mod args;
pub mod matrix;
pub mod methods;
pub mod view;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use bevy::app::App;
use bevy::math::{DVec2, DVec3, ops};
use dolomite::ground::{MaterialBands, Sea};
use dolomite_classic::{ClassicHeights, ClassicHeightsError, heights};

use crate::scene::{LoadedScene, NamedScene, OwnView, Pose, changed};
use crate::settings::paths;
use methods::Methods;
use view::ClassicViewPlugin;

/// Its name.
pub const NAME: &str = "classic";

/// The scene, to be asked for by its name. `data` is the folder of shared data, in which its heights lie;
/// `None`: where [`paths::shared_dir`] looks.
pub fn scene(data: Option<PathBuf>, methods: Methods) -> NamedScene {
    NamedScene {
        name: NAME,
        load: Arc::new(move || {
            let folder = paths::shared_dir(data.as_deref());
            Ok(load(&folder.join(heights::FILE), methods)?)
        }),
    }
}

/// The scene from its samples; the ground that answers questions is the same bilinear map, in f64.
fn load(path: &Path, methods: Methods) -> Result<LoadedScene, ClassicHeightsError> {
    let heights = ClassicHeights::load(path)?;
    Ok(LoadedScene {
        name: NAME.to_owned(),
        about: "one surface and one path, to compare methods".to_owned(),
        terrain: heights.terrain(),
        bands: MaterialBands::default(),
        material: None,
        sea: Sea::default(),
        sun: dolomite::sky::Sun::default(),
        lamps: None,
        city: None,
        vegetation: None,
        camera: orbit(0.0),
        figure: DVec2::ZERO,
        facing: 0.0,
        things: Vec::new(),
        files: vec![(path.to_owned(), changed(path))],
        own: Some(Arc::new(Classic { heights, methods })),
    })
}

/// The surface, and how its triangles are made at the start.
struct Classic {
    heights: ClassicHeights,
    methods: Methods,
}

impl OwnView for Classic {
    fn build(&self, app: &mut App) {
        app.insert_resource(self.methods)
            .add_plugins(ClassicViewPlugin {
                heights: self.heights.clone(),
            });
    }

    fn orbit(&self, seconds: f32) -> Pose {
        orbit(seconds)
    }
}

/// Seconds of one circle of the path: 120 frames.
const CIRCLE: f64 = 2.0;

/// The path of the classic scene: 200 m from the axis, 70 m high, looking along the circle and down
/// by a quarter. In f64 but for the angles, rounded once.
pub fn orbit(seconds: f32) -> Pose {
    let angle = std::f64::consts::TAU * f64::from(seconds) / CIRCLE;
    let (sin, cos) = ops::sin_cos(angle as f32);
    let (sin, cos) = (f64::from(sin), f64::from(cos));
    let eye = DVec3::new(200.0 * cos, 70.0, 200.0 * sin);
    Pose::looking_at(eye, eye + DVec3::new(-sin, -0.25, cos))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{self, SceneRequest};

    #[test]
    fn missing_shared_data_are_named() {
        let data = Some(PathBuf::from("no/such/folder"));
        let request = SceneRequest {
            named: vec![super::scene(data, Methods::default())],
            ..SceneRequest::new(NAME)
        };
        let error = scene::load(&request, Path::new("assets"))
            .err()
            .unwrap()
            .to_string();
        for word in ["no/such/folder/data/classic", "shared", "--data"] {
            assert!(error.contains(word), "{error} does not say {word}");
        }
    }

    #[test]
    fn the_classic_path_is_as_defined() {
        for (frame, eye, ahead) in [
            (0, [200.0, 70.0, 0.0], [0.0, -0.25, 1.0]),
            (30, [0.0, 70.0, 200.0], [-1.0, -0.25, 0.0]),
            (90, [0.0, 70.0, -200.0], [1.0, -0.25, 0.0]),
            (120, [200.0, 70.0, 0.0], [0.0, -0.25, 1.0]),
        ] {
            let pose = orbit(frame as f32 / 60.0);
            // Sine and cosine of f32 angles up to 2 pi: 5e-7 of 200 m.
            assert!(
                pose.position.distance(DVec3::from(eye)) < 2e-4,
                "{frame}: {pose:?}"
            );
            let looks = pose.rotation() * bevy::math::Vec3::NEG_Z;
            let wanted = bevy::math::Vec3::from(ahead).normalize();
            assert!(looks.distance(wanted) < 1e-5, "{frame}: {looks}");
        }
    }
}
