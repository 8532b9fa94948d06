//! The codec of `EXT_meshopt_compression`: bytes of a buffer view in, fewer bytes out, and back.
//!
//! What the extension calls modes and filters is Arseny Kapoulkine's meshoptimizer, which is called here and
//! nowhere else. Everything but the two filters for unit vectors gives back what was put in. Whatever
//! comes from a file is looked at before the decoder sees it, so that no lying number costs memory or
//! trips it. Without the feature `meshopt` nothing is encoded and nothing decoded.

#[cfg(feature = "meshopt")]
mod by_meshopt;
mod filters;
mod layout;
#[cfg(all(test, feature = "meshopt"))]
mod tests;
#[cfg(not(feature = "meshopt"))]
mod without;

#[cfg(feature = "meshopt")]
use by_meshopt as coder;
#[cfg(not(feature = "meshopt"))]
use without as coder;

pub(crate) use coder::{encode, encode_triangles, fast_order};
pub(crate) use filters::{exponent_below, exponential, power, quaternion_of_bits};
pub(crate) use layout::{Filter, Layout, Mode};

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
    coder::decode(coded, layout).ok_or("compressed data that is broken")
}
