//! Edits in a file.
//!
//! All numbers little-endian. `DOLEDITS`; version (u32, 1); filter (u32: 0 bilinear, 1 bicubic); place of sample (0, 0)
//! (2 × i64, steps of 2⁻³² m); samples a metre along x and z as mantissa and shift (4 × u32); tiles along x and z
//! (2 × u32); number of tiles that follow (u32). A tile: x, z, bytes of its samples (3 × u32); its 32 × 32 samples row
//! by row, each the difference to the one before it (the first to 0) in steps of 2⁻¹² m, as zigzag LEB128. Tiles come in
//! rising order of z, then x; one in which nothing is edited is left out. At the end FNV-1a (64 bits) of all before it.

use super::brush::MAX_TILES;
use super::error::EditFileError;
use crate::edits::{CELLS, EditLattice, Edits, LIMIT, SAMPLES, SIDE, STEP, Tile};
use crate::height_map::Filter;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

/// What a scene's file of edits is called in its folder.
pub const FILE_NAME: &str = "edits.dolomite";

const MAGIC: &[u8; 8] = b"DOLEDITS";
const VERSION: u32 = 1;
/// Samples of a tile that are its own.
const OWN: usize = (CELLS * CELLS) as usize;
/// Most bytes of a sample.
const MOST_BYTES: usize = 5;
/// Bytes before the first tile.
const HEADER: usize = 8 + 4 + 4 + 16 + 16 + 8 + 4;

fn fnv(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

/// A tile's own samples.
fn own(tile: &Tile) -> impl Iterator<Item = i32> + '_ {
    (0..CELLS).flat_map(move |z| (0..CELLS).map(move |x| tile.at(x, z)))
}

fn header(lattice: &EditLattice, count: u32) -> Vec<u8> {
    let mut bytes = MAGIC.to_vec();
    let filter = u32::from(lattice.filter == Filter::Bicubic);
    let mut put = |number: u32| bytes.extend(number.to_le_bytes());
    put(VERSION);
    put(filter);
    for number in lattice.origin.to_fixed() {
        put(number as u32);
        put((number >> 32) as u32);
    }
    for frequency in lattice.frequency {
        put(frequency.mantissa);
        put(frequency.shift);
    }
    lattice.tiles.into_iter().for_each(&mut put);
    put(count);
    bytes
}

/// A layer as bytes.
fn bytes_of(edits: &Edits) -> Vec<u8> {
    let mut tiles: Vec<_> = edits
        .tiles()
        .into_iter()
        .filter(|(_, tile)| own(tile).any(|step| step != 0))
        .collect();
    tiles.sort_by_key(|([x, z], _)| (*z, *x));
    let mut bytes = header(edits.lattice(), tiles.len() as u32);
    for ([x, z], tile) in tiles {
        let mut samples = Vec::with_capacity(2 * OWN);
        let mut before = 0;
        for step in own(tile) {
            let rise = step.wrapping_sub(before);
            before = step;
            let mut rest = ((rise << 1) ^ (rise >> 31)) as u32;
            while rest >= 0x80 {
                samples.push(rest as u8 | 0x80);
                rest >>= 7;
            }
            samples.push(rest as u8);
        }
        for number in [x, z, samples.len() as u32] {
            bytes.extend(number.to_le_bytes());
        }
        bytes.extend(samples);
    }
    let check = fnv(&bytes);
    bytes.extend(check.to_le_bytes());
    bytes
}

/// Writes a layer into a file: beside it first, then in its place, so that there is always a whole one.
///
/// # Errors
/// [`EditFileError::Io`].
pub fn save(path: &Path, edits: &Edits) -> Result<(), EditFileError> {
    let refused = |error: std::io::Error| EditFileError::Io {
        file: path.to_owned(),
        what: error.to_string(),
    };
    let mut beside = path.as_os_str().to_owned();
    beside.push(".new");
    let beside = PathBuf::from(beside);
    let mut file = fs::File::create(&beside).map_err(refused)?;
    file.write_all(&bytes_of(edits)).map_err(refused)?;
    file.sync_all().map_err(refused)?;
    drop(file);
    fs::rename(&beside, path).map_err(refused)
}

/// Reads a layer for a lattice.
///
/// # Errors
/// [`EditFileError`], which names the file and the place.
pub fn load(path: &Path, lattice: &EditLattice) -> Result<Edits, EditFileError> {
    let refused = |error: std::io::Error| EditFileError::Io {
        file: path.to_owned(),
        what: error.to_string(),
    };
    let most = HEADER as u64 + 8 + MAX_TILES * (12 + (OWN * MOST_BYTES) as u64);
    let length = fs::metadata(path).map_err(refused)?.len();
    if length > most {
        return Err(EditFileError::Damaged {
            file: path.to_owned(),
            at: most as usize,
            what: "it goes on behind all that a file of edits can hold",
        });
    }
    parse(path, &fs::read(path).map_err(refused)?, lattice)
}

/// Bytes that are read one after the other.
struct Reader<'a> {
    file: &'a Path,
    bytes: &'a [u8],
    at: usize,
}

impl Reader<'_> {
    fn take<const N: usize>(&mut self, what: &'static str) -> Result<[u8; N], EditFileError> {
        let taken = self.bytes.get(self.at..self.at + N);
        let Some(taken) = taken.and_then(|taken| <[u8; N]>::try_from(taken).ok()) else {
            return Err(EditFileError::Truncated {
                file: self.file.to_owned(),
                at: self.bytes.len(),
                what,
            });
        };
        self.at += N;
        Ok(taken)
    }

    fn number(&mut self, what: &'static str) -> Result<u32, EditFileError> {
        self.take(what).map(u32::from_le_bytes)
    }

    fn damaged(&self, at: usize, what: &'static str) -> EditFileError {
        EditFileError::Damaged {
            file: self.file.to_owned(),
            at,
            what,
        }
    }

    /// A zigzag LEB128 number.
    fn rise(&mut self) -> Result<i32, EditFileError> {
        let begin = self.at;
        let mut number = 0_u64;
        for k in 0..MOST_BYTES {
            let [byte] = self.take("the samples of a tile")?;
            number |= u64::from(byte & 0x7f) << (7 * k);
            if byte & 0x80 == 0 {
                let Ok(number) = u32::try_from(number) else {
                    break;
                };
                return Ok((number >> 1) as i32 ^ -((number & 1) as i32));
            }
        }
        Err(self.damaged(begin, "a sample of more than 32 bits"))
    }
}

fn parse(file: &Path, bytes: &[u8], lattice: &EditLattice) -> Result<Edits, EditFileError> {
    let mut reader = Reader { file, bytes, at: 0 };
    let foreign = || EditFileError::Foreign {
        file: file.to_owned(),
    };
    if !bytes.starts_with(&MAGIC[..bytes.len().min(MAGIC.len())]) || bytes.is_empty() {
        return Err(foreign());
    }
    reader.take::<8>("the header")?;
    let version = reader.number("the header")?;
    if version > VERSION {
        return Err(EditFileError::Newer {
            file: file.to_owned(),
            version,
            known: VERSION,
        });
    }
    if version == 0 {
        return Err(reader.damaged(8, "version 0"));
    }
    let behind = bytes.get(..HEADER);
    let Some(found) = behind else {
        return Err(EditFileError::Truncated {
            file: file.to_owned(),
            at: bytes.len(),
            what: "the header",
        });
    };
    reader.at = HEADER - 4;
    let count = reader.number("the header")?;
    if u64::from(count) > MAX_TILES {
        return Err(reader.damaged(HEADER - 4, "more tiles than a layer can have"));
    }
    let expected = header(lattice, count);
    let tiles = read_tiles(&mut reader, count, lattice)?;
    let end = reader.at;
    let check = reader.take("the checksum").map(u64::from_le_bytes)?;
    if fnv(&bytes[..end]) != check {
        return Err(reader.damaged(end, "the checksum is another one"));
    }
    if reader.at != bytes.len() {
        return Err(reader.damaged(reader.at, "something follows the checksum"));
    }
    // Of a whole file: now it is known that the ground is another one, not the file damaged.
    if found != expected {
        return Err(EditFileError::OtherGround {
            file: file.to_owned(),
        });
    }
    Ok(layer_of(lattice, &tiles))
}

type Own = BTreeMap<[u32; 2], Vec<i32>>;

fn read_tiles(
    reader: &mut Reader,
    count: u32,
    lattice: &EditLattice,
) -> Result<Own, EditFileError> {
    let mut tiles = Own::new();
    let mut last = None;
    let most = (LIMIT / STEP) as i32;
    for _ in 0..count {
        let begin = reader.at;
        let [x, z, length] = [
            reader.number("a tile")?,
            reader.number("a tile")?,
            reader.number("a tile")?,
        ];
        if last.is_some_and(|last| last >= (z, x)) {
            return Err(reader.damaged(begin, "a tile out of order"));
        }
        last = Some((z, x));
        let first = reader.at;
        let (mut samples, mut height) = (Vec::with_capacity(OWN), 0_i32);
        for _ in 0..OWN {
            let at = reader.at;
            height = height.saturating_add(reader.rise()?);
            if !(-most..=most).contains(&height) {
                return Err(reader.damaged(at, "a sample beyond 4096 m"));
            }
            samples.push(height);
        }
        if reader.at - first != length as usize {
            return Err(reader.damaged(begin + 8, "a tile of another length"));
        }
        // Tiles of other ground are refused behind the checksum.
        if x < lattice.tiles[0] && z < lattice.tiles[1] {
            tiles.insert([x, z], samples);
        }
    }
    Ok(tiles)
}

/// Tiles with what they share with those beside them.
fn layer_of(lattice: &EditLattice, own: &Own) -> Edits {
    let cells = i64::from(CELLS);
    let sample = |at: [i64; 2]| {
        let tile = at.map(|k| u32::try_from(k.div_euclid(cells)).ok());
        let [Some(x), Some(z)] = tile else { return 0 };
        let [i, j] = at.map(|k| k.rem_euclid(cells) as usize);
        own.get(&[x, z])
            .map_or(0, |samples| samples[j * CELLS as usize + i])
    };
    let beside = |[x, z]: [u32; 2]| {
        let span = |k: u32, most: u32| k.saturating_sub(1)..=(k + 1).min(most - 1);
        span(z, lattice.tiles[1]).flat_map(move |z| span(x, lattice.tiles[0]).map(move |x| [x, z]))
    };
    let places: BTreeSet<[u32; 2]> = own.keys().copied().flat_map(beside).collect();
    let mut edits = Edits::none(*lattice);
    for place in places {
        let first = place.map(|k| i64::from(k) * cells - 1);
        let steps = (0..SAMPLES)
            .map(|k| sample([first[0] + (k % SIDE) as i64, first[1] + (k / SIDE) as i64]));
        if let Some(tile) = Tile::new(steps.collect()) {
            edits = edits.with_tile(place, Some(tile));
        }
    }
    edits
}
