//! What the passes read of a kind's entities: owners of corners and edges, patches, control points.
//!
//! Tables are words: the owners of all corners, those of all edges, twelve words a patch (entity,
//! number in its mesh, first index, first point, four corners, four edges; with split sides eight
//! more: [`Topology::halves`](super::patches::Topology::halves)), then the control point indices of
//! each mesh. Data are vec4: eleven an entity ([`Instance`]), then the control points.

use std::collections::HashMap;
use std::sync::Arc;

use bytemuck::{Pod, Zeroable};
use dolomite_geometry::layout::EVALUATED_BYTES;

use super::layout::{SEGMENT_BYTES, StageParams};
use super::patches::{BINDING_LIMIT, WHOLE};
use super::{PatchLayout, PatchMesh};

/// One entity, as the shaders read it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable, PartialEq)]
pub struct Instance {
    /// To the world, row by row.
    pub rows: [[f32; 4]; 3],
    /// The same in the last frame.
    pub previous: [[f32; 4]; 3],
    /// Parameters, as `entity_params` gives them.
    pub params: [[f32; 4]; 4],
    /// Number of the only camera that sees it ([`StageView`](super::layout::StageView)'s `camera`);
    /// 0: all do. Then the layers that it is in, 16 bits each ([`layer_words`]); both 0: in all. The last is
    /// unused.
    pub camera: [f32; 4],
}

impl Instance {
    /// Where its mesh stands, with all parameters 0.
    pub const IDENTITY: Self = Self {
        rows: Self::UNIT_ROWS,
        previous: Self::UNIT_ROWS,
        params: [[0.0; 4]; 4],
        camera: [0.0; 4],
    };

    const UNIT_ROWS: [[f32; 4]; 3] = [
        [1.0, 0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0],
    ];
}

/// Layers 0 to 31, one a bit, as two numbers that are exact as f32.
#[must_use]
pub const fn layer_words(layers: u32) -> [f32; 2] {
    [(layers & 0xffff) as f32, (layers >> 16) as f32]
}

impl Instance {
    /// The same, in these layers.
    #[must_use]
    pub const fn in_layers(mut self, layers: u32) -> Self {
        let [low, high] = layer_words(layers);
        self.camera[1] = low;
        self.camera[2] = high;
        self
    }

    /// Whether a camera that sees `layers` sees the entity, as `entity_seen` in `api.wgsl` has it.
    #[must_use]
    pub const fn is_in(&self, layers: u32) -> bool {
        let own = self.camera[1] as u32 | ((self.camera[2] as u32) << 16);
        own == 0 || own & layers != 0
    }
}

/// The buffers of a kind's entities.
#[derive(Clone, Debug)]
pub struct Tables {
    /// Owners, patches, control point indices.
    pub words: Vec<u32>,
    /// Entities, control points.
    pub data: Vec<[f32; 4]>,
    /// Counts and places; the view and the pools are left 0.
    pub params: StageParams,
}

impl Tables {
    /// Tables of entities whose meshes all have `layout`.
    ///
    /// # Errors
    /// The bytes of the buffer that would be larger than [`BINDING_LIMIT`].
    pub fn new(layout: PatchLayout, entities: &[(Arc<PatchMesh>, Instance)]) -> Result<Self, u64> {
        let (mut corners, mut edges, mut patches) = (Vec::new(), Vec::new(), Vec::<u32>::new());
        let (mut indices, mut points) = (Vec::new(), Vec::new());
        // Entities of one mesh share its control points: where they and their indices begin.
        let mut known: HashMap<*const PatchMesh, (u32, u32)> = HashMap::new();
        let patch_words = layout.patch_words();
        let mut count = 0_u64;
        for (entity, (mesh, _)) in (0_u32..).zip(entities) {
            count += mesh.patches() as u64;
            let bytes = count * patch_words * 4;
            if bytes > BINDING_LIMIT {
                return Err(bytes);
            }
            let (first_index, first_point) = *known.entry(Arc::as_ptr(mesh)).or_insert_with(|| {
                let first = (
                    indices.len() as u32,
                    points.len() as u32 / layout.point_size,
                );
                indices.extend_from_slice(mesh.indices());
                points.extend_from_slice(mesh.points());
                first
            });
            let topology = mesh.topology();
            let first_patch = patches.len() as u32 / patch_words as u32;
            let (first_corner, first_edge) = (corners.len() as u32, edges.len() as u32);
            corners.extend(topology.corners.iter().map(|owner| owner + 4 * first_patch));
            edges.extend(topology.edges.iter().map(|owner| owner + 4 * first_patch));
            for (number, shared) in (0_u32..).zip(&topology.patches) {
                patches.extend([
                    entity,
                    number,
                    first_index + number * layout.points,
                    first_point,
                ]);
                patches.extend(shared[..4].iter().map(|corner| corner + first_corner));
                // The sum leaves the mark of reversal in the top bit alone.
                patches.extend(shared[4..].iter().map(|edge| edge + first_edge));
                if let Some(halves) = topology.halves.get(number as usize) {
                    let moved =
                        |word: &u32, by: u32| if *word == WHOLE { WHOLE } else { word + by };
                    patches.extend(halves[..4].iter().map(|corner| moved(corner, first_corner)));
                    patches.extend(halves[4..].iter().map(|edge| moved(edge, first_edge)));
                }
            }
        }
        let mut params = StageParams::zeroed();
        params.corners = corners.len() as u32;
        params.edges = edges.len() as u32;
        params.patches = count as u32;
        params.edge_table = params.corners;
        params.patch_table = params.corners + params.edges;
        params.points = entities.len() as u32 * (size_of::<Instance>() / 16) as u32;
        params.point_size = layout.point_size;
        params.split = u32::from(layout.split);
        let index_table = params.patch_table + patches.len() as u32;
        for patch in patches.chunks_exact_mut(patch_words as usize) {
            patch[2] += index_table;
        }
        let words: Vec<u32> = [corners, edges, patches, indices].concat();
        let mut data: Vec<[f32; 4]> = entities
            .iter()
            .flat_map(|(_, instance)| bytemuck::cast::<_, [[f32; 4]; 11]>(*instance))
            .collect();
        data.extend(points);
        // The work buffer has to have room for the largest pools as well.
        let mut most = params;
        most.max_vertices = (BINDING_LIMIT / EVALUATED_BYTES) as u32;
        most.max_primitives = (BINDING_LIMIT / SEGMENT_BYTES) as u32;
        let greatest = (words.len() as u64 * 4)
            .max(data.len() as u64 * 16)
            .max(most.work_bytes());
        if greatest > BINDING_LIMIT {
            return Err(greatest);
        }
        Ok(Self {
            words,
            data,
            params,
        })
    }
}
