//! Views of the frame: what may be drawn in place of the picture, or over it, one switch each.

use std::sync::Arc;

use bevy::app::App;
use bevy::ecs::prelude::*;

/// A view and its switch.
#[derive(Clone)]
pub struct FrameView {
    /// What it is called in the console.
    pub name: &'static str,
    /// What it shows.
    pub about: &'static str,
    /// Of the views of a group one alone is on.
    pub group: Option<&'static str>,
    is_on: Arc<dyn Fn(&World) -> bool + Send + Sync>,
    switch: Arc<dyn Fn(&mut World, bool) -> Result<(), String> + Send + Sync>,
}

impl FrameView {
    /// A view that is on where `is_on` says so, and is switched by `switch`.
    pub fn new(
        name: &'static str,
        about: &'static str,
        is_on: impl Fn(&World) -> bool + Send + Sync + 'static,
        switch: impl Fn(&mut World, bool) + Send + Sync + 'static,
    ) -> Self {
        Self::refusing(name, about, is_on, move |world, on| {
            switch(world, on);
            Ok(())
        })
    }

    /// A view that may refuse to be switched, and says why.
    pub fn refusing(
        name: &'static str,
        about: &'static str,
        is_on: impl Fn(&World) -> bool + Send + Sync + 'static,
        switch: impl Fn(&mut World, bool) -> Result<(), String> + Send + Sync + 'static,
    ) -> Self {
        Self {
            name,
            about,
            group: None,
            is_on: Arc::new(is_on),
            switch: Arc::new(switch),
        }
    }

    /// It is one of those of a group of which one alone is on, by how they are switched.
    #[must_use]
    pub const fn in_group(mut self, group: &'static str) -> Self {
        self.group = Some(group);
        self
    }

    /// Whether it is on.
    #[must_use]
    pub fn is_on(&self, world: &World) -> bool {
        (self.is_on)(world)
    }

    /// Switches it.
    ///
    /// # Errors
    /// Why it is not switched, in words for whoever asked.
    pub fn switch(&self, world: &mut World, on: bool) -> Result<(), String> {
        (self.switch)(world, on)
    }
}

/// All views of an app, in the order they were added.
#[derive(Resource, Clone, Default)]
pub struct FrameViews(Vec<FrameView>);

impl FrameViews {
    /// Adds a view, or replaces the one with its name.
    pub fn add(&mut self, view: FrameView) {
        match self.0.iter_mut().find(|known| known.name == view.name) {
            Some(known) => *known = view,
            None => self.0.push(view),
        }
    }

    /// All of them.
    #[must_use]
    pub fn list(&self) -> &[FrameView] {
        &self.0
    }

    /// The one of this name.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<&FrameView> {
        self.0.iter().find(|view| view.name == name)
    }
}

/// Adds views of the frame to an app: `app.frame_view(FrameView::new(..))`.
pub trait AddFrameView {
    /// Adds a view, with the inspector or without, before it is added or after.
    fn frame_view(&mut self, view: FrameView) -> &mut Self;
}

impl AddFrameView for App {
    fn frame_view(&mut self, view: FrameView) -> &mut Self {
        self.init_resource::<FrameViews>();
        self.world_mut().resource_mut::<FrameViews>().add(view);
        self
    }
}
