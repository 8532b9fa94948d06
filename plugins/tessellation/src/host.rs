//! The stage on the CPU: a kind whose control and evaluate functions stand in Rust as well can be
//! tessellated without a dispatch; vertices and indices are then uploaded, and drawn as the GPU's own.

use std::sync::Arc;

use bevy::math::{Vec2, Vec3};
use dolomite_geometry::vertex::pack;

use super::layout::{StageView, WorkHead};
use super::tables::Instance;
use super::{Levels, PatchMesh, Tessellator};

/// A patch of an entity.
#[derive(Clone, Copy, Debug)]
pub struct HostPatch<'a> {
    /// The entity's patches.
    pub mesh: &'a PatchMesh,
    /// Which of them.
    pub number: u32,
    /// Matrix and parameters of the entity.
    pub instance: &'a Instance,
}

/// What `evaluate` gives, as `Vertex` in `api.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HostVertex {
    /// In the local space of the entity, metres.
    pub position: Vec3,
    /// Of any length.
    pub normal: Vec3,
    /// Texture coordinates.
    pub uv: Vec2,
    /// Which material, 0 to 255.
    pub material: u32,
}

/// Control and evaluate functions in Rust, as a kind has them in WGSL.
pub trait HostFunctions: Send + Sync {
    /// Levels of a patch.
    fn control(&self, patch: &HostPatch, view: &StageView) -> Levels;
    /// The vertex at (u, v, w) of a patch.
    fn evaluate(&self, patch: &HostPatch, at: Vec3) -> HostVertex;
}

/// What is uploaded: the contents of the stage's buffers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HostTessellation {
    /// As `vertex.wgsl` stores them.
    pub vertices: Vec<[u32; 5]>,
    /// Three a triangle, two a segment.
    pub indices: Vec<u32>,
    /// Counters and the arguments of draws.
    pub head: WorkHead,
}

/// Tessellates the entities of a kind one after the other into pools of so many vertices and
/// primitives; the levels of those that do not fit into what is left are lowered, each entity's for
/// itself. `uv_range` is the kind's.
///
/// # Panics
/// If a mesh has another domain than the tessellator.
#[must_use]
pub fn tessellate_host(
    tessellator: &Tessellator,
    entities: &[(Arc<PatchMesh>, Instance)],
    functions: &dyn HostFunctions,
    view: &StageView,
    pools: [u32; 2],
    uv_range: f32,
) -> HostTessellation {
    let mut made = HostTessellation::default();
    for (mesh, instance) in entities {
        let only = instance.camera[0];
        if only != 0.0 && only != view.camera {
            made.head.discarded += mesh.patches() as u32;
            continue;
        }
        let left = [
            pools[0] - made.head.vertices,
            pools[1] - made.head.primitives,
        ];
        if left.contains(&0) {
            break;
        }
        let patch = |number| HostPatch {
            mesh,
            number,
            instance,
        };
        let control = |number| functions.control(&patch(number), view);
        let one = tessellator.tessellate_mesh(mesh, control, left);
        let space = Space::new(instance, view);
        let first = made.head.vertices;
        made.vertices.extend(one.vertices.iter().map(|vertex| {
            // Exact: at most 2^24.
            let at = vertex.at.map(|c| c as f32 * (1.0 / (1 << 24) as f32));
            let vertex = functions.evaluate(&patch(vertex.patch), Vec3::from(at));
            pack(
                space.position(vertex.position),
                space.normal(vertex.normal),
                vertex.uv / uv_range,
                vertex.material,
            )
        }));
        match &one.primitives {
            super::Primitives::Triangles(triangles) => {
                let shifted = triangles.iter().flatten().map(|index| index + first);
                made.indices.extend(shifted);
            }
            super::Primitives::Segments(segments) => {
                let shifted = segments.iter().flatten().map(|index| index + first);
                made.indices.extend(shifted);
            }
        }
        let head = &mut made.head;
        head.vertices += one.vertices.len() as u32;
        head.primitives += one.primitives.len() as u32;
        head.discarded += one.discarded;
        head.lowered = head.lowered.max(one.lowered);
    }
    let count = made.indices.len() as u32;
    made.head.indexed = [count, 1, 0, 0, 0];
    made.head.plain = [count, 1, 0, 0];
    // What lowered levels would have been is not counted.
    made.head.wanted_vertices = made.head.vertices;
    made.head.wanted_primitives = made.head.primitives;
    made
}

/// From an entity's local space to the stage's, as `stage_position` and `stage_normal` in `api.wgsl`.
struct Space {
    rows: [Vec3; 3],
    origin: Vec3,
}

impl Space {
    fn new(instance: &Instance, view: &StageView) -> Self {
        let rows = instance.rows.map(|[x, y, z, _]| Vec3::new(x, y, z));
        let origin = Vec3::from(instance.rows.map(|row| row[3])) - Vec3::from(view.anchor);
        Self { rows, origin }
    }

    fn position(&self, local: Vec3) -> Vec3 {
        Vec3::from(self.rows.map(|row| row.dot(local))) + self.origin
    }

    fn normal(&self, local: Vec3) -> Vec3 {
        let [x, y, z] = self.rows;
        let n = Vec3::new(
            y.cross(z).dot(local),
            z.cross(x).dot(local),
            x.cross(y).dot(local),
        );
        // Scaled first: the squares of tiny cofactors vanish.
        (n / n.abs().max_element())
            .try_normalize()
            .unwrap_or(Vec3::Y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Domain, PatchLayout};

    struct Flat;

    impl HostFunctions for Flat {
        fn control(&self, patch: &HostPatch, _: &StageView) -> Levels {
            Levels::uniform(patch.instance.params[0][0])
        }
        fn evaluate(&self, _: &HostPatch, at: Vec3) -> HostVertex {
            HostVertex {
                position: at,
                normal: Vec3::Z,
                uv: at.truncate(),
                material: 3,
            }
        }
    }

    fn quad() -> Arc<PatchMesh> {
        let mesh = PatchMesh::new(PatchLayout::QUAD, vec![[0.0; 4]; 4], vec![0, 1, 2, 3]);
        Arc::new(mesh.expect("one patch"))
    }

    fn instance(level: f32, x: f32) -> Instance {
        let mut instance = Instance::IDENTITY;
        instance.params[0][0] = level;
        instance.rows[0][3] = x;
        instance
    }

    fn run(entities: &[(Arc<PatchMesh>, Instance)], pools: [u32; 2]) -> HostTessellation {
        let quads = Tessellator {
            domain: Domain::Quads,
            ..Default::default()
        };
        let view: StageView = bytemuck::Zeroable::zeroed();
        tessellate_host(&quads, entities, &Flat, &view, pools, 1.0)
    }

    #[test]
    fn entities_follow_each_other() {
        let made = run(
            &[(quad(), instance(1.0, 0.0)), (quad(), instance(2.0, 10.0))],
            [99, 99],
        );
        assert_eq!((made.head.vertices, made.head.primitives), (4 + 9, 2 + 8));
        assert_eq!(made.head.indexed, [30, 1, 0, 0, 0]);
        assert!(
            made.indices[6..]
                .iter()
                .all(|index| (4..13).contains(index))
        );
        let x = |k: usize| f32::from_bits(made.vertices[k][0]);
        assert!((0..4).all(|k| x(k) <= 1.0) && (4..13).all(|k| (10.0..=11.0).contains(&x(k))));
    }

    #[test]
    fn pools_are_never_overrun_and_other_cameras_see_nothing() {
        let many = [(quad(), instance(8.0, 0.0)), (quad(), instance(8.0, 1.0))];
        for pools in [[4, 2], [90, 150], [100, 1], [1, 100]] {
            let made = run(&many, pools);
            assert!(made.vertices.len() <= pools[0] as usize);
            assert!(made.indices.len() <= 3 * pools[1] as usize);
            let held = made.vertices.len() as u32;
            assert!(made.indices.iter().all(|index| *index < held), "{pools:?}");
        }
        let mut other = instance(8.0, 0.0);
        other.camera[0] = 7.0;
        let made = run(&[(quad(), other)], [99, 999]);
        assert_eq!((made.vertices.len(), made.head.discarded), (0, 1));
    }
}
