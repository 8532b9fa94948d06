//! The direct light of a scene in f64, written from the equations of radiometry and of each shading model, to hold a
//! renderer against.
//!
//! ```text
//! seed -> generate -> Scene -> render (rays, f64) ------------------> Image -+
//!                       |                                                    +-> Ledger: what the frame is off by
//!                       +-> a renderer -> frame ----------------------> Image -+
//!                                     +-> G-buffer, decoded -> shade --------+
//! ```
//!
//! A [`Scene`] is plain data of which both this crate and an app with a renderer are built. Every number of a generated
//! scene is an f32, so nothing is lost on the way.
//!
//! # Conventions
//! Right-handed, +Y up, metres, radians; a camera looks along its −Z. Colours are linear, of Rec. 709 primaries.
//! `n` is the unit normal of the surface, `v` the unit vector to the eye, `l` the unit vector to the light,
//! `h = (l + v) / |l + v|`. The light that arrives is illuminance `E` in lux, a light's intensity `I` is in candela, what
//! leaves is luminance `L` in cd/m², and all of them are a value a colour channel.
//!
//! ```text
//! L(v) = exposure · (Σ_lights f(v, l) (n·l)⁺ E_light + ambient · occlusion) + emissive
//! ```
//!
//! | module | what |
//! |---|---|
//! | [`scene`] | meshes, exact shapes, materials, lights, camera |
//! | [`generate`](mod@generate) | a random scene for each seed; [`hostile`] lights and geometry where they are asked for |
//! | [`light`] | what arrives: attenuation, cones |
//! | [`model`] | what leaves: `StandardMaterial` as Bevy 0.19 documents it, Blinn-Phong and Phong |
//! | [`trace`] | watertight rays against triangles, ellipsoids and planes |
//! | [`shade`] | the sum over the lights at a point, hard shadows by rays, and texels of a decoded G-buffer |
//! | [`occlusion`] | ambient occlusion by rays |
//! | [`render`](mod@render) | an image; lens and shutter |
//! | [`per_pixel`] | the true G-buffer, occlusion, and which ways of a light are free |
//! | [`ledger`] | relative errors, lit pixels missed, FLIP, and the parts that an error is made of |
//! | [`flip`] | LDR-FLIP and HDR-FLIP |
//! | [`quadrature`], [`random`] | integrals, and numbers that come again with their seed |

#![expect(clippy::disallowed_methods, reason = "an oracle in f64")]

pub mod flip;
pub mod generate;
pub mod hostile;
pub mod image;
pub mod ledger;
pub mod light;
pub mod model;
pub mod occlusion;
pub mod per_pixel;
pub mod quadrature;
pub mod random;
pub mod render;
pub mod rows;
pub mod scene;
pub mod shade;
pub mod trace;

pub use generate::{Recipe, generate};
pub use image::Image;
pub use ledger::Ledger;
pub use render::{Options, render};
pub use scene::Scene;
