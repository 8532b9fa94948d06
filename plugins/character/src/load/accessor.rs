//! Numbers out of buffers, every range looked at first.

use super::LoadError;
use gltf::accessor::{Accessor, DataType, Dimensions};

/// Reads `N` floats an element; integers that are normalised become floats as glTF says.
pub(super) fn floats<const N: usize>(
    accessor: &Accessor,
    buffers: &[Vec<u8>],
    of: &'static str,
) -> Result<Vec<[f32; N]>, LoadError> {
    let integers = accessor.normalized();
    if accessor.data_type() != DataType::F32 && !integers {
        return Err(refuse(accessor, of, "integers are not normalised".into()));
    }
    read(accessor, buffers, of, |bytes, kind| {
        number(bytes, kind) as f32
    })
}

/// Reads `N` whole numbers an element, such as joint numbers and indices.
pub(super) fn whole<const N: usize>(
    accessor: &Accessor,
    buffers: &[Vec<u8>],
    of: &'static str,
) -> Result<Vec<[u32; N]>, LoadError> {
    use DataType::{U8, U16, U32};
    if !matches!(accessor.data_type(), U8 | U16 | U32) || accessor.normalized() {
        return Err(refuse(
            accessor,
            of,
            "whole numbers without a sign are needed".into(),
        ));
    }
    read(accessor, buffers, of, |bytes, kind| match kind {
        U8 => u32::from(bytes[0]),
        U16 => u32::from(u16::from_le_bytes([bytes[0], bytes[1]])),
        _ => u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]),
    })
}

/// glTF 2.0, section 3.11: normalised integers.
fn number(bytes: &[u8], kind: DataType) -> f64 {
    match kind {
        DataType::F32 => f64::from(f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]])),
        DataType::I8 => (f64::from(bytes[0] as i8) / 127.0).max(-1.0),
        DataType::U8 => f64::from(bytes[0]) / 255.0,
        DataType::I16 => (f64::from(i16::from_le_bytes([bytes[0], bytes[1]])) / 32_767.0).max(-1.0),
        DataType::U16 => f64::from(u16::from_le_bytes([bytes[0], bytes[1]])) / 65_535.0,
        DataType::U32 => {
            let word = u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
            f64::from(word) / f64::from(u32::MAX)
        }
    }
}

fn refuse(accessor: &Accessor, of: &'static str, reason: String) -> LoadError {
    LoadError::Accessor {
        accessor: accessor.index(),
        of,
        reason,
    }
}

fn read<T: Copy + Default, const N: usize>(
    accessor: &Accessor,
    buffers: &[Vec<u8>],
    of: &'static str,
    convert: impl Fn(&[u8], DataType) -> T,
) -> Result<Vec<[T; N]>, LoadError> {
    let wanted = match N {
        1 => Dimensions::Scalar,
        2 => Dimensions::Vec2,
        3 => Dimensions::Vec3,
        4 => Dimensions::Vec4,
        _ => Dimensions::Mat4,
    };
    if accessor.dimensions() != wanted {
        let reason = format!("{:?} where {wanted:?} is needed", accessor.dimensions());
        return Err(refuse(accessor, of, reason));
    }
    if accessor.sparse().is_some() {
        return Err(refuse(
            accessor,
            of,
            "sparse accessors are not supported".into(),
        ));
    }
    let Some(view) = accessor.view() else {
        return Err(refuse(accessor, of, "it has no buffer view".into()));
    };
    let kind = accessor.data_type();
    let each = kind.size();
    let element = each * N;
    let stride = view.stride().unwrap_or(element);
    let bytes = buffers
        .get(view.buffer().index())
        .and_then(|buffer| buffer.get(view.offset()..view.offset().checked_add(view.length())?))
        .ok_or_else(|| {
            refuse(
                accessor,
                of,
                "its buffer view ends behind its buffer".into(),
            )
        })?;
    let end = accessor
        .count()
        .checked_sub(1)
        .and_then(|last| last.checked_mul(stride))
        .and_then(|last| last.checked_add(accessor.offset())?.checked_add(element));
    if end.is_none_or(|end| end > bytes.len()) || stride < element {
        return Err(refuse(
            accessor,
            of,
            "its elements end behind its buffer view".into(),
        ));
    }
    Ok((0..accessor.count())
        .map(|index| {
            let at = accessor.offset() + index * stride;
            core::array::from_fn(|i| convert(&bytes[at + i * each..][..each], kind))
        })
        .collect())
}
