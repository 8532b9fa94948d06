//! Study `shadow`: is what is drawn dark in a shadow, and what is drawn lit not?
//!
//! Receivers at every angle to a light, near and far, each with a body that blocks the way. A pixel counts as lit where it
//! has more than half of the light that it has without shadows. The truth is a ray in f64; it also knows how many texels of
//! the shadow map around the pixel's own are of the same kind, and pixels nearer to an edge than a band of so many texels
//! are not counted. Wrong pixels are told apart: `dark` are in the light (acne), `lit` are in the shadow (gaps, light that
//! leaks). Lights and their bias are Bevy's defaults; so are the maps' sizes.

mod receiver;

use bevy::light::{
    CascadeShadowConfigBuilder, Cascades, DirectionalLight, PointLight, ShadowFilteringMethod,
    SpotLight,
};
use bevy::prelude::*;
use dolomite_deferred::{DeferredLighting, DeferredPlugin};
use dolomite_light_oracle::per_pixel::{Way, ways_around};
use dolomite_testkit::light::{self, Picture, Spawned};
use serde_json::{Value, json};

use crate::csv::{ErrorNumbers, Row};
use crate::studies::light::way;
use crate::study::{Asked, Options, Report, Study};
use receiver::{KINDS, PIXELS, Receiver};

/// As the command line knows it.
pub const STUDY: Study = Study {
    name: "shadow",
    about: "shadow maps against rays in f64: pixels off the edges that are on the wrong side",
    run,
    asked: &ASKED,
};

/// What its measured table says.
const ASKED: [Asked; 4] = [
    Asked {
        what: "Shadows, pixels farther than 1.5 texels from an edge on the wrong side, Gaussian filter",
        asked: "0",
        at: "/filters/gaussian/wrong",
        unit: "",
    },
    Asked {
        what: "The same by the adapter's filter of 2 × 2",
        asked: "0",
        at: "/filters/hardware/wrong",
        unit: "",
    },
    Asked {
        what: "Pixels that were counted",
        asked: "",
        at: "/filters/gaussian/counted",
        unit: "",
    },
    Asked {
        what: "Receivers",
        asked: "≥ 200",
        at: "/receivers",
        unit: "",
    },
];

/// Receivers of a run.
const RECEIVERS: usize = 200;

/// Texels that an edge may be away at most.
const BANDS: [f64; 9] = [0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0];

/// Index of the band that is asked for.
const ASKED_BAND: usize = 2;

/// Ways of reading the maps.
const FILTERS: [(&str, ShadowFilteringMethod); 2] = [
    ("gaussian", ShadowFilteringMethod::Gaussian),
    ("hardware", ShadowFilteringMethod::Hardware2x2),
];

fn run(options: &Options) -> Report {
    let mut report = Report {
        study: STUDY.name,
        rows: Vec::new(),
        figures: Vec::new(),
        notes: Vec::new(),
        summary: Value::Null,
    };
    let app = light::app_with(|app| {
        app.add_plugins(DeferredPlugin);
    });
    match app {
        Some(mut app) => measure(&mut app, options, &mut report),
        None => report
            .notes
            .push("no Vulkan device: nothing was measured".into()),
    }
    report
}

/// Pixels on the wrong side, over [`BANDS`].
#[derive(Clone, Copy, Default)]
struct Wrong {
    counted: [usize; BANDS.len()],
    /// In the light.
    dark: [usize; BANDS.len()],
    /// In the shadow.
    lit: [usize; BANDS.len()],
}

impl Wrong {
    fn add(&mut self, other: &Self) {
        for k in 0..BANDS.len() {
            self.counted[k] += other.counted[k];
            self.dark[k] += other.dark[k];
            self.lit[k] += other.lit[k];
        }
    }

    /// Of a frame with shadows and one without.
    fn of(ways: &[Option<Way>], with: &Picture, without: &Picture) -> Self {
        let mut wrong = Self::default();
        let light = |pixel: &[f32; 4]| pixel[0] + pixel[1] + pixel[2];
        let most = without.pixels.iter().map(light).fold(0.0, f32::max);
        for ((way, with), without) in ways.iter().zip(&with.pixels).zip(&without.pixels) {
            let Some(way) = way else { continue };
            // At the border of a cone, or along a surface, hardly any light arrives that could be missed.
            if light(without) < 1e-3 * most {
                continue;
            }
            let lit = light(with) > 0.5 * light(without);
            for (k, _) in BANDS
                .iter()
                .enumerate()
                .filter(|(_, band)| way.alike >= **band)
            {
                wrong.counted[k] += 1;
                wrong.dark[k] += usize::from(way.free && !lit);
                wrong.lit[k] += usize::from(!way.free && lit);
            }
        }
        wrong
    }

    fn json(&self) -> Value {
        let at = |k: usize| self.dark[k] + self.lit[k];
        let least = (0..BANDS.len()).rev().take_while(|k| at(*k) == 0).last();
        json!({
            "counted": self.counted[ASKED_BAND],
            "wrong": at(ASKED_BAND),
            "dark": self.dark,
            "lit": self.lit,
            "least_band": least.map(|k| BANDS[k]),
        })
    }
}

/// Lets the light of a receiver cast shadows, or not.
fn cast(app: &mut App, spawned: &Spawned, receiver: &Receiver, casts: bool) {
    for entity in &spawned.others {
        let mut entity = app.world_mut().entity_mut(*entity);
        if let Some(mut light) = entity.get_mut::<PointLight>() {
            light.shadow_maps_enabled = casts;
        }
        if let Some(mut light) = entity.get_mut::<SpotLight>() {
            light.shadow_maps_enabled = casts;
        }
        if let Some(mut light) = entity.get_mut::<DirectionalLight>() {
            light.shadow_maps_enabled = casts;
            entity.insert(
                CascadeShadowConfigBuilder {
                    num_cascades: 1,
                    minimum_distance: 0.0,
                    maximum_distance: receiver.far as f32,
                    ..default()
                }
                .build(),
            );
        }
    }
}

/// Metres of a texel of the map of a directional light; 0 without one.
fn texel_metres(app: &mut App, camera: Entity) -> f64 {
    let mut all = app.world_mut().query::<&Cascades>();
    let found = all.iter(app.world()).find_map(|cascades| {
        let first = cascades.cascades.get(&camera)?.first()?;
        Some(f64::from(first.texel_size))
    });
    found.unwrap_or(0.0)
}

/// By each of [`FILTERS`].
fn of_receiver(app: &mut App, receiver: &Receiver) -> [Wrong; FILTERS.len()] {
    let spawned = light::spawn(app, &receiver.scene, DeferredLighting::default());
    let without = light::picture(app, spawned.camera, 2);
    cast(app, &spawned, receiver, true);
    let pictures = FILTERS.map(|(_, filter)| {
        app.world_mut().entity_mut(spawned.camera).insert(filter);
        light::picture(app, spawned.camera, 2)
    });
    let metres = texel_metres(app, spawned.camera);
    let lamp = &receiver.scene.lamps[0];
    let ways = ways_around(&receiver.scene, lamp, receiver.texels(metres), &BANDS);
    way::despawn(app, spawned);
    pictures.map(|with| Wrong::of(&ways, &with, &without))
}

fn measure(app: &mut App, options: &Options, report: &mut Report) {
    let receivers = options.count.unwrap_or(RECEIVERS);
    let mut by_kind = [[Wrong::default(); KINDS.len()]; FILTERS.len()];
    let mut worst = Vec::new();
    for index in 0..receivers {
        let receiver = Receiver::new(options.seed, index);
        let found = of_receiver(app, &receiver);
        for ((sums, found), (filter, _)) in by_kind.iter_mut().zip(&found).zip(FILTERS) {
            sums[receiver.kind].add(found);
            let wrong = found.dark[ASKED_BAND] + found.lit[ASKED_BAND];
            if wrong > 0 {
                let place = json!({
                    "receiver": index,
                    "filter": filter,
                    "light": KINDS[receiver.kind],
                    "incidence_deg": receiver.incidence,
                    "dark": found.dark[ASKED_BAND],
                    "lit": found.lit[ASKED_BAND],
                });
                eprintln!("{place}");
                worst.push(place);
            }
        }
    }
    let mut filters = serde_json::Map::new();
    for ((filter, _), kinds) in FILTERS.iter().zip(&by_kind) {
        let mut sum = Wrong::default();
        for (kind, wrong) in KINDS.iter().zip(kinds) {
            sum.add(wrong);
            report.rows.extend(rows(filter, kind, wrong));
        }
        let mut entry = sum.json();
        for (kind, wrong) in KINDS.iter().zip(kinds) {
            entry[*kind] = wrong.json();
        }
        filters.insert((*filter).into(), entry);
    }
    report.notes.push("dark and lit are over the bands; least_band is the narrowest from which on no pixel is wrong, none if there is none".into());
    report.notes.push(format!(
        "frames of {PIXELS} x {PIXELS} pixels, each of half a texel to thirty; incidence 0 to 89 degrees, 0.5 to 50 m from the light"
    ));
    worst.truncate(40);
    report.summary = json!({
        "seed": options.seed,
        "receivers": receivers,
        "bands": BANDS,
        "filters": filters,
        "worst": worst,
    });
}

fn rows(filter: &str, kind: &str, wrong: &Wrong) -> Vec<Row> {
    let row = |k: usize| {
        let share = |count: usize| count as f64 / wrong.counted[k].max(1) as f64;
        Row {
            sweep: format!("{kind} light"),
            method: filter.into(),
            parameter: format!("{} texels from an edge", BANDS[k]),
            parameter_value: BANDS[k],
            quantity: "share of the pixels that is wrong; rms is that of acne".into(),
            error: Some(ErrorNumbers {
                max: share(wrong.dark[k] + wrong.lit[k]),
                rms: share(wrong.dark[k]),
                p99: share(wrong.lit[k]),
            }),
            error_unit: "share; p99 is that of leaks".into(),
            time_ns: None,
            bytes: None,
            vertices: None,
            hash: None,
            device: String::new(),
        }
    };
    (0..BANDS.len()).map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(values: &[f32]) -> Picture {
        Picture {
            width: values.len() as u32,
            pixels: values.iter().map(|v| [*v, *v, *v, 1.0]).collect(),
        }
    }

    #[test]
    fn both_mistakes_are_counted_where_no_edge_is_near() {
        let way = |free, alike| Some(Way { free, alike });
        let ways = [
            way(true, 1.5),
            way(true, 1.5),
            way(false, 3.0),
            way(false, 1.0),
            None,
            way(true, 12.0),
        ];
        // Lit, acne, a leak, a leak at an edge, nothing, acne where hardly any light arrives.
        let with = picture(&[1.0, 0.2, 0.9, 0.9, 0.5, 0.0]);
        let without = picture(&[1.0, 1.0, 1.0, 1.0, 1.0, 1e-4]);
        let wrong = Wrong::of(&ways, &with, &without);
        assert_eq!(wrong.counted[ASKED_BAND], 3);
        assert_eq!((wrong.dark[ASKED_BAND], wrong.lit[ASKED_BAND]), (1, 1));
        assert_eq!((wrong.lit[1], wrong.lit[4], wrong.lit[5]), (2, 1, 0));
        assert_eq!(wrong.json()["least_band"], 4.0);
    }

    #[test]
    fn a_few_receivers_have_shadows_and_what_is_asked_for() {
        let options = Options {
            count: Some(6),
            ..Options::default()
        };
        let report = run(&options);
        if report.summary.is_null() {
            assert!(std::env::var_os("CI").is_none(), "{:?}", report.notes);
            return;
        }
        for asked in &ASKED {
            let number = report.summary.pointer(asked.at);
            assert!(number.is_some_and(Value::is_number), "{}", asked.at);
        }
        // Most pixels are right; without shadows all in a shadow would be wrong.
        for (filter, _) in FILTERS {
            let of = &report.summary["filters"][filter];
            let number = |value: &Value| value.as_u64().unwrap_or(u64::MAX);
            let (counted, wrong) = (number(&of["counted"]), number(&of["wrong"]));
            assert!(counted > 1000 && wrong * 20 < counted, "{of}");
        }
    }
}
