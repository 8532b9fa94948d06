//! A model and its levels of detail.
//!
//! What is solid is simplified by `meshopt`. Leaves are not: a simplifier joins what belongs to different leaves, and
//! the crown shrinks. Of them each level keeps the first ones of a random order, larger by as much as keeps the area
//! (R. Cook and others, *Stochastic Simplification of Aggregate Detail*, SIGGRAPH 2007).

use meshopt::{SimplifyOptions, VertexDataAdapter};

use crate::model::{Leaf, Model};

/// Levels of detail of a model.
pub const LEVELS: usize = 4;

/// What a model is made of.
pub struct Plant {
    /// Trunk and branches, or the whole rock.
    pub solid: Model,
    /// Leaves, in random order.
    pub leaves: Vec<Leaf>,
    /// Share of the triangles of what is solid that each level keeps.
    pub solid_shares: [f32; LEVELS],
    /// Share of the leaves that each level keeps.
    pub leaf_shares: [f32; LEVELS],
}

impl Plant {
    /// The levels, finest first.
    ///
    /// # Errors
    /// Where `meshopt` refuses the vertices.
    pub fn levels(&self) -> Result<Vec<Model>, meshopt::Error> {
        (0..LEVELS).map(|level| self.level(level)).collect()
    }

    fn level(&self, level: usize) -> Result<Model, meshopt::Error> {
        let mut model = simplified(&self.solid, self.solid_shares[level])?;
        let share = self.leaf_shares[level];
        let count = (share * self.leaves.len() as f32).ceil() as usize;
        // The whole area would be kept by 1/√share; large leaves reach out of the crown, so a little less.
        let scale = if share > 0.0 {
            (1.0 / share).sqrt() * (0.78 + 0.22 * share)
        } else {
            1.0
        };
        for leaf in self.leaves.iter().take(count) {
            model.leaf(leaf, scale);
        }
        model.indices = meshopt::optimize_vertex_cache(&model.indices, model.vertices.len());
        model.vertices = meshopt::optimize_vertex_fetch(&mut model.indices, &model.vertices);
        Ok(model)
    }
}

fn simplified(model: &Model, share: f32) -> Result<Model, meshopt::Error> {
    if share >= 1.0 || model.indices.is_empty() {
        return Ok(model.clone());
    }
    let bytes: &[u8] = bytemuck::cast_slice(&model.vertices);
    let stride = size_of::<crate::model::Vertex>();
    let vertices = VertexDataAdapter::new(bytes, stride, 0)?;
    let target = (share * model.indices.len() as f32) as usize / 3 * 3;
    let options = SimplifyOptions::None;
    let indices = meshopt::simplify(&model.indices, &vertices, target, 1.0, options, None);
    let mut kept = Model {
        vertices: model.vertices.clone(),
        indices,
    };
    kept.vertices = meshopt::optimize_vertex_fetch(&mut kept.indices, &kept.vertices);
    Ok(kept)
}
