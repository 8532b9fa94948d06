//! Ranges that several parts agree on.

/// The bed of water deeper than this cannot be seen, metres: the surface above it is flat.
pub const OPAQUE_DEPTH: f32 = 12.0;

/// Depth below the sea that a vertex can carry either way, metres.
pub const DEPTH_RANGE: f32 = 32.0;

/// A number within its range; `default` for what is no number.
pub(crate) fn within(value: f32, low: f32, high: f32, default: f32) -> f32 {
    if value.is_nan() {
        default
    } else {
        value.clamp(low, high)
    }
}
