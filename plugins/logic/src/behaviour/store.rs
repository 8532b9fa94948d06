//! The behaviours of an app: read, held to the rules, read again when their files change.

use super::compile::compile;
use super::error::{BehaviourError, Reason};
use super::leaf::{LeafBatch, Leaves};
use super::mind::BehaviourId;
use super::program::Program;
use crate::clock::LogicClock;
use crate::names::Names;
use bevy::app::App;
use bevy::ecs::prelude::*;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;

/// Largest file that is read, bytes: some hundred times the largest program.
const MOST_BYTES: u64 = 4 << 20;

/// When a file changed, and how long it is.
type Stamp = (Option<SystemTime>, u64);

#[derive(Debug)]
struct Entry {
    name: String,
    path: Option<PathBuf>,
    stamp: Option<Stamp>,
    program: Arc<Program>,
    edition: u32,
    error: Option<BehaviourError>,
}

/// The behaviours of an app.
#[derive(Resource, Debug, Default)]
pub struct Behaviours {
    entries: Vec<Entry>,
    /// Whether files are looked at every second, and read again when they changed. Off by default.
    pub watch: bool,
}

/// A file was read again.
#[derive(Message, Clone, Debug, PartialEq, Eq)]
pub struct BehaviourMessage {
    /// Which behaviour.
    pub behaviour: BehaviourId,
    /// Why it stays as it was, if it does.
    pub error: Option<BehaviourError>,
}

impl Behaviours {
    /// A behaviour by its file, or by the name that it was given.
    #[must_use]
    pub fn find(&self, name: &str) -> Option<BehaviourId> {
        let at = self.entries.iter().position(|entry| entry.name == name)?;
        Some(BehaviourId(at as u16))
    }

    /// What is run of a behaviour.
    #[must_use]
    pub fn program(&self, behaviour: BehaviourId) -> Option<&Program> {
        let entry = self.entries.get(usize::from(behaviour.0))?;
        Some(&entry.program)
    }

    /// Why the last text of a behaviour was refused, if it was.
    #[must_use]
    pub fn error(&self, behaviour: BehaviourId) -> Option<&BehaviourError> {
        self.entries.get(usize::from(behaviour.0))?.error.as_ref()
    }

    /// Name, program and edition of a behaviour.
    pub(super) fn entry(&self, behaviour: BehaviourId) -> Option<(&str, &Program, u32)> {
        let entry = self.entries.get(usize::from(behaviour.0))?;
        Some((&entry.name, &entry.program, entry.edition))
    }

    /// Programs by number, with their editions.
    pub(super) fn programs(&self) -> impl Iterator<Item = (&Arc<Program>, u32)> {
        self.entries
            .iter()
            .map(|entry| (&entry.program, entry.edition))
    }

    fn take(
        &mut self,
        name: &str,
        path: Option<&Path>,
        stamp: Option<Stamp>,
        result: Result<Program, BehaviourError>,
    ) -> Result<BehaviourId, BehaviourError> {
        let known = self.find(name);
        let program = match (result, known) {
            (Ok(program), _) => Arc::new(program),
            (Err(error), Some(known)) => {
                let entry = &mut self.entries[usize::from(known.0)];
                // A text that was refused says nothing about the file that is watched.
                if entry.path.as_deref() == path {
                    entry.stamp = stamp;
                }
                entry.error = Some(error.clone());
                return Err(error);
            }
            (Err(error), None) => return Err(error),
        };
        let number = known.map_or(self.entries.len(), |known| usize::from(known.0));
        if number == self.entries.len() {
            self.entries.push(Entry {
                name: name.to_owned(),
                path: None,
                stamp: None,
                program: Arc::default(),
                edition: 0,
                error: None,
            });
        }
        let entry = &mut self.entries[number];
        entry.program = program;
        entry.edition += 1;
        // Where it came from last is what is watched: a text that took a file's place is not undone by it.
        entry.path = path.map(Path::to_owned);
        entry.stamp = stamp;
        entry.error = None;
        Ok(BehaviourId(number as u16))
    }
}

fn stamp_of(path: &Path) -> Option<Stamp> {
    let about = fs::metadata(path).ok()?;
    Some((about.modified().ok(), about.len()))
}

fn read(path: &Path) -> Result<String, BehaviourError> {
    let refuse = |why: String| BehaviourError {
        file: path.display().to_string(),
        line: 0,
        column: 0,
        reason: Reason::Read(why),
    };
    match fs::metadata(path) {
        Ok(about) if about.len() > MOST_BYTES => {
            return Err(refuse(format!("it is larger than {MOST_BYTES} bytes")));
        }
        _ => (),
    }
    fs::read_to_string(path).map_err(|error| refuse(error.to_string()))
}

/// Adds a behaviour, or takes the place of one of the same name. Agents that follow it begin at its root.
///
/// # Errors
/// [`BehaviourError`]; what was there under this name stays.
pub fn add_behaviour(
    world: &mut World,
    name: &str,
    text: &str,
) -> Result<BehaviourId, BehaviourError> {
    put(world, name, None, None, Ok(text.to_owned()))
}

/// Reads a behaviour from a file, which is looked at again where [`Behaviours::watch`] says so.
///
/// # Errors
/// [`BehaviourError`]; what was read from this file before stays.
pub fn load_behaviour(world: &mut World, path: &Path) -> Result<BehaviourId, BehaviourError> {
    // Before the text: what is written between the two is then read again, and not missed.
    let stamp = stamp_of(path);
    let name = path.display().to_string();
    put(world, &name, Some(path), stamp, read(path))
}

fn put(
    world: &mut World,
    name: &str,
    path: Option<&Path>,
    stamp: Option<Stamp>,
    text: Result<String, BehaviourError>,
) -> Result<BehaviourId, BehaviourError> {
    world.init_resource::<Names>();
    world.init_resource::<Leaves>();
    world.init_resource::<Behaviours>();
    world.resource_scope(|world, leaves: Mut<Leaves>| {
        let result = text.and_then(|text| {
            let mut names = world.resource_mut::<Names>();
            compile(name, &text, &mut names, |leaf| leaves.find(leaf))
        });
        let mut behaviours = world.resource_mut::<Behaviours>();
        behaviours.take(name, path, stamp, result)
    })
}

/// Once a second of steps, where files are watched: a run condition.
pub(super) fn looks(behaviours: Res<Behaviours>, clock: Res<LogicClock>) -> bool {
    let every = clock.steps(1.0).map_or(64, u64::from);
    behaviours.watch && clock.step.is_multiple_of(every)
}

/// Reads again what changed.
pub(super) fn reload(world: &mut World) {
    let changed: Vec<(u16, PathBuf)> = {
        let entries = &world.resource::<Behaviours>().entries;
        (0..)
            .zip(entries)
            .filter_map(|(number, entry)| {
                let path = entry.path.clone()?;
                (stamp_of(&path) != entry.stamp).then_some((number, path))
            })
            .collect()
    };
    for (number, path) in changed {
        let error = load_behaviour(world, &path).err();
        world.write_message(BehaviourMessage {
            behaviour: BehaviourId(number),
            error,
        });
    }
}

/// Adds behaviours and leaves to an app.
pub trait BehaviourAppExt {
    /// A system for all agents that are at the leaf of this name. Behaviours that use it are added later.
    fn add_leaf<M>(
        &mut self,
        name: &str,
        system: impl IntoSystem<InMut<'static, LeafBatch>, (), M> + 'static,
    ) -> &mut Self;

    /// See [`add_behaviour`].
    ///
    /// # Errors
    /// [`BehaviourError`].
    fn add_behaviour(&mut self, name: &str, text: &str) -> Result<BehaviourId, BehaviourError>;

    /// See [`load_behaviour`].
    ///
    /// # Errors
    /// [`BehaviourError`].
    fn load_behaviour(&mut self, path: impl AsRef<Path>) -> Result<BehaviourId, BehaviourError>;
}

impl BehaviourAppExt for App {
    fn add_leaf<M>(
        &mut self,
        name: &str,
        system: impl IntoSystem<InMut<'static, LeafBatch>, (), M> + 'static,
    ) -> &mut Self {
        let world = self.world_mut();
        let system = world.register_system(system);
        world.init_resource::<Leaves>();
        world.resource_mut::<Leaves>().add(name, system);
        self
    }

    fn add_behaviour(&mut self, name: &str, text: &str) -> Result<BehaviourId, BehaviourError> {
        add_behaviour(self.world_mut(), name, text)
    }

    fn load_behaviour(&mut self, path: impl AsRef<Path>) -> Result<BehaviourId, BehaviourError> {
        load_behaviour(self.world_mut(), path.as_ref())
    }
}
