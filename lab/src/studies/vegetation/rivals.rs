//! What others do in place of it: instances placed on the CPU.

use std::hint::black_box;
use std::time::Instant;

use bytemuck::{Zeroable, bytes_of};
use dolomite_terrain::GroundPoint;
use dolomite_testkit::metrics::median;
use dolomite_vegetation::render::layout::{BladeView, GrowParams};
use dolomite_vegetation::render::rings::set_rings;
use dolomite_vegetation::{Growth, Law, Wind, WindField};

/// Blades that are placed.
pub const BLADES: usize = 1_000_000;

pub struct OnCpu {
    pub placed_ms: f64,
    pub placed_bytes: usize,
    pub told_ms: f64,
    pub told_bytes: usize,
}

/// Places a million blades as a list on the CPU, 8 bytes each (x and z, as `warbler_grass` has it; their heights would come
/// from a map). Against it, what the CPU computes and uploads a frame here, whatever the number of blades: rings about the eye
/// and the wind, twice, and a copy of both uniforms. Systems and commands of a frame are not part of either.
pub fn on_the_cpu(growth: Growth, law: Law, repeats: usize) -> OnCpu {
    let timed = |work: &mut dyn FnMut()| {
        let times = (0..repeats.clamp(1, 5)).map(|_| {
            let start = Instant::now();
            work();
            start.elapsed().as_secs_f64() * 1e3
        });
        median(times.collect()).unwrap_or(f64::NAN)
    };
    let mut placed: Vec<[f32; 2]> = Vec::with_capacity(BLADES);
    let placed_ms = timed(&mut || {
        placed.clear();
        let mut k = 0;
        while placed.len() < BLADES {
            let root = growth.lattice.root([k & 2047, k >> 11]);
            if growth.stands(root, 200.0, 0.1) {
                placed.push(growth.lattice.place(root).to_dvec2().as_vec2().to_array());
            }
            k += 1;
        }
        black_box(&placed);
    });
    const FRAMES: usize = 1000;
    let mut params: Box<GrowParams> = Box::new(GrowParams::zeroed());
    let mut view: Box<BladeView> = Box::new(BladeView::zeroed());
    let mut uploaded = vec![0_u8; size_of::<GrowParams>() + size_of::<BladeView>()];
    let told_ms = timed(&mut || {
        for frame in 0..FRAMES {
            let layer = &mut params.layers[0];
            layer.growth = growth;
            layer.reach = law;
            set_rings(layer, [frame as i64, 7], [0.3, -0.6]);
            let field = |time| WindField::new(&Wind::default(), GroundPoint::default(), time);
            view.wind = field(frame as f64);
            view.previous_wind = field(frame as f64 - 0.016);
            let (of_params, of_view) = uploaded.split_at_mut(size_of::<GrowParams>());
            of_params.copy_from_slice(bytes_of(&*params));
            of_view.copy_from_slice(bytes_of(&*view));
            black_box(&uploaded);
        }
    }) / FRAMES as f64;
    OnCpu {
        placed_ms,
        placed_bytes: placed.len() * size_of::<[f32; 2]>(),
        told_ms,
        told_bytes: uploaded.len(),
    }
}
