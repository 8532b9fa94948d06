//! Without meshoptimizer nothing is encoded and nothing decoded.

use super::layout::Layout;

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
