//! Tests of deferred lighting, as one program, since each more would link Bevy once more.
//! `cargo nextest run -p dolomite_deferred NAME::` runs one module.

#[cfg(feature = "render")]
mod absent;
#[cfg(feature = "render")]
mod bevys;
#[cfg(feature = "render")]
mod costs;
#[cfg(feature = "render")]
mod example;
#[cfg(feature = "render")]
mod gbuffer;
#[cfg(feature = "render")]
mod hostile;
#[cfg(feature = "render")]
mod mistakes;
#[cfg(feature = "render")]
mod models;
#[cfg(feature = "render")]
#[expect(dead_code, reason = "an app of its own")]
#[path = "../../examples/deferred.rs"]
mod night;
#[cfg(feature = "render")]
mod occlusion;
#[cfg(feature = "render")]
mod oracle;
#[cfg(feature = "render")]
mod orthographic;
#[cfg(feature = "render")]
mod pyramid;
#[cfg(feature = "render")]
mod renderers;
#[cfg(feature = "render")]
mod still;
#[cfg(feature = "render")]
mod ways;
