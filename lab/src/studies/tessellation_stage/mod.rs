//! Study `tessellation-stage`: what is asked of the tessellation stage as a whole, number by number:
//! cracks, background pixels, rest, shadow views, bytes.
//!
//! | module | what |
//! |---|---|
//! | [`cracks`] | pairs of patches with a side in common, bit by bit |
//! | [`pairs`], [`cpu`], [`adapter`], [`seam`] | the pairs; what the CPU reference and the adapter emit for them; whether it meets |
//! | [`frames`] | background pixels around a camera inside of closed surfaces |
//! | [`shadows`], [`gbuffer`], [`scene`] | frames with shadow views; their draws; what is drawn |
//! | [`bytes`] | bytes a triangle over the level |
//! | [`functions`] | the WGSL functions that the stage is run with |
//! | [`report`] | sections, rows, figures |

pub mod adapter;
pub mod bytes;
pub mod cpu;
pub mod cracks;
pub mod frames;
pub mod functions;
pub mod gbuffer;
pub mod pairs;
pub mod report;
pub mod scene;
pub mod seam;
pub mod shadows;
pub mod tally;

use crate::study::{Options, Report, Study};
use dolomite_testkit::gpu::Gpu;
use report::Section;

/// As the command line knows it.
pub const STUDY: Study = Study {
    name: "tessellation-stage",
    about: "cracks, background pixels, shadow views, bytes a triangle; how each can fail",
    run,
    asked: &[],
};

fn run(options: &Options) -> Report {
    let (gpu, missing) = match Gpu::new() {
        Ok(gpu) => (Some(gpu), None),
        Err(reason) => (None, Some(reason.to_string())),
    };
    let gpu = gpu.as_ref();
    // Times last: what is measured then shares the machine with nothing of ours.
    let sections = vec![
        cracks::run(options, gpu),
        frames::run(options, gpu),
        unchanged(),
        bytes::run(gpu),
        shadows::run(options, gpu),
    ];
    let mut report = report::report(STUDY.name, gpu.map(|gpu| gpu.name.as_str()), sections);
    report
        .notes
        .extend(missing.map(|reason| format!("No adapter: {reason}")));
    report
}

/// Rest is decided by the plugin's Bevy systems, which the lab is built without: a test counts it.
fn unchanged() -> Section {
    let mut section = Section::open(
        "unchanged",
        "0 dispatches while patches and view are unchanged",
    );
    section.details = serde_json::json!({
        "counted_by": "cargo nextest run -p dolomite_game stage::what_is_not_there_costs_nothing",
    });
    section.notes.push(
        "Not measured here: whether anything is dispatched is decided by the plugin's systems in \
         Bevy's renderer, which the lab is built without. tests/all/stage.rs \
         (what_is_not_there_costs_nothing_and_what_rests_is_not_done_again) counts it in an app."
            .into(),
    );
    section
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::Value;

    #[test]
    fn what_is_not_measured_is_not_claimed() {
        let report = report::report("x", None, vec![unchanged()]);
        let section = &report.summary["unchanged"];
        assert_eq!(
            (&section["reached"], &section["holds"]),
            (&Value::Null, &Value::Null)
        );
        assert!(
            report
                .notes
                .iter()
                .any(|note| note.contains("tests/all/stage.rs"))
        );
    }

    /// Without an adapter the CPU reference's cracks are what is left.
    #[test]
    fn cracks_are_found_without_an_adapter() {
        let options = Options {
            samples: 2400,
            ..Options::default()
        };
        let section = cracks::run(&options, None);
        assert_eq!(section.reached, 0);
        let cpu = &section.details["cpu"];
        assert_eq!(cpu["shared"]["pairs"], 2400);
        assert!(cpu["shared"]["vertices"].as_u64() > Some(20_000), "{cpu}");
        assert!(
            cpu["not_shared_own_levels"]["pairs_with_other_bits"].as_u64() > Some(60),
            "{cpu}"
        );
        assert_eq!(cpu["not_shared_own_levels"]["pairs"], 156);
        assert!(section.figures.len() == 1 && section.details["adapter"].is_null());
    }
}
