//! Study `animation`: skeletons sampled and blended, ours beside other libraries, and skinning on the GPU.
//!
//! How far are joints from where f64 has them, over random moments of all clips? How much does the order of
//! a three-clip blend matter? What does a joint cost when 1000 figures each blend three clips, on one core?
//! And how far is a vertex that the GPU skins from the one that the CPU skins?

pub mod accuracy;
pub mod bevy_baseline;
pub mod blending;
pub mod method;
pub mod model;
pub mod ours;
pub mod report;
pub mod skinning;
pub mod speed;

use crate::study::{Asked, Options, Report, Study};
use method::Method;
use model::Model;

/// As the command line knows it.
pub const STUDY: Study = Study {
    name: "animation",
    about: "clips sampled and blended, and skinning: error against f64, ns a joint, beside other libraries",
    run,
    asked: &ASKED,
};

/// What its measured table says.
const ASKED: [Asked; 9] = [
    Asked {
        what: "Joint positions against f64",
        asked: "≤ 1e-5",
        at: "/joint_error_max_m/ours",
        unit: "m",
    },
    Asked {
        what: "Blends against f64",
        asked: "",
        at: "/blend_error_max_rad/ours",
        unit: "rad",
    },
    Asked {
        what: "Difference between orders of a blend",
        asked: "≤ 1e-5",
        at: "/order_difference_max_rad/ours",
        unit: "rad",
    },
    Asked {
        what: "Difference between orders of a blend, `bevy_animation` 0.19",
        asked: "",
        at: "/order_difference_max_rad/bevy_animation 0.19",
        unit: "rad",
    },
    Asked {
        what: "Time of a joint, three clips each sampled and blended",
        asked: "",
        at: "/ns_per_joint/ours",
        unit: "ns",
    },
    Asked {
        what: "Time of a joint, `bevy_animation` 0.19",
        asked: "",
        at: "/ns_per_joint/bevy_animation 0.19",
        unit: "ns",
    },
    Asked {
        what: "Speed over `bevy_animation` 0.19",
        asked: "≥ 5",
        at: "/time_over_ours/bevy_animation 0.19",
        unit: "ratio",
    },
    Asked {
        what: "GPU skinning against CPU skinning",
        asked: "≤ 1e-5",
        at: "/gpu_skinning_max_m/cpu",
        unit: "m",
    },
    Asked {
        what: "GPU skinning against f64",
        asked: "≤ 1e-5",
        at: "/gpu_skinning_max_m/f64",
        unit: "m",
    },
];

/// Figures of the timed crowd.
pub const FIGURES: usize = 1000;

/// Every method, for blends of these three clips in this order.
fn methods(model: &Model, clips: [usize; 3]) -> Vec<Box<dyn Method>> {
    vec![
        Box::new(ours::Ours::new(model)),
        Box::new(bevy_baseline::Bevy::new(model, clips)),
    ]
}

fn run(options: &Options) -> Report {
    run_with(options, FIGURES)
}

fn run_with(options: &Options, figures: usize) -> Report {
    let (model, mut notes) = Model::load(options.seed);
    notes.extend(report::left_out());
    eprintln!("animation: {}", model.name);
    let mut rows = accuracy::rows(&model, options);
    eprintln!("animation: blends");
    rows.extend(blending::rows(&model, options));
    eprintln!("animation: {figures} figures");
    rows.extend(speed::rows(&model, options, figures));
    eprintln!("animation: skinning");
    match skinning::rows(&model, options) {
        Ok(skinned) => rows.extend(skinned),
        Err(reason) => notes.push(format!("skinning on the GPU is left out: {reason}")),
    }
    report::report(rows, notes, &model, figures)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A small run of the whole study: what is promised of ours holds.
    #[test]
    fn gpu_small_run_holds_what_is_promised() {
        let options = Options {
            samples: 512,
            repeats: 1,
            ..Options::default()
        };
        let report = run_with(&options, 20);
        let summary = &report.summary;
        let number = |path: &str| {
            let value = summary.pointer(path);
            value
                .and_then(|value| value.as_f64())
                .unwrap_or_else(|| panic!("{path}: {summary}"))
        };
        assert!(number("/joint_error_max_m/ours") <= 1e-5);
        assert!(number("/order_difference_max_rad/ours") <= 1e-5);
        assert!(number("/ns_per_joint/ours") > 0.0);
        if summary.pointer("/gpu_skinning_max_m/cpu").is_some() {
            assert!(number("/gpu_skinning_max_m/cpu") <= 1e-5);
            assert!(number("/gpu_skinning_max_m/f64") <= 1e-5);
        } else {
            let reasons = report.notes.join("; ");
            assert!(
                std::env::var_os("CI").is_none(),
                "CI must not skip the GPU: {reasons}"
            );
            eprintln!("skipped: skinning ({reasons})");
        }
        let folder =
            std::env::temp_dir().join(format!("dolomite_lab_animation_{}", std::process::id()));
        assert_eq!(
            report.write(&folder).unwrap().len(),
            1 + report.figures.len()
        );
        std::fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn same_seed_same_hashes() {
        let options = Options {
            samples: 256,
            seed: 3,
            ..Options::default()
        };
        let hashes = || {
            let model = Model::made(options.seed);
            accuracy::rows(&model, &options)
                .iter()
                .map(|row| row.hash)
                .collect::<Vec<_>>()
        };
        assert_eq!(hashes(), hashes());
    }
}
