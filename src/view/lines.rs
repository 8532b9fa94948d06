//! Lines over the picture, as one mesh: what other parts know, drawn for who looks for a mistake.

use bevy::asset::RenderAssetUsages;
use bevy::camera::visibility::NoFrustumCulling;
use bevy::light::{NotShadowCaster, NotShadowReceiver};
use bevy::material::OpaqueRendererMethod;
use bevy::math::ops;
use bevy::mesh::PrimitiveTopology;
use bevy::prelude::*;

/// Sides of a ring.
const RING: u32 = 24;

/// Ends of lines and their linear colours.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lines {
    /// Two a line, metres.
    pub ends: Vec<Vec3>,
    colours: Vec<Vec4>,
}

impl Lines {
    /// One.
    pub fn line(&mut self, from: Vec3, to: Vec3, colour: Vec4) {
        self.ends.extend([from, to]);
        self.colours.extend([colour, colour]);
    }

    /// Those from each point to the next.
    pub fn path(&mut self, points: impl IntoIterator<Item = Vec3>, colour: Vec4) {
        let mut last = None;
        for point in points {
            if let Some(last) = last {
                self.line(last, point, colour);
            }
            last = Some(point);
        }
    }

    /// Three rings around a centre, along the axes of a turn.
    pub fn rings(&mut self, center: Vec3, turn: Quat, radii: Vec3, colour: Vec4) {
        let (x, y, z) = (
            turn * Vec3::X * radii.x,
            turn * Vec3::Y * radii.y,
            turn * Vec3::Z * radii.z,
        );
        for (one, two) in [(x, y), (y, z), (z, x)] {
            let at = |i: u32| {
                let (sin, cos) = ops::sin_cos(std::f32::consts::TAU * i as f32 / RING as f32);
                center + one * cos + two * sin
            };
            self.path((0..=RING).map(at), colour);
        }
    }

    /// The edges of a box.
    pub fn cuboid(&mut self, place: &Transform, half: Vec3, colour: Vec4) {
        let corner = |i: u32| {
            let side = |bit: u32| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
            place.translation + place.rotation * (half * Vec3::new(side(0), side(1), side(2)))
        };
        for i in 0..8_u32 {
            for bit in 0..3 {
                if i >> bit & 1 == 0 {
                    self.line(corner(i), corner(i | 1 << bit), colour);
                }
            }
        }
    }

    fn mesh(self) -> Mesh {
        Mesh::new(PrimitiveTopology::LineList, RenderAssetUsages::default())
            .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, vec![Vec3::Y; self.ends.len()])
            .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, self.ends)
            .with_inserted_attribute(
                Mesh::ATTRIBUTE_COLOR,
                self.colours.iter().map(Vec4::to_array).collect::<Vec<_>>(),
            )
    }
}

/// The mesh of lines, while they are drawn.
#[derive(Debug, Default)]
pub struct Drawn(Option<(Entity, Handle<Mesh>)>);

impl Drawn {
    /// Whether there is one.
    #[must_use]
    pub const fn is_there(&self) -> bool {
        self.0.is_some()
    }

    /// Draws these lines in place of the last ones.
    pub fn show(
        &mut self,
        lines: Lines,
        meshes: &mut Assets<Mesh>,
        materials: &mut Assets<StandardMaterial>,
        commands: &mut Commands,
    ) {
        let mesh = lines.mesh();
        if let Some((_, handle)) = &self.0
            && let Some(mut known) = meshes.get_mut(handle)
        {
            *known = mesh;
            return;
        }
        let handle = meshes.add(mesh);
        let entity = commands
            .spawn((
                Mesh3d(handle.clone()),
                MeshMaterial3d(materials.add(StandardMaterial {
                    unlit: true,
                    // Not into the G-buffer, which has no lines.
                    opaque_render_method: OpaqueRendererMethod::Forward,
                    ..default()
                })),
                Transform::default(),
                NoFrustumCulling,
                NotShadowCaster,
                NotShadowReceiver,
            ))
            .id();
        self.0 = Some((entity, handle));
    }

    /// Draws none.
    pub fn hide(&mut self, commands: &mut Commands) {
        if let Some((entity, _)) = self.0.take() {
            commands.entity(entity).try_despawn();
        }
    }
}
