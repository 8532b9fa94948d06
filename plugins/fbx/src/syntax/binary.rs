//! The binary form.

use super::Values;
use miniz_oxide::inflate::core::{DecompressorOxide, decompress, inflate_flags};
use miniz_oxide::inflate::{TINFLStatus, decompress_to_vec_zlib_with_limit};

const MAGIC: &[u8] = b"Kaydara FBX Binary  \0\x1a";
/// Bytes before the first node: the magic, the byte order and the version.
const HEADER: usize = 27;
/// From this version on offsets and counts have eight bytes.
const WIDE: u32 = 7500;
/// A packed array may say that it grows so many times and is believed: that much ufbx may ask for before
/// it finds out. What says more is unpacked to see.
const BELIEVED: usize = 8;
/// Deflate makes no more of a byte than this.
const MOST: usize = 1032;

/// Whether it is the binary form, in the byte order that all but a few old files have.
pub(super) fn is_binary(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC) && bytes.get(22) == Some(&0)
}

/// Where a node's parts are.
struct Header {
    name: std::ops::Range<usize>,
    values: std::ops::Range<usize>,
    count: usize,
    end: usize,
}

enum Next {
    Node(Header),
    /// The empty node that ends a list, and what follows it.
    End(usize),
}

fn u32_at(bytes: &[u8], at: usize) -> Option<usize> {
    let four = bytes.get(at..at.checked_add(4)?)?;
    usize::try_from(u32::from_le_bytes(four.try_into().ok()?)).ok()
}

fn u64_at(bytes: &[u8], at: usize) -> Option<usize> {
    let eight = bytes.get(at..at.checked_add(8)?)?;
    usize::try_from(u64::from_le_bytes(eight.try_into().ok()?)).ok()
}

fn header(bytes: &[u8], at: usize, wide: bool) -> Option<Next> {
    let size = if wide { 8 } else { 4 };
    let word = |i: usize| match wide {
        true => u64_at(bytes, at + 8 * i),
        false => u32_at(bytes, at + 4 * i),
    };
    let (end, count, length) = (word(0)?, word(1)?, word(2)?);
    let name_length = usize::from(*bytes.get(at + 3 * size)?);
    let name = at + 3 * size + 1;
    if end == 0 {
        return Some(Next::End(name));
    }
    let values = name + name_length;
    let after = values.checked_add(length)?;
    (after <= end && end <= bytes.len()).then_some(Next::Node(Header {
        name: name..values,
        values: values..after,
        count,
        end,
    }))
}

/// See [`super::walk`].
pub(super) fn walk<'a>(bytes: &'a [u8], take: &mut impl FnMut(usize, &'a [u8], Values<'a>)) {
    let Some(version) = u32_at(bytes, 23) else {
        return;
    };
    let wide = version >= WIDE as usize;
    let mut at = HEADER;
    // Ends of the nodes that this one lies in.
    let mut ends: Vec<usize> = Vec::new();
    while let Some(next) = header(bytes, at, wide) {
        match next {
            Next::End(after) if ends.is_empty() || after <= at => return,
            Next::End(after) => at = after,
            Next::Node(node) => {
                let outer = ends.last().copied().unwrap_or(bytes.len());
                if node.end > outer {
                    return;
                }
                let values = Values::Binary(&bytes[node.values.clone()], node.count);
                take(ends.len(), &bytes[node.name], values);
                at = node.values.end;
                ends.push(node.end);
            }
        }
        while ends.last().is_some_and(|&end| at >= end) {
            ends.pop();
        }
    }
}

/// A value.
enum Value<'a> {
    Number(i64),
    Text(&'a [u8]),
    Array(Array<'a>),
    Other,
}

struct Array<'a> {
    kind: u8,
    count: usize,
    packed: bool,
    bytes: &'a [u8],
}

impl Array<'_> {
    fn size_of_one(&self) -> usize {
        match self.kind {
            b'd' | b'l' => 8,
            b'f' | b'i' => 4,
            _ => 1,
        }
    }
}

/// Hands out the values of a node one after another.
fn values<'a>(bytes: &'a [u8], count: usize, take: &mut impl FnMut(Value<'a>)) {
    let mut at = 0;
    for _ in 0..count {
        let Some((value, next)) = value(bytes, at) else {
            return;
        };
        take(value);
        at = next;
    }
}

fn value(bytes: &[u8], at: usize) -> Option<(Value<'_>, usize)> {
    let kind = *bytes.get(at)?;
    let at = at + 1;
    let fixed = |size: usize| bytes.get(at..at.checked_add(size)?);
    let number = |bytes: &[u8]| match *bytes {
        [a] => Some(i64::from(a)),
        [a, b] => Some(i64::from(i16::from_le_bytes([a, b]))),
        [a, b, c, d] => Some(i64::from(i32::from_le_bytes([a, b, c, d]))),
        _ => Some(i64::from_le_bytes(bytes.try_into().ok()?)),
    };
    Some(match kind {
        b'B' | b'C' => (Value::Number(number(fixed(1)?)?), at + 1),
        b'Y' => (Value::Number(number(fixed(2)?)?), at + 2),
        b'I' => (Value::Number(number(fixed(4)?)?), at + 4),
        b'L' => (Value::Number(number(fixed(8)?)?), at + 8),
        b'F' => (Value::Other, at + fixed(4)?.len()),
        b'D' => (Value::Other, at + fixed(8)?.len()),
        b'S' | b'R' => {
            let text = bytes.get(at + 4..(at + 4).checked_add(u32_at(bytes, at)?)?)?;
            (Value::Text(text), at + 4 + text.len())
        }
        b'f' | b'd' | b'l' | b'i' | b'b' | b'c' => {
            let (count, packing, length) = (
                u32_at(bytes, at)?,
                u32_at(bytes, at + 4)?,
                u32_at(bytes, at + 8)?,
            );
            let mut array = Array {
                kind,
                count,
                packed: packing == 1,
                bytes: &[],
            };
            let length = match array.packed {
                true => length,
                false => count.checked_mul(array.size_of_one())?,
            };
            array.bytes = bytes.get(at + 12..(at + 12).checked_add(length)?)?;
            (Value::Array(array), at + 12 + length)
        }
        _ => return None,
    })
}

pub(super) fn last_string(bytes: &[u8], count: usize) -> Option<&[u8]> {
    let mut last = None;
    values(bytes, count, &mut |value| {
        if let Value::Text(text) = value {
            last = Some(text);
        }
    });
    last
}

pub(super) fn numbers(bytes: &[u8], count: usize) -> Vec<i64> {
    let mut out = Vec::new();
    values(bytes, count, &mut |value| match value {
        Value::Number(number) => out.push(number),
        Value::Array(array) => out.extend(whole_numbers(&array)),
        Value::Text(_) | Value::Other => {}
    });
    out
}

fn whole_numbers(array: &Array) -> Vec<i64> {
    let one = array.size_of_one();
    let most = (array.bytes.len().saturating_mul(MOST)).min(array.count.saturating_mul(one));
    let unpacked;
    let bytes = match array.packed {
        false => array.bytes,
        true => match decompress_to_vec_zlib_with_limit(array.bytes, most) {
            Ok(bytes) => {
                unpacked = bytes;
                &unpacked
            }
            Err(_) => return Vec::new(),
        },
    };
    let numbers = bytes.chunks_exact(one).take(array.count);
    match array.kind {
        b'i' => numbers
            .filter_map(|four| Some(i64::from(i32::from_le_bytes(four.try_into().ok()?))))
            .collect(),
        b'l' => numbers
            .filter_map(|eight| Some(i64::from_le_bytes(eight.try_into().ok()?)))
            .collect(),
        b'b' | b'c' => numbers.flatten().map(|&byte| i64::from(byte)).collect(),
        _ => Vec::new(),
    }
}

/// Bytes of a file when its packed arrays are unpacked. It is never far more than what is truly there,
/// whatever the file says: an array that claims to grow much is unpacked, and its bytes counted.
pub(crate) fn unpacked(file: &[u8]) -> usize {
    let mut size = file.len();
    if !is_binary(file) {
        return size;
    }
    walk(file, &mut |_, _, node| {
        let Values::Binary(bytes, count) = node else {
            return;
        };
        values(bytes, count, &mut |value| {
            if let Value::Array(array) = value
                && array.packed
            {
                let claimed = array.count.saturating_mul(array.size_of_one());
                let believed = array.bytes.len().saturating_mul(BELIEVED);
                let whole = match claimed > believed {
                    true => count_unpacked(array.bytes, claimed),
                    false => claimed,
                };
                size = size.saturating_add(whole.saturating_sub(array.bytes.len()));
            }
        });
    });
    size
}

/// How many bytes packed ones become, at most `most`, without keeping them.
fn count_unpacked(bytes: &[u8], most: usize) -> usize {
    let mut state = Box::<DecompressorOxide>::default();
    let mut window = vec![0; 1 << 15];
    let flags = inflate_flags::TINFL_FLAG_PARSE_ZLIB_HEADER;
    let (mut read, mut at, mut total) = (0, 0, 0_usize);
    while total < most {
        let (status, taken, made) = decompress(&mut state, &bytes[read..], &mut window, at, flags);
        read += taken;
        total = total.saturating_add(made);
        at = (at + made) % window.len();
        if status != TINFLStatus::HasMoreOutput || read > bytes.len() {
            break;
        }
    }
    total.min(most)
}

#[cfg(test)]
mod tests {
    use super::*;
    use miniz_oxide::deflate::compress_to_vec_zlib;

    /// A file of one node with a packed array of `count` integers.
    fn file(count: u32, bytes: &[u8], wide: bool) -> Vec<u8> {
        let mut value = vec![b'i'];
        for word in [count, 1, bytes.len() as u32] {
            value.extend(word.to_le_bytes());
        }
        value.extend(bytes);
        let mut file = MAGIC.to_vec();
        file.push(0);
        file.extend(if wide { 7500_u32 } else { 7400 }.to_le_bytes());
        let name = b"Smoothing";
        let head = if wide { 25 } else { 13 };
        let end = file.len() + head + name.len() + value.len();
        for word in [end, 1, value.len()] {
            match wide {
                true => file.extend((word as u64).to_le_bytes()),
                false => file.extend((word as u32).to_le_bytes()),
            }
        }
        file.push(name.len() as u8);
        file.extend(name);
        file.extend(value);
        file.extend(vec![0; head]);
        file
    }

    #[test]
    fn packed_arrays_count_unpacked() {
        let numbers: Vec<u8> = (0..100_000_u32)
            .flat_map(|i| (i / 1000).to_le_bytes())
            .collect();
        let packed = compress_to_vec_zlib(&numbers, 9);
        assert!(packed.len() * 20 < numbers.len());
        for wide in [false, true] {
            let file = file(100_000, &packed, wide);
            assert_eq!(unpacked(&file), file.len() - packed.len() + 400_000);
            let mut read = Vec::new();
            walk(&file, &mut |depth, name, node| {
                assert_eq!((depth, name), (0, b"Smoothing".as_slice()));
                read = node.numbers();
            });
            assert_eq!(read, (0..100_000).map(|i| i / 1000).collect::<Vec<i64>>());
        }
    }

    #[test]
    fn counts_that_lie_are_not_believed() {
        let packed = compress_to_vec_zlib(&[7; 1000], 9);
        for count in [250, 1 << 20, u32::MAX] {
            let file = file(count, &packed, false);
            assert!(unpacked(&file) <= file.len() + 1000, "{count}");
        }
        // What is no deflate at all.
        let noise = file(u32::MAX, &[0xff; 64], true);
        assert!(unpacked(&noise) <= noise.len() + 64 * BELIEVED);
    }

    #[test]
    fn what_is_cut_ends_the_walk() {
        let whole = file(4, &compress_to_vec_zlib(&[1; 16], 9), false);
        for end in 0..whole.len() {
            unpacked(&whole[..end]);
            walk(&whole[..end], &mut |_, _, node| drop(node.numbers()));
        }
    }
}
