//! What stands and grows on the ground: cities, plants, wind.

use bevy::app::App;
use dolomite_city::{City, CityView};
use dolomite_inspector::settings::described::{Describe, Description, Field};
use dolomite_vegetation::{PressesGrass, Vegetation, VegetationRanks, VegetationView, Wind};

use super::{LARGEST, LEAST};

pub(super) fn describe(app: &mut App) {
    city(app);
    growth(app);
}

fn city(app: &mut App) {
    let metres =
        |about: &'static str, low: f64, high: f64| Field::new(about).range(low..=high).unit("m");
    let share = |about: &'static str, low: f64, high: f64| Field::new(about).range(low..=high);
    app.describe::<City>(
        Description::new("A city: its rules, how finely it is divided, its hour and its lamps")
            .field(
                "hour",
                Field::new("Hour of the day: which windows are lit")
                    .range(0.0..=24.0)
                    .unit("h"),
            )
            .field(
                "lamps",
                share("Brightness of lamps and windows; 0: none", 0.0, 1.0),
            )
            .field(
                "rules.pitch",
                metres("From the middle of a street to the next", 16.0, 512.0),
            )
            .field(
                "rules.street",
                metres("Width of a street from kerb to kerb", 2.0, 256.0),
            )
            .field(
                "rules.lots",
                share("Lots along each side of a block", 1.0, 2.0),
            )
            .field("rules.footprint", metres("Side of a building", 2.0, 512.0))
            .field(
                "rules.built",
                share("Share of lots with a building", 0.0, 1.0),
            )
            .field("rules.storey", metres("Height of a storey", 2.0, 10.0))
            .field(
                "rules.storeys",
                share("Least and greatest number of storeys", 1.0, 64.0),
            )
            .field(
                "rules.roof.height",
                metres("From eaves to the top of the roof", 0.1, 20.0),
            )
            .field(
                "rules.roof.inset",
                share("How far a roof stands back, of the footprint", 0.1, 0.45),
            )
            .field(
                "rules.hedge.share",
                share("Share of sides of a block with a hedge", 0.0, 1.0),
            )
            .field(
                "rules.hedge.width",
                metres("Least and greatest width of a hedge", 0.6, 4.0),
            )
            .field(
                "rules.hedge.height",
                metres("Least and greatest height of a hedge", 0.6, 4.0),
            )
            .field(
                "rules.lamp.spacing",
                metres("From one lamp to the next along a kerb", 4.0, 1000.0),
            )
            .field("rules.lamp.height", metres("Height of the post", 1.0, 20.0))
            .field(
                "rules.lamp.reach",
                metres("From the post to the end with the light", 0.2, 4.0),
            )
            .field(
                "rules.lamp.drop",
                share(
                    "Length of the end that hangs down, of the height",
                    0.01,
                    0.9,
                ),
            )
            .field(
                "rules.lamp.radius",
                metres("Radius of the tube", 0.005, 0.5),
            )
            .field(
                "rules.lamp.globe",
                metres("Least and greatest radius of a globe", 0.02, 1.0),
            )
            .field(
                "rules.lamp.lumens",
                Field::new("Luminous flux of a lamp")
                    .range(0.0..=1e7)
                    .unit("lm"),
            )
            .field(
                "rules.window.spacing",
                metres("From one window to the next", 1.0, 10.0),
            )
            .field(
                "rules.window.lit",
                share(
                    "Share of windows that are lit at the busiest hour",
                    0.0,
                    1.0,
                ),
            )
            .field(
                "rules.relief.band",
                metres("Over which displacement fades towards a border", 0.02, 0.25),
            )
            .field(
                "rules.relief.patch",
                metres("Longest side of a patch", 1.0, 16.0),
            )
            .field(
                "rules.relief.asphalt",
                metres("Greatest displacement of roads", 0.0, 0.2),
            )
            .field(
                "detail",
                Field::new("Level of every patch, or pixels of error in the picture")
                    .range(LEAST..=LARGEST)
                    .logarithmic(),
            ),
    )
    .describe::<CityView>(
        Description::new("The camera sees the city")
            .field("near", metres("How far blocks are patches", 0.0, 1000.0))
            .field(
                "far",
                metres("How far buildings are drawn at all", 0.0, 20_000.0),
            )
            .field("lights", metres("How far lamps are lights", 0.0, 2000.0))
            .field(
                "most_lights",
                share("Most lights at once", 0.0, f64::from(u32::MAX)),
            ),
    );
}

fn growth(app: &mut App) {
    app.describe::<Vegetation>(
        Description::new("What grows on a terrain")
            .field(
                "density",
                Field::new("Share of all densities; 0: nothing is computed").range(0.0..=1.0),
            )
            .field(
                "reach",
                Field::new("Share of how far away each kind is drawn").range(0.0..=4.0),
            )
            .field(
                "most_meshes",
                Field::new("Most trees and rocks at once").range(0.0..=1e6),
            ),
    )
    .describe::<VegetationView>(Description::new("The camera sees what grows"))
    .describe::<VegetationRanks>(Description::new(
        "The rank of what grows is found in each pixel of the camera",
    ))
    .describe::<Wind>(
        Description::new("Wind over a terrain, and the swell of its water")
            .field(
                "towards",
                Field::new("Where it blows to, from +x towards +z")
                    .range(-LARGEST..=LARGEST)
                    .unit("rad"),
            )
            .field(
                "speed",
                Field::new("Mean speed").range(0.0..=40.0).unit("m/s"),
            )
            .field(
                "gusts",
                Field::new("How much gusts differ from the mean, of it").range(0.0..=1.0),
            )
            .field(
                "swell",
                Field::new("From trough to crest")
                    .range(0.0..=10.0)
                    .unit("m"),
            ),
    )
    .describe::<PressesGrass>(
        Description::new("Presses grass aside").field(
            "radius",
            Field::new("Radius of its capsule")
                .range(0.0..=LARGEST)
                .unit("m"),
        ),
    );
}
