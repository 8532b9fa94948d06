//! meshoptimizer.

use super::layout::{Filter, Layout, Mode};

/// The version of attributes that the extension has.
const VERSION: i32 = 0;

/// Calls a function for elements of `$stride` bytes, a multiple of four up to 256.
macro_rules! by_stride {
    ($stride:expr, $of:ident $arguments:tt, $($words:literal)*) => {
        match $stride {
            $(n if n == 4 * $words => $of::<{ 4 * $words }> $arguments,)*
            _ => None,
        }
    };
    ($stride:expr, $of:ident $arguments:tt) => {
        by_stride!($stride, $of $arguments,
            1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25 26 27 28 29 30 31 32
            33 34 35 36 37 38 39 40 41 42 43 44 45 46 47 48 49 50 51 52 53 54 55 56 57 58 59 60 61 62 63 64)
    };
}

fn encode_elements<const N: usize>(bytes: &[u8]) -> Option<Vec<u8>> {
    let (elements, rest) = bytes.as_chunks::<N>();
    if !rest.is_empty() {
        return None;
    }
    meshopt::encode_vertex_buffer_level(elements, 2, Some(VERSION)).ok()
}

#[derive(Clone, Copy)]
struct Element<const N: usize>([u8; N]);

impl<const N: usize> Default for Element<N> {
    fn default() -> Self {
        Self([0; N])
    }
}

fn decode_elements<const N: usize>(coded: &[u8], count: usize) -> Option<Vec<u8>> {
    let elements = meshopt::decode_vertex_buffer::<Element<N>>(coded, count).ok()?;
    Some(elements.iter().flat_map(|element| element.0).collect())
}

/// Elements of `stride` bytes, coded; `None` where the codec has no such stride.
pub(crate) fn encode(bytes: &[u8], stride: usize) -> Option<Vec<u8>> {
    by_stride!(stride, encode_elements(bytes))
}

/// Triangles, coded.
pub(crate) fn encode_triangles(indices: &[u32]) -> Option<Vec<u8>> {
    let vertices = indices.iter().max().map_or(0, |&most| most as usize + 1);
    match indices.len() % 3 {
        0 => meshopt::encode_index_buffer(indices, vertices).ok(),
        _ => None,
    }
}

/// Indices of the same triangles and vertices in an order that is fast to draw, and for each vertex which it
/// was; vertices that no triangle has come last.
pub(crate) fn fast_order(indices: &[u32], vertices: usize) -> Option<(Vec<u32>, Vec<u32>)> {
    let sound = indices.len().is_multiple_of(3) && indices.iter().all(|&i| (i as usize) < vertices);
    if !sound || indices.is_empty() {
        return None;
    }
    let mut indices = meshopt::optimize_vertex_cache(indices, vertices);
    let mut new = vec![u32::MAX; vertices];
    let mut old = Vec::with_capacity(vertices);
    for index in &mut indices {
        let slot = new.get_mut(*index as usize)?;
        if *slot == u32::MAX {
            *slot = old.len() as u32;
            old.push(*index);
        }
        *index = *slot;
    }
    let left = (0..).zip(&new).filter(|(_, new)| **new == u32::MAX);
    old.extend(left.map(|(vertex, _): (u32, _)| vertex));
    Some((indices, old))
}

pub(super) fn decode(coded: &[u8], layout: Layout) -> Option<Vec<u8>> {
    let Layout {
        mode,
        filter,
        stride,
        count,
    } = layout;
    let mut bytes = match (mode, stride) {
        (Mode::Attributes, _) => by_stride!(stride, decode_elements(coded, count))?,
        (Mode::Triangles, 2) => of_u16(&meshopt::decode_index_buffer(coded, count).ok()?),
        (Mode::Triangles, _) => of_u32(&meshopt::decode_index_buffer(coded, count).ok()?),
        (Mode::Indices, 2) => of_u16(&meshopt::decode_index_sequence(coded, count).ok()?),
        (Mode::Indices, _) => of_u32(&meshopt::decode_index_sequence(coded, count).ok()?),
    };
    let shorts = |bytes: &[u8]| -> Vec<[i16; 4]> {
        let eight = bytes.as_chunks::<8>().0;
        let one = |b: &[u8; 8]| [0, 2, 4, 6].map(|i| i16::from_le_bytes([b[i], b[i + 1]]));
        eight.iter().map(one).collect()
    };
    let of_shorts = |all: &[[i16; 4]]| -> Vec<u8> {
        all.iter().flatten().flat_map(|x| x.to_le_bytes()).collect()
    };
    match filter {
        Filter::None => {}
        Filter::Octahedral if stride == 4 => {
            let four = bytes.as_chunks::<4>().0;
            let mut all: Vec<[i8; 4]> = four.iter().map(|b| b.map(|x| x as i8)).collect();
            meshopt::decode_filter_oct(&mut all);
            bytes = all.iter().flatten().map(|&x| x as u8).collect();
        }
        Filter::Octahedral => {
            let mut all = shorts(&bytes);
            meshopt::decode_filter_oct(&mut all);
            bytes = of_shorts(&all);
        }
        Filter::Quaternion => {
            let mut all = shorts(&bytes);
            meshopt::decode_filter_quat(&mut all);
            bytes = of_shorts(&all);
        }
        Filter::Exponential => {
            let four = bytes.as_chunks::<4>().0;
            let mut all: Vec<[u32; 1]> = four.iter().map(|b| [u32::from_le_bytes(*b)]).collect();
            meshopt::decode_filter_exp(&mut all);
            bytes = of_u32(all.as_flattened());
        }
    }
    Some(bytes)
}

fn of_u16(all: &[u16]) -> Vec<u8> {
    all.iter().flat_map(|x| x.to_le_bytes()).collect()
}

fn of_u32(all: &[u32]) -> Vec<u8> {
    all.iter().flat_map(|x| x.to_le_bytes()).collect()
}
