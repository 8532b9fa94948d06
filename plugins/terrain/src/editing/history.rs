//! Steps that can be taken back.

use super::brush::{Edit, Edited, edit, lattice_of};
use super::error::EditError;
use crate::edits::{EditLattice, Edits};
use crate::terrain::Terrain;
use bevy::ecs::component::Component;

/// Most steps that are kept; older ones are forgotten. A step shares all tiles that it did not change.
const MOST_STEPS: usize = 1024;

/// Edits of the terrain on the same entity: what can be undone and redone. Nothing watches it: its calls give the terrain
/// that is to be written into the entity's [`Terrain`].
///
/// ```
/// # use bevy::math::DVec2;
/// # use dolomite_terrain::*;
/// # let mut terrain = Terrain::new(TerrainData {
/// #     extent: GroundRect::square(DVec2::ZERO, 400.0),
/// #     layers: vec![],
/// #     base: 0.0,
/// #     sea_level: None,
/// # })?;
/// let mut edits = TerrainEdits::new(&terrain)?;
/// let crater = Edit {
///     kind: EditKind::Lower,
///     place: DVec2::new(10.0, 20.0),
///     radius: 20.0,
///     strength: 6.0,
///     falloff: 1.0,
/// };
/// terrain = edits.apply(&terrain, &crater)?.terrain;
/// assert!(terrain.height(crater.place) < -5.9);
/// terrain = edits.undo(&terrain).expect("a step");
/// assert_eq!(terrain.height(crater.place), 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Component, Clone, Debug)]
pub struct TerrainEdits {
    lattice: EditLattice,
    base: Terrain,
    undo: Vec<Option<Edits>>,
    redo: Vec<Option<Edits>>,
}

impl TerrainEdits {
    /// No steps yet, on the lattice of the terrain's edits or on [`lattice_of`] it.
    ///
    /// # Errors
    /// [`EditError::Lattice`].
    pub fn new(terrain: &Terrain) -> Result<Self, EditError> {
        let lattice = match terrain.edits() {
            Some(edits) => *edits.lattice(),
            None => lattice_of(terrain)?,
        };
        Ok(Self {
            lattice,
            base: terrain.with_edits(None),
            undo: Vec::new(),
            redo: Vec::new(),
        })
    }

    /// Where samples of edits lie.
    #[must_use]
    pub const fn lattice(&self) -> &EditLattice {
        &self.lattice
    }

    /// How many steps can be undone, and redone.
    #[must_use]
    pub const fn steps(&self) -> [usize; 2] {
        [self.undo.len(), self.redo.len()]
    }

    /// Begins anew where the terrain is made of something else by now.
    fn follow(&mut self, terrain: &Terrain) -> Result<(), EditError> {
        if !terrain.same_base(&self.base) {
            *self = Self::new(terrain)?;
        }
        Ok(())
    }

    /// Makes an edit, as a step of its own.
    ///
    /// # Errors
    /// [`EditError`]; nothing has changed then.
    pub fn apply(&mut self, terrain: &Terrain, brush: &Edit) -> Result<Edited, EditError> {
        self.follow(terrain)?;
        let edited = edit(terrain, &self.lattice, brush)?;
        if edited.tiles > 0 {
            self.push(terrain.edits().cloned());
        }
        Ok(edited)
    }

    /// Makes an edit, as a part of the last step: a stroke of many edits is undone at once.
    ///
    /// # Errors
    /// [`EditError`]; nothing has changed then.
    pub fn apply_to_last(&mut self, terrain: &Terrain, brush: &Edit) -> Result<Edited, EditError> {
        self.follow(terrain)?;
        if self.undo.is_empty() {
            return self.apply(terrain, brush);
        }
        let edited = edit(terrain, &self.lattice, brush)?;
        if edited.tiles > 0 {
            self.redo.clear();
        }
        Ok(edited)
    }

    fn push(&mut self, before: Option<Edits>) {
        self.redo.clear();
        if self.undo.len() == MOST_STEPS {
            self.undo.remove(0);
        }
        self.undo.push(before);
    }

    /// Notes that all edits were replaced, as by a file: one step.
    pub fn replaced(&mut self, terrain: &Terrain) -> Result<(), EditError> {
        self.follow(terrain)?;
        self.push(terrain.edits().cloned());
        Ok(())
    }

    /// The terrain before the last step; `None` where there is none.
    pub fn undo(&mut self, terrain: &Terrain) -> Option<Terrain> {
        self.follow(terrain).ok()?;
        let before = self.undo.pop()?;
        self.redo.push(terrain.edits().cloned());
        Some(self.back_to(terrain, before))
    }

    /// The terrain with the last step that was undone; `None` where there is none.
    pub fn redo(&mut self, terrain: &Terrain) -> Option<Terrain> {
        self.follow(terrain).ok()?;
        let again = self.redo.pop()?;
        self.undo.push(terrain.edits().cloned());
        Some(self.back_to(terrain, again))
    }

    /// A layer stays where there was one, though nothing may be in it: who draws keeps what it made for edited ground.
    fn back_to(&self, terrain: &Terrain, edits: Option<Edits>) -> Terrain {
        terrain.with_edits(Some(edits.unwrap_or(Edits::none(self.lattice))))
    }
}
