//! Buffer views under `EXT_meshopt_compression`: what is kept how, and which way is smallest.
//!
//! Nothing is rounded here: whatever is written comes back bit for bit (0 for -0), so that an error which was
//! measured on a model holds for its compressed file. Floats that are whole multiples of a power of two lose
//! the bits that they do not use, and quaternions in 16 bits that three numbers say are kept as three.
//! Numbers of clips lie together by their kind, since each view costs some 33 bytes of its own. A view that would be no
//! smaller, with what the document says of the extension, is written plainly, as the extension allows.

use super::buffer::Numbers;
use crate::codec::{self, Filter, Mode};
use gltf_json::accessor::{ComponentType, Type};
use gltf_json::buffer::View;
use gltf_json::extensions;
use gltf_json::validation::USize64;
use gltf_json::{Index, Root};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// The extension's name.
pub(crate) const NAME: &str = "EXT_meshopt_compression";

/// Elements of one kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Kind {
    mode: Mode,
    filter: Filter,
    stride: usize,
}

/// A view in the making.
pub(crate) struct Group {
    kind: Kind,
    /// Of clips: no reader takes its elements for those of an accessor.
    keys: bool,
    /// Elements before the codec, after the filter's own first half.
    stored: Vec<u8>,
    /// What comes back, triangles perhaps turned.
    decoded: Vec<u8>,
    /// Its entry in the document.
    pub(crate) view: Index<View>,
}

/// Views that are compressed at the end.
#[derive(Default)]
pub(crate) struct Packing {
    groups: Vec<Group>,
    /// Those of clips, which take in more.
    open: BTreeMap<Kind, usize>,
    /// All that the exponential filter keeps of clips lies in one view.
    merged: bool,
}

/// Numbers as they are stored and as they come back.
struct Stored {
    kind: Kind,
    stored: Vec<u8>,
    decoded: Vec<u8>,
}

impl Packing {
    /// With one view for all that the exponential filter keeps of clips, or with one a kind.
    pub(crate) fn new(merged: bool) -> Self {
        Self {
            merged,
            ..Self::default()
        }
    }

    /// Takes in numbers; says in which view they are and where.
    pub(crate) fn take(
        &mut self,
        root: &mut Root,
        numbers: &Numbers,
        triangles: bool,
        shared: bool,
        view: View,
    ) -> Option<(Index<View>, usize)> {
        let mut made = stored(numbers, triangles)?;
        if shared && self.merged && made.kind.filter == Filter::Exponential {
            made.kind.stride = 4;
        }
        let open = self.open.get(&made.kind).copied().filter(|_| shared);
        if let Some(open) = open {
            let group = &mut self.groups[open];
            let at = group.decoded.len();
            group.stored.extend(made.stored);
            group.decoded.extend(made.decoded);
            return Some((group.view, at));
        }
        if shared {
            self.open.insert(made.kind, self.groups.len());
        }
        let view = root.push(view);
        self.groups.push(Group {
            kind: made.kind,
            keys: shared,
            stored: made.stored,
            decoded: made.decoded,
            view,
        });
        Some((view, 0))
    }

    /// What a view holds once it is decoded.
    pub(crate) fn decoded(&self, view: Index<View>) -> Option<&[u8]> {
        let mut groups = self.groups.iter();
        groups
            .find(|group| group.view == view)
            .map(|group| &*group.decoded)
    }

    /// Writes all views into `bytes`, compressed where file and document together are smaller for it, and completes
    /// their entries. Answers how long the buffer is that nobody needs, which compressed views would lie in without the
    /// extension; 0 where nothing is compressed.
    pub(crate) fn finish(self, root: &mut Root, bytes: &mut Vec<u8>) -> usize {
        let mut fallback = 0;
        for group in self.groups {
            let offset = bytes.len();
            let view = &mut root.buffer_views[group.view.value()];
            let plain = View {
                byte_length: USize64::from(group.decoded.len()),
                byte_offset: (offset > 0).then(|| USize64::from(offset)),
                ..view.clone()
            };
            let packed = group.coded().map(|(stride, coded)| {
                let entry = group.entry(view, (stride, coded.len()), offset, fallback);
                (entry, coded)
            });
            let packed = packed.filter(|(entry, coded)| {
                cost(entry, coded.len()) < cost(&plain, group.decoded.len())
            });
            match packed {
                Some((entry, coded)) => {
                    fallback += (entry.byte_length.0 as usize).next_multiple_of(4);
                    bytes.extend(coded);
                    *view = entry;
                }
                None => {
                    bytes.extend(group.decoded);
                    *view = plain;
                }
            }
            bytes.resize(bytes.len().next_multiple_of(4), 0);
        }
        fallback
    }
}

impl Group {
    /// Its elements' size as they are coded, and their bytes then.
    fn coded(&self) -> Option<(usize, Vec<u8>)> {
        let Kind { mode, stride, .. } = self.kind;
        match mode {
            Mode::Attributes if self.keys => best(self.kind, &self.stored),
            Mode::Attributes => Some((stride, codec::encode(&self.stored, stride)?)),
            _ => Some((
                stride,
                codec::encode_triangles(&indices(&self.stored, stride))?,
            )),
        }
    }

    /// Its entry where it is compressed: `coded` are the size of its elements and its bytes, which lie from `offset` on;
    /// in the buffer that nobody needs it lies from `fallback` on.
    fn entry(&self, view: &View, coded: (usize, usize), offset: usize, fallback: usize) -> View {
        let Kind { mode, filter, .. } = self.kind;
        let (stride, length) = coded;
        // What is coded in larger elements than it has is padded to whole ones.
        let decoded = self.decoded.len().next_multiple_of(stride);
        let mut how = json!({
            "buffer": 0,
            "byteOffset": offset,
            "byteLength": length,
            "byteStride": stride,
            "count": decoded / stride,
            "mode": mode.name(),
        });
        if filter != Filter::None {
            how["filter"] = filter.name().into();
        }
        View {
            buffer: Index::new(1),
            byte_length: USize64::from(decoded),
            byte_offset: (fallback > 0).then(|| USize64::from(fallback)),
            extensions: Some(extensions::buffer::View { others: named(how) }),
            ..view.clone()
        }
    }
}

/// Bytes in the file of a view with this entry: its own, to a multiple of four, and those of the entry's text.
fn cost(entry: &View, bytes: usize) -> usize {
    let text = serde_json::to_vec(entry).map_or(0, |text| text.len());
    text + bytes.next_multiple_of(4)
}

/// Extensions of one entry: this one.
pub(crate) fn named(value: Value) -> Map<String, Value> {
    Map::from_iter([(NAME.to_owned(), value)])
}

/// Bytes that numbers of clips come to, in views of their own, each compressed where its bytes are fewer then. What the
/// document says of views is not in it: clips have them in common, and the whole file is looked at in the end.
pub(crate) fn size<'a>(all: impl Iterator<Item = &'a Numbers>) -> usize {
    let mut groups: BTreeMap<Kind, Vec<u8>> = BTreeMap::new();
    let mut size = 0;
    let mut exponential = Vec::new();
    for numbers in all {
        match stored(numbers, false) {
            Some(made) => {
                if made.kind.filter == Filter::Exponential && exponential.len() <= SMALL {
                    exponential.extend(&made.stored);
                }
                groups.entry(made.kind).or_default().extend(made.stored);
            }
            None => size += numbers.bytes.len(),
        }
    }
    let coded = |kind: Kind, bytes: &[u8]| {
        let coded = best(kind, bytes).map_or(usize::MAX, |(_, coded)| coded.len());
        coded.min(bytes.len())
    };
    let (mut apart, mut other) = (0, 0);
    for (kind, bytes) in &groups {
        match kind.filter {
            Filter::Exponential => apart += coded(*kind, bytes),
            _ => other += coded(*kind, bytes),
        }
    }
    if (1..=SMALL).contains(&exponential.len()) {
        let kind = Kind {
            mode: Mode::Attributes,
            filter: Filter::Exponential,
            stride: 4,
        };
        apart = apart.min(coded(kind, &exponential));
    }
    size + apart + other
}

/// Views of so many bytes are worth looking at in several ways: what a view costs by itself counts there.
const SMALL: usize = 4096;

/// The elements in which bytes are smallest, and what they are then. The exponential filter does not care how
/// many numbers an element has.
fn best(kind: Kind, bytes: &[u8]) -> Option<(usize, Vec<u8>)> {
    let own = codec::encode(bytes, kind.stride).map(|coded| (kind.stride, coded));
    if kind.filter != Filter::Exponential || bytes.len() > SMALL {
        return own;
    }
    let others = [4, 12, 16].into_iter().filter_map(|stride| {
        let mut padded = bytes.to_vec();
        padded.resize(bytes.len().next_multiple_of(stride), 0);
        codec::encode(&padded, stride).map(|coded| (stride, coded))
    });
    own.into_iter()
        .chain(others)
        .min_by_key(|(_, coded)| coded.len())
}

/// The way to keep numbers; `None` where the codec has none.
fn stored(numbers: &Numbers, triangles: bool) -> Option<Stored> {
    let size = numbers.component.size();
    // What repeats with every key of a clip is one element, though an accessor has more.
    let whole = numbers.period * size;
    let sound = |bytes: usize| bytes.is_multiple_of(4) && (4..=256).contains(&bytes);
    let of = |mode, filter, stride: usize, stored: Vec<u8>| Stored {
        kind: Kind {
            mode,
            filter,
            stride,
        },
        stored,
        decoded: numbers.bytes.clone(),
    };
    let plain = || numbers.bytes.clone();
    if triangles {
        let made = of(Mode::Triangles, Filter::None, size, plain());
        return numbers.count.is_multiple_of(3).then_some(made);
    }
    match (numbers.component, numbers.shape) {
        (ComponentType::I16, Type::Vec4) if numbers.period == 4 => {
            Some(match quaternions(&numbers.bytes) {
                Some(stored) => of(Mode::Attributes, Filter::Quaternion, 8, stored),
                None => of(Mode::Attributes, Filter::None, 8, plain()),
            })
        }
        (ComponentType::F32, _) => {
            let period = if sound(whole) { numbers.period } else { 1 };
            let four = numbers.bytes.as_chunks().0.iter();
            let floats: Vec<f32> = four.map(|b| f32::from_le_bytes(*b)).collect();
            Some(match codec::exponential(&floats, period) {
                Some(stored) => {
                    let stored = stored.iter().flat_map(|x| x.to_le_bytes()).collect();
                    of(Mode::Attributes, Filter::Exponential, period * 4, stored)
                }
                None => of(Mode::Attributes, Filter::None, period * 4, plain()),
            })
        }
        _ if sound(whole) => Some(of(Mode::Attributes, Filter::None, whole, plain())),
        _ => None,
    }
}

/// What the filter for quaternions makes into these 16-bit integers; `None` where nothing does.
fn quaternions(bytes: &[u8]) -> Option<Vec<u8>> {
    let all: Vec<[i16; 4]> = bytes
        .as_chunks::<8>()
        .0
        .iter()
        .map(|b| [0, 2, 4, 6].map(|i| i16::from_le_bytes([b[i], b[i + 1]])))
        .collect();
    (4..=15).find_map(|bits| {
        let mut out = Vec::with_capacity(bytes.len());
        for q in &all {
            let (stored, back) = codec::quaternion_of_bits(q.map(|x| f64::from(x) / 32767.0), bits);
            if back != *q {
                return None;
            }
            out.extend(stored.iter().flat_map(|x| x.to_le_bytes()));
        }
        Some(out)
    })
}

fn indices(bytes: &[u8], size: usize) -> Vec<u32> {
    match size {
        2 => {
            let two = bytes.as_chunks::<2>().0;
            two.iter()
                .map(|b| u32::from(u16::from_le_bytes(*b)))
                .collect()
        }
        _ => {
            let four = bytes.as_chunks::<4>().0;
            four.iter().map(|b| u32::from_le_bytes(*b)).collect()
        }
    }
}

#[cfg(all(test, feature = "meshopt"))]
mod tests {
    use super::*;
    use crate::write::buffer::{Buffer, Use};

    /// The view of equally spaced times, and the bytes of it and of its entry.
    fn made(count: usize, mut buffer: Buffer) -> (View, usize) {
        let times: Vec<[f32; 1]> = (0..count).map(|i| [i as f32 / 32.0]).collect();
        let mut root = Root::default();
        buffer.accessor(&mut root, &Numbers::bounded(&times), Use::Keys);
        let (bytes, _) = buffer.finish(&mut root);
        let view = root.buffer_views.remove(0);
        let cost = cost(&view, bytes.len());
        (view, cost)
    }

    #[test]
    fn a_view_is_compressed_where_that_pays_for_what_is_said_of_it() {
        let mut kinds = Vec::new();
        for count in [2, 30, 60, 70, 80, 90, 100, 120, 200, 1000] {
            let (_, plain) = made(count, Buffer::default());
            let (view, packed) = made(count, Buffer::compressed(false));
            assert!(packed <= plain, "{count}: {packed} bytes, {plain} plain");
            let is_packed = view.extensions.is_some();
            assert_eq!(view.buffer.value(), usize::from(is_packed));
            assert_eq!(is_packed, packed < plain, "{count}");
            kinds.push(is_packed);
        }
        assert!(!kinds[0] && kinds[9] && kinds.is_sorted(), "{kinds:?}");
    }
}
