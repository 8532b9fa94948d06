//! The first ground in a window is coarse and gets sharper from frame to frame, so that no frame builds all
//! of it at once: at a pixel of error that alone takes a software device a minute.

use bevy::prelude::*;
use dolomite::ground::detail::{Choice, Metric, TerrainLod};
use dolomite::tessellation::render::GeometryStats;

use crate::settings::Settings;

/// The error bound of the first frame over the one that was asked for.
const FIRST: f32 = 64.0;

/// The bound of a frame over that of the frame before. Triangles go with one over the bound: each frame adds
/// a fifth to what there is, and the last step is as long as any.
const STEP: f32 = 0.84;

/// By how much the error bound is still widened; 1: no more, and so where there is no such resource.
#[derive(Resource, Clone, Copy, Debug, PartialEq)]
pub struct Widened(f32);

impl Default for Widened {
    fn default() -> Self {
        Self(FIRST)
    }
}

impl Widened {
    /// Level of detail with an error of `pixels`, as far as it has got. Blocks get sharper by themselves.
    pub fn detail(widened: Option<&Self>, pixels: f32, choice: Choice) -> TerrainLod {
        let widened = widened.filter(|_| choice == Choice::Cells);
        TerrainLod {
            metric: Metric::ErrorBound {
                pixels: pixels * widened.map_or(1.0, |widened| widened.0),
            },
            choice,
            ..default()
        }
    }
}

/// Sharpens the ground by a step, once there is some.
pub fn sharpen(
    mut commands: Commands,
    stats: Option<Res<GeometryStats>>,
    settings: Option<Res<Settings>>,
    mut widened: ResMut<Widened>,
) {
    if settings.is_some_and(|settings| settings.blocks) {
        commands.remove_resource::<Widened>();
        return;
    }
    if stats.is_none_or(|stats| stats.primitives == 0) {
        return;
    }
    widened.0 *= STEP;
    if widened.0 <= 1.0 {
        commands.remove_resource::<Widened>();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pixels(app: &App) -> f32 {
        let widened = app.world().get_resource::<Widened>();
        match Widened::detail(widened, 2.0, Choice::Cells).metric {
            Metric::ErrorBound { pixels } => pixels,
            other => panic!("{other:?} is no bound"),
        }
    }

    #[test]
    fn the_bound_narrows_once_there_is_ground_and_ends_where_it_was_asked_for() {
        let mut app = App::new();
        app.init_resource::<Widened>()
            .init_resource::<GeometryStats>()
            .add_systems(Update, sharpen.run_if(resource_exists::<Widened>));
        app.update();
        assert_eq!(pixels(&app), 2.0 * FIRST, "nothing is drawn yet");
        app.world_mut().resource_mut::<GeometryStats>().primitives = 9;
        let mut last = pixels(&app);
        let mut frames = 0;
        while last > 2.0 {
            app.update();
            let now = pixels(&app);
            assert!(now < last && now >= STEP * last, "{last}, then {now}");
            last = now;
            frames += 1;
        }
        // 64 · 0.84ⁿ ≤ 1.
        assert_eq!((frames, last), (24, 2.0));
        app.update();
        assert_eq!(pixels(&app), 2.0);
    }
}
