//! Kira without a device: somebody asks for the samples.

use kira::backend::{Backend, Renderer};
use std::convert::Infallible;
use std::sync::Mutex;

/// Renders when it is asked to, on the thread that asks.
pub struct Offline {
    rate: u32,
    renderer: Option<Mutex<Renderer>>,
}

impl Backend for Offline {
    /// Samples a second.
    type Settings = u32;
    type Error = Infallible;

    fn setup(rate: u32, _: usize) -> Result<(Self, u32), Infallible> {
        let backend = Self {
            rate,
            renderer: None,
        };
        Ok((backend, rate))
    }

    fn start(&mut self, renderer: Renderer) -> Result<(), Infallible> {
        self.renderer = Some(Mutex::new(renderer));
        Ok(())
    }
}

impl Offline {
    /// Samples a second.
    #[must_use]
    pub fn rate(&self) -> u32 {
        self.rate
    }

    /// The next frames, left and right.
    pub fn render(&mut self, frames: usize) -> Vec<[f32; 2]> {
        let mut samples = vec![0.0; 2 * frames];
        if let Some(Ok(renderer)) = self.renderer.as_mut().map(Mutex::get_mut) {
            renderer.on_start_processing();
            renderer.process(&mut samples, 2);
        }
        samples
            .chunks_exact(2)
            .map(|pair| [pair[0], pair[1]])
            .collect()
    }
}
