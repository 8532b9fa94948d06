//! The figure's body among things: an upright ellipsoid that slides along them, stands on them and rides on them.
//!
//! The figure plans its step over the ground, which knows no things. Its body goes the planned way, and what stops,
//! lifts or carries it changes the plan. Where nothing is touched the plan stands to the bit.

use bevy::math::{DVec3, Vec3Swizzles as _};
use bevy::prelude::*;
use dolomite::character::CharacterGround;
use dolomite::character::feet::Footing;
use dolomite::collision::rapier::Pusher;
use dolomite::collision::{CharacterBody, CollisionSystems, MoveState, MoveWish};
use dolomite::terrain::{Ground, Terrain};

use super::city::CityWall;
use super::figure::{Figure, FigureSystems, Stance, inside};
use super::jump::Jump;
use super::things::{LiftSystems, Solid};
use crate::scene::CurrentScene;

/// Half of the size of a grown person, metres.
const RADII: Vec3 = Vec3::new(0.28, 0.9, 0.28);

/// A body that is farther than this from where the figure is was left behind: the figure was put elsewhere. Metres.
const LEFT: f64 = 3.0;

/// Feet that are less than this above the ground stand on it, metres.
const ON_GROUND: f64 = 0.01;

/// What a body goes down by while it stands on something, so that it does not rise: setting down does the rest.
const DOWN: f64 = 0.02;

/// The body of a figure. Its translation is its centre.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
pub struct BodyOf(pub Entity);

/// Gives figures bodies where there are things.
pub struct BodyPlugin;

impl Plugin for BodyPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(
            FixedUpdate,
            (
                (embody, aim)
                    .chain()
                    .after(FigureSystems)
                    .after(LiftSystems)
                    .before(CollisionSystems::Gather),
                land.after(CollisionSystems::Move)
                    .before(CollisionSystems::Trigger),
            ),
        )
        .add_systems(Update, footing);
    }
}

fn center(stance: &Stance, terrain: &Terrain) -> DVec3 {
    let feet = terrain.height(stance.place) + stance.jump.lift();
    DVec3::new(stance.place.x, feet + f64::from(RADII.y), stance.place.y)
}

fn embody(
    mut commands: Commands,
    scene: Res<CurrentScene>,
    figures: Query<(Entity, &Figure)>,
    bodies: Query<(Entity, &BodyOf)>,
    things: Query<(), Or<(With<Solid>, With<CityWall>)>>,
) {
    for (entity, body) in &bodies {
        if things.is_empty() || !figures.contains(body.0) {
            commands.entity(entity).despawn();
        }
    }
    if things.is_empty() {
        return;
    }
    for (figure, state) in &figures {
        if !bodies.iter().any(|(_, body)| body.0 == figure) {
            let body = CharacterBody {
                radii: RADII,
                ..default()
            };
            let place = center(&state.now, &scene.terrain).as_vec3();
            commands.spawn((
                BodyOf(figure),
                body,
                Pusher::default(),
                Transform::from_translation(place),
            ));
        }
    }
}

/// Bodies want to go where their figures plan to be.
fn aim(
    scene: Res<CurrentScene>,
    figures: Query<&Figure>,
    mut bodies: Query<(&BodyOf, &MoveState, &mut MoveWish, &mut Transform)>,
) {
    for (body, state, mut wish, mut place) in &mut bodies {
        let Ok(figure) = figures.get(body.0) else {
            continue;
        };
        let target = center(&figure.now, &scene.terrain);
        let new = state.center.distance(place.translation.as_dvec3()) > 0.01;
        if new || state.center.distance(target) > LEFT {
            place.translation = target.as_vec3();
            wish.0 = Vec3::ZERO;
            continue;
        }
        let mut way = target - state.center;
        if matches!(figure.now.jump, Jump::On { .. }) {
            way.y = -DOWN;
        }
        wish.0 = way.as_vec3();
    }
}

/// Figures are where their bodies came to.
fn land(
    scene: Res<CurrentScene>,
    mut figures: Query<&mut Figure>,
    bodies: Query<(&BodyOf, &MoveState)>,
) {
    for (body, state) in &bodies {
        let Ok(mut figure) = figures.get_mut(body.0) else {
            continue;
        };
        let now = landed(figure.now, state, &scene.terrain);
        if now != figure.now {
            figure.now = now;
        }
    }
}

/// Who stands on something has their feet on its plane, and not on the ground below it.
fn footing(
    mut commands: Commands,
    figures: Query<(&Figure, &Transform)>,
    bodies: Query<(&BodyOf, &MoveState)>,
    known: Option<Res<CharacterGround>>,
) {
    let stood = bodies.iter().find_map(|(body, state)| {
        let (figure, place) = figures.get(body.0).ok()?;
        let on = matches!(figure.now.jump, Jump::On { .. });
        let ground = state.outcome.ground.filter(|_| on)?;
        Some((place.translation.as_dvec3(), ground.normal))
    });
    match stood {
        Some((feet, normal)) => {
            let gradient = -normal.xz() / normal.y.max(0.5);
            commands.insert_resource(CharacterGround::new(move |xz| {
                let height = feet.y + gradient.dot(xz - feet.xz());
                Some(Footing { height, gradient })
            }));
        }
        None if known.is_some() => commands.remove_resource::<CharacterGround>(),
        None => {}
    }
}

/// What became of a plan.
fn landed(plan: Stance, state: &MoveState, terrain: &Terrain) -> Stance {
    let on = matches!(plan.jump, Jump::On { .. });
    let touched = state.grounded() || !state.outcome.contacts.is_empty();
    // A body that has not moved yet knows nothing.
    if state.error().is_some() || state.before == DVec3::ZERO || !(touched || on) {
        return plan;
    }
    let place = inside(state.center.xz(), terrain);
    let lift = state.center.y - f64::from(RADII.y) - terrain.height(place);
    let stands = || match lift > ON_GROUND {
        true => Jump::On { lift },
        false => Jump::None,
    };
    let jump = match plan.jump {
        Jump::Air { rise, .. } if state.grounded() && rise <= 0.0 => stands(),
        Jump::Air { rise, .. } => {
            let above = state.contacts().any(|(_, touch)| touch.normal.y < -0.5);
            Jump::Air {
                lift: lift.max(0.0),
                rise: if above { rise.min(0.0) } else { rise },
            }
        }
        Jump::On { .. } | Jump::None if state.grounded() => stands(),
        // It went over the edge.
        Jump::On { .. } if lift > ON_GROUND => Jump::Air { lift, rise: 0.0 },
        Jump::On { .. } => Jump::None,
        plan => plan,
    };
    Stance {
        place,
        jump,
        ..plan
    }
}
