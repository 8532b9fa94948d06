//! The binary buffer, its views and accessors.

use super::compress::Packing;
use gltf_json::accessor::{ComponentType, GenericComponentType, Type};
use gltf_json::buffer::{Target, View};
use gltf_json::validation::{Checked, USize64};
use gltf_json::{Accessor, Index, Root, Value};
use std::collections::BTreeMap;

/// What a view is for.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Use {
    Vertices,
    Indices,
    /// Keys and their times.
    Keys,
    Other,
}

/// A buffer in the making. Accessors of equal contents are made once.
#[derive(Default)]
pub(crate) struct Buffer {
    pub(crate) bytes: Vec<u8>,
    known: BTreeMap<(u64, usize, u32, u8, bool), Index<Accessor>>,
    /// Where views are to be compressed, those that wait for it.
    packing: Option<Packing>,
}

/// Numbers as an accessor holds them.
pub(crate) struct Numbers {
    pub(crate) bytes: Vec<u8>,
    pub(crate) component: ComponentType,
    pub(crate) shape: Type,
    pub(crate) count: usize,
    pub(crate) normalised: bool,
    /// Numbers, each of its own kind, that come again and again: those of an element, or of a key.
    pub(crate) period: usize,
    /// Least and greatest of each component, where the specification wants them.
    pub(crate) bounds: Option<(Vec<f32>, Vec<f32>)>,
}

impl Numbers {
    /// Floats in groups of `N`.
    pub(crate) fn floats<const N: usize>(values: &[[f32; N]]) -> Self {
        Self {
            bytes: values
                .iter()
                .flatten()
                .flat_map(|x| x.to_le_bytes())
                .collect(),
            component: ComponentType::F32,
            shape: match N {
                1 => Type::Scalar,
                2 => Type::Vec2,
                3 => Type::Vec3,
                4 => Type::Vec4,
                _ => Type::Mat4,
            },
            count: values.len(),
            normalised: false,
            period: N,
            bounds: None,
        }
    }

    /// With the bounds that positions and times need.
    pub(crate) fn bounded<const N: usize>(values: &[[f32; N]]) -> Self {
        let mut low = vec![f32::INFINITY; N];
        let mut high = vec![f32::NEG_INFINITY; N];
        for value in values {
            for i in 0..N {
                low[i] = low[i].min(value[i]);
                high[i] = high[i].max(value[i]);
            }
        }
        Self {
            bounds: Some((low, high)),
            ..Self::floats(values)
        }
    }
}

impl Buffer {
    /// An accessor of `numbers`; the same one for the same numbers.
    pub(crate) fn accessor(
        &mut self,
        root: &mut Root,
        numbers: &Numbers,
        of: Use,
    ) -> Index<Accessor> {
        let key = (
            fnv(&numbers.bytes),
            numbers.bytes.len(),
            numbers.component.as_gl_enum(),
            numbers.shape.multiplicity() as u8,
            of == Use::Indices,
        );
        // Equal hashes of equal length are looked at before they are believed.
        if let Some(&known) = self.known.get(&key)
            && self.holds(root, known, numbers)
        {
            return known;
        }
        let (view, offset) = self.place(root, numbers, of);
        let bound = |values: &Vec<f32>| Value::from(values.clone());
        let accessor = root.push(Accessor {
            buffer_view: Some(view),
            byte_offset: (offset > 0).then(|| USize64::from(offset)),
            count: USize64::from(numbers.count),
            component_type: Checked::Valid(GenericComponentType(numbers.component)),
            extensions: None,
            extras: None,
            type_: Checked::Valid(numbers.shape),
            min: numbers.bounds.as_ref().map(|(low, _)| bound(low)),
            max: numbers.bounds.as_ref().map(|(_, high)| bound(high)),
            name: None,
            normalized: numbers.normalised,
            sparse: None,
        });
        self.known.insert(key, accessor);
        accessor
    }

    /// Whose views are compressed in the end, those of clips in one or in several.
    pub(crate) fn compressed(merged: bool) -> Self {
        Self {
            packing: Some(Packing::new(merged)),
            ..Self::default()
        }
    }

    /// Where numbers are kept: a view and an offset into it.
    fn place(&mut self, root: &mut Root, numbers: &Numbers, of: Use) -> (Index<View>, usize) {
        let placed = self.packing.as_mut().and_then(|packing| {
            let view = self::view(numbers.bytes.len(), None, of);
            packing.take(root, numbers, of == Use::Indices, of == Use::Keys, view)
        });
        placed.unwrap_or_else(|| (self.view(root, &numbers.bytes, of), 0))
    }

    /// A view of bytes, at a multiple of four.
    pub(crate) fn view(&mut self, root: &mut Root, bytes: &[u8], of: Use) -> Index<View> {
        let offset = self.bytes.len();
        self.bytes.extend_from_slice(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let offset = (offset > 0).then(|| USize64::from(offset));
        root.push(self::view(bytes.len(), offset, of))
    }

    /// All bytes, and how long the buffer of those is that a reader without the extension would miss.
    pub(crate) fn finish(mut self, root: &mut Root) -> (Vec<u8>, usize) {
        let fallback = self
            .packing
            .take()
            .map_or(0, |packing| packing.finish(root, &mut self.bytes));
        (self.bytes, fallback)
    }

    fn holds(&self, root: &Root, accessor: Index<Accessor>, numbers: &Numbers) -> bool {
        let accessor = &root.accessors[accessor.value()];
        let Some(number) = accessor.buffer_view else {
            return false;
        };
        let offset = |offset: Option<USize64>| offset.map_or(0, |offset| offset.0 as usize);
        let packed = self
            .packing
            .as_ref()
            .and_then(|packing| packing.decoded(number));
        let begin = match packed {
            Some(_) => offset(accessor.byte_offset),
            None => offset(root.buffer_views[number.value()].byte_offset),
        };
        let there = packed.unwrap_or(&self.bytes).get(begin..);
        accessor.normalized == numbers.normalised
            && accessor.min.is_some() == numbers.bounds.is_some()
            && there.is_some_and(|there| there.starts_with(&numbers.bytes))
    }
}

/// The entry of a view.
fn view(bytes: usize, offset: Option<USize64>, of: Use) -> View {
    View {
        buffer: Index::new(0),
        byte_length: USize64::from(bytes),
        byte_offset: offset,
        byte_stride: None,
        extensions: None,
        extras: None,
        name: None,
        target: match of {
            Use::Vertices => Some(Checked::Valid(Target::ArrayBuffer)),
            Use::Indices => Some(Checked::Valid(Target::ElementArrayBuffer)),
            Use::Keys | Use::Other => None,
        },
    }
}

/// FNV-1a, 64 bits, over words of eight bytes for speed.
fn fnv(bytes: &[u8]) -> u64 {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    let mut mix = |word: u64| {
        hash = (hash ^ word)
            .wrapping_mul(0x0000_0100_0000_01b3)
            .rotate_left(23)
    };
    let mut words = bytes.chunks_exact(8);
    for word in &mut words {
        mix(u64::from_le_bytes(
            word.try_into().expect("chunks of eight"),
        ));
    }
    for &byte in words.remainder() {
        mix(u64::from(byte));
    }
    hash
}
