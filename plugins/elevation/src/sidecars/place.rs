//! Where a map lies: what it says itself and what stands beside it, in GDAL's order.
//!
//! Of files that go first ([`First::File`]) nothing beside them is asked where they tell their place.

use super::{MOST_PRJ, Sidecars, bytes_of, called, world};
use crate::crs::{by_text, guessed};
use crate::error::ElevationError;
use crate::georeference::{Crs, Registration};
use crate::lattice::{First, Lattice, Own, refused};
use crate::options::Options;
use crate::samples::Elevation;

/// Columns and rows on the ground, and what told them.
struct Laid {
    lattice: Lattice,
    /// For errors.
    tag: String,
    /// Whether the file itself did.
    own: bool,
}

impl Sidecars {
    /// Tells a map where it lies, if anything says it.
    ///
    /// # Errors
    /// A place that cannot be used, a projection whose unit is not known, a file beside the map that cannot be understood.
    pub fn place(
        &self,
        map: &mut Elevation,
        (file, options): (&str, &Options),
        own: &dyn Own,
    ) -> Result<(), ElevationError> {
        let notes = &mut map.about.notes;
        let Some(laid) = self.laid(file, own, notes)? else {
            return Ok(());
        };
        let rows = map.about.size[1];
        let crs = self.crs(&laid, rows, (file, options), own, notes)?;
        let place = laid.lattice.within(crs);
        let place = place.map_err(|reason| refused(file, &laid.tag, reason, "gdalwarp"))?;
        map.lies_at(place, options.every);
        Ok(())
    }

    /// Columns and rows on the ground.
    fn laid(
        &self,
        file: &str,
        own: &dyn Own,
        notes: &mut Vec<String>,
    ) -> Result<Option<Laid>, ElevationError> {
        let registration = || {
            let said = self.said.registration.or_else(|| own.registration());
            said.unwrap_or(Registration::Area)
        };
        let itself = match own.first() {
            First::File => own.lattice()?,
            First::Beside => None,
        };
        if let Some(numbers) = self.said.transform.filter(|_| itself.is_none()) {
            let tag = format!("<GeoTransform> in {}", self.called);
            // GDAL's own counts from a corner, whatever a sample stands for.
            let lattice = Lattice::upright(numbers, 0.5, registration());
            let lattice = lattice.map_err(|reason| refused(file, &tag, reason, "gdalwarp"))?;
            notes.push(format!("{} beside it says where it lies", self.called));
            return Ok(Some(Laid {
                lattice,
                tag,
                own: false,
            }));
        }
        let itself = match itself {
            Some(itself) => Some(itself),
            None => own.lattice()?,
        };
        if let Some(lattice) = itself {
            return Ok(Some(Laid {
                lattice,
                tag: own.tag().to_owned(),
                own: true,
            }));
        }
        if self.said.points > 0 {
            let reason = format!(
                "{} points tie it to the ground, which is not that of a grid",
                self.said.points
            );
            let tag = format!("<GCPList> in {}", self.called);
            return Err(refused(file, &tag, reason, "gdalwarp -tps"));
        }
        let Some(path) = &self.world else {
            return Ok(None);
        };
        let bytes = bytes_of(path, &self.map, world::MOST)?;
        let numbers = world::read(&bytes).map_err(|wrong| wrong.of(path, &self.map))?;
        let tag = format!("{} beside it", called(path));
        let lattice = Lattice::upright(numbers, 0.0, registration());
        let lattice = lattice.map_err(|reason| refused(file, &tag, reason, "gdalwarp"))?;
        notes.push(format!("{tag} says where it lies"));
        Ok(Some(Laid {
            lattice,
            tag,
            own: false,
        }))
    }

    /// What the numbers of its places are.
    fn crs(
        &self,
        laid: &Laid,
        rows: u32,
        (file, options): (&str, &Options),
        own: &dyn Own,
        notes: &mut Vec<String>,
    ) -> Result<Crs, ElevationError> {
        let named = |text: &str, tag: String| match by_text(text) {
            Some(crs) => Ok(crs),
            None if options.any_projection => Ok(Crs::Unknown),
            None => Err(ElevationError::Projection {
                file: file.to_owned(),
                again: options.command(file),
                tag,
                name: text.chars().take(60).collect(),
            }),
        };
        let says_itself = own.first() == First::File && laid.own;
        let is_named = says_itself && (self.prj.is_some() || own.crs()?.is_some());
        if let Some(text) = self.said.srs.as_ref().filter(|_| !is_named) {
            let crs = named(text, format!("<SRS> in {}", self.called))?;
            notes.push(format!(
                "{} beside it names its coordinate system",
                self.called
            ));
            return Ok(crs);
        }
        // Of a file that tells its place and not what its numbers are nothing else is believed.
        if let Some(crs) = own.crs()?
            && (laid.own || crs != Crs::Unknown)
        {
            return Ok(crs);
        }
        let Some(path) = &self.prj else {
            let (crs, note) = guessed(&laid.lattice, rows);
            notes.push(note.to_owned());
            return Ok(crs);
        };
        let bytes = bytes_of(path, &self.map, MOST_PRJ)?;
        let crs = named(
            &String::from_utf8_lossy(&bytes),
            format!("{} beside it", called(path)),
        )?;
        if !laid.own {
            notes.push(format!(
                "{} beside it names its coordinate system",
                called(path)
            ));
        }
        Ok(crs)
    }
}
