//! How long a conversion takes beside ufbx's loading of the same bytes.

use dolomite_fbx::check::Truth;
use dolomite_fbx::{Options, Origin, convert};
use std::path::Path;
use std::time::Instant;

/// Medians of `repeats` runs each, milliseconds: the conversion from bytes to bytes, and ufbx's
/// loading alone. 0 where the file cannot be read.
pub(super) fn timed(path: &Path, repeats: usize) -> (f64, f64) {
    let Ok(bytes) = std::fs::read(path) else {
        return (0.0, 0.0);
    };
    let origin = Origin {
        name: path.display().to_string(),
        folder: path.parent().map(Path::to_owned),
        ..Origin::default()
    };
    let median = |work: &dyn Fn()| {
        let run = |_| {
            let began = Instant::now();
            work();
            began.elapsed().as_secs_f64() * 1e3
        };
        super::median((0..repeats.max(1)).map(run).collect())
    };
    // Both by turns would be fairer to neither: each finds its own memory warm.
    let whole = median(&|| {
        let made = convert(&bytes, &origin, &Options::default()).and_then(|made| made.to_glb());
        std::hint::black_box(&made);
    });
    let load = median(&|| {
        std::hint::black_box(&Truth::load_alone(&bytes, &origin));
    });
    (whole, load)
}
