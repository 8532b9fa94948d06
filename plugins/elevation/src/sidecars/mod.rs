//! What stands beside a map and counts for it: GDAL's `.aux.xml`, a world file, a `.prj`, a mask. In the map's own folder alone.
//!
//! Which goes first is GDAL's order, which is not one for all kinds ([`First`]). Beside a TIFF, of the place: `.aux.xml`, what the file
//! says itself, the world file; of the coordinate system: `.aux.xml`, the file itself, `.prj`, a guess; of no data, of scale and
//! offset as a pair, and of the unit: `.aux.xml`, then the file itself. Of any other kind what the file says itself goes before
//! `.aux.xml`, and the `.prj` beside a file that tells its place too. A mask in the file goes before one beside it. What is not asked for is
//! not read, but for the `.aux.xml`.

mod find;
mod pam;
mod place;
mod world;
mod xml;

use crate::about::About;
use crate::error::{ElevationError, read_error};
use crate::lattice::First;
use find::{Found, find};
use pam::{Band, Pam};
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Bytes of a `.prj` at most; the longest of the EPSG are some 3 000.
const MOST_PRJ: u64 = 1 << 16;

/// Where something in a file beside the map is wrong, and what.
#[derive(Debug)]
struct Wrong {
    place: String,
    reason: String,
}

impl Wrong {
    fn of(self, beside: &Path, map: &Path) -> ElevationError {
        ElevationError::Sidecar {
            file: beside.display().to_string(),
            map: map.display().to_string(),
            place: self.place,
            reason: self.reason,
        }
    }
}

/// What stands beside a map. Of bytes that are no file there is nothing.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sidecars {
    map: PathBuf,
    /// What GDAL's own says, and what it is called.
    said: Pam,
    called: String,
    mask: Option<PathBuf>,
    prj: Option<PathBuf>,
    world: Option<PathBuf>,
}

/// What is known of the numbers of a band.
#[derive(Clone, Debug, Default)]
pub(crate) struct Numbers {
    /// Those that stand for no data.
    pub nodata: Vec<f64>,
    /// A sample is number × scale + offset.
    pub scale: Option<(f64, f64)>,
    /// Metres a unit of the heights.
    pub unit: Option<f64>,
    /// What one should know of where they come from.
    pub notes: Vec<String>,
}

impl Numbers {
    /// Scale and offset, those that change nothing where none are told.
    pub fn scaled(&self) -> (f64, f64) {
        self.scale.unwrap_or((1.0, 0.0))
    }

    /// Says what is known of them. No data is said by the grid.
    pub fn tell(self, about: &mut About) {
        (about.scale, about.offset) = self.scaled();
        about.unit_metres = self.unit;
        about.notes.extend(self.notes);
    }
}

impl Sidecars {
    /// Those of a map.
    ///
    /// # Errors
    /// An `.aux.xml` that cannot be read or understood.
    pub fn of(map: &Path) -> Result<Self, ElevationError> {
        let Found {
            pam,
            mask,
            prj,
            world,
        } = find(map);
        let said = match &pam {
            Some(path) => {
                let bytes = bytes_of(path, map, pam::MOST)?;
                Pam::read(&bytes).map_err(|wrong| wrong.of(path, map))?
            }
            None => Pam::default(),
        };
        Ok(Self {
            map: map.to_owned(),
            said,
            called: pam.as_deref().map(called).unwrap_or_default(),
            mask,
            prj,
            world,
        })
    }

    /// Where a mask stands, 0 where there is no data.
    pub fn mask(&self) -> Option<&Path> {
        self.mask.as_deref()
    }

    /// What is known of a band, from 1.
    pub fn numbers(&self, band: u32, own: Numbers, first: First) -> Numbers {
        let Band {
            nodata,
            scale,
            offset,
            unit,
        } = self.said.band(band);
        let mut numbers = own;
        let mut notes = Vec::new();
        let mut note = |words: &str| notes.push(format!("{} beside it says {words}", self.called));
        let counts = |is_told: bool| first == First::Beside || !is_told;
        if let Some(nodata) = nodata.filter(|_| counts(!numbers.nodata.is_empty())) {
            note("which number stands for no data");
            numbers.nodata = vec![nodata];
        }
        if (scale.is_some() || offset.is_some()) && counts(numbers.scale.is_some()) {
            let both = (scale.unwrap_or(1.0), offset.unwrap_or(0.0));
            if both != numbers.scaled() {
                note("its scale and offset");
            }
            numbers.scale = Some(both);
        }
        if unit.is_some() && counts(numbers.unit.is_some()) {
            note("the unit of its heights");
            numbers.unit = unit;
        }
        numbers.notes.append(&mut notes);
        if let Some(root) = &self.said.stranger {
            numbers.notes.push(format!(
                "{} beside it is not GDAL's, its root is <{root}>: nothing of it counts",
                self.called
            ));
        }
        numbers
    }

    /// Whether samples of a band are other numbers than those that the file holds.
    pub fn changes(&self, band: u32) -> bool {
        let Band {
            nodata,
            scale,
            offset,
            unit: _,
        } = self.said.band(band);
        nodata.is_some() || scale.is_some() || offset.is_some()
    }

    /// Bytes of what counts of them, for sums: those of the `.prj` first, whether there is one or not. Nothing of an `.aux.xml` in which
    /// only statistics stand; nor of a mask, which is as large as the map.
    pub fn traces(&self) -> Vec<Vec<u8>> {
        let bytes = |path: &Option<PathBuf>, most: u64| {
            let path = path.as_deref();
            // What cannot be read is an error where it is asked for.
            path.and_then(|path| bytes_of(path, &self.map, most).ok())
                .unwrap_or_default()
        };
        let mut traces = vec![bytes(&self.prj, MOST_PRJ)];
        if let Some(world) = &self.world {
            traces.push(called(world).into_bytes());
            traces.push(bytes(&self.world, world::MOST));
        }
        if !self.said.is_silent() {
            traces.push(format!("{:?}", self.said).into_bytes());
        }
        traces
    }
}

/// A file's name without its folder.
fn called(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default();
    name.to_string_lossy().into_owned()
}

/// All bytes of a file beside a map.
fn bytes_of(path: &Path, map: &Path, most: u64) -> Result<Vec<u8>, ElevationError> {
    let failed = |error: std::io::Error| read_error(&path.display().to_string(), &error);
    let file = File::open(path).map_err(failed)?;
    let mut bytes = Vec::new();
    file.take(most + 1)
        .read_to_end(&mut bytes)
        .map_err(failed)?;
    if bytes.len() as u64 > most {
        let wrong = Wrong {
            place: "its length".to_owned(),
            reason: format!("more than {most} bytes"),
        };
        return Err(wrong.of(path, map));
    }
    Ok(bytes)
}
