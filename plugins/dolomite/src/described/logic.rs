//! Values, parts, senses and crowds of the game's logic.

use bevy::app::App;
use dolomite_inspector::entities::ReadComponents;
use dolomite_inspector::settings::described::{Describe, Description, Field};
use dolomite_logic::behaviour::{Behaviours, Leaves, ThoughtCounters, tree_of};
use dolomite_logic::movement::{Patrol, WalkCounters, WalkSettings, WalkTimes, Walker};
use dolomite_logic::parts::Shots;
use dolomite_logic::senses::{Ear, SightCounters, SightSettings};
use dolomite_logic::{
    Attention, AttentionSettings, Button, Door, Health, Lift, LogicClock, LogicCounters,
    LogicTimer, Mind, Mission, Names, Objective, PickUp, Values, Weapon, Wires, Zone,
};

use super::LARGEST;

/// Some of logic keeps its state in forms that reflection does not know: it is shown as text.
pub(super) fn describe(app: &mut App) {
    app.read_component::<Values>(|world, values| {
        let names = world.get_resource::<Names>();
        let sorted = values.sorted();
        let parts = sorted.iter().map(|(number, value)| {
            let name = names.map_or("", |names| names.text_of(*number));
            format!("{name}: {value:?}")
        });
        parts.collect::<Vec<_>>().join(", ")
    })
    .read_component::<Mind>(|world, mind| {
        let of = (
            world.get_resource::<Behaviours>(),
            world.get_resource::<Names>(),
            world.get_resource::<Leaves>(),
        );
        match of {
            (Some(behaviours), Some(names), Some(leaves)) => {
                tree_of(mind, behaviours, names, leaves)
            }
            _ => format!("{mind:?}"),
        }
    })
    .read_debug::<Attention>()
    .read_debug::<Button>()
    .read_debug::<Lift>()
    .read_debug::<PickUp>()
    .read_debug::<Wires>()
    .read_debug::<Zone>();
    parts(app);
    shared(app);
}

fn parts(app: &mut App) {
    let seconds = |about: &'static str| Field::new(about).range(-LARGEST..=LARGEST).unit("s");
    let amount = |about: &'static str| Field::new(about).range(-LARGEST..=LARGEST);
    app.describe::<Door>(
        Description::new("A door")
            .field("open", Field::new("How far it is open").range(0.0..=1.0))
            .field("time", seconds("From closed to open; not above 0: at once"))
            .field("hold", seconds("After which it closes by itself"))
            .field("waited", seconds("That it has been open")),
    )
    .describe::<LogicTimer>(
        Description::new("A timer")
            .field("period", seconds("Of a round; not above 0: never elapses"))
            .field("passed", seconds("That passed")),
    )
    .describe::<Health>(
        Description::new("What is left of one's health")
            .field("now", amount("What is left"))
            .field("most", amount("At most")),
    )
    .describe::<Objective>(Description::new("One part of a mission"))
    .describe::<Mission>(Description::new("What is to be done"))
    .describe::<Weapon>(
        Description::new("What shoots")
            .field("damage", amount("Taken from the health of who is hit"))
            .field(
                "speed",
                // Infinite: it hits in the same step.
                Field::new("Speed of a shot; infinite: it hits at once")
                    .range(0.0..=f64::INFINITY)
                    .unit("m/s"),
            )
            .field(
                "range",
                Field::new("How far a shot flies")
                    .range(0.0..=LARGEST)
                    .unit("m"),
            )
            .field(
                "gravity",
                Field::new("Downwards")
                    .range(-LARGEST..=LARGEST)
                    .unit("m/s2"),
            )
            .field("interval", seconds("Between shots"))
            .field("reload", seconds("Until it is loaded again")),
    )
    .describe::<Walker>(
        Description::new("One of a crowd")
            .field(
                "radius",
                Field::new("Its radius").range(0.0..=LARGEST).unit("m"),
            )
            .field(
                "speed",
                Field::new("The speed that it wants; not above 0: it stands")
                    .range(-LARGEST..=LARGEST)
                    .unit("m/s"),
            ),
    )
    .describe::<Patrol>(
        Description::new("Goes along a route")
            .field(
                "speed",
                Field::new("Below 0 it goes the other way around")
                    .range(-LARGEST..=LARGEST)
                    .unit("m/s"),
            )
            .field(
                "along",
                Field::new("Its place on the way")
                    .range(-LARGEST..=LARGEST)
                    .unit("m"),
            ),
    )
    .describe::<Ear>(Description::new("Hears noises").field(
        "keen",
        Field::new("Ranges are this many times as long to it").range(0.0..=LARGEST),
    ));
}

/// What all of a world share.
fn shared(app: &mut App) {
    let steps = |about: &'static str| {
        Field::new(about)
            .range(1.0..=65_536.0)
            .unit("steps")
            .logarithmic()
    };
    let metres = |about: &'static str| Field::new(about).range(0.0..=LARGEST).unit("m");
    let most = |about: &'static str| Field::new(about).range(0.0..=f64::from(u32::MAX));
    app.describe::<WalkSettings>(
        Description::new("How walkers avoid each other")
            .field("every", steps("From one decision to the next"))
            .field(
                "horizon",
                Field::new("Within which two are not to meet")
                    .range(0.0..=LARGEST)
                    .unit("s"),
            )
            .field("reach", metres("Farthest neighbour"))
            .field("looks", most("Most others that are looked at")),
    )
    .describe::<SightSettings>(
        Description::new("How sight is shared out")
            .field("every", steps("From one look of an observer to the next"))
            .field("rays", most("Most rays of a look")),
    )
    .describe::<AttentionSettings>(
        Description::new("What distance means for how often one thinks")
            .field("near", metres("To a focus up to which every step counts"))
            .field("most", steps("At most; a power of two")),
    )
    .describe::<LogicClock>(Description::answer("Steps of logic so far"))
    .describe::<LogicCounters>(Description::answer("What logic did in the last step"))
    .describe::<Shots>(Description::answer("Shots that fly"))
    .describe::<SightCounters>(Description::answer("What sight did in the last step"))
    .describe::<ThoughtCounters>(Description::answer("What behaviours did in the last step"))
    .describe::<WalkCounters>(Description::answer("What walkers did in the last step"))
    .describe::<WalkTimes>(Description::answer("What stages of the last step took, ms"));
}
