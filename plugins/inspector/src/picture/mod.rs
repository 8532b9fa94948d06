//! Pictures of what a frame is made of, in its place: channels of the G-buffer, depth, motion; and what other plugins add.
//!
//! One is shown at a time: [`FramePicture::shown`] says which, and the console, the panel and the app all write that. It
//! is drawn by one triangle over each 3D camera, behind its other passes. A prepass that a picture reads and a camera lacks
//! is added to the camera while it is shown.
//!
//! **While none is shown** there is no pass, no buffer, no pipeline and no shader; two systems ask each frame whether one is.
//!
//! | file | concern |
//! |---|---|
//! | [`source`] | what a picture reads, and in which ways |
//! | `equip` | prepasses for as long as they are needed; what is refused |
//! | `render` | the pass |
//! | [`colours`] | numbers as colours, as `shaders/src/inspector/colours.wgsl` |
//! | [`legend`] | where the legend of a picture lies, as `shaders/src/inspector/legend.wgsl` |

pub mod colours;
mod equip;
pub mod legend;
mod render;
pub mod source;

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use bevy::prelude::*;
use bevy::render::RenderApp;

use crate::settings::described::{Describe, Description, Field};
use crate::views::{AddFrameView, FrameView};
pub use equip::PictureRefusal;
pub(crate) use equip::PictureRenders;
pub use render::{FramePictureSystems, variants};
use source::{Picture, own_pictures};

/// Which picture is shown in place of the frame, and in which ranges.
#[derive(Resource, Reflect, Clone, Debug, PartialEq)]
#[reflect(Resource, Default, Clone, PartialEq)]
pub struct FramePicture {
    /// The picture's name; empty: the frame itself. A name that no picture has shows the frame.
    pub shown: String,
    /// Distance from the camera's plane that is white, metres, above 0.
    pub near: f32,
    /// Distance that is black, metres, above `near`.
    pub far: f32,
    /// Motion of full colour, pixels a frame, above 0.
    pub fastest: f32,
    /// Count that is red, above 0.
    pub most: f32,
    /// Level of the depth pyramid: its texels are 2 to this power pixels wide. 1 to 16; what a view has not is its last.
    pub level: u32,
    /// Difference against the reference that is pale yellow, as a share of it, above 0.
    pub difference: f32,
}

impl Default for FramePicture {
    fn default() -> Self {
        Self {
            shown: String::new(),
            near: 0.1,
            far: 10_000.0,
            fastest: 32.0,
            most: 32.0,
            level: 4,
            difference: 0.01,
        }
    }
}

/// All pictures of an app.
#[derive(Resource, Clone, Debug, Default)]
pub struct Pictures(Vec<Picture>);

impl Pictures {
    /// All of them, in the order they were added.
    #[must_use]
    pub fn list(&self) -> &[Picture] {
        &self.0
    }

    /// The one of this name.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<&Picture> {
        self.0.iter().find(|picture| picture.name == name)
    }
}

/// How many passes of pictures were recorded, over all views: 0 as long as none was shown.
#[derive(Resource, Clone, Debug, Default)]
pub struct PicturePasses(Arc<AtomicU64>);

impl PicturePasses {
    /// The count.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.0.load(Ordering::Relaxed)
    }

    fn add(&self) {
        self.0.fetch_add(1, Ordering::Relaxed);
    }
}

/// The group of all pictures among the views of the frame.
pub const GROUP: &str = "picture";

/// Adds pictures of the frame to an app.
pub trait AddPicture {
    /// Adds a picture and its switch, or replaces the one of its name; with the inspector or without, before it is added
    /// or after. Nothing is drawn of it without a renderer.
    fn picture(&mut self, picture: Picture) -> &mut Self;
}

impl AddPicture for App {
    fn picture(&mut self, picture: Picture) -> &mut Self {
        let name = picture.name;
        let view = FrameView::refusing(
            name,
            picture.about,
            move |world| {
                let shown = world.get_resource::<FramePicture>();
                shown.is_some_and(|picture| picture.shown == name)
            },
            move |world, on| equip::switch(world, name, on),
        );
        self.init_resource::<Pictures>()
            .frame_view(view.in_group(GROUP));
        let pictures = &mut self.world_mut().resource_mut::<Pictures>().0;
        match pictures.iter_mut().find(|known| known.name == name) {
            Some(known) => *known = picture,
            None => pictures.push(picture),
        }
        self
    }
}

pub(crate) fn build(app: &mut App) {
    let above = |about: &'static str, unit: &'static str| {
        Field::new(about).range(1e-3..=1e9).unit(unit).logarithmic()
    };
    app.init_resource::<FramePicture>()
        .init_resource::<PicturePasses>()
        .register_type::<FramePicture>()
        .describe::<FramePicture>(
            Description::new("What is shown in place of the frame, and in which ranges")
                .field("near", above("Distance that is white", "m"))
                .field("far", above("Distance that is black", "m"))
                .field("fastest", above("Motion of full colour", "px"))
                .field("most", above("Count that is red", ""))
                .field(
                    "difference",
                    above("Difference that is pale yellow, of 1", ""),
                )
                .field(
                    "level",
                    Field::new("Level of the depth pyramid").range(1.0..=16.0),
                ),
        );
    for picture in own_pictures() {
        app.picture(picture);
    }
    app.add_systems(
        PostUpdate,
        // Cameras may come while a picture is shown.
        equip::equip
            .run_if(resource_changed::<FramePicture>.or_else(resource_exists::<equip::Shown>)),
    );
    equip::look(app);
    let passes = app.world().resource::<PicturePasses>().clone();
    let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
        return;
    };
    render::build(render_app, passes);
}
