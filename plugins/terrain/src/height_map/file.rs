//! Height maps from files: how a file becomes heights in metres on the ground.

use super::{Filter, HeightMap, HeightMapError};
use bevy::math::DVec2;
use dolomite_elevation::{
    ByteOrder, Elevation, ElevationError, ElevationProgress, NoData, NumberType, Options, Raw,
    Tile, TileSettings, TiledMap, fill_holes, mosaic, place_by_georeference,
};
use serde::{Deserialize, Deserializer, Serialize};
use std::path::Path;

/// Kinds of numbers of a raw file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum RawFormat {
    /// Unsigned 8-bit.
    U8,
    /// Signed 16-bit.
    I16,
    /// Unsigned 16-bit.
    U16,
    /// Unsigned 32-bit.
    U32,
    /// 32-bit float.
    F32,
}

impl RawFormat {
    /// The same as the reader of files names it.
    #[must_use]
    pub const fn number(self) -> NumberType {
        match self {
            Self::U8 => NumberType::U8,
            Self::I16 => NumberType::I16,
            Self::U16 => NumberType::U16,
            Self::U32 => NumberType::U32,
            Self::F32 => NumberType::F32,
        }
    }
}

/// What kind of file a height map is in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum MapFormat {
    /// By the content of the file: PNG, TIFF, ESRI ASCII, HGT.
    #[default]
    Auto,
    /// PNG, 8 or 16 bits. The same as [`Self::Auto`].
    Png,
    /// Numbers without a header.
    Raw {
        /// Kind of number.
        format: RawFormat,
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
        /// Order of bytes.
        #[serde(default)]
        order: ByteOrder,
        /// Bytes before the first sample.
        #[serde(default)]
        header: u64,
        /// Bytes after each row.
        #[serde(default)]
        row_padding: u64,
        /// Whether rows run from south to north.
        #[serde(default)]
        flip: bool,
    },
}

impl MapFormat {
    /// Little-endian numbers from north to south, with nothing before, between or after the rows.
    #[must_use]
    pub const fn raw(format: RawFormat, width: u32, height: u32) -> Self {
        Self::Raw {
            format,
            width,
            height,
            order: ByteOrder::Little,
            header: 0,
            row_padding: 0,
            flip: false,
        }
    }
}

/// What becomes of samples without data.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub enum Holes {
    /// Filled smoothly from their border, within its range ([`fill_holes`]).
    #[default]
    Fill,
    /// The ground there lies [`Holes::DEPTH`] below this height, metres: a sea of that level covers it.
    Sea(f32),
}

impl Holes {
    /// How deep the sea is where there is no data, metres.
    pub const DEPTH: f32 = 10.0;
}

/// A height map file and how it lies on the ground; what a scene file says of it.
///
/// Either `path`, or `tiles` that make one map together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HeightMapFile {
    /// Path of the file.
    #[serde(default)]
    pub path: String,
    /// Paths of tiles, rows from north to south, from west to east in a row. Where every file tells its place, that
    /// counts and not the order here.
    #[serde(default)]
    pub tiles: Vec<Vec<String>>,
    /// Columns and rows that neighbours in `tiles` share, 0 or 1, where files do not tell their place.
    #[serde(default = "one_column")]
    pub overlap: u32,
    /// Kind of file.
    #[serde(default)]
    pub format: MapFormat,
    /// Metres a unit of the file's heights, after its own scale and unit.
    #[serde(default = "one")]
    pub scale: f32,
    /// Metres added to the scaled sample.
    #[serde(default)]
    pub offset: f32,
    /// Distance of columns and of rows, metres: 0.1 to 1e6. `None`: what the file tells.
    #[serde(default, deserialize_with = "some")]
    pub spacing: Option<[f64; 2]>,
    /// Place of the middle of the map (x, z), metres.
    #[serde(default)]
    pub centre: [f64; 2],
    /// How heights between samples are found.
    #[serde(default)]
    pub filter: Filter,
    /// Which number stands for no data.
    #[serde(default)]
    pub nodata: NoData,
    /// What becomes of samples without data.
    #[serde(default)]
    pub holes: Holes,
    /// Which channel or band holds the heights, from 1; 0: the only one.
    #[serde(default)]
    pub band: u32,
    /// Every so many columns and rows one is taken.
    #[serde(default = "one_column")]
    pub every: u32,
    /// Most bytes that its heights take in memory, and as many on a GPU: a map that would take more is read by tiles about the
    /// camera, at coarser levels elsewhere. A file of tiles is made beside it then, once ([`TiledMap`]). Without a number a map
    /// that may be read as a whole ([`HeightMap::MAX_SAMPLES`]) is, and a larger one by tiles within [`Self::BUDGET`].
    #[serde(default, deserialize_with = "some")]
    pub budget: Option<u64>,
}

fn one() -> f32 {
    1.0
}

fn one_column() -> u32 {
    1
}

/// A value that is there, written without `Some`.
fn some<'de, D: Deserializer<'de>, T: Deserialize<'de>>(from: D) -> Result<Option<T>, D::Error> {
    T::deserialize(from).map(Some)
}

impl Default for HeightMapFile {
    fn default() -> Self {
        Self {
            path: String::new(),
            tiles: Vec::new(),
            overlap: 1,
            format: MapFormat::Auto,
            scale: 1.0,
            offset: 0.0,
            spacing: None,
            centre: [0.0; 2],
            filter: Filter::default(),
            nodata: NoData::File,
            holes: Holes::Fill,
            band: 0,
            every: 1,
            budget: None,
        }
    }
}

impl HeightMapFile {
    /// Within how many bytes a map is read by tiles that is too large to be read as a whole, if nothing is said: 128 MiB, what
    /// WebGPU grants a storage buffer; some 5000 × 5000 samples.
    pub const BUDGET: u64 = 128 << 20;

    /// Bytes of the largest map that is read as a whole.
    pub const WHOLE: u64 = HeightMap::MAX_SAMPLES as u64 * 16 / 3 + 1;

    /// Reads the file; a relative path is taken from `folder`.
    ///
    /// # Errors
    /// A [`HeightMapError`] with the path, the reason and what to do.
    pub fn load(&self, folder: &Path) -> Result<HeightMap, HeightMapError> {
        self.load_telling(folder, &ElevationProgress::default())
    }

    /// As [`Self::load`], and says how far it has come.
    ///
    /// # Errors
    /// As [`Self::load`].
    pub fn load_telling(
        &self,
        folder: &Path,
        progress: &ElevationProgress,
    ) -> Result<HeightMap, HeightMapError> {
        let options = self.options();
        if !self.tiles.is_empty() {
            return self.make(self.mosaic(folder, &options)?);
        }
        let path = folder.join(&self.path);
        if let Some(tiles) = self.open_tiles(&path, &options, progress)? {
            return self.make_by_tiles(tiles);
        }
        self.make(Elevation::read_telling(&path, &options, progress)?)
    }

    /// Opens a file by tiles, where its heights would take more than [`Self::budget`]. `None` where they do not, where the file's head is not
    /// read (whoever reads it says why), where one side is more than four times the other, or where there are holes to be filled and the
    /// map fits into memory.
    ///
    /// # Errors
    /// As [`TiledMap::open`].
    pub fn open_tiles(
        &self,
        path: &Path,
        options: &Options,
        progress: &ElevationProgress,
    ) -> Result<Option<TiledMap>, HeightMapError> {
        let Ok(head) = Elevation::head(path, options) else {
            return Ok(None);
        };
        let [columns, rows] = head.size.map(u64::from);
        // Samples, and a third for what lies between them.
        let bytes = columns.saturating_mul(rows).saturating_mul(16) / 3;
        let is_long = columns.max(rows) > 4 * columns.min(rows);
        if bytes <= self.budget.unwrap_or(Self::WHOLE) || options.every > 1 || is_long {
            return Ok(None);
        }
        let settings = TileSettings {
            smooth: self.filter == Filter::Bicubic,
            hole: match self.holes {
                Holes::Fill => None,
                Holes::Sea(level) => {
                    // A number of the file, which becomes this height.
                    let scale = self.scale * head.unit_metres.unwrap_or(1.0) as f32;
                    Some((level - Holes::DEPTH - self.offset) / scale)
                }
            },
            ..TileSettings::default()
        };
        match TiledMap::open(path, options, &settings, progress) {
            Ok(tiles) => Ok(Some(tiles)),
            Err(ElevationError::TiledHoles { .. })
                if columns * rows <= HeightMap::MAX_SAMPLES as u64 =>
            {
                Ok(None)
            }
            Err(error) => Err(error.into()),
        }
    }

    /// A map that is read by tiles, on the ground: all fields but `path`, `tiles` and how they are read count.
    ///
    /// # Errors
    /// As [`HeightMap::by_tiles`].
    pub fn make_by_tiles(&self, tiles: TiledMap) -> Result<HeightMap, HeightMapError> {
        let file = tiles.about().file.clone();
        let spacing = self.spacing.or_else(|| tiles.spacing());
        let spacing = spacing.ok_or(HeightMapError::NoSpacing { file })?;
        let unit = tiles.about().unit_metres.unwrap_or(1.0) as f32;
        let place = (DVec2::from_array(self.centre), DVec2::from_array(spacing));
        let metres = [self.scale * unit, self.offset];
        let budget = self.budget.unwrap_or(Self::BUDGET);
        HeightMap::by_tiles(tiles, metres, place, self.filter, budget)
    }

    /// Makes the map from the file's bytes; `name` is what errors call it.
    ///
    /// # Errors
    /// As [`Self::load`].
    pub fn decode(&self, name: &str, bytes: &[u8]) -> Result<HeightMap, HeightMapError> {
        self.make(Elevation::decode(name, bytes, &self.options())?)
    }

    /// The files that it is made of.
    pub fn paths(&self) -> impl Iterator<Item = &str> {
        let single = self.tiles.is_empty().then_some(self.path.as_str());
        single
            .into_iter()
            .chain(self.tiles.iter().flatten().map(String::as_str))
    }

    /// How the reader of files takes it.
    #[must_use]
    pub fn options(&self) -> Options {
        let raw = match self.format {
            MapFormat::Auto | MapFormat::Png => None,
            MapFormat::Raw {
                format,
                width,
                height,
                order,
                header,
                row_padding,
                flip,
            } => Some(Raw {
                size: Some([width, height]),
                number: Some(format.number()),
                order,
                header,
                row_padding,
                flip,
            }),
        };
        Options {
            raw,
            nodata: self.nodata,
            band: (self.band != 0).then_some(self.band),
            every: self.every.max(1),
            max_samples: HeightMap::MAX_SAMPLES as u64,
            any_projection: self.spacing.is_some(),
        }
    }

    /// All tiles as one.
    fn mosaic(&self, folder: &Path, options: &Options) -> Result<Elevation, HeightMapError> {
        let mut tiles = Vec::new();
        for path in self.tiles.iter().flatten() {
            tiles.push(Elevation::read(&folder.join(path), options)?);
        }
        let placed: Option<Vec<_>> = tiles
            .iter()
            .map(|tile| {
                let place = tile.georeference.as_ref()?;
                Some((tile.about.file.as_str(), place, tile.size))
            })
            .collect();
        let at = match placed {
            Some(placed) => place_by_georeference(&placed)?,
            None => self.grid(&tiles)?,
        };
        let parts: Vec<_> = tiles
            .iter()
            .zip(&at)
            .map(|(tile, &at)| Tile {
                name: &tile.about.file,
                size: tile.size,
                samples: &tile.samples,
                at,
            })
            .collect();
        let (size, samples, corner) = mosaic(&parts, options)?;
        let georeference = tiles.first().and_then(|tile| tile.georeference.clone());
        let georeference = georeference.map(|mut place| {
            // The same tile's own number where it begins the mosaic: not a sum that rounds.
            for k in 0..2 {
                let first = tiles.iter().zip(&at).find(|(_, at)| at[k] == corner[k]);
                if let Some(other) = first.and_then(|(tile, _)| tile.georeference.as_ref()) {
                    place.first[k] = other.first[k];
                }
            }
            place
        });
        let mut all = tiles.swap_remove(0);
        all.about.holes = samples.iter().filter(|sample| sample.is_nan()).count() as u64;
        Ok(Elevation {
            size,
            samples,
            georeference,
            ..all
        })
    }

    /// Where tiles lie that do not tell it themselves.
    fn grid(&self, tiles: &[Elevation]) -> Result<Vec<[i64; 2]>, HeightMapError> {
        let mut at = Vec::new();
        let mut left = tiles;
        let mut top = 0_i64;
        let overlap = i64::from(self.overlap.min(1));
        let above = &tiles[..self.tiles.first().map_or(0, Vec::len)];
        for row in &self.tiles {
            let (line, rest) = left.split_at(row.len());
            let mut west = 0_i64;
            for (column, tile) in line.iter().enumerate() {
                let other = [(&line[0], 1), (above.get(column).unwrap_or(tile), 0)];
                for (other, side) in other {
                    if other.size[side] != tile.size[side] {
                        let name = ["columns", "rows"][side];
                        let error = ElevationError::Tiles {
                            file: other.about.file.clone(),
                            other: tile.about.file.clone(),
                            reason: format!(
                                "they stand in one line of `tiles`, but have {} and {} {name}; cut them alike",
                                other.size[side], tile.size[side]
                            ),
                        };
                        return Err(error.into());
                    }
                }
                at.push([west, top]);
                west += i64::from(tile.size[0]) - overlap;
            }
            top += line
                .first()
                .map_or(0, |tile| i64::from(tile.size[1]) - overlap);
            left = rest;
        }
        Ok(at)
    }

    /// From samples that were read to heights on the ground: all fields but `path`, `tiles` and how they are read count.
    ///
    /// # Errors
    /// As [`Self::load`].
    pub fn make(&self, elevation: Elevation) -> Result<HeightMap, HeightMapError> {
        let name = elevation.about.file.clone();
        let Some(spacing) = self.spacing.or_else(|| elevation.spacing()) else {
            return Err(HeightMapError::NoSpacing { file: name });
        };
        let unit = elevation.about.unit_metres.unwrap_or(1.0) as f32;
        let [width, height] = elevation.size;
        let mut samples = elevation.samples;
        let scale = self.scale * unit;
        for sample in &mut samples {
            *sample = *sample * scale + self.offset;
        }
        if elevation.about.holes > 0 {
            match self.holes {
                Holes::Fill if fill_holes(&mut samples, width as usize).is_none() => {
                    return Err(HeightMapError::AllHoles { file: name });
                }
                Holes::Fill => {}
                Holes::Sea(level) => {
                    let holes = samples.iter_mut().filter(|sample| sample.is_nan());
                    holes.for_each(|sample| *sample = level - Holes::DEPTH);
                }
            }
        }
        let spacing = DVec2::from_array(spacing);
        let steps = DVec2::new(f64::from(width - 1), f64::from(height - 1));
        let origin = DVec2::from_array(self.centre) - spacing * steps * 0.5;
        let map = HeightMap::named(
            &name,
            [width, height],
            samples,
            (origin, spacing),
            self.filter,
        )?;
        Ok(map.lying_at(elevation.georeference))
    }
}
