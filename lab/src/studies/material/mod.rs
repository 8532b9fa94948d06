//! Study `material`: time of the ground's pixels against their error, for each way of shading.

pub mod frame;
pub mod measure;
pub mod report;
pub mod textures;
pub mod views;
pub mod ways;

use crate::study::{Asked, Options, Report, Study};
use dolomite_ground::render::relief::relief_map;
use dolomite_ground::render::{GroundLook, TerrainRelief};
use dolomite_testkit::blocks::BlockError;
use dolomite_testkit::gpu::Gpu;
use frame::Renderer;
use measure::{Buffers, Case, TIMED, measure};
use std::path::Path;
use views::{KINDS, places};
use ways::WAYS;

/// As the command line knows it.
pub const STUDY: Study = Study {
    name: "material",
    about: "the ground's pixels: time of each way of shading against FLIP and error, shimmer",
    run,
    asked: &ASKED,
};

const ASKED: [Asked; 6] = [
    Asked {
        what: "the ground's pixels of the mountain, `Balanced` over `Full`, 640 × 360, mean of six views",
        asked: "≤ 1/5",
        at: "/mountain/Balanced/time_over_full",
        unit: "",
    },
    Asked {
        what: "the same, `Fine` over `Full`",
        asked: "",
        at: "/mountain/Fine/time_over_full",
        unit: "",
    },
    Asked {
        what: "mean FLIP of `Balanced` to `Full` at one sample a pixel, all views",
        asked: "≤ 0.02",
        at: "/all/Balanced/flip_to_full",
        unit: "",
    },
    Asked {
        what: "mean FLIP of `Fine` to `Full` at one sample a pixel, all views",
        asked: "≤ 0.02",
        at: "/all/Fine/flip_to_full",
        unit: "",
    },
    Asked {
        what: "mean FLIP of `Balanced` to `Full` at 64 samples, less that of `Full` itself, all views",
        asked: "≤ 0.02",
        at: "/all/Balanced/flip_over_full",
        unit: "",
    },
    Asked {
        what: "shimmer of `Balanced` over that of `Full`, pictures half a pixel apart, all views",
        asked: "≤ 1",
        at: "/all/Balanced/shimmer_over_full",
        unit: "",
    },
];

/// The ground's triangles are within this of it, pixels of 360 rows.
const ERROR: f32 = 4.0;
/// Texels of a side of a relief map, as the plugin makes it by default.
const RELIEF: u32 = 1024;

fn cases(options: &Options, gpu: &Gpu) -> Result<Vec<Case>, BlockError> {
    let arrays = textures::arrays();
    let renderer = Renderer::new(gpu, [&arrays[0], &arrays[1]]);
    let buffers = Buffers::new(gpu);
    let mut cases = Vec::new();
    for place in places(options.seed) {
        let relief = relief_map(&place.terrain, RELIEF);
        let side = place.terrain.extent().size().max_element();
        let known = TerrainRelief {
            image: bevy::asset::Handle::default(),
            texel: (side / f64::from(RELIEF)) as f32,
            side: RELIEF,
        };
        let sea = place.terrain.sea_level().zip(place.sea);
        let (look, _) = GroundLook::new(&place.material, sea, Some(&known));
        let pipelines = WAYS.iter().map(|way| renderer.pipeline(way, sea.is_some()));
        let pipelines = pipelines.collect::<Result<Vec<_>, _>>()?;
        for kind in KINDS {
            let Some(camera) = place.camera(kind, TIMED, options.seed) else {
                continue;
            };
            let scene = renderer.scene(&place.terrain, &camera, ERROR, &look, &relief)?;
            let view = (&place, kind, &camera);
            // A frame of software takes a second: a third of the repeats of other studies.
            let repeats = options.repeats.div_ceil(3);
            let case = measure(&renderer, &buffers, view, &scene, &pipelines, repeats)?;
            for (way, measured) in WAYS.iter().zip(&case.ways) {
                eprintln!(
                    "{}: {}, {kind:?}, {}: {:.1} ms, FLIP {:.4} ({:.4} to Full), shimmer {:.4} of {:.4}",
                    STUDY.name,
                    place.name,
                    way.name,
                    measured.ms,
                    measured.flip,
                    measured.flip_to_full,
                    measured.shimmer,
                    case.shimmer,
                );
            }
            cases.push(case);
        }
    }
    Ok(cases)
}

/// Writes the pictures, to be looked at.
fn write(cases: &[Case], folder: &Path) {
    let folder = folder.join(STUDY.name);
    for case in cases {
        let names = ["truth"].into_iter().chain(WAYS.iter().map(|way| way.name));
        for (picture, name) in case.pictures.iter().zip(names) {
            let file = format!("{}-{:?}-{name}.png", case.place, case.kind).replace(' ', "-");
            let written = std::fs::create_dir_all(&folder)
                .map_err(image::ImageError::IoError)
                .and_then(|()| picture.save(folder.join(file)));
            if let Err(error) = written {
                eprintln!("{}: {}: {error}", STUDY.name, folder.display());
                return;
            }
        }
    }
}

fn run(options: &Options) -> Report {
    let measured = Gpu::new()
        .map_err(BlockError::from)
        .and_then(|gpu| Ok((cases(options, &gpu)?, gpu.name)));
    match measured {
        Ok((cases, device)) => {
            if let Some(folder) = &options.out {
                write(&cases, folder);
            }
            report::report(STUDY.name, &cases, &device)
        }
        Err(error) => report::none(STUDY.name, &error.to_string()),
    }
}
