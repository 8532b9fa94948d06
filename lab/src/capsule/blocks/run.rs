//! The passes that choose and make blocks, recorded as an app records them, and their buffers.

use std::collections::HashMap;

use bytemuck::{bytes_of, cast_slice};
use dolomite_geometry::layout::{GeometryHead, VERTEX_BYTES};
use dolomite_ground::blocks::layout::{
    ARGUMENT_BYTES, Beginning, BlockNumbers, COUNT_WORDS, Groups, HEAD_BYTES, LOOKED_BYTES,
    MOST_MADE, PASSES, RECORD_WORDS, SAMPLE_BYTES, SEEN_BYTES, STOCK_HEAD_BYTES, Second, done_at,
    list_words, made_at, slot_groups,
};
use dolomite_ground::detail::DetailGround;
use dolomite_ground::detail::layout::{DetailParams, without};
use dolomite_ground::render::blocks::record::{Extras, Step as BlockStep, steps};

use super::view::{Chosen, POOLS};
use crate::capsule::CapsuleError;
use crate::capsule::builder::Builder;
use crate::capsule::format::{BindingKind, Command, Indirect, Step};

/// Slots of blocks.
pub(super) const SLOTS: u32 = 256;

/// A bind group and its layout.
#[derive(Clone, Copy)]
pub(super) struct Bound {
    pub layout: u32,
    pub group: u32,
}

/// What is recorded, and its buffers.
pub(super) struct Run {
    pub builder: Builder,
    pub params: DetailParams,
    defs: Vec<&'static str>,
    roots: u32,
    pub shared: Bound,
    looked: Bound,
    arguments: Bound,
    triangles: Bound,
    ground: Bound,
    headed: Bound,
    told: u32,
    looked_arguments: u32,
    other_arguments: u32,
    counts: u32,
    lists: u32,
    /// Bound where a shader has no binding: a capsule's are numbered from 0 on.
    pub nothing: u32,
    pub heads: u32,
    pub vertices: u32,
    pub indices: u32,
    pub head: u32,
}

impl Run {
    pub fn new(name: &str, about: &str, ground: &DetailGround, chosen: &Chosen) -> Self {
        let mut builder = Builder::new(name, about);
        let room = u64::from(SLOTS);
        let mut params = DetailParams {
            stamp: 1,
            anchor_height: chosen.anchor_height,
            ..DetailParams::new(ground, chosen.view, SLOTS, POOLS)
        };
        if let Some(picture) = &chosen.picture {
            params = params.cull(picture, true);
        }
        let beginning = Beginning::new(&ground.lattice);
        let mut begun = vec![0_u32; made_at(SLOTS) as usize];
        begun.extend(&beginning.made);
        let told = builder.buffer("params", bytes_of(&params));
        let numbers = builder.buffer("numbers", bytes_of(&BlockNumbers::new(MOST_MADE)));
        let records = builder.filled("records", 4 * RECORD_WORDS as u64 * room, 0);
        let heads = builder.begun("heads", HEAD_BYTES * room, cast_slice(&beginning.heads));
        let seen = builder.filled("seen", SEEN_BYTES * room, 0);
        let counts = builder.filled("counts", 4 * COUNT_WORDS as u64, 0);
        let lists = builder.begun("lists", 4 * list_words(SLOTS), cast_slice(&begun));
        let stock = builder.begun(
            "stock",
            STOCK_HEAD_BYTES + 4 * room,
            cast_slice(&beginning.stock()),
        );
        let looked_arguments = builder.filled("arguments of the pass that looks", LOOKED_BYTES, 0);
        let other_arguments = builder.filled("arguments of the others", ARGUMENT_BYTES, 0);
        let samples = builder.filled("samples", SAMPLE_BYTES, 0);
        let given = ground.terrain().gpu();
        let data: &[u32] = if given.data.is_empty() {
            &[0]
        } else {
            &given.data
        };
        let terrain = [
            builder.buffer("layers", cast_slice(&given.layers)),
            builder.buffer("data", cast_slice(data)),
            builder.buffer("terrain", bytes_of(&given.uniform)),
        ];
        let vertices = builder.filled("vertices", VERTEX_BYTES * u64::from(POOLS[0]), 0xAB);
        let indices = builder.filled("indices", 12 * u64::from(POOLS[1]), 0xAB);
        let head = builder.filled("head", size_of::<GeometryHead>() as u64, 0xAB);
        let nothing = builder.filled("nothing", 16, 0);

        let (uniform, read, write) = (
            BindingKind::Uniform,
            BindingKind::ReadOnlyStorage,
            BindingKind::Storage,
        );
        let mut bound = |kinds: &[BindingKind], buffers: &[u32]| {
            let layout = builder.layout(kinds);
            let group = builder.group(layout, buffers);
            Bound { layout, group }
        };
        let shared = bound(
            &[uniform, uniform, write, write, write, write, write],
            &[told, numbers, records, heads, seen, counts, lists],
        );
        let looked = bound(&[write], &[looked_arguments]);
        let arguments = bound(&[write; 3], &[looked_arguments, other_arguments, stock]);
        let triangles = bound(&[write; 2], &[vertices, indices]);
        let [layers, data, of_terrain] = terrain;
        let bound_ground = bound(
            &[read, read, uniform, write],
            &[layers, data, of_terrain, samples],
        );
        let headed = bound(&[write, uniform, write], &[head, nothing, stock]);
        Self {
            builder,
            params,
            defs: without(ground.terrain()),
            roots: beginning.made.len() as u32,
            shared,
            looked,
            arguments,
            triangles,
            ground: bound_ground,
            headed,
            told,
            looked_arguments,
            other_arguments,
            counts,
            lists,
            nothing,
            heads,
            vertices,
            indices,
            head,
        }
    }

    /// What a pass binds as group 1.
    const fn second(&self, second: Second) -> Option<Bound> {
        match second {
            Second::Nothing => None,
            Second::Looked => Some(self.looked),
            Second::Arguments => Some(self.arguments),
            Second::Triangles => Some(self.triangles),
            Second::Ground => Some(self.ground),
            Second::Head => Some(self.headed),
        }
    }

    /// Records so many choices, each with the blocks that it makes for the next, as `record_step` does.
    pub fn choose(&mut self, rounds: u32) -> Result<(), CapsuleError> {
        let mut pipelines: HashMap<usize, u32> = HashMap::new();
        for round in 1..=rounds {
            self.params.stamp = round;
            self.write_stamp(round);
            for (buffer, size) in [
                (self.looked_arguments, LOOKED_BYTES),
                (self.counts, 4 * COUNT_WORDS as u64),
            ] {
                let offset = 0;
                self.builder.command(Command::Clear {
                    buffer,
                    offset,
                    size,
                });
            }
            self.builder.command(Command::Clear {
                buffer: self.lists,
                offset: 4 * done_at(SLOTS),
                size: 4,
            });
            let extras = Extras {
                roots: (round == 1).then_some(self.roots),
                ..Extras::default()
            };
            let recorded = steps(extras)
                .map(|step| self.step(step, &mut pipelines))
                .collect::<Result<_, _>>()?;
            self.builder.command(Command::Pass { steps: recorded });
        }
        Ok(())
    }

    fn write_stamp(&mut self, stamp: u32) {
        let data = self.builder.data(bytes_of(&stamp));
        self.builder.command(Command::Write {
            buffer: self.told,
            offset: core::mem::offset_of!(DetailParams, stamp) as u64,
            data,
        });
    }

    fn step(
        &mut self,
        step: BlockStep,
        pipelines: &mut HashMap<usize, u32>,
    ) -> Result<Step, CapsuleError> {
        let (file, entry, second, groups) = PASSES[step.pass];
        let bound = self.second(second);
        let pipeline = match pipelines.get(&step.pass) {
            Some(known) => *known,
            None => {
                let defs: &[&str] = match second {
                    Second::Ground => &self.defs,
                    _ => &[],
                };
                let module = dolomite_shaders::compose(file, defs)?;
                let module = self.builder.module(file, defs, &module)?;
                let layouts: Vec<u32> = [self.shared.layout]
                    .into_iter()
                    .chain(bound.map(|bound| bound.layout))
                    .collect();
                let made = self.builder.pipeline(module, entry, &layouts);
                pipelines.insert(step.pass, made);
                made
            }
        };
        let at = |buffer, offset| (None, Some(Indirect { buffer, offset }));
        let (dispatch, indirect) = match (step.groups, groups) {
            (Some(groups), _) => (Some(groups), None),
            (None, Groups::One | Groups::Edit) => (Some([1; 3]), None),
            (None, Groups::Slots | Groups::Sweep) => (Some([slot_groups(SLOTS), 1, 1]), None),
            (None, Groups::Looked) => at(self.looked_arguments, 0),
            (None, Groups::At(offset) | Groups::Horizon(offset) | Groups::EditAt(offset)) => {
                at(self.other_arguments, offset)
            }
        };
        Ok(Step {
            pipeline,
            groups: [self.shared.group]
                .into_iter()
                .chain(bound.map(|bound| bound.group))
                .collect(),
            dispatch,
            indirect,
        })
    }
}
