//! How long a conversion takes beside ufbx's loading of the same bytes.

use dolomite_fbx::check::Truth;
use dolomite_fbx::{Options, Origin, convert};
use std::path::Path;
use std::time::Instant;

/// The least of `repeats` runs each, milliseconds (what else the machine does only adds to a few
/// milliseconds): the conversion from bytes to bytes, and ufbx's
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
    let least = |work: &dyn Fn()| {
        let run = |_| {
            let began = Instant::now();
            work();
            began.elapsed().as_secs_f64() * 1e3
        };
        (0..repeats.max(1)).map(run).fold(f64::INFINITY, f64::min)
    };
    // Both by turns would be fairer to neither: each finds its own memory warm.
    let whole = least(&|| {
        let made = convert(&bytes, &origin, &Options::default()).and_then(|made| made.to_glb());
        std::hint::black_box(&made);
    });
    let load = least(&|| {
        std::hint::black_box(&Truth::load_alone(&bytes, &origin));
    });
    (whole, load)
}
