//! A block: what stands in a cell of the grid, as one record of 64 bytes.

use bytemuck::{Pod, Zeroable};

use crate::hash::{cell_hash, salted, unit};
use crate::lamp;
use crate::rules::CityRules;
use crate::streets::{Cell, EAST, NORTH, SOUTH, WEST, street_at};
use crate::surface::Surface;

/// What stands in a cell. Made of the rules and the place alone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct Block {
    /// Its cell.
    pub cell: Cell,
    /// Hash of its place.
    pub hash: u32,
    /// Bits 0 to 3: sides along streets. Bits 4 to 7: lots with a building. Bits 8 to 11: sides with a hedge. Bits
    /// 12 to 15: lots whose walls are plastered.
    pub flags: u32,
    /// Of each lot's building.
    pub storeys: [u8; 4],
    /// Colour of each lot's building, 0 to 7.
    pub tints: [u8; 4],
    /// Where each building stands in its lot, from −127 to 127: west to east, north to south.
    pub shifts: [[i8; 2]; 4],
    /// Length, width, height and place of each side's hedge, from 0 to 255 between the rules' ends.
    pub hedges: [[u8; 4]; 4],
    /// Lamps along each side.
    pub lamps: [u8; 4],
    /// Not used.
    pub pad: [u32; 3],
}

/// A building: a prism over a square, and a truncated pyramid on it. Metres from the cell's north-western corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Building {
    /// Its lot, 0 to 3.
    pub lot: u32,
    /// Middle, east and south.
    pub centre: [f32; 2],
    /// Half of its side.
    pub half: f32,
    /// Storeys.
    pub storeys: u32,
    /// Height of the eaves.
    pub eaves: f32,
    /// Height of the roof's top.
    pub top: f32,
    /// How far the roof's top stands back.
    pub inset: f32,
    /// What its walls are covered with.
    pub walls: Surface,
    /// Colour, 0 to 7.
    pub tint: u32,
}

/// A hedge: a box. Metres from the cell's north-western corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hedge {
    /// Its side.
    pub side: usize,
    /// Middle, east and south.
    pub centre: [f32; 2],
    /// Half of its size, east and south.
    pub half: [f32; 2],
    /// Height.
    pub height: f32,
}

impl Block {
    /// The block of a cell.
    #[must_use]
    pub fn new(rules: &CityRules, cell: Cell) -> Self {
        let hash = cell_hash(rules.seed, cell);
        let mut block = Self {
            cell,
            hash,
            ..Self::default()
        };
        let (low, high) = rules.storeys;
        for lot in 0..rules.lots * rules.lots {
            let own = salted(hash, 16 + lot);
            let k = lot as usize;
            if unit(own) < rules.built {
                block.flags |= 0x10 << lot;
            }
            if unit(salted(own, 1)) < 0.5 {
                block.flags |= 0x1000 << lot;
            }
            // Low houses are the more frequent: the square of an even number.
            let share = unit(salted(own, 2));
            block.storeys[k] = (low + (share * share * (high - low + 1.0)).floor()).min(high) as u8;
            block.tints[k] = (salted(own, 3) & 7) as u8;
            let shift = |salt| (unit(salted(own, salt)) * 255.0 - 127.0).floor().min(127.0) as i8;
            block.shifts[k] = [shift(4), shift(5)];
        }
        for side in 0..4 {
            let own = salted(hash, 32 + side as u32);
            if street_at(rules, cell, side) {
                block.flags |= 1 << side;
            }
            if unit(own) < rules.hedge.share {
                block.flags |= 0x100 << side;
            }
            block.hedges[side] = salted(own, 1).to_le_bytes();
            block.lamps[side] = lamp::count(rules, cell, side) as u8;
        }
        block
    }

    /// Whether there is a street along a side.
    #[must_use]
    pub const fn street(&self, side: usize) -> bool {
        self.flags & (1 << side) != 0
    }

    /// Its buildings.
    pub fn buildings(&self, rules: &CityRules) -> impl Iterator<Item = Building> {
        let (lots, lot_side) = (rules.lots, rules.lot());
        let first = 0.5 * rules.street + rules.verge();
        let free = 0.5 * (lot_side - rules.footprint) - 0.25;
        let half = 0.5 * rules.footprint;
        let (storey, roof, block) = (rules.storey, rules.roof, *self);
        (0..lots * lots)
            .filter(move |lot| block.flags & (0x10 << lot) != 0)
            .map(move |lot| {
                let k = lot as usize;
                let place = |number: u32, shift: i8| {
                    first + (number as f32 + 0.5) * lot_side + f32::from(shift) / 127.0 * free
                };
                let storeys = u32::from(block.storeys[k]);
                let eaves = storeys as f32 * storey;
                let plastered = block.flags & (0x1000 << lot) != 0;
                Building {
                    lot,
                    centre: [
                        place(lot % lots, block.shifts[k][0]),
                        place(lot / lots, block.shifts[k][1]),
                    ],
                    half,
                    storeys,
                    eaves,
                    top: eaves + roof.height,
                    inset: roof.inset * 2.0 * half,
                    walls: if plastered {
                        Surface::Plaster
                    } else {
                        Surface::Bricks
                    },
                    tint: u32::from(block.tints[k]),
                }
            })
    }

    /// Its hedges: 1 m behind the kerb, so that one can walk round them.
    pub fn hedges(&self, rules: &CityRules) -> impl Iterator<Item = Hedge> {
        let (pitch, block) = (rules.pitch, *self);
        let middle = 0.5 * pitch;
        let back = 0.5 * rules.street + 1.0 + 0.5 * rules.hedge.width.1;
        let room = 0.5 * (rules.block_side() - 2.0 * rules.verge());
        let hedge = rules.hedge;
        (0..4)
            .filter(move |side| block.flags & (0x100 << side) != 0)
            .map(move |side| {
                let [length, width, height, place] =
                    block.hedges[side].map(|byte| f32::from(byte) / 255.0);
                let between = |(low, high): (f32, f32), share: f32| low + share * (high - low);
                let long = between((0.35, 0.95), length) * room;
                let wide = 0.5 * between(hedge.width, width);
                let along = middle + (2.0 * place - 1.0) * (room - long);
                let (centre, half) = match side {
                    WEST => ([back, along], [wide, long]),
                    EAST => ([pitch - back, along], [wide, long]),
                    NORTH => ([along, back], [long, wide]),
                    _ => ([along, pitch - back], [long, wide]),
                };
                Hedge {
                    side,
                    centre,
                    half,
                    height: between(hedge.height, height),
                }
            })
    }
}

const _: () = assert!(size_of::<Block>() == 64 && SOUTH == 1);

#[cfg(test)]
mod tests {
    use super::*;

    fn blocks(rules: &CityRules) -> Vec<Block> {
        (0..4096)
            .map(|k| Block::new(rules, [k % 64 - 32, k / 64 - 32]))
            .collect()
    }

    #[test]
    fn what_stands_in_a_block_keeps_clear_of_streets_and_of_each_other() {
        for lots in [1, 2] {
            let rules = CityRules {
                lots,
                ..CityRules::default()
            }
            .checked()
            .expect("usual rules");
            let edge = 0.5 * rules.street;
            for block in blocks(&rules) {
                let mut boxes: Vec<([f32; 2], [f32; 2])> = Vec::new();
                boxes.extend(block.buildings(&rules).map(|b| (b.centre, [b.half; 2])));
                boxes.extend(block.hedges(&rules).map(|h| (h.centre, h.half)));
                for (k, (centre, half)) in boxes.iter().enumerate() {
                    for axis in 0..2 {
                        // Half a metre of kerb at least, less a rounding.
                        assert!(centre[axis] - half[axis] > edge + 0.49, "{block:?}");
                        assert!(
                            centre[axis] + half[axis] < rules.pitch - edge - 0.49,
                            "{block:?}"
                        );
                    }
                    for (other, size) in &boxes[..k] {
                        let apart = (0..2)
                            .map(|a| (centre[a] - other[a]).abs() - half[a] - size[a])
                            .fold(f32::MIN, f32::max);
                        assert!(apart > 0.2, "{apart} {block:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn shares_are_those_of_the_rules() {
        let rules = CityRules::default();
        let blocks = blocks(&rules);
        let built: usize = blocks.iter().map(|b| b.buildings(&rules).count()).sum();
        let hedged: usize = blocks.iter().map(|b| b.hedges(&rules).count()).sum();
        // Of 16 384 lots and sides; four standard deviations of such shares are 0.015.
        assert!(
            (built as f32 / 16_384.0 - rules.built).abs() < 0.015,
            "{built}"
        );
        assert!(
            (hedged as f32 / 16_384.0 - rules.hedge.share).abs() < 0.015,
            "{hedged}"
        );
        let mut storeys = [0_usize; 8];
        for block in &blocks {
            for building in block.buildings(&rules) {
                storeys[building.storeys as usize] += 1;
            }
        }
        assert!(storeys[2..7].iter().all(|n| *n > 500), "{storeys:?}");
        assert_eq!(storeys[0] + storeys[1] + storeys[7], 0);
    }

    #[test]
    fn hedges_vary() {
        let rules = CityRules::default();
        let hedges: Vec<Hedge> = blocks(&rules)
            .iter()
            .flat_map(|b| b.hedges(&rules))
            .collect();
        let range = |of: fn(&Hedge) -> f32| {
            let values = hedges.iter().map(of);
            (
                values.clone().fold(f32::MAX, f32::min),
                values.fold(0.0, f32::max),
            )
        };
        assert_eq!(range(|h| h.height), rules.hedge.height);
        let (low, high) = range(|h| h.half[0].max(h.half[1]));
        assert!(high > 2.0 * low, "{low} {high}");
    }
}
