//! Study `city`: what the city promises, counted: bits at seams, background pixels, displacement at borders, errors
//! above the tolerance, levels, boxes, tubes, bytes, and the time to make four kilometres squared.

mod frames;
mod levels;
mod numbers;
mod uniform;

use dolomite_city::CityRules;
use dolomite_city::maps::maps;
use dolomite_testkit::gpu::Gpu;
use serde_json::json;

use crate::study::{Asked, Options, Report, Study};
use numbers::{Effort, numbers, patches};

/// As the command line knows it.
pub const STUDY: Study = Study {
    name: "city",
    about: "a city by its rules: seams, background pixels, errors, levels, boxes, tubes, bytes, time to make",
    run,
    asked: &ASKED,
};

const ASKED: [Asked; 21] = [
    asked("Blocks of 4 × 4 km", "15 625", "/blocks", ""),
    asked("Lamps of them", "67 000", "/lamps", ""),
    asked("Made by one thread", "≤ 50", "/make_ms", "ms"),
    asked(
        "Made by one thread, time on its core",
        "≤ 50",
        "/make_core_ms",
        "ms",
    ),
    asked(
        "Blocks that are other ones in another order",
        "0",
        "/order_differs",
        "",
    ),
    asked(
        "Differing bits of points on facing sides",
        "0",
        "/seams/differing_bits",
        "",
    ),
    asked("Points on facing sides", "≥ 1e6", "/seams/points", ""),
    asked(
        "Background pixels over a sentinel",
        "0",
        "/background/background_pixels",
        "",
    ),
    asked("Frames of that", "1 000", "/background/frames", ""),
    asked(
        "Background pixels with a patch taken out",
        "above 0",
        "/background/patch_taken_out/background_pixels",
        "",
    ),
    asked(
        "Points of borders that are displaced",
        "0",
        "/borders/displaced",
        "",
    ),
    asked(
        "Points of borders where displacement has a slope",
        "0",
        "/borders/sloped",
        "",
    ),
    asked(
        "Samples above the tolerance, of 0.5, 1, 2 and 4 pixels",
        "0",
        "/error_above_tolerance",
        "",
    ),
    asked("Samples of that", "≥ 1e7", "/error_samples", ""),
    asked(
        "Levels by distance whose bits are not the shader's",
        "0",
        "/levels/differing_from_the_shader",
        "",
    ),
    asked(
        "Levels by distance beside the formulas in f64, largest error",
        "",
        "/levels/largest_error",
        "ratio",
    ),
    asked(
        "Normals beside differences in f64, largest angle",
        "≤ 0.1",
        "/normals_deg",
        "°",
    ),
    asked(
        "Displaced vertices outside of boxes",
        "0",
        "/boxes/outside",
        "",
    ),
    asked("Twist of a post", "≤ 0.1", "/tubes/twist_deg", "°"),
    asked(
        "Bytes of a block's record",
        "≤ 64",
        "/bytes/block_record",
        "B",
    ),
    asked(
        "Bytes of a near block on the GPU",
        "≤ 1 100",
        "/bytes/near_block_on_gpu",
        "B",
    ),
];

const fn asked(
    what: &'static str,
    asked: &'static str,
    at: &'static str,
    unit: &'static str,
) -> Asked {
    Asked {
        what,
        asked,
        at,
        unit,
    }
}

fn run(options: &Options) -> Report {
    let effort = Effort {
        sides: options.count.unwrap_or(1_000_000),
        samples: options.count.unwrap_or(2_500_000),
        repeats: options.repeats,
    };
    let mut notes = vec![
        "Errors are those of rectangles that the stage's greatest level, 64, does not cut off; how many it cuts off is \
         counted beside them."
            .to_owned(),
        "Background: the ground alone from above, and buildings from within, without depth, over a sentinel. Levels by \
         distance are a baseline of their own there: the two faces of an edge may have other levels."
            .to_owned(),
    ];
    let mut summary = numbers(options.seed, effort);
    let rules = CityRules {
        seed: options.seed,
        ..CityRules::default()
    };
    let maps = maps();
    let gpu = Gpu::new();
    if let Err(reason) = &gpu {
        notes.push(format!("Nothing was drawn: {reason}"));
    }
    let gpu = gpu.ok();
    let count = options.count.unwrap_or(100_000).min(100_000);
    match levels::levels(gpu.as_ref(), &rules, &maps, &patches(&rules, &maps), count) {
        Ok(levels) => summary["levels"] = levels,
        Err(reason) => notes.push(format!("Levels were not compared: {reason}")),
    }
    if let Some(gpu) = &gpu {
        // Three of four are by a bound or of one level, and count.
        let frames = options.frames.div_ceil(3) * 4;
        match frames::frames(gpu, &rules, &maps, options.seed, frames) {
            Ok(background) => summary["background"] = background,
            Err(reason) => notes.push(format!("Background was not counted: {reason}")),
        }
    }
    summary["adapter"] = json!(gpu.map(|gpu| gpu.name));
    Report {
        study: STUDY.name,
        rows: Vec::new(),
        figures: Vec::new(),
        notes,
        summary,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gpu_what_is_promised_is_kept() {
        let options = Options {
            count: Some(40_000),
            repeats: 3,
            frames: 24,
            ..Options::default()
        };
        let report = run(&options);
        let summary = report.summary;
        for (at, most) in [
            ("/seams/differing_bits", 0.0),
            ("/borders/displaced", 0.0),
            ("/borders/sloped", 0.0),
            ("/error_above_tolerance", 0.0),
            ("/boxes/outside", 0.0),
            ("/order_differs", 0.0),
            ("/tubes/twist_deg", 0.1),
            ("/tubes/not_finite", 0.0),
            ("/bytes/block_record", 64.0),
            ("/normals_deg", 0.1),
            // A handful of roundings of f32.
            ("/levels/largest_error", 1e-5),
        ] {
            let number = summary.pointer(at).and_then(serde_json::Value::as_f64);
            assert!(number.is_some_and(|n| n <= most), "{at}: {number:?}");
        }
        assert_eq!(summary["same_bits"], true);
        assert!(summary["seams"]["points"].as_u64() >= Some(40_000));
        if dolomite_testkit::gpu::for_test().is_none() {
            return;
        }
        assert_eq!(
            summary["levels"]["differing_from_the_shader"], 0,
            "{:?}",
            report.notes
        );
        let background = &summary["background"];
        assert_eq!(background["background_pixels"], 0, "{background}");
        assert!(background["frames"].as_u64() >= Some(24));
        let open = &background["patch_taken_out"]["background_pixels"];
        assert!(open.as_u64() > Some(100), "{background}");
    }
}
