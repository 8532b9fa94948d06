//! Files of elevation, read without a renderer and without Bevy.
//!
//! [`Elevation::read`] tells what a file is by its content first and by its ending then, and gives its
//! samples as `f32` in rows from north to south, NaN where there is no data, with where they lie. A file is
//! read as it streams in: besides the samples themselves little memory is taken, and none before the
//! file's own length bears out what its header says.
//!
//! | kind | numbers |
//! |---|---|
//! | raw | u8, u16, i16, u32, f32, both byte orders, header, row padding, rows from south to north |
//! | `.hgt` | 1 and 3 arc seconds; −32768 is no data |
//! | ESRI ASCII | corner or centre, keys in any order and case, `dx` and `dy`, rows that wrap |
//! | PNG | 1 to 16 bits, interlaced; tRNS and alpha 0 are no data; one channel of a coloured one |
//! | TIFF, GeoTIFF, BigTIFF | strips and tiles, LZW, deflate, PackBits, ZSTD, predictors 2 and 3, 1 to 64 bits; absent tiles, masks and alpha tell of no data |
//!
//! ```
//! use dolomite_elevation::{Elevation, NumberType, Options, Raw};
//!
//! let options = Options {
//!     raw: Some(Raw { size: Some([2, 1]), number: Some(NumberType::I16), ..Raw::default() }),
//!     ..Options::default()
//! };
//! let map = Elevation::decode("two.raw", &[5, 0, 0xff, 0xff], &options)?;
//! assert_eq!(map.samples, [5.0, -1.0]);
//! # Ok::<(), dolomite_elevation::ElevationError>(())
//! ```
//!
//! What stands beside a file counts too: GDAL's `.aux.xml`, a world file, a `.prj` and a mask (`.msk`), in the file's own folder and in any letter
//! case. Of the place GDAL's own goes first, then the file itself, then the world file; of no data, scale and unit the file itself goes
//! first; a mask in the file goes before one beside it. [`About::notes`] says what was used.
//!
//! Conventions: columns run to the east, rows to the south; a place of a map is that of a sample's centre.

mod about;
mod ascii;
mod crs;
mod error;
mod extremes;
mod gaps;
mod geodesy;
mod georeference;
mod grid;
mod hgt;
mod hillshade;
mod holes;
mod input;
mod lattice;
mod looks;
mod mosaic;
mod nodata;
mod number;
mod options;
mod parts;
mod picture;
mod progress;
mod raw;
mod read;
mod refuse;
mod samples;
mod sidecars;
mod through;
mod tiff;
mod tiled;
mod write;

pub use about::{About, FileKind, Head, NumberType};
pub use error::ElevationError;
pub use geodesy::metres_per_degree;
pub use georeference::{Crs, Georeference, Registration};
pub use hillshade::hillshade;
pub use holes::{Filled, fill_holes};
pub use mosaic::{Tile, mosaic, place_by_georeference};
pub use options::{ByteOrder, NoData, Options, Raw};
pub use progress::{ElevationProgress, ElevationStep};
pub use samples::Elevation;
pub use through::convert;
pub use tiled::{
    Extremes, TILE, TILE_COUNT, TileSamples, TileSettings, TiledMap, pack_slope, unpack_slope,
};
pub use write::write;
