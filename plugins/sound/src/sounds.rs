//! All sounds, by number and by name.

use std::path::Path;

use bevy::ecs::resource::Resource;

use crate::built_in;
use crate::error::SoundError;
use crate::id::SoundId;
use crate::samples::Samples;
use crate::wav;

/// Most sounds.
pub const MOST_SOUNDS: usize = 65_536;

/// All sounds. Those of [`built_in`] are there from the begin; their files are read when the first output opens.
#[derive(Resource, Debug, Default)]
pub struct Sounds {
    added: Vec<(String, Vec<Samples>)>,
    own: Option<Vec<Vec<Samples>>>,
}

impl Sounds {
    /// Adds a sound of one or more kinds, of which each time another is played. Gives its number.
    ///
    /// # Errors
    /// [`SoundError::Samples`] without any kind, [`SoundError::Full`] beyond [`MOST_SOUNDS`].
    pub fn add(
        &mut self,
        name: impl Into<String>,
        kinds: Vec<Samples>,
    ) -> Result<SoundId, SoundError> {
        let name = name.into();
        if kinds.is_empty() {
            return Err(SoundError::Samples(format!("`{name}` has no kind")));
        }
        let number = built_in::NAMES.len() + self.added.len();
        if number >= MOST_SOUNDS {
            return Err(SoundError::Full(number));
        }
        self.added.push((name, kinds));
        Ok(SoundId(number as u32))
    }

    /// Adds what a file holds, by the file's name without its ending.
    ///
    /// # Errors
    /// Those of [`wav::read`] and [`Sounds::add`].
    pub fn read(&mut self, path: impl AsRef<Path>) -> Result<SoundId, SoundError> {
        let path = path.as_ref();
        let samples = wav::read(path)?;
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        self.add(name, vec![samples])
    }

    /// The number of a name; the last added one counts.
    #[must_use]
    pub fn find(&self, name: &str) -> Option<SoundId> {
        let first = built_in::NAMES.len();
        let added = self.added.iter().rposition(|(known, _)| known == name);
        let own = || built_in::NAMES.iter().position(|(known, _)| *known == name);
        let number = added.map(|at| first + at).or_else(own)?;
        Some(SoundId(number as u32))
    }

    /// The `turn`th kind of a sound, again from the first after the last; `None` for a number that is not there, and
    /// before [`Sounds::unpack`] for those that come with the crate.
    #[must_use]
    pub fn get(&self, id: SoundId, turn: u32) -> Option<&Samples> {
        let number = id.0 as usize;
        let kinds = match number.checked_sub(built_in::NAMES.len()) {
            Some(added) => &self.added.get(added)?.1,
            None => self.own.as_ref()?.get(number)?,
        };
        kinds.get(turn as usize % kinds.len())
    }

    /// Reads the files that come with the crate, once.
    ///
    /// # Errors
    /// [`SoundError::File`], which a test excludes.
    pub fn unpack(&mut self) -> Result<(), SoundError> {
        if self.own.is_some() {
            return Ok(());
        }
        let read = |file: &usize| {
            let (name, bytes) = built_in::FILES[*file];
            wav::parse(bytes, Path::new(name))
        };
        let own: Result<_, _> = built_in::NAMES
            .iter()
            .map(|(_, files)| files.iter().map(read).collect::<Result<Vec<_>, _>>())
            .collect();
        self.own = Some(own?);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_numbers_lead_to_sounds() {
        let mut sounds = Sounds::default();
        assert_eq!(sounds.find("wind"), Some(built_in::WIND));
        assert!(
            sounds.get(built_in::WIND, 0).is_none(),
            "nothing is read yet"
        );
        sounds.unpack().unwrap();
        for (number, (name, files)) in built_in::NAMES.iter().enumerate() {
            let id = SoundId(number as u32);
            assert_eq!(sounds.find(name), Some(id));
            let kinds: Vec<_> = (0..2)
                .map(|turn| sounds.get(id, turn).unwrap().len())
                .collect();
            assert!(kinds.iter().all(|len| *len > 500), "{name}");
            assert!(
                files
                    .iter()
                    .all(|file| built_in::FILES[*file].0.starts_with(name))
            );
        }
        let beep = Samples::new(8000, &[0.5; 80]).unwrap();
        let id = sounds.add("beep", vec![beep]).unwrap();
        assert_eq!(sounds.find("beep"), Some(id));
        assert_eq!(sounds.get(id, 7).unwrap().len(), 80);
        assert!(sounds.get(SoundId(9999), 0).is_none() && sounds.find("boop").is_none());
        assert!(sounds.add("none", vec![]).is_err());
    }
}
