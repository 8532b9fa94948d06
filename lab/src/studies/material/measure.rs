//! Time and error of each way of shading in one view.

use super::frame::{Daylight, Renderer, Scene, Targets};
use super::views::{Kind, Place};
use super::ways::WAYS;
use crate::scenes::camera::Camera;
use bevy::math::UVec2;
use dolomite_testkit::blocks::BlockError;
use dolomite_testkit::flip;
use dolomite_testkit::metrics::ErrorStats;
use image::RgbImage;
use wgpu::RenderPipeline;

/// Pixels of a frame that is timed.
pub const TIMED: UVec2 = UVec2::new(640, 360);
/// Pixels of a picture that is compared: a hundredth of a display, since the truth has 64 samples for each.
pub const COMPARED: UVec2 = UVec2::new(192, 108);
/// Samples along a side of a pixel of the truth.
pub const ACROSS: u32 = 8;

/// G-buffers for frames that are timed, for pictures, and for their truth.
pub struct Buffers {
    timed: Targets,
    compared: Targets,
    truth: Targets,
}

impl Buffers {
    /// For a device.
    #[must_use]
    pub fn new(gpu: &dolomite_testkit::gpu::Gpu) -> Self {
        Self {
            timed: Targets::new(gpu, TIMED),
            compared: Targets::new(gpu, COMPARED),
            truth: Targets::new(gpu, COMPARED * ACROSS),
        }
    }
}

/// What a way of shading has in a view.
#[derive(Debug, Clone)]
pub struct Measured {
    /// Time of the G-buffer's pass, the median, milliseconds.
    pub ms: f64,
    /// Mean FLIP to the full material at 64 samples a pixel.
    pub flip: f64,
    /// The FLIP that 99 % of the pixels stay at or below.
    pub flip_p99: f64,
    /// Mean FLIP to the full material at one sample a pixel: what the way itself changes.
    pub flip_to_full: f64,
    /// Differences of the colours, linear, as a display shows them: their mean and the rest.
    pub mean_error: f64,
    /// See [`Self::mean_error`].
    pub errors: ErrorStats,
    /// Mean FLIP between pictures that are half a pixel apart.
    pub shimmer: f64,
}

/// A view that was measured.
pub struct Case {
    /// Name of the ground.
    pub place: &'static str,
    /// What is seen.
    pub kind: Kind,
    /// One a way.
    pub ways: Vec<Measured>,
    /// Mean FLIP between truths that are half a pixel apart.
    pub shimmer: f64,
    /// The truth, and each way's picture.
    pub pictures: Vec<RgbImage>,
}

/// Levels of sRGB of linear colours.
fn levels(picture: &[[f32; 4]]) -> RgbImage {
    RgbImage::from_fn(COMPARED.x, COMPARED.y, |x, y| {
        let [r, g, b, _] = picture[(y * COMPARED.x + x) as usize];
        image::Rgb([r, g, b].map(|linear| {
            let encoded = bevy::color::Srgba::gamma_function_inverse(linear.clamp(0.0, 1.0));
            (encoded * 255.0 + 0.5) as u8
        }))
    })
}

/// Differences of the three colours of all pixels.
fn differences(a: &[[f32; 4]], b: &[[f32; 4]]) -> Vec<f64> {
    let colours = |picture: &[[f32; 4]]| {
        let colours = picture.iter().flat_map(|&[r, g, b, _]| [r, g, b]);
        colours.collect::<Vec<f32>>()
    };
    let pairs = colours(a).into_iter().zip(colours(b));
    pairs.map(|(a, b)| f64::from((a - b).abs())).collect()
}

fn flip_of(a: &RgbImage, b: &RgbImage) -> (f64, f64) {
    flip::compare(a, b).map_or((f64::NAN, f64::NAN), |found| {
        (found.flip_mean, found.flip_p99)
    })
}

/// Measures all ways in a view; frames are timed in turns, so that what else the machine does falls on all.
///
/// # Errors
/// [`BlockError`].
pub fn measure(
    renderer: &Renderer<'_>,
    buffers: &Buffers,
    (place, kind, camera): (&Place, Kind, &Camera),
    scene: &Scene,
    pipelines: &[RenderPipeline],
    repeats: usize,
) -> Result<Case, BlockError> {
    let light = match kind {
        Kind::Night => Daylight::Night,
        _ => Daylight::Day,
    };
    let ways = || WAYS.iter().zip(pipelines);
    let full = (&WAYS[0], &pipelines[0]);
    renderer.draw(&buffers.truth, scene, full, (camera, 0.0))?;
    let truth = |shift| renderer.lit(&buffers.truth, scene, (camera, 0.0), (ACROSS, shift), light);
    let (truth, moved) = (truth(0)?, truth(ACROSS / 2)?);
    let reference = levels(&truth);
    let shimmer = flip_of(&levels(&moved), &reference).0;
    let mut times = vec![Vec::new(); WAYS.len()];
    for _ in 0..repeats.max(1) {
        for (of, way) in times.iter_mut().zip(ways()) {
            of.push(renderer.draw(&buffers.timed, scene, way, (camera, 0.0))?);
        }
    }
    let mut pictures = vec![reference];
    let mut measured = Vec::new();
    for (way, mut times) in ways().zip(times) {
        let seen = |moved| {
            renderer.draw(&buffers.compared, scene, way, (camera, moved))?;
            renderer.lit(&buffers.compared, scene, (camera, moved), (1, 0), light)
        };
        let (linear, moved) = (seen(0.0)?, seen(0.5)?);
        let picture = levels(&linear);
        let (flip, flip_p99) = flip_of(&picture, &pictures[0]);
        let flip_to_full = pictures
            .get(1)
            .map_or(0.0, |full| flip_of(&picture, full).0);
        let errors = differences(&linear, &truth);
        times.sort_unstable();
        measured.push(Measured {
            ms: times[times.len() / 2].as_secs_f64() * 1e3,
            flip,
            flip_p99,
            flip_to_full,
            mean_error: errors.iter().sum::<f64>() / errors.len() as f64,
            errors: ErrorStats::of(errors).expect("a picture has pixels"),
            shimmer: flip_of(&levels(&moved), &picture).0,
        });
        pictures.push(picture);
    }
    Ok(Case {
        place: place.name,
        kind,
        ways: measured,
        shimmer,
        pictures,
    })
}
