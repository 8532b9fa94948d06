//! Times of render passes, as Bevy's render diagnostics publish them.
//!
//! A pass publishes `render/<name>/elapsed_gpu` and `render/<name>/elapsed_cpu` in milliseconds,
//! two or three frames after it ran; `<name>` may itself hold slashes where passes are nested.

use bevy::diagnostic::{Diagnostic, DiagnosticsStore};

/// Whose time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clock {
    /// The GPU's, by timestamps.
    Gpu,
    /// The CPU's, for recording the pass.
    Cpu,
}

/// The pass that a diagnostic times by `clock`; `None` for other diagnostics.
pub fn pass_of(diagnostic: &Diagnostic, clock: Clock) -> Option<&str> {
    name_of(diagnostic.path().as_str(), clock)
}

fn name_of(path: &str, clock: Clock) -> Option<&str> {
    let ending = match clock {
        Clock::Gpu => "/elapsed_gpu",
        Clock::Cpu => "/elapsed_cpu",
    };
    path.strip_prefix("render/")?.strip_suffix(ending)
}

/// Every pass with its smoothed time in milliseconds.
pub fn newest(diagnostics: &DiagnosticsStore, clock: Clock) -> Vec<(String, f64)> {
    diagnostics
        .iter()
        .filter_map(|diagnostic| {
            let name = pass_of(diagnostic, clock)?;
            Some((name.to_owned(), diagnostic.smoothed()?))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_times_of_render_passes_are_taken() {
        assert_eq!(
            name_of("render/bloom/elapsed_gpu", Clock::Gpu),
            Some("bloom")
        );
        assert_eq!(name_of("render/a/b/elapsed_cpu", Clock::Cpu), Some("a/b"));
        assert_eq!(name_of("render/bloom/elapsed_gpu", Clock::Cpu), None);
        assert_eq!(
            name_of("render/bloom/fragment_shader_invocations", Clock::Gpu),
            None
        );
        assert_eq!(name_of("fps", Clock::Gpu), None);
    }
}
