//! The codec of `EXT_meshopt_compression`: bytes of a buffer view in, fewer bytes out, and back.
//!
//! What the extension calls modes and filters is Arseny Kapoulkine's meshoptimizer, which is called here and
//! nowhere else. Everything but the two filters for unit vectors gives back what was put in. Whatever
//! comes from a file is looked at before the decoder sees it, so that no lying number costs memory or
//! trips it. Without the feature `meshopt` nothing is encoded and nothing decoded.

/// How elements are arranged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Mode {
    /// Elements of `stride` bytes, each beside the one before it.
    Attributes,
    /// Three indices a triangle; triangles may come back turned.
    Triangles,
    /// Indices in any order.
    Indices,
}

/// What is done to elements once they are decoded.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Filter {
    /// Nothing.
    None,
    /// Unit vectors by two numbers.
    Octahedral,
    /// Unit quaternions by their three smaller numbers, to 16-bit integers.
    Quaternion,
    /// Floats as a whole number of 24 bits times a power of two.
    Exponential,
}

impl Mode {
    /// As the extension calls it.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Attributes => "ATTRIBUTES",
            Self::Triangles => "TRIANGLES",
            Self::Indices => "INDICES",
        }
    }

    pub(crate) fn of(name: &str) -> Option<Self> {
        [Self::Attributes, Self::Triangles, Self::Indices]
            .into_iter()
            .find(|mode| mode.name() == name)
    }
}

impl Filter {
    /// As the extension calls it.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::None => "NONE",
            Self::Octahedral => "OCTAHEDRAL",
            Self::Quaternion => "QUATERNION",
            Self::Exponential => "EXPONENTIAL",
        }
    }

    pub(crate) fn of(name: &str) -> Option<Self> {
        [
            Self::None,
            Self::Octahedral,
            Self::Quaternion,
            Self::Exponential,
        ]
        .into_iter()
        .find(|filter| filter.name() == name)
    }
}

/// Elements of a buffer view, described as the extension does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Layout {
    pub(crate) mode: Mode,
    pub(crate) filter: Filter,
    /// Bytes an element.
    pub(crate) stride: usize,
    pub(crate) count: usize,
}

/// Elements that a coded byte may stand for: 64 where nothing changes, and what a short end is padded by.
const MOST_ELEMENTS_A_BYTE: usize = 80;

impl Layout {
    /// What the extension and the decoder ask for.
    fn fault(&self, coded: usize) -> Option<&'static str> {
        let Self {
            mode,
            filter,
            stride,
            count,
        } = *self;
        let sound = match mode {
            Mode::Attributes => stride.is_multiple_of(4) && (4..=256).contains(&stride),
            Mode::Triangles => (stride == 2 || stride == 4) && count.is_multiple_of(3),
            Mode::Indices => stride == 2 || stride == 4,
        };
        let filtered = match filter {
            Filter::None => true,
            Filter::Octahedral => mode == Mode::Attributes && (stride == 4 || stride == 8),
            Filter::Quaternion => mode == Mode::Attributes && stride == 8,
            Filter::Exponential => mode == Mode::Attributes,
        };
        if !sound {
            return Some("a stride or a count that its mode does not have");
        }
        if !filtered {
            return Some("a filter that its stride does not have");
        }
        if count > coded.saturating_mul(MOST_ELEMENTS_A_BYTE) {
            return Some("more elements than its bytes can hold");
        }
        None
    }
}

/// Decoders compute in f32, some in another order and with another rounding of halves than others. So far from a
/// half, in steps of 1/32767, all of them come to the same integer.
const CLEAR: f64 = 0.01;

/// A quaternion as the filter keeps it in so many bits, 4 to 15, and the 16-bit integers that come back from every
/// decoder. Where they would not agree, one next to it is taken.
pub(crate) fn quaternion_of_bits(q: [f64; 4], bits: u32) -> ([i16; 4], [i16; 4]) {
    let mut largest = 0;
    for i in 1..4 {
        if q[i].abs() > q[largest].abs() {
            largest = i;
        }
    }
    let sign = if q[largest] < 0.0 { -1.0 } else { 1.0 };
    let most = (1_i32 << (bits - 1)) - 1;
    let aim = [1, 2, 3].map(|next| {
        let x = q[(largest + next) & 3] * sign * std::f64::consts::SQRT_2;
        x.clamp(-1.0, 1.0) * f64::from(most)
    });
    let last = (most as i16 & !3) | largest as i16;
    let stored = |aside: [f64; 3]| {
        let whole = |i: usize| (aim[i].round() + aside[i]).clamp(f64::from(-most), f64::from(most));
        [whole(0) as i16, whole(1) as i16, whole(2) as i16, last]
    };
    // The next integer on the other side of each number, nearest first.
    let other = [0, 1, 2].map(|i| if aim[i] < aim[i].round() { -1.0 } else { 1.0 });
    let mut asides = vec![[0.0; 3]];
    for pick in 1..8 {
        asides.push([0, 1, 2].map(|i| if pick >> i & 1 == 1 { other[i] } else { 0.0 }));
    }
    let far = |aside: &[f64; 3]| -> f64 {
        let off = |i: usize| aim[i].round() + aside[i] - aim[i];
        off(0) * off(0) + off(1) * off(1) + off(2) * off(2)
    };
    asides.sort_by(|a, b| far(a).total_cmp(&far(b)));
    let clear = asides.into_iter().map(stored).find_map(|stored| {
        let (back, clear) = quaternion_of_stored(stored);
        clear.then_some((stored, back))
    });
    clear.unwrap_or_else(|| {
        let stored = stored([0.0; 3]);
        (stored, quaternion_of_stored(stored).0)
    })
}

/// What the filter makes of four stored integers, and whether every decoder does.
fn quaternion_of_stored(stored: [i16; 4]) -> ([i16; 4], bool) {
    let s = f64::from(stored[3] | 3);
    let [x, y, z] = [stored[0], stored[1], stored[2]].map(f64::from);
    let w = (s * s * 2.0 - x * x - y * y - z * z).max(0.0).sqrt();
    let factor = 32767.0 / std::f64::consts::SQRT_2 / s;
    let largest = (stored[3] & 3) as usize;
    let mut out = [0; 4];
    let mut clear = true;
    for (next, value) in [(1, x), (2, y), (3, z), (0, w)] {
        let value = value * factor;
        clear &= (value.abs().fract() - 0.5).abs() > CLEAR;
        out[(largest + next) & 3] = value.round() as i16;
    }
    (out, clear)
}

/// A power of two, exactly, on every machine; `exponent` is held to -1000..=1000.
pub(crate) fn power(exponent: i32) -> f64 {
    f64::from_bits(((exponent.clamp(-1000, 1000) + 1023) as u64) << 52)
}

/// The exponent of the power of two at or below `x`; -1000 where there is none.
pub(crate) fn exponent_below(x: f64) -> i32 {
    match x.is_normal() && x > 0.0 {
        true => ((x.to_bits() >> 52) as i32 & 0x7ff) - 1023,
        false => -1000,
    }
}

/// Exponents and integers that are exactly `values`, for each of `width` components; `None` where there
/// are none of 24 bits.
pub(crate) fn exponential(values: &[f32], width: usize) -> Option<Vec<u32>> {
    let mut out = vec![0; values.len()];
    for component in 0..width {
        let own = || values.iter().skip(component).step_by(width);
        let exponent = own().filter(|x| **x != 0.0).map(lowest_bit).min();
        let exponent = exponent.unwrap_or(0);
        if !(-120..=100).contains(&exponent) || !own().all(|x| x.is_finite()) {
            return None;
        }
        let step = power(exponent);
        for (x, out) in own().zip(out.iter_mut().skip(component).step_by(width)) {
            let whole = f64::from(*x) / step;
            if whole.abs() >= f64::from(1 << 23) {
                return None;
            }
            *out = (whole as i32 as u32 & 0x00ff_ffff) | (exponent as u32) << 24;
        }
    }
    Some(out)
}

/// The power of two of the lowest bit that is set in a float.
fn lowest_bit(x: &f32) -> i32 {
    let bits = x.to_bits();
    let (mantissa, exponent) = (bits & 0x007f_ffff, (bits >> 23 & 0xff) as i32);
    let mantissa = if exponent == 0 {
        mantissa
    } else {
        mantissa | 0x0080_0000
    };
    mantissa.trailing_zeros() as i32 + exponent.max(1) - 150
}

#[cfg(feature = "meshopt")]
mod by_meshopt {
    use super::{Filter, Layout, Mode};

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
        let sound =
            indices.len().is_multiple_of(3) && indices.iter().all(|&i| (i as usize) < vertices);
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
                let mut all: Vec<[u32; 1]> =
                    four.iter().map(|b| [u32::from_le_bytes(*b)]).collect();
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
}

#[cfg(not(feature = "meshopt"))]
mod by_meshopt {
    use super::Layout;

    pub(crate) fn encode(_: &[u8], _: usize) -> Option<Vec<u8>> {
        None
    }

    pub(crate) fn encode_triangles(_: &[u32]) -> Option<Vec<u8>> {
        None
    }

    pub(crate) fn fast_order(_: &[u32], _: usize) -> Option<(Vec<u32>, Vec<u32>)> {
        None
    }

    pub(super) fn decode(_: &[u8], _: Layout) -> Option<Vec<u8>> {
        None
    }
}

pub(crate) use by_meshopt::{encode, encode_triangles, fast_order};

/// The bytes that `coded` stands for: `layout.stride * layout.count` of them.
///
/// # Errors
/// What is wrong, in a few words.
pub(crate) fn decode(coded: &[u8], layout: Layout) -> Result<Vec<u8>, &'static str> {
    if let Some(fault) = layout.fault(coded.len()) {
        return Err(fault);
    }
    if !cfg!(feature = "meshopt") {
        return Err(
            "compressed data, which this build does not read: its feature `meshopt` is off",
        );
    }
    by_meshopt::decode(coded, layout).ok_or("compressed data that is broken")
}

#[cfg(all(test, feature = "meshopt"))]
mod tests {
    use super::*;

    struct Random(u64);

    impl Random {
        fn next(&mut self) -> u32 {
            self.0 = self
                .0
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (self.0 >> 33) as u32
        }
    }

    fn attributes(filter: Filter, stride: usize, count: usize) -> Layout {
        Layout {
            mode: Mode::Attributes,
            filter,
            stride,
            count,
        }
    }

    #[test]
    fn elements_come_back_bit_for_bit() {
        let mut random = Random(1);
        for stride in [4, 8, 12, 16, 48, 64, 256] {
            for count in [1, 2, 15, 16, 17, 255, 256, 257, 1000] {
                let bits = random.next() % 8;
                let bytes: Vec<u8> = (0..stride * count)
                    .map(|_| (random.next() & ((1 << bits) - 1)) as u8)
                    .collect();
                let coded = encode(&bytes, stride).unwrap();
                assert_eq!(coded[0], 0xa0, "the extension has version 0 alone");
                let back = decode(&coded, attributes(Filter::None, stride, count));
                assert_eq!(back.unwrap(), bytes, "{stride} {count}");
            }
        }
        assert_eq!(encode(&[0; 12], 6), None);
        assert_eq!(encode(&[0; 13], 4), None);
    }

    /// Whatever does not change costs least: no count that is sound may be refused.
    #[test]
    fn a_million_equal_elements_are_believed() {
        for count in [1, 256, 1_000_000] {
            let bytes = vec![7; 4 * count];
            let coded = encode(&bytes, 4).unwrap();
            let back = decode(&coded, attributes(Filter::None, 4, count)).unwrap();
            assert_eq!(back, bytes);
        }
        let coded = encode(&[7; 400], 4).unwrap();
        let lying = attributes(Filter::None, 4, usize::MAX / 8);
        assert!(decode(&coded, lying).is_err());
    }

    #[test]
    fn quaternions_are_what_the_decoder_makes() {
        let mut random = Random(2);
        for bits in 4..=15 {
            let mut stored = Vec::new();
            let mut wanted = Vec::new();
            for _ in 0..200 {
                let q =
                    [0; 4].map(|_| f64::from(random.next()) / f64::from(1_u32 << 31) * 2.0 - 1.0);
                let length = q.iter().map(|x| x * x).sum::<f64>().sqrt();
                let q = q.map(|x| x / length);
                let (kept, back) = quaternion_of_bits(q, bits);
                stored.extend(kept.iter().flat_map(|x| x.to_le_bytes()));
                wanted.extend(back.iter().flat_map(|x| x.to_le_bytes()));
                // Half a step in each of three numbers, and what that does to the fourth.
                let step = 0.5_f64.sqrt() / f64::from((1 << (bits - 1)) - 1);
                let dot: f64 = (0..4).map(|i| f64::from(back[i]) / 32767.0 * q[i]).sum();
                let size = back
                    .iter()
                    .map(|&x| f64::from(x) / 32767.0 * (f64::from(x) / 32767.0))
                    .sum::<f64>()
                    .sqrt();
                let cosine = (dot.abs() / size).min(1.0);
                // Small angles are their sines.
                let angle = 2.0 * (1.0 - cosine * cosine).sqrt();
                assert!(angle < 7.0 * step + 1e-4, "{bits}: {angle} {step}");
            }
            let coded = encode(&stored, 8).unwrap();
            let back = decode(&coded, attributes(Filter::Quaternion, 8, 200)).unwrap();
            assert!(back == wanted, "{bits} bits");
        }
    }

    #[test]
    fn multiples_of_powers_of_two_come_back_exactly() {
        let mut random = Random(3);
        for step in [-60, -24, -12, 0, 5] {
            let size = power(step);
            let values: Vec<f32> = (0..300)
                .map(|_| ((f64::from(random.next() % 2_000_001) - 1e6) * size) as f32)
                .collect();
            let stored = exponential(&values, 3).expect("21 bits fit 24");
            let bytes: Vec<u8> = stored.iter().flat_map(|x| x.to_le_bytes()).collect();
            let coded = encode(&bytes, 12).unwrap();
            let back = decode(&coded, attributes(Filter::Exponential, 12, 100)).unwrap();
            let wanted: Vec<u8> = values.iter().flat_map(|x| x.to_le_bytes()).collect();
            assert_eq!(back, wanted, "{step}");
        }
        assert_eq!(exponential(&[1.0, 1e-30], 1), None);
        assert_eq!(exponential(&[f32::NAN], 1), None);
        assert_eq!(exponential(&[f32::MIN_POSITIVE / 2.0], 1), None);
        assert!(exponential(&[0.0; 3], 3).is_some());
    }

    #[test]
    fn triangles_are_the_same_but_turned() {
        let mut random = Random(4);
        let indices: Vec<u32> = (0..3000).map(|_| random.next() % 700).collect();
        let (fast, old) = fast_order(&indices, 700).unwrap();
        let turned = |t: &[u32]| {
            let least = (0..3).min_by_key(|&i| t[i]).unwrap();
            [t[least], t[(least + 1) % 3], t[(least + 2) % 3]]
        };
        let set = |all: &[u32]| {
            let mut all: Vec<[u32; 3]> = all.chunks(3).map(turned).collect();
            all.sort_unstable();
            all
        };
        let named: Vec<u32> = fast.iter().map(|&i| old[i as usize]).collect();
        assert_eq!(set(&named), set(&indices));
        let coded = encode_triangles(&fast).unwrap();
        for stride in [2, 4] {
            let layout = Layout {
                mode: Mode::Triangles,
                filter: Filter::None,
                stride,
                count: fast.len(),
            };
            let back = decode(&coded, layout).unwrap();
            let back: Vec<u32> = match stride {
                2 => back
                    .as_chunks()
                    .0
                    .iter()
                    .map(|b| u16::from_le_bytes(*b).into())
                    .collect(),
                _ => back
                    .as_chunks()
                    .0
                    .iter()
                    .map(|b| u32::from_le_bytes(*b))
                    .collect(),
            };
            assert_eq!(set(&back), set(&fast));
        }
    }

    /// Whatever is there and whatever it is said to be: an answer or a refusal.
    #[test]
    fn broken_bytes_are_refused_or_answered() {
        let mut random = Random(5);
        let sound = encode(&vec![3; 1200], 12).unwrap();
        let modes = [Mode::Attributes, Mode::Triangles, Mode::Indices];
        let filters = [
            Filter::None,
            Filter::Octahedral,
            Filter::Quaternion,
            Filter::Exponential,
        ];
        let mut refused = 0;
        for _ in 0..3000 {
            let mut bytes = sound.clone();
            bytes.truncate(random.next() as usize % (bytes.len() + 1));
            for _ in 0..random.next() % 4 {
                if let Some(at) = (random.next() as usize).checked_rem(bytes.len()) {
                    bytes[at] = random.next() as u8;
                }
            }
            if let Some(first) = bytes.first_mut() {
                *first = [0xa0, 0xe1, 0xd1, *first][random.next() as usize % 4];
            }
            let layout = Layout {
                mode: modes[random.next() as usize % 3],
                filter: filters[random.next() as usize % 4],
                stride: [0, 2, 3, 4, 8, 12, 300][random.next() as usize % 7],
                count: [0, 1, 3, 100, 300, usize::MAX][random.next() as usize % 6],
            };
            match decode(&bytes, layout) {
                Ok(back) => assert_eq!(back.len(), layout.stride * layout.count),
                Err(_) => refused += 1,
            }
        }
        assert!(refused > 1000, "{refused}");
    }
}
