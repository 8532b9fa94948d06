//! The first directory of a TIFF, looked over before the decoder sees it: it makes room for as many values as a tag
//! claims, 32 bytes each, before it finds that the file has fewer.

use super::failure::Failure;
use crate::error::ElevationError;
use crate::input::Input;
use std::io::{Read, SeekFrom};

/// Bytes a value of each type of field (TIFF 6.0, section 2; BigTIFF).
const TYPE_BYTES: [u64; 19] = [1, 1, 1, 2, 4, 8, 1, 1, 2, 4, 8, 4, 8, 4, 1, 1, 8, 8, 8];

/// What the directories say besides what the decoder reads.
pub(super) struct Found {
    /// Whether it is a BigTIFF.
    pub big: bool,
    /// Where later directories stand that hold masks, of these samples or of others.
    pub masks: Vec<u64>,
}

/// Directories that are looked through for a mask: a map has some overviews.
const MOST_DIRECTORIES: usize = 64;
/// Tag of a directory's purpose, and its bit that stands for a mask (TIFF 6.0, section 8).
const PURPOSE: u64 = 254;
const MASK: u64 = 4;
/// And for an overview.
const REDUCED: u64 = 1;

/// Refuses a directory with a tag whose values do not lie in the file.
pub(super) fn check(input: &mut Input<'_>) -> Result<Found, ElevationError> {
    let (file, bytes) = (input.file, input.bytes);
    let failure = Failure { file };
    let mut read = |at: u64, length: u64, place: &str| -> Result<Vec<u8>, ElevationError> {
        let mut buffer = Vec::new();
        let from = &mut *input.source;
        from.seek(SeekFrom::Start(at))
            .and_then(|_| from.take(length).read_to_end(&mut buffer))
            .map_err(|error| crate::error::read_error(file, &error))?;
        if (buffer.len() as u64) < length {
            return Err(failure.damaged(place, "the file ends before it"));
        }
        Ok(buffer)
    };
    let head = read(0, 16.min(bytes), "its header")?;
    let little = head.starts_with(b"II");
    let number = |from: &[u8]| -> u64 {
        let add = |sum: u64, byte: &u8| sum << 8 | u64::from(*byte);
        if little {
            from.iter().rev().fold(0, add)
        } else {
            from.iter().fold(0, add)
        }
    };
    let big = head.len() == 16 && number(&head[2..4]) == 43;
    let ([count_bytes, entry_bytes], offset) = match (big, head.len()) {
        (true, _) => ([8, 20], number(&head[8..16])),
        (false, 8..) => ([2, 12], number(&head[4..8])),
        _ => return Err(failure.damaged("its header", "the file ends before it")),
    };
    let place = "its directory";
    let count = number(&read(offset, count_bytes, place)?);
    let length = count.saturating_mul(entry_bytes);
    if length > bytes {
        return Err(failure.damaged(place, format!("{count} tags cannot be in {bytes} bytes")));
    }
    let entries = read(offset.saturating_add(count_bytes), length, place)?;
    let inside = |entry: &[u8]| -> Result<(), ElevationError> {
        let (tag, kind) = (number(&entry[..2]), number(&entry[2..4]));
        let room = if big { 8 } else { 4 };
        let (count, value) = entry[4..].split_at(room);
        let count = number(count);
        let size = TYPE_BYTES.get(kind as usize).copied().unwrap_or(1);
        let length = count.checked_mul(size);
        let lies = length.is_some_and(|length| {
            length <= room as u64
                || number(value)
                    .checked_add(length)
                    .is_some_and(|end| end <= bytes)
        });
        if !lies {
            return Err(failure.damaged(
                format!("tag {tag}"),
                format!("{count} values of {size} bytes do not lie in the file"),
            ));
        }
        Ok(())
    };
    let mut each = entries.chunks_exact(entry_bytes as usize);
    each.try_for_each(inside)?;
    // Of later directories masks count alone. But which of them holds one is not known of a file that is cut off.
    let mut masks = Vec::new();
    let mut known = vec![offset];
    let link = if big { 8 } else { 4 };
    let mut end = offset.saturating_add(count_bytes).saturating_add(length);
    while known.len() < MOST_DIRECTORIES {
        let place = &format!("its directory {}", known.len() + 1);
        let next = number(&read(end, link, place)?);
        if next == 0 || known.contains(&next) {
            break;
        }
        known.push(next);
        let count = number(&read(next, count_bytes, place)?);
        let length = count.saturating_mul(entry_bytes);
        let first = next.saturating_add(count_bytes);
        if length > bytes {
            return Err(failure.damaged(place, format!("{count} tags cannot be in {bytes} bytes")));
        }
        let entries = read(first, length, place)?;
        let mut each = entries.chunks_exact(entry_bytes as usize);
        let is_mask = each.any(|entry| {
            let value = &entry[entry.len() - link as usize..];
            // A LONG; little-endian ones have their lowest bytes first.
            let value = number(&value[..4]);
            number(&entry[..2]) == PURPOSE && value & MASK != 0 && value & REDUCED == 0
        });
        if is_mask {
            let mut each = entries.chunks_exact(entry_bytes as usize);
            each.try_for_each(inside)?;
            masks.push(next);
        }
        end = first.saturating_add(length);
    }
    input
        .source
        .rewind()
        .map_err(|error| input.failed(&error))?;
    Ok(Found { big, masks })
}
