//! `tessellation --cases FILE.jsonl`: the CPU reference and the WGSL, in both modes, against captures.

use super::cases::{Case, CaseError, read};
use super::check::{Faults, against_capture};
use super::wgsl::{Adapter, AdapterError};
use dolomite_tessellation::{Mode, Tessellator};
use dolomite_testkit::gpu::GpuError;
use serde_json::{Value, json};
use std::path::Path;
use thiserror::Error;

/// Why captures could not be compared.
#[derive(Debug, Error)]
pub enum CaptureError {
    /// The file.
    #[error(transparent)]
    Cases(#[from] CaseError),
    /// No adapter for the WGSL.
    #[error("the WGSL cannot be run: {0}")]
    Adapter(#[from] AdapterError),
    /// A run on the adapter.
    #[error("the WGSL cannot be run: {0}")]
    Gpu(#[from] GpuError),
}

const MODES: [(Mode, &str); 2] = [(Mode::Exact, "exact"), (Mode::D3d, "d3d")];

/// Compares every case of the file; gives one JSON object: `cases`, and for `cpu` and `gpu` the
/// faults of both modes together and of each.
///
/// # Errors
/// [`CaptureError`].
pub fn compare(path: &Path) -> Result<Value, CaptureError> {
    let cases = read(path)?;
    eprintln!("tessellation: {} cases", cases.len());
    let adapter = Adapter::open()?;
    let (mut cpu, mut gpu) = (Summary::default(), Summary::default());
    let mut different_bits = 0;
    for (slot, (mode, name)) in MODES.into_iter().enumerate() {
        eprintln!("tessellation: mode {name}");
        let patches: Vec<_> = cases
            .iter()
            .map(|case| (set(case, mode), case.levels))
            .collect();
        adapter.tessellate(&patches, |k, ours| {
            let (case, (tessellator, levels)) = (&cases[k], &patches[k]);
            let reference = tessellator.tessellate_fixed(levels);
            different_bits += usize::from(reference != ours);
            cpu.0[slot].add(&against_capture(case, mode, &reference));
            gpu.0[slot].add(&against_capture(case, mode, &ours));
        })?;
    }
    Ok(json!({
        "cases": cases.len(),
        "cpu": cpu.to_json(),
        "gpu": gpu.to_json(),
        "cases_with_other_bits_on_the_gpu": different_bits,
        "adapter": adapter.name(),
    }))
}

fn set(case: &Case, mode: Mode) -> Tessellator {
    Tessellator {
        mode,
        ..case.tessellator
    }
}

/// Faults by mode.
#[derive(Default)]
struct Summary([Faults; 2]);

impl Summary {
    fn to_json(&self) -> Value {
        let mut both = self.0[0];
        both.add(&self.0[1]);
        let mut value = json!(both);
        for ((_, name), faults) in MODES.iter().zip(&self.0) {
            value[name] = json!(faults);
        }
        value
    }
}
