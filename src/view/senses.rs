//! What logic's figures sense and where they go, drawn as lines over the picture: fields of view in yellow, who is seen
//! in red, what is remembered in violet, routes in blue, ways of walkers in green.

use bevy::math::ops;
use bevy::prelude::*;
use dolomite::logic::movement::{FlowFields, Patrol, Walker};
use dolomite::logic::senses::{Memory, Sight, Visible};

use super::lines::{Drawn, Lines};
use crate::play::Switches;

const FIELD: Vec4 = Vec4::new(0.9, 0.6, 0.02, 1.0);
const SEEN: Vec4 = Vec4::new(1.0, 0.03, 0.02, 1.0);
const REMEMBERED: Vec4 = Vec4::new(0.5, 0.05, 0.9, 1.0);
const ROUTE: Vec4 = Vec4::new(0.02, 0.3, 1.0, 1.0);
const WAY: Vec4 = Vec4::new(0.03, 0.8, 0.05, 1.0);

/// Lines of the arc of a field of view, and of a route.
const ARC: u32 = 16;
const ROUND: u32 = 96;

/// Routes and ways lie this far above the ground, metres.
const ABOVE: f32 = 0.1;

/// Draws them while [`Switches::senses`] is on; off, one condition a frame.
pub struct SensesPlugin;

/// The mesh of all lines.
#[derive(Resource, Default)]
struct SensesDrawn(Drawn);

impl Plugin for SensesPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<SensesDrawn>().add_systems(
            PostUpdate,
            (
                draw.run_if(|switches: Res<Switches>| switches.senses),
                hide.run_if(|switches: Res<Switches>, drawn: Res<SensesDrawn>| {
                    !switches.senses && drawn.0.is_there()
                }),
            ),
        );
    }
}

fn draw(
    observers: Query<(&Sight, &Transform, Option<&Memory>)>,
    visible: Query<(&Visible, &Transform)>,
    patrols: Query<&Patrol>,
    walkers: Query<(&Walker, Option<&Transform>)>,
    fields: Option<Res<FlowFields>>,
    mut drawn: ResMut<SensesDrawn>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut commands: Commands,
) {
    let mut lines = Lines::default();
    for (sight, place, memory) in &observers {
        let eye = place.translation + sight.eye;
        field(
            &mut lines,
            eye,
            *place.forward(),
            sight.range,
            sight.half_field,
        );
        for (seen, at) in sight.seen().filter_map(|who| visible.get(who).ok()) {
            lines.line(eye, at.translation + seen.offset, SEEN);
        }
        for trace in memory.into_iter().flat_map(Memory::traces) {
            let size = Vec3::splat(0.1 + 0.4 * trace.certainty.clamp(0.0, 1.0));
            lines.rings(trace.place, Quat::IDENTITY, size, REMEMBERED);
        }
    }
    for patrol in &patrols {
        let length = patrol.route.length();
        let at = |i: u32| patrol.route.at(length * i as f32 / ROUND as f32) + Vec3::Y * ABOVE;
        lines.path((0..=ROUND).map(at), ROUTE);
    }
    for (walker, place) in &walkers {
        let height = place.map_or(0.0, |place| place.translation.y) + ABOVE;
        let on_ground = |at: Vec2| Vec3::new(at.x, height, at.y);
        lines.line(
            on_ground(walker.place),
            on_ground(walker.place + walker.velocity),
            WAY,
        );
        let field = fields
            .as_ref()
            .and_then(|fields| fields.0.get(usize::from(walker.field)));
        if let Some(field) = field {
            let way = field.way(walker.place);
            lines.line(
                on_ground(walker.place),
                on_ground(walker.place + way),
                ROUTE,
            );
        }
    }
    drawn
        .0
        .show(lines, &mut meshes, &mut materials, &mut commands);
}

/// The outline of a field of view, level with the eye: two sides and an arc; a full circle has no sides.
fn field(lines: &mut Lines, eye: Vec3, forward: Vec3, range: f32, half: f32) {
    // Above a field without an end there is nothing to draw.
    if !(range > 0.0 && range.is_finite() && half > 0.0) {
        return;
    }
    let half = half.min(std::f32::consts::PI);
    let level = Vec3::new(forward.x, 0.0, forward.z).normalize_or(Vec3::NEG_Z);
    let at = |i: u32| {
        let angle = half * (2.0 * i as f32 / ARC as f32 - 1.0);
        eye + Quat::from_rotation_y(angle) * level * range
    };
    lines.path((0..=ARC).map(at), FIELD);
    if ops::cos(half) > -1.0 + 1e-6 {
        lines.path([at(0), eye, at(ARC)], FIELD);
    }
}

fn hide(mut drawn: ResMut<SensesDrawn>, mut commands: Commands) {
    drawn.0.hide(&mut commands);
}

#[cfg(test)]
mod tests {
    use super::*;
    use dolomite::logic::senses::in_field;

    /// The range, a hair wider, and its field: corners of the outline lie on both to rounding.
    #[test]
    fn the_outline_of_a_field_lies_on_its_edge() {
        let (eye, range, half) = (Vec3::new(3.0, 2.0, -5.0), 20.0, 0.7);
        for forward in [Vec3::NEG_Z, Vec3::X, Vec3::new(1.0, 0.0, 1.0).normalize()] {
            let mut lines = Lines::default();
            field(&mut lines, eye, forward, range, half);
            // The arc, and two sides.
            assert_eq!(lines.ends.len(), 2 * (ARC as usize + 2));
            let sees = |range, half: f32, at| in_field(eye, forward, range, ops::cos(half), at);
            for end in lines.ends.iter().filter(|end| **end != eye) {
                assert!(sees(range * 1.0001, half * 1.0001, *end), "{end}");
                assert!(!sees(range * 0.9999, half * 1.0001, *end), "{end}");
            }
            // The sides are as far from the middle as it says.
            assert!(!sees(range * 1.0001, half * 0.999, lines.ends[0]));
        }
    }

    #[test]
    fn a_field_without_an_end_is_not_drawn_and_a_full_circle_has_no_sides() {
        for (range, half) in [
            (f32::INFINITY, 1.0),
            (f32::NAN, 1.0),
            (0.0, 1.0),
            (5.0, f32::NAN),
        ] {
            let mut lines = Lines::default();
            field(&mut lines, Vec3::ZERO, Vec3::Y, range, half);
            assert_eq!(lines, Lines::default(), "{range} {half}");
        }
        let mut lines = Lines::default();
        field(&mut lines, Vec3::ZERO, Vec3::NEG_Z, 5.0, 9.0);
        assert_eq!(lines.ends.len(), 2 * ARC as usize);
    }

    fn app() -> App {
        let mut app = App::new();
        app.add_plugins(bevy::asset::AssetPlugin::default())
            .init_asset::<Mesh>()
            .init_asset::<StandardMaterial>()
            .init_resource::<Switches>()
            .add_plugins(SensesPlugin);
        app.world_mut()
            .spawn((Sight::default(), Transform::default()));
        app
    }

    #[test]
    fn there_is_a_mesh_while_it_is_on_and_none_before_and_after() {
        let mut app = app();
        let meshes = |app: &mut App| {
            let world = app.world_mut();
            world.query::<&Mesh3d>().iter(world).count()
        };
        let switch = |app: &mut App, on| {
            app.world_mut().resource_mut::<Switches>().senses = on;
            app.update();
        };
        switch(&mut app, false);
        assert_eq!(
            (
                meshes(&mut app),
                app.world().resource::<Assets<Mesh>>().len()
            ),
            (0, 0)
        );
        switch(&mut app, true);
        app.update();
        assert_eq!(meshes(&mut app), 1);
        switch(&mut app, false);
        assert_eq!(meshes(&mut app), 0);
    }
}
