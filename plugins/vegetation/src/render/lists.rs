//! The lists of records: of each shape one a level of detail, with what is drawn of a record.

use bevy::mesh::PrimitiveTopology;

use super::layout::{LISTS, RECORD_ALIGN};
use crate::blade::SEGMENTS;
use crate::blossom::{MIDDLE, PETAL};
use crate::kind::{Kind, Shape};

/// What is drawn of the records of a list.
#[derive(Clone, Copy, Debug)]
pub struct List {
    /// Name of its pipelines.
    pub label: &'static str,
    /// File of its shaders.
    pub file: &'static str,
    /// Definition of its level of detail; none for the finest.
    pub def: Option<&'static str>,
    /// Of the vertices of a record.
    pub topology: PrimitiveTopology,
    /// Its part of the pool, beside the parts of the other lists that are used.
    pub part: u32,
}

const fn list(
    label: &'static str,
    file: &'static str,
    def: Option<&'static str>,
    topology: PrimitiveTopology,
    part: u32,
) -> List {
    List {
        label,
        file,
        def,
        topology,
        part,
    }
}

/// First list of blades, of [`SEGMENTS`]' levels of detail.
pub const BLADES: usize = 0;
/// First list of flowers, of two levels of detail.
pub const FLOWERS: usize = 3;
/// First list of chains, of three levels of detail: all nodes, each second, each fourth.
pub const CHAINS: usize = 5;

const BLADE: &str = "vegetation/draw.wgsl";
const FLOWER: &str = "vegetation/draw_flower.wgsl";
const CHAIN: &str = "vegetation/draw_chain.wgsl";
const STRIP: PrimitiveTopology = PrimitiveTopology::TriangleStrip;

/// All lists.
pub const LIST: [List; LISTS] = [
    list("vegetation_blades 15", BLADE, None, STRIP, 8),
    list("vegetation_blades 7", BLADE, Some("BLADE_OF_7"), STRIP, 16),
    list("vegetation_blades 3", BLADE, Some("BLADE_OF_3"), STRIP, 40),
    list(
        "vegetation_flowers",
        FLOWER,
        None,
        PrimitiveTopology::TriangleList,
        1,
    ),
    list(
        "vegetation_flowers far",
        FLOWER,
        Some("FLOWER_FAR"),
        PrimitiveTopology::TriangleList,
        3,
    ),
    list("vegetation_chains", CHAIN, None, STRIP, 1),
    list(
        "vegetation_chains by 2",
        CHAIN,
        Some("CHAIN_BY_2"),
        STRIP,
        1,
    ),
    list(
        "vegetation_chains by 4",
        CHAIN,
        Some("CHAIN_BY_4"),
        STRIP,
        2,
    ),
];

/// Definitions with which a list is drawn.
#[must_use]
pub fn draw_defs(list: usize, normals: bool, motion: bool) -> Vec<&'static str> {
    let level = LIST[list].def;
    let normals = normals.then_some("NORMAL_PREPASS");
    let motion = motion.then_some("MOTION_VECTORS");
    [level, normals, motion].into_iter().flatten().collect()
}

/// Definitions with which a list is drawn for the ranks of what stands.
#[must_use]
pub fn rank_defs(list: usize) -> Vec<&'static str> {
    let level = LIST[list].def;
    level.into_iter().chain(["RANK"]).collect()
}

/// Definitions with which shadows of blades are drawn.
pub const SHADOW_DEFS: [&str; 2] = ["SHADOW", "BLADE_OF_3"];

/// Vertices of a record of each list, for these kinds; 0 for a list that no kind uses.
#[must_use]
pub fn vertices_of<'a>(kinds: impl Iterator<Item = &'a Kind>) -> [u32; LISTS] {
    let mut vertices = [0; LISTS];
    let mut set = |list: usize, count: u32| vertices[list] = vertices[list].max(count);
    for kind in kinds {
        match &kind.shape {
            Shape::Blade(_) => {
                for (k, segments) in SEGMENTS.into_iter().enumerate() {
                    set(BLADES + k, 2 * segments + 1);
                }
            }
            Shape::Flower(flower) => {
                // Stems of three segments and of one.
                set(FLOWERS, 15 + PETAL * flower.petals + MIDDLE);
                set(FLOWERS + 1, 3 + MIDDLE);
            }
            Shape::Chain(chain) => {
                for (k, step) in [1, 2, 4].into_iter().enumerate() {
                    set(CHAINS + k, 2 * (chain.segments.div_ceil(step) + 1));
                }
            }
            Shape::Mesh(_) => {}
        }
    }
    vertices
}

/// Room of each list in a pool of so many records, and where its records begin: by the parts of the lists that are used,
/// the last of which has the rest. A list that is not used has as little as can be bound.
#[must_use]
pub fn rooms_of(records: u32, vertices: [u32; LISTS]) -> ([u32; LISTS], [u32; LISTS]) {
    let all = records.clamp(RECORD_ALIGN * LISTS as u32, 1 << 23);
    let used = |list: usize| vertices[list] > 0;
    let parts: u32 = (0..LISTS).filter(|k| used(*k)).map(|k| LIST[k].part).sum();
    let mut rooms = [RECORD_ALIGN; LISTS];
    let spare = u64::from(all - RECORD_ALIGN * LISTS as u32);
    for (list, room) in rooms.iter_mut().enumerate().filter(|(k, _)| used(*k)) {
        let share = spare * u64::from(LIST[list].part) / u64::from(parts.max(1));
        *room += share as u32 / RECORD_ALIGN * RECORD_ALIGN;
    }
    let mut bases = [0; LISTS];
    for list in 1..LISTS {
        bases[list] = bases[list - 1] + rooms[list - 1];
    }
    (rooms, bases)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kind::Kinds;

    /// Rooms follow each other, aligned, within the pool, and what no kind uses has next to none.
    #[test]
    fn rooms_are_parts_of_the_pool() {
        let kinds = Kinds::small_set();
        let grass = vertices_of(kinds.kinds[..1].iter());
        assert_eq!(grass, [15, 7, 3, 0, 0, 0, 0, 0]);
        let all = vertices_of(kinds.kinds.iter());
        assert_eq!(all, [15, 7, 3, 108, 15, 66, 34, 18]);
        for (vertices, records) in [(grass, 1 << 20), (all, 1 << 20), (all, 1), (grass, 1000)] {
            let (rooms, bases) = rooms_of(records, vertices);
            let mut next = 0;
            for list in 0..LISTS {
                assert_eq!(bases[list], next);
                assert!(rooms[list] >= RECORD_ALIGN && rooms[list].is_multiple_of(RECORD_ALIGN));
                assert!(vertices[list] > 0 || rooms[list] == RECORD_ALIGN);
                next += rooms[list];
            }
            let most = records.max(RECORD_ALIGN * LISTS as u32);
            assert!(next <= most && next + RECORD_ALIGN * LISTS as u32 >= most);
        }
    }

    #[test]
    fn lists_are_told_apart() {
        for (k, list) in LIST.iter().enumerate() {
            assert!(LIST[..k].iter().all(|other| other.label != list.label));
        }
        assert_eq!(draw_defs(0, false, false), [""; 0]);
        assert_eq!(
            draw_defs(4, true, true),
            ["FLOWER_FAR", "NORMAL_PREPASS", "MOTION_VECTORS"]
        );
    }
}
