//! The passes of a choice, recorded as an app records them, and their buffers.

use std::collections::HashMap;

use bytemuck::{bytes_of, cast_slice};
use dolomite_geometry::layout::{GeometryHead, VERTEX_BYTES};
use dolomite_ground::detail::DetailCells;
use dolomite_ground::detail::layout::{
    ALL_COUNT_WORDS, ARGUMENT_BYTES, Beginning, CLOSING_BYTES, DEPTH_PASSES, DetailParams,
    DetailPass, Groups, LAST_PASSES, LEAST_CAPACITY, LIST_BYTES, RECORD_BYTES, STOCK_HEAD_BYTES,
    Second, VIEW_CELL_BYTES, arguments_at, without,
};
use dolomite_ground::render::detail::record::{Extras, Step as DetailStep, steps};

use super::view::{Chosen, POOLS};
use crate::capsule::CapsuleError;
use crate::capsule::builder::Builder;
use crate::capsule::format::{BindingKind, Command, Indirect, Step};

/// What is recorded, and its buffers.
pub(super) struct Run {
    pub builder: Builder,
    pub params: DetailParams,
    defs: Vec<&'static str>,
    shared_layout: u32,
    /// Of each depth.
    shared: Vec<u32>,
    /// Layout and group of each [`Second`]; of arguments there are two groups, by the depth.
    ground: [u32; 2],
    arguments: (u32, [u32; 2]),
    placed: [u32; 2],
    joined: [u32; 2],
    headed: [u32; 2],
    indirect: [u32; 2],
    closing: u32,
    /// What answers share with the choice.
    pub answering: [u32; 2],
    pub corners: u32,
    pub vertices: u32,
    pub indices: u32,
    pub head: u32,
}

impl Run {
    pub fn new(
        name: &str,
        about: &str,
        cells: &DetailCells,
        chosen: &Chosen,
    ) -> Result<Self, CapsuleError> {
        let mut builder = Builder::new(name, about);
        let capacity = LEAST_CAPACITY;
        let room = u64::from(capacity);
        let params = DetailParams {
            stamp: 1,
            anchor_height: chosen.anchor_height,
            ..DetailParams::new(cells, chosen.view, capacity, POOLS)
        };
        let beginning = Beginning::new(cells);
        let uniform = builder.buffer("params", bytes_of(&params));
        let kept = [
            builder.filled("cells", 96 * room, 0),
            builder.begun("links", 16 * room, cast_slice(&beginning.links)),
            builder.filled("seen", VIEW_CELL_BYTES * room, 0),
            builder.begun(
                "counts",
                4 * ALL_COUNT_WORDS as u64,
                cast_slice(&beginning.counts(true)),
            ),
            builder.begun(
                "lists",
                LIST_BYTES * room,
                cast_slice(&beginning.lists(capacity)),
            ),
        ];
        let stock = builder.begun(
            "stock",
            STOCK_HEAD_BYTES + room,
            cast_slice(&beginning.stock()),
        );
        let arguments = beginning.arguments(true);
        let indirect = ["arguments of even depths", "arguments of odd depths"]
            .map(|name| builder.begun(name, ARGUMENT_BYTES, cast_slice(&arguments)));
        let closing = builder.begun(
            "closing arguments",
            CLOSING_BYTES,
            cast_slice(&Beginning::CLOSING),
        );
        let corners = builder.buffer("corners", cast_slice(&beginning.corners));
        let given = cells.terrain().gpu();
        let terrain = [
            builder.buffer("layers", cast_slice(&given.layers)),
            builder.buffer("data", cast_slice(&given.data)),
            builder.buffer("terrain", bytes_of(&given.uniform)),
        ];
        let vertices = builder.filled("vertices", VERTEX_BYTES * u64::from(POOLS[0]), 0xAB);
        let indices = builder.filled("indices", 12 * u64::from(POOLS[1]), 0xAB);
        let head = builder.filled("head", size_of::<GeometryHead>() as u64, 0xAB);
        let records = builder.filled("records", RECORD_BYTES * u64::from(POOLS[0]), 0xAB);

        let (uniform_kind, read, write) = (
            BindingKind::Uniform,
            BindingKind::ReadOnlyStorage,
            BindingKind::Storage,
        );
        let shared_layout = builder.layout(&[
            uniform_kind,
            uniform_kind,
            write,
            write,
            write,
            write,
            write,
        ]);
        let [cells_made, links, seen, counts, lists] = kept;
        let depths: Vec<u32> = (0..=params.depth)
            .map(|depth| {
                let pass = DetailPass {
                    depth,
                    ..DetailPass::default()
                };
                builder.buffer("depth", bytes_of(&pass))
            })
            .collect();
        let shared = depths.iter().map(|&pass| {
            let bound = [uniform, pass, cells_made, links, seen, counts, lists];
            builder.group(shared_layout, &bound)
        });
        let shared = shared.collect();
        let mut both = |kinds: &[BindingKind], buffers: &[u32]| {
            let layout = builder.layout(kinds);
            [layout, builder.group(layout, buffers)]
        };
        let ground = both(&[read, read, uniform_kind], &terrain);
        let [even, odd] = indirect;
        // An even depth reads its own arguments and writes those of the odd ones.
        let [arguments_layout, of_even] = both(&[write; 3], &[odd, closing, stock]);
        let placed = both(&[read, write, write], &[corners, vertices, records]);
        let joined = both(&[read, write], &[vertices, indices]);
        let headed = both(&[write; 3], &[head, closing, stock]);
        let kinds = [uniform_kind, uniform_kind, write, write, write, write];
        let bound = [uniform, depths[0], cells_made, links, seen, counts];
        let answering = both(&kinds, &bound);
        let of_odd = builder.group(arguments_layout, &[even, closing, stock]);
        Ok(Self {
            defs: without(cells.terrain()),
            builder,
            params,
            shared_layout,
            shared,
            ground,
            arguments: (arguments_layout, [of_even, of_odd]),
            placed,
            joined,
            headed,
            indirect,
            closing,
            answering,
            corners,
            vertices,
            indices,
            head,
        })
    }

    /// Layout and group of what a pass binds as group 1.
    const fn second(&self, second: Second, depth: u32) -> Option<[u32; 2]> {
        match second {
            Second::Nothing => None,
            Second::Ground => Some(self.ground),
            Second::Arguments => Some([self.arguments.0, self.arguments.1[(depth & 1) as usize]]),
            Second::Vertices => Some(self.placed),
            Second::Triangles => Some(self.joined),
            Second::Head => Some(self.headed),
        }
    }

    /// Records a choice as `record_step` does.
    pub fn choose(&mut self) -> Result<(), CapsuleError> {
        let passes: Vec<_> = DEPTH_PASSES.iter().chain(&LAST_PASSES).collect();
        let mut pipelines: HashMap<usize, u32> = HashMap::new();
        let mut recorded = Vec::new();
        let all: Vec<DetailStep> = steps(self.params.depth, Extras::default()).collect();
        for step in all {
            let (file, entry, second, groups) = *passes[step.pipeline];
            let bound = self.second(second, step.depth);
            let pipeline = match pipelines.get(&step.pipeline) {
                Some(known) => *known,
                None => {
                    let defs: &[&str] = match second {
                        Second::Ground => &self.defs,
                        _ => &[],
                    };
                    let module = dolomite_shaders::compose(file, defs)?;
                    let module = self.builder.module(file, defs, &module)?;
                    let layouts: Vec<u32> = [self.shared_layout]
                        .into_iter()
                        .chain(bound.map(|[layout, _]| layout))
                        .collect();
                    let made = self.builder.pipeline(module, entry, &layouts);
                    pipelines.insert(step.pipeline, made);
                    made
                }
            };
            let own = self.indirect[(step.depth & 1) as usize];
            let indirect = match groups {
                Groups::Make | Groups::Look => Some((own, arguments_at(step.depth, groups))),
                Groups::Kept | Groups::Horizon => Some((self.closing, 0)),
                Groups::One | Groups::Blocks => None,
            };
            recorded.push(Step {
                pipeline,
                groups: [self.shared[step.depth as usize]]
                    .into_iter()
                    .chain(bound.map(|[_, group]| group))
                    .collect(),
                dispatch: indirect.is_none().then_some([1; 3]),
                indirect: indirect.map(|(buffer, offset)| Indirect { buffer, offset }),
            });
        }
        self.builder.command(Command::Pass { steps: recorded });
        Ok(())
    }
}
