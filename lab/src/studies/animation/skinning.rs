//! Skinning from a crowd's palette: the GPU against the CPU reference in f32, and against f64.

use super::model::Model;
use crate::csv::Row;
use crate::study::Options;
use dolomite_character::crowd::Palette;
use dolomite_testkit::gpu::Gpu;
use dolomite_testkit::metrics::ErrorStats;
use dolomite_testkit::skinning::{Probe, SkinningError};

/// Frames of the palette a second.
const RATE: f32 = 30.0;

/// Two rows: GPU against CPU, and against f64.
///
/// # Errors
/// [`SkinningError`]: without an adapter there is nothing to measure.
pub fn rows(model: &Model, options: &Options) -> Result<Vec<Row>, SkinningError> {
    let probe = Probe::new(Gpu::new()?)?;
    let clips: Vec<usize> = (0..model.rig.clips.len()).collect();
    let palette = Palette::bake(&model.rig, 0, &clips, RATE)?;
    let distances = probe.measure(&palette, &model.rig.meshes, options.seed)?;
    let row = |quantity: &str, errors: Vec<f64>| Row {
        sweep: "skinning".into(),
        method: "ours (WGSL)".into(),
        parameter: "vertices".into(),
        parameter_value: errors.len() as f64,
        quantity: quantity.into(),
        error: ErrorStats::of(errors).map(Into::into),
        error_unit: "m".into(),
        time_ns: None,
        bytes: Some(palette.bytes()),
        vertices: None,
        hash: None,
        device: probe.device().into(),
    };
    Ok(vec![
        row("GPU against CPU", distances.reference),
        row("GPU against f64", distances.exact),
    ])
}
