//! An inspector and a console over any Bevy app.
//!
//! ```no_run
//! use bevy::prelude::*;
//! use dolomite_inspector::InspectorPlugin;
//!
//! App::new().add_plugins((DefaultPlugins, InspectorPlugin)).run();
//! ```
//!
//! F10 opens the panel, the key left of 1 the console. What the panel shows is what the app's registry knows: a component
//! or a resource that derives `Reflect` and is registered shows up, under the name of its crate. Ranges and units are
//! said by [`Describe`](settings::described::Describe), views of the frame by
//! [`AddFrameView`](views::AddFrameView), commands by [`Console`]'s table.
//!
//! | module | concern |
//! |---|---|
//! | [`console`], [`commands`] | lines, scripts, help and completion from one table; the commands of every app |
//! | [`settings`] | values by reflection: found, read, written within ranges, taken back |
//! | [`chart`] | charts of the running scene |
//! | [`entities`] | their tree; render, physics and logic answers |
//! | [`measures`] | diagnostics by plugin, histories, sums, what was skipped |
//! | [`views`] | views of the frame, a switch each |
//! | `picture` | channels of the G-buffer, depth, motion in place of the frame (feature `picture`) |
//! | `panel` | what is drawn of all that (feature `panel`) |
//!
//! Without a renderer, or without the feature `panel`, the console works all the same, by [`Console::enter`] and by
//! scripts. **Closed, nothing is done**: no system of this crate or of `bevy_egui`'s main world runs, there is no camera,
//! no pass, no buffer and no pipeline of theirs.

pub mod chart;
pub mod commands;
pub mod console;
pub mod entities;
pub mod measures;
#[cfg(feature = "panel")]
pub mod panel;
#[cfg(feature = "picture")]
pub mod picture;
pub mod settings;
pub mod views;

use bevy::ecs::reflect::AppTypeRegistry;
use bevy::input::InputSystems;
use bevy::prelude::*;

pub use console::Console;

use console::queue;
use measures::Watched;
use settings::described::Descriptions;
use settings::edit::Undo;
use views::FrameViews;

/// The inspector and the console. Add it after Bevy's `DefaultPlugins`, and after `EguiPlugin` where the app has one of
/// its own; added again it does nothing.
pub struct InspectorPlugin;

/// What is open. Keys, tests and the app itself write it.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Inspector {
    /// The panel: settings, entities, diagnostics, views.
    pub panel: bool,
    /// The console.
    pub console: bool,
}

impl Inspector {
    /// Whether anything is.
    #[must_use]
    pub const fn is_open(self) -> bool {
        self.panel || self.console
    }
}

/// The keys that open and close it; `None`: no key does.
#[derive(Resource, Clone, Copy, Debug, PartialEq, Eq)]
pub struct InspectorKeys {
    /// For the panel.
    pub panel: Option<KeyCode>,
    /// For the console.
    pub console: Option<KeyCode>,
    /// Closes both.
    pub close: Option<KeyCode>,
}

impl Default for InspectorKeys {
    fn default() -> Self {
        Self {
            panel: Some(KeyCode::F10),
            console: Some(KeyCode::Backquote),
            close: Some(KeyCode::Escape),
        }
    }
}

/// What of the input is the inspector's in this frame: an app whose keys and mouse do other things leaves them then.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct InspectorWants {
    /// Something is being typed.
    pub keyboard: bool,
    /// The pointer is over it, or drags something of it.
    pub pointer: bool,
}

/// The systems of this crate in `PreUpdate`, after Bevy's `InputSystems`.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct InspectorSystems;

/// Says that the plugin was added.
#[derive(Resource)]
struct Added;

impl Plugin for InspectorPlugin {
    fn build(&self, app: &mut App) {
        if app.world().contains_resource::<Added>() {
            return;
        }
        app.insert_resource(Added)
            .init_resource::<AppTypeRegistry>()
            .init_resource::<Descriptions>()
            .init_resource::<FrameViews>()
            .init_resource::<Inspector>()
            .init_resource::<InspectorKeys>()
            .init_resource::<InspectorWants>()
            .init_resource::<Undo>()
            .init_resource::<Watched>();
        // An app may have added commands of its own before.
        let mut console = app
            .world_mut()
            .remove_resource::<Console>()
            .unwrap_or_default();
        let own = std::mem::take(&mut console.table);
        commands::add(&mut console);
        console.table.extend(own);
        app.insert_resource(console);
        app.configure_sets(PreUpdate, InspectorSystems.after(InputSystems))
            .add_systems(
                PreUpdate,
                (
                    toggle.run_if(is_key_pressed),
                    queue::advance.run_if(|console: Res<Console>| !console.queue.is_empty()),
                )
                    .chain()
                    .in_set(InspectorSystems),
            );
        #[cfg(feature = "picture")]
        picture::build(app);
        #[cfg(feature = "panel")]
        panel::build(app);
    }

    fn is_unique(&self) -> bool {
        false
    }

    #[cfg(feature = "panel")]
    fn finish(&self, app: &mut App) {
        panel::finish(app);
    }
}

fn is_key_pressed(
    keys: Option<Res<ButtonInput<KeyCode>>>,
    ours: Res<InspectorKeys>,
    inspector: Res<Inspector>,
) -> bool {
    let pressed = |key: Option<KeyCode>| {
        let keys = keys.as_ref();
        key.is_some_and(|key| keys.is_some_and(|keys| keys.just_pressed(key)))
    };
    pressed(ours.panel) || pressed(ours.console) || inspector.is_open() && pressed(ours.close)
}

fn toggle(
    keys: Res<ButtonInput<KeyCode>>,
    ours: Res<InspectorKeys>,
    mut inspector: ResMut<Inspector>,
) {
    let pressed = |key: Option<KeyCode>| key.is_some_and(|key| keys.just_pressed(key));
    inspector.panel ^= pressed(ours.panel);
    inspector.console ^= pressed(ours.console);
    if pressed(ours.close) {
        *inspector = Inspector::default();
    }
}
