//! What a frame says of the light from everywhere, how far that is from the truth, and the time of it.

use std::time::Instant;

use bevy::prelude::*;
use bevy::render::renderer::RenderAdapterInfo;
use dolomite_testkit::cores::processor_time;
use dolomite_testkit::light::{self, occlusion};

use super::settings::By;

/// The share of the light from everywhere of each pixel; `None` where nothing is seen.
pub fn drawn(app: &mut App, camera: Entity, by: By, radius: f32) -> Vec<Option<f64>> {
    by.without().put(app, camera, radius);
    let without = light::picture(app, camera, 3);
    by.put(app, camera, radius);
    let with = light::picture(app, camera, 3);
    light::keep(&with, 0.5, &format!("occlusion-{by:?}-{radius}"));
    occlusion::shares(&with, &without)
}

/// Errors of pixels, counted together.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Errors {
    pixels: usize,
    sum: f64,
    squares: f64,
    most: f64,
}

impl Errors {
    /// Counts the pixels of a frame.
    pub fn add(&mut self, drawn: &[Option<f64>], truth: &[Option<f64>]) {
        for (drawn, truth) in drawn.iter().zip(truth) {
            if let (Some(drawn), Some(truth)) = (drawn, truth) {
                let off = drawn - truth;
                self.pixels += 1;
                self.sum += off;
                self.squares += off * off;
                self.most = self.most.max(off.abs());
            }
        }
    }

    /// Root of the mean square.
    pub fn rmse(&self) -> f64 {
        (self.squares / self.pixels as f64).sqrt()
    }

    /// The mean; above 0 is too light.
    pub fn bias(&self) -> f64 {
        self.sum / self.pixels as f64
    }

    /// The largest.
    pub const fn most(&self) -> f64 {
        self.most
    }
}

/// Medians of what each adds to the time of a frame, milliseconds. All take turns, so that what else the machine does
/// meets all of them; where the adapter is a program on the processor, it is the processor's time.
pub fn times(app: &mut App, camera: Entity, all: &[By], radius: f32, repeats: usize) -> Vec<f64> {
    let info = app.world().resource::<RenderAdapterInfo>();
    let software = info.device_type == wgpu::DeviceType::Cpu;
    let mut taken = vec![Vec::new(); all.len()];
    for _ in 0..repeats.max(1) {
        for (by, taken) in all.iter().zip(&mut taken) {
            let mut time = |by: By| {
                by.put(app, camera, radius);
                light::frames(app, 3);
                let start = Instant::now();
                let before = processor_time(start);
                light::frames(app, 2);
                let spent = if software {
                    processor_time(start) - before
                } else {
                    start.elapsed()
                };
                spent.as_secs_f64() * 1e3 / 2.0
            };
            let without = time(by.without());
            taken.push(time(*by) - without);
        }
    }
    taken
        .iter_mut()
        .map(|times| {
            times.sort_by(f64::total_cmp);
            times[times.len() / 2]
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_those_of_pixels_that_both_have() {
        let mut errors = Errors::default();
        errors.add(
            &[Some(1.0), None, Some(0.25)],
            &[Some(0.5), Some(1.0), None],
        );
        errors.add(&[Some(0.5)], &[Some(0.75)]);
        assert_eq!(errors.bias(), 0.125);
        assert_eq!(errors.rmse(), (0.3125_f64 / 2.0).sqrt());
        assert_eq!(errors.most(), 0.5);
    }
}
