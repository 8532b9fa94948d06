//! What the inspector is told of the settings of all plugins: ranges and units, as their documentation has them.

mod logic;
mod places;

use bevy::app::App;
use dolomite_character::{CharacterCounters, CharacterEye, CharacterJoints, CharacterLod};
use dolomite_collision::{Blocker, CharacterBody, CollisionCounters, MoveState, Trigger};
use dolomite_deferred::{AmbientOcclusion, DeferredLighting, LightingDifference, StillShadows};
use dolomite_geometry::budget::{Budget, BudgetReport};
use dolomite_geometry::{GeometryCamera, GeometryStats};
use dolomite_ground::detail::{DrawnProbes, MakingBudget, TerrainLod};
use dolomite_ground::{GroundMaterial, PatchDetail, Sea, TerrainView};
use dolomite_inspector::entities::ReadComponents;
use dolomite_inspector::settings::described::{Describe, Description, Field};
use dolomite_sky::{Sky, Sun};
use dolomite_sound::{SoundCounters, SoundEmitter, SoundListener, SoundSettings};
use dolomite_terrain::ProbeBatch;

/// The greatest finite number of an f32: above 0, and no end.
const LARGEST: f64 = f32::MAX as f64;

/// The least number of an f32 above 0 that is not subnormal.
const LEAST: f64 = f32::MIN_POSITIVE as f64;

/// Tells the inspector, whether it was added already or not.
pub fn describe(app: &mut App) {
    sky(app);
    ground(app);
    geometry(app);
    figures(app);
    places::describe(app);
    sound(app);
    logic::describe(app);
}

fn sky(app: &mut App) {
    let degrees = |about: &'static str, ends| Field::new(about).range(ends).unit("deg");
    let times = |about: &'static str, most: f64| Field::new(about).range(0.0..=most);
    app.describe::<Sun>(
        Description::new("The sun, by its place in the sky; below the horizon it is night")
            .field(
                "azimuth",
                degrees("Clockwise from north: 90 is east", -360.0..=360.0),
            )
            .field("elevation", degrees("Above the horizon", -90.0..=90.0)),
    )
    .describe::<Sky>(
        Description::new("The sky that a camera sees, its haze and its exposure")
            .field(
                "dust",
                times(
                    "Dust against that of a very clear day; 20 is a usual one",
                    100.0,
                ),
            )
            .field(
                "haze",
                times("Haze against that of very clear air; 0: none", 1e4).logarithmic(),
            )
            .field(
                "day_ev100",
                Field::new("Exposure by day at ISO 100")
                    .range(-20.0..=30.0)
                    .unit("EV"),
            )
            .field(
                "night_ev100",
                Field::new("Exposure of a night at ISO 100")
                    .range(-20.0..=30.0)
                    .unit("EV"),
            )
            .field(
                "stars",
                times("Brightness of the stars; 0: none", 1000.0).logarithmic(),
            )
            .field(
                "milky_way",
                times("Brightness of the Milky Way", 1000.0).logarithmic(),
            )
            .field("moon_size", times("Size of the moon; 0: none", 20.0))
            .field(
                "side",
                Field::new("Side of a face of the sky's cube map")
                    .range(8.0..=1024.0)
                    .unit("texels"),
            )
            .field(
                "map_step",
                degrees(
                    "How far the sun goes before the maps are made anew",
                    0.0..=10.0,
                ),
            ),
    );
}

fn ground(app: &mut App) {
    let metres = |about: &'static str, ends| Field::new(about).range(ends).unit("m");
    let pixels = Field::new("How long an edge, or how large an error, may be in the picture")
        .range(LEAST..=LARGEST)
        .unit("px")
        .logarithmic();
    app.describe::<TerrainView>(Description::new("The camera sees the ground"))
        .describe::<TerrainLod>(
            Description::new("How finely a camera sees the ground")
                .field("metric.pixels", pixels)
                .field(
                    "finest",
                    metres("Side of the smallest cell", 1.0 / 1024.0..=1024.0).logarithmic(),
                )
                .field(
                    "max_vertices",
                    Field::new("Most vertices of the view")
                        .range(1024.0..=4_194_304.0)
                        .logarithmic(),
                )
                .field(
                    "shadow_share",
                    Field::new("Share of the detail where only the shadow is seen")
                        .range(0.0..=1.0),
                ),
        )
        .describe::<PatchDetail>(
            Description::new("The camera sees the ground as patches of the tessellation stage")
                .field(
                    "finest_patch",
                    metres("Side of the smallest patch", 1.0..=4096.0).logarithmic(),
                )
                .field(
                    "split_distance",
                    Field::new("A node is split while the focus is nearer than this many sides")
                        .range(1.5..=LARGEST),
                )
                .field(
                    "max_vertices",
                    Field::new("Capacity of the vertex pool").range(1.0..=16_777_216.0),
                )
                .field(
                    "max_triangles",
                    Field::new("Capacity of the index pool").range(1.0..=33_554_432.0),
                ),
        )
        .describe::<MakingBudget>(
            Description::new("How many blocks of ground a frame makes").field(
                "blocks",
                Field::new("Most blocks").range(0.0..=f64::from(u32::MAX)),
            ),
        )
        .describe::<DrawnProbes>(
            Description::new("How many heights of drawn triangles are asked for in a frame").field(
                "per_frame",
                Field::new("Most places").range(0.0..=f64::from(u32::MAX)),
            ),
        )
        .describe::<GroundMaterial>(
            Description::new("Layers of the ground, from the uppermost to the lowest")
                .field(
                    "layers.tile",
                    metres("Side of a tile of the texture", 0.01..=1e4).logarithmic(),
                )
                .field(
                    "layers.surface.colour",
                    Field::new("Linear albedo").range(0.0..=1.0),
                )
                .field(
                    "layers.surface.roughness",
                    Field::new("Perceptual roughness").range(0.089..=1.0),
                ),
        )
        .describe::<Sea>(
            Description::new("The sea of a terrain")
                .field(
                    "extinction",
                    Field::new("Light lost on a metre of water: red, green, blue")
                        .range(0.0..=LARGEST)
                        .unit("/m"),
                )
                .field(
                    "deep",
                    Field::new("Linear colour of deep water").range(0.0..=1.0),
                )
                .field(
                    "steepness",
                    Field::new("Greatest slope of each wave; 0: a mirror").range(0.0..=1.0),
                ),
        )
        .describe::<ProbeBatch>(
            Description::new("Places whose true heights are asked for").field(
                "per_frame",
                Field::new("Most answers of a frame").range(1.0..=1e9),
            ),
        );
}

fn geometry(app: &mut App) {
    let pixels = |about: &'static str| {
        Field::new(about)
            .range(LEAST..=LARGEST)
            .unit("px")
            .logarithmic()
    };
    app.describe::<GeometryCamera>(
        Description::new("The camera sees what producers of triangles make")
            .field(
                "pixels_per_edge",
                Field::new("Length of an edge that control functions aim at")
                    .range(1.0..=1000.0)
                    .unit("px")
                    .logarithmic(),
            )
            .field(
                "shadow_reach",
                Field::new("How far outside the view patches still cast their shadow into it")
                    .range(0.0..=LARGEST)
                    .unit("m"),
            ),
    )
    .describe::<Budget>(
        Description::new("Time for the ground's detail, held by its error")
            .field(
                "milliseconds",
                Field::new("Time that 99 of 100 frames keep to")
                    .range(LEAST..=LARGEST)
                    .unit("ms"),
            )
            .field("least", pixels("The finest tolerance"))
            .field("greatest", pixels("The coarsest tolerance")),
    )
    .describe::<BudgetReport>(Description::answer("What a budget does"))
    .describe::<DeferredLighting>(Description::new("Dolomite's lighting in place of Bevy's"))
    .describe::<LightingDifference>(Description::new(
        "How far the camera's light is from the reference is found in each pixel",
    ))
    .describe::<StillShadows>(
        Description::new("A point light's shadow map is drawn where something in its reach moved")
            .field(
                "redraw",
                Field::new("When it changes, all of it is drawn again")
                    .range(0.0..=f64::from(u32::MAX)),
            ),
    )
    .describe::<AmbientOcclusion>(
        Description::new("Objects near by block the light from everywhere")
            .field(
                "radius",
                Field::new("What is farther away blocks nothing")
                    .range(LEAST..=LARGEST)
                    .unit("m")
                    .logarithmic(),
            )
            .field(
                "thickness",
                Field::new("How far things reach behind what is seen of them")
                    .range(LEAST..=LARGEST)
                    .unit("m")
                    .logarithmic(),
            ),
    )
    .describe::<GeometryStats>(Description::answer(
        "What producers of triangles made and hold",
    ));
}

fn sound(app: &mut App) {
    let share = |about: &'static str| Field::new(about).range(0.0..=1.0);
    let metres = |about: &'static str| Field::new(about).range(1e-3..=1e6).unit("m").logarithmic();
    app.describe::<SoundSettings>(
        Description::new("Sound: off, no device is open")
            .field("volume", share("Amplitude of everything"))
            .field("effects", share("Amplitude of things and people"))
            .field("ambience", share("Amplitude of wind, water and fire"))
            .field(
                "voices",
                Field::new("Heard at once at most").range(1.0..=128.0),
            )
            .field(
                "speed_of_sound",
                Field::new("How fast sound is; not above 0: at once")
                    .range(-LARGEST..=LARGEST)
                    .unit("m/s"),
            ),
    )
    .describe::<SoundEmitter>(
        Description::new("Sounds without end")
            .field("loudness.volume", Field::new("Amplitude").range(0.0..=4.0))
            .field(
                "loudness.rate",
                Field::new("Speed and pitch")
                    .range(0.0625..=16.0)
                    .logarithmic(),
            )
            .field("loudness.reference", metres("As loud as can be up to here"))
            .field("loudness.reach", metres("Not heard from here on")),
    )
    .describe::<SoundListener>(Description::new("Hears"))
    .describe::<SoundCounters>(Description::answer("What was heard"));
}

fn figures(app: &mut App) {
    let metres = |about: &'static str| Field::new(about).range(LEAST..=LARGEST).unit("m");
    let pixels = |about: &'static str| Field::new(about).range(0.0..=LARGEST).unit("px");
    app.describe::<CharacterEye>(
        Description::new("Where figures are seen from: smaller ones are sampled less often")
            .field(
                "focal",
                Field::new("Pixels of a metre at a metre")
                    .range(0.0..=LARGEST)
                    .unit("px"),
            )
            .field(
                "cone",
                Field::new("From the middle of the view to its corner")
                    .range(0.0..=LARGEST)
                    .unit("rad"),
            )
            .field(
                "full",
                pixels("Smaller, a figure is sampled every second frame"),
            )
            .field("least", pixels("Smaller, a figure is not sampled"))
            .field(
                "shadows",
                Field::new("Within it figures out of view are sampled")
                    .range(0.0..=LARGEST)
                    .unit("m"),
            ),
    )
    .describe::<CharacterLod>(
        // Infinite without eyes.
        Description::answer("How often a figure is sampled").field(
            "pixels",
            Field::new("Its height in view")
                .range(0.0..=f64::INFINITY)
                .unit("px"),
        ),
    )
    .describe::<CharacterJoints>(Description::answer("The entities of a figure's joints"))
    .describe::<CharacterCounters>(Description::answer("Figures of the last frame"))
    .describe::<CharacterBody>(
        Description::new("A mover that slides over triangles")
            .field("radii", metres("Its radii along the axes")),
    )
    .describe::<Blocker>(
        Description::new("A box that movers stop at")
            .field("half_size", metres("Half of its size")),
    )
    .describe::<Trigger>(
        Description::new("A box that says who enters it")
            .field("half_size", metres("Half of its size")),
    )
    .describe::<CollisionCounters>(Description::answer("What collision did in the last step"))
    .read_debug::<MoveState>();
    #[cfg(feature = "rapier")]
    app.describe::<dolomite_collision::rapier::Pusher>(
        Description::new("A mover that pushes bodies of Rapier's").field(
            "force",
            Field::new("How hard at most; not above 0: not at all")
                .range(-LARGEST..=LARGEST)
                .unit("N"),
        ),
    );
}
