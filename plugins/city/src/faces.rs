//! From a block to the patches of its ground, walls, roofs and hedges.
//!
//! Coordinates are metres east, up and south of the corner of an `origin` cell near the camera. A line of the grid
//! has one coordinate, computed in one way, for all faces that meet there.

use crate::block::{Block, Building, Hedge};
use crate::map::{DisplacementMap, TEXELS_PER_METRE};
use crate::maps::TILE;
use crate::relief::{CityPatch, PatchData};
use crate::rules::CityRules;
use crate::streets::{Cell, EAST, NORTH, SOUTH, WEST, borders, extent, section};
use crate::surface::Surface;

/// How far walls and hedges reach into the ground, metres: more than the ground is ever displaced.
pub const FOOT: f32 = 0.25;

/// How far below the true ground the flat ground lies that goes on beyond the patches and under them, metres.
pub const SUNK: f32 = 0.02;

/// Makes patches of blocks.
pub struct Faces<'a> {
    rules: &'a CityRules,
    maps: &'a [DisplacementMap],
    origin: Cell,
    /// What was made.
    pub patches: Vec<CityPatch>,
}

/// A face that is cut into patches.
struct Face<'f> {
    surface: Surface,
    /// Which way it looks: 0 up, 1 + side of walls, 5 + side of roofs.
    facing: u32,
    /// Lot and colour, bits 3 to 7 of the material.
    detail: u32,
    borders: [bool; 4],
    /// Metres along its foot, and up in its plane, of the cuts.
    across: &'f [f32],
    up: &'f [f32],
    /// Width of its top.
    top: f32,
    /// Where it begins in the map, metres.
    phase: [f64; 2],
}

/// So many equal parts that none is longer than `most`.
fn parts(length: f32, most: f32) -> u32 {
    ((length / most).ceil() as u32).max(1)
}

/// From `a` to `b`, both exactly.
fn cut(a: f32, b: f32, n: u32) -> Vec<f32> {
    (0..=n)
        .map(|k| {
            let t = k as f32 / n as f32;
            a * (1.0 - t) + b * t
        })
        .collect()
}

impl<'a> Faces<'a> {
    /// Of no block yet.
    #[must_use]
    pub const fn new(rules: &'a CityRules, maps: &'a [DisplacementMap], origin: Cell) -> Self {
        Self {
            rules,
            maps,
            origin,
            patches: Vec::new(),
        }
    }

    /// All of a block. `has` says whether the ground of a cell is there too: where it is not, the ground ends in a
    /// border.
    pub fn block(&mut self, block: &Block, has: impl Fn(Cell) -> bool) {
        self.ground(block.cell, has);
        for building in block.buildings(self.rules) {
            self.building(block.cell, &building);
        }
        for hedge in block.hedges(self.rules) {
            self.hedge(block.cell, &hedge);
        }
    }

    /// Lines 0 (a cell's own line), 1 (its kerb), 2 (the other kerb) and 3 (the next cell's line) along an axis.
    fn line(&self, axis: usize, cell: i32, number: usize) -> f32 {
        let pitch = f64::from(self.rules.pitch);
        let kerb = 0.5 * f64::from(self.rules.street);
        let (cell, within) = match number {
            0 => (cell, 0.0),
            1 => (cell, kerb),
            2 => (cell, pitch - kerb),
            _ => (cell.wrapping_add(1), 0.0),
        };
        (f64::from(cell.wrapping_sub(self.origin[axis])) * pitch + within) as f32
    }

    /// The 3 × 3 sections of a cell.
    pub fn ground(&mut self, cell: Cell, has: impl Fn(Cell) -> bool) {
        let most = self.rules.relief.patch;
        let lines = |axis: usize| {
            [0, 1, 2].map(|k| {
                let (a, b) = (
                    self.line(axis, cell[axis], k),
                    self.line(axis, cell[axis], k + 1),
                );
                // By the rule, not by the rounded coordinates: neighbours have to cut alike.
                let length = [0.5 * self.rules.street, self.rules.block_side()][k % 2];
                cut(a, b, parts(length, most))
            })
        };
        let (xs, zs) = (lines(0), lines(1));
        let [x, z] = cell;
        let ends = [
            !has([x.wrapping_sub(1), z]),
            !has([x, z.wrapping_add(1)]),
            !has([x.wrapping_add(1), z]),
            !has([x, z.wrapping_sub(1)]),
        ];
        for b in 0..3_u32 {
            for a in 0..3_u32 {
                let mut limits = borders(self.rules, cell, [a, b]);
                let outer = [a == 0, b == 2, a == 2, b == 0];
                for side in 0..4 {
                    limits[side] |= outer[side] && ends[side];
                }
                let (columns, rows) = (&xs[a as usize], &zs[b as usize]);
                let across: Vec<f32> = columns.iter().map(|x| x - columns[0]).collect();
                let south = rows[rows.len() - 1];
                let up: Vec<f32> = rows.iter().rev().map(|z| south - z).collect();
                let pitch = f64::from(self.rules.pitch);
                let kerb = 0.5 * f64::from(self.rules.street);
                let world = |cell: i32, k: u32| {
                    f64::from(cell) * pitch + [0.0, kerb, pitch - kerb, pitch][k as usize]
                };
                let face = Face {
                    surface: section(self.rules, cell, [a, b]),
                    facing: 0,
                    detail: 0,
                    borders: limits,
                    across: &across,
                    up: &up,
                    top: across[across.len() - 1],
                    phase: [world(x, a), -world(z, b + 1)],
                };
                let last = rows.len() - 1;
                self.face(&face, |i, j| [columns[i], 0.0, rows[last - j]]);
            }
        }
    }

    /// Four walls and a roof of five faces.
    pub fn building(&mut self, cell: Cell, building: &Building) {
        let most = self.rules.relief.patch;
        let n = parts(2.0 * building.half, most);
        let axis = |k: usize, by: f32| {
            let middle = self.line(k, cell[k], 0) + building.centre[k];
            let half = building.half - by;
            cut(middle - half, middle + half, n)
        };
        let [xs, zs] = [axis(0, 0.0), axis(1, 0.0)];
        let [top_xs, top_zs] = [axis(0, building.inset), axis(1, building.inset)];
        let storeys = ((most / self.rules.storey) as u32).max(1);
        let mut ys = vec![-FOOT];
        ys.extend(
            (1..=building.storeys)
                .filter(|k| k % storeys == 0 || *k == building.storeys)
                .map(|k| k as f32 * self.rules.storey),
        );
        let detail = (building.lot << 3) | (building.tint << 5);
        let height = building.top - building.eaves;
        let slant = (height * height + building.inset * building.inset).sqrt();
        let rows = parts(slant, most);
        let shares = cut(0.0, 1.0, rows);
        let between = |a: f32, b: f32, t: f32| a * (1.0 - t) + b * t;
        let up: Vec<f32> = ys.iter().map(|y| y + FOOT).collect();
        let roof_up: Vec<f32> = shares.iter().map(|t| t * slant).collect();
        let last = n as usize;
        for side in [WEST, SOUTH, EAST, NORTH] {
            // From the left end, seen from outside; `low` picks the coordinate of the wall's plane.
            let backwards = side == EAST || side == NORTH;
            let along_z = side == WEST || side == EAST;
            let index = |i: usize| if backwards { last - i } else { i };
            let (along, plane) = if along_z { (&zs, &xs) } else { (&xs, &zs) };
            let (top_along, top_plane) = if along_z {
                (&top_zs, &top_xs)
            } else {
                (&top_xs, &top_zs)
            };
            let at_end = if side == WEST || side == NORTH {
                0
            } else {
                last
            };
            let across: Vec<f32> = (0..=last)
                .map(|i| (along[index(i)] - along[index(0)]).abs())
                .collect();
            let place = |a: f32, p: f32, y: f32| if along_z { [p, y, a] } else { [a, y, p] };
            let wall = Face {
                surface: building.walls,
                facing: 1 + side as u32,
                detail,
                borders: [true; 4],
                across: &across,
                up: &up,
                top: across[last],
                phase: [0.0, 0.0],
            };
            self.face(&wall, |i, j| place(along[index(i)], plane[at_end], ys[j]));
            let slope = Face {
                surface: Surface::Tiles,
                facing: 5 + side as u32,
                detail,
                borders: [true; 4],
                across: &across,
                up: &roof_up,
                top: (top_along[last] - top_along[0]).abs(),
                phase: [0.0, 0.0],
            };
            self.face(&slope, |i, j| {
                let (i, t) = (index(i), shares[j]);
                place(
                    between(along[i], top_along[i], t),
                    between(plane[at_end], top_plane[at_end], t),
                    between(building.eaves, building.top, t),
                )
            });
        }
        self.lid(Surface::Tiles, detail, &top_xs, &top_zs, building.top);
    }

    /// A level face, all of whose sides are borders.
    fn lid(&mut self, surface: Surface, detail: u32, xs: &[f32], zs: &[f32], y: f32) {
        let across: Vec<f32> = xs.iter().map(|x| x - xs[0]).collect();
        let last = zs.len() - 1;
        let up: Vec<f32> = zs.iter().rev().map(|z| zs[last] - z).collect();
        let face = Face {
            surface,
            facing: 9,
            detail,
            borders: [true; 4],
            across: &across,
            up: &up,
            top: across[across.len() - 1],
            phase: [0.0, 0.0],
        };
        self.face(&face, |i, j| [xs[i], y, zs[last - j]]);
    }

    /// A box without a floor.
    pub fn hedge(&mut self, cell: Cell, hedge: &Hedge) {
        let most = self.rules.relief.patch;
        let axis = |k: usize| {
            let middle = self.line(k, cell[k], 0) + hedge.centre[k];
            let half = hedge.half[k];
            cut(middle - half, middle + half, parts(2.0 * half, most))
        };
        let (xs, zs) = (axis(0), axis(1));
        let ys = cut(-FOOT, hedge.height, parts(hedge.height + FOOT, most));
        let up: Vec<f32> = ys.iter().map(|y| y + FOOT).collect();
        // Every hedge has leaves of its own.
        let phase = [
            f64::from(hedge.centre[0]) * 3.7,
            f64::from(hedge.centre[1]) * 5.3,
        ];
        for side in [WEST, SOUTH, EAST, NORTH] {
            let backwards = side == EAST || side == NORTH;
            let along_z = side == WEST || side == EAST;
            let (along, plane) = if along_z { (&zs, &xs) } else { (&xs, &zs) };
            let last = along.len() - 1;
            let index = |i: usize| if backwards { last - i } else { i };
            let wall = if side == WEST || side == NORTH {
                plane[0]
            } else {
                plane[plane.len() - 1]
            };
            let across: Vec<f32> = (0..=last)
                .map(|i| (along[index(i)] - along[index(0)]).abs())
                .collect();
            let face = Face {
                surface: Surface::Leaves,
                facing: 1 + side as u32,
                detail: 0,
                borders: [true; 4],
                across: &across,
                up: &up,
                top: across[last],
                phase,
            };
            self.face(&face, |i, j| {
                let a = along[index(i)];
                if along_z {
                    [wall, ys[j], a]
                } else {
                    [a, ys[j], wall]
                }
            });
        }
        self.lid(Surface::Leaves, 0, &xs, &zs, hedge.height);
    }

    /// Flat ground in four patches, below the true one: that of all cells of a city that ends, and to `reach` metres
    /// around the origin's corner of one that does not.
    pub fn far_ground(&mut self, reach: f32) {
        let (lines_x, lines_z) = match extent(self.rules) {
            Some((least, count)) => {
                let [x, z] = [0, 1].map(|k| {
                    let end = least[k].wrapping_add(count[k].cast_signed());
                    cut(self.line(k, least[k], 0), self.line(k, end, 0), 2)
                });
                (x, z)
            }
            None => (cut(-reach, reach, 2), cut(-reach, reach, 2)),
        };
        let across: Vec<f32> = lines_x.iter().map(|x| x - lines_x[0]).collect();
        let up: Vec<f32> = lines_z.iter().rev().map(|z| lines_z[2] - z).collect();
        let face = Face {
            surface: Surface::Far,
            facing: 0,
            detail: 0,
            borders: [false; 4],
            across: &across,
            up: &up,
            top: across[2],
            phase: [0.0, 0.0],
        };
        self.face(&face, |i, j| [lines_x[i], -SUNK, lines_z[2 - j]]);
    }

    fn face(&mut self, face: &Face<'_>, point: impl Fn(usize, usize) -> [f32; 3]) {
        let map = &self.maps[face.surface.map()];
        let amplitude = face.surface.amplitude(self.rules);
        let (columns, rows) = (face.across.len() - 1, face.up.len() - 1);
        let (wide, high) = (face.across[columns], face.up[rows]);
        let texels = f64::from(TEXELS_PER_METRE);
        let phase = face
            .phase
            .map(|metres| (metres.rem_euclid(f64::from(TILE)) * texels) as f32);
        let limits = (0..4).fold(0_u32, |bits, side| {
            bits | (u32::from(face.borders[side]) << side)
        });
        let mark = (face.surface as u32 + 8 * face.facing) as f32;
        // (before, own, behind): the first and the last are exactly 0 at the face's ends.
        let shares = |cuts: &[f32], k: usize, n: usize| {
            let whole = cuts[n];
            let behind = if k + 1 == n {
                0.0
            } else {
                (whole - cuts[k + 1]) / whole
            };
            [cuts[k] / whole, (cuts[k + 1] - cuts[k]) / whole, behind]
        };
        for j in 0..rows {
            let [t0, dt, behind_t] = shares(face.up, j, rows);
            for i in 0..columns {
                let [s0, ds, behind_s] = shares(face.across, i, columns);
                let corner = |i: usize, j: usize| {
                    let [x, y, z] = point(i, j);
                    [x, y, z, mark]
                };
                let place = |s: f32, t: f32| {
                    let w = wide + (face.top - wide) * t;
                    0.5 * wide + (s - 0.5) * w
                };
                let ends = [
                    place(s0, t0),
                    place(s0, t0 + dt),
                    place(s0 + ds, t0),
                    place(s0 + ds, t0 + dt),
                ];
                // Half a texel more than the roundings of these coordinates.
                let along = [
                    phase[0] + ends[0].min(ends[1]) * TEXELS_PER_METRE - 0.5,
                    phase[0] + ends[2].max(ends[3]) * TEXELS_PER_METRE + 0.5,
                ];
                let upwards = [
                    phase[1] + t0 * high * TEXELS_PER_METRE - 0.5,
                    phase[1] + (t0 + dt) * high * TEXELS_PER_METRE + 0.5,
                ];
                let greatest = amplitude * map.greatest(along, upwards);
                self.patches.push(CityPatch {
                    corners: [
                        corner(i, j),
                        corner(i + 1, j),
                        corner(i + 1, j + 1),
                        corner(i, j + 1),
                    ],
                    data: PatchData {
                        across: [s0, ds, behind_s, wide],
                        up: [t0, dt, behind_t, high],
                        face: [
                            face.top,
                            limits as f32,
                            amplitude,
                            (face.surface as u32 | face.detail) as f32,
                        ],
                        map: [phase[0], phase[1], greatest, face.surface.map() as f32],
                    },
                });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maps::maps;
    use std::collections::HashMap;

    fn patches(rules: &CityRules) -> Vec<CityPatch> {
        let maps = maps();
        let mut faces = Faces::new(rules, &maps, [100, -7]);
        for x in 0..3 {
            for z in 0..3 {
                let block = Block::new(rules, [100 + x, -7 + z]);
                faces.block(&block, |c| {
                    (100..103).contains(&c[0]) && (-7..-4).contains(&c[1])
                });
            }
        }
        faces.patches
    }

    fn key(c: [f32; 4]) -> [u32; 3] {
        [c[0], c[1], c[2]].map(f32::to_bits)
    }

    #[test]
    fn faces_look_outwards_and_are_as_large_as_they_say() {
        for patch in patches(&CityRules::default()) {
            let [along, up, out] = patch.frame();
            let facing = (patch.corners[0][3] as u32) / 8;
            let expected = [
                [0.0, 1.0, 0.0],
                [-1.0, 0.0, 0.0],
                [0.0, 0.0, 1.0],
                [1.0, 0.0, 0.0],
                [0.0, 0.0, -1.0],
            ];
            match facing {
                // Two roundings of a length.
                0..=4 => assert!(out.distance(expected[facing as usize].into()) < 3e-7),
                9 => assert!(out.y > 1.0 - 3e-7),
                _ => assert!(out.y > 0.3 && up.y > 0.3, "{out}"),
            }
            let place = |k: usize| bevy::math::Vec3::from_slice(&patch.corners[k][..3]);
            let data = patch.data;
            let wide = |t: f32| data.across[3] + (data.face[0] - data.across[3]) * t;
            let foot = (place(1) - place(0)).dot(along);
            // Coordinates up to 100 m, rounded to 4 µm, a few of them.
            assert!(
                (foot - data.across[1] * wide(data.up[0])).abs() < 4e-5,
                "{data:?}"
            );
            let height = (place(3) - place(0)).dot(up);
            assert!((height - data.up[1] * data.up[3]).abs() < 4e-5, "{data:?}");
            assert!(data.map[2] <= data.face[2]);
        }
    }

    /// Every side is either a border of its face, or shared by two patches with the same surface; and sides that lie
    /// on each other but are not shared are borders on both sides.
    #[test]
    fn sides_that_meet_are_shared_or_borders_of_both() {
        for streets in [crate::rules::Streets::Grid, crate::rules::Streets::Cross] {
            let rules = CityRules {
                streets,
                ..CityRules::default()
            };
            let mut sides: HashMap<[[u32; 3]; 2], Vec<(u32, bool)>> = HashMap::new();
            for patch in patches(&rules) {
                let ends = [[0, 3], [0, 1], [1, 2], [3, 2]];
                for (side, [a, b]) in ends.into_iter().enumerate() {
                    let (a, b) = (key(patch.corners[a]), key(patch.corners[b]));
                    let line = if a < b { [a, b] } else { [b, a] };
                    let mark = patch.corners[0][3] as u32;
                    sides
                        .entry(line)
                        .or_default()
                        .push((mark, patch.data.is_border(side)));
                }
            }
            let (mut shared, mut meeting, mut alone) = (0, 0, 0);
            for (line, users) in &sides {
                match users[..] {
                    [(_, border)] => {
                        assert!(border, "{line:?} ends without a border");
                        alone += 1;
                    }
                    [(a, false), (b, false)] => {
                        assert_eq!(a, b);
                        shared += 1;
                    }
                    [(a, true), (b, true)] => {
                        assert_ne!(a, b);
                        meeting += 1;
                    }
                    _ => panic!("{line:?}: {users:?}"),
                }
            }
            assert!(
                shared > 1000 && meeting > 500 && alone > 100,
                "{shared} {meeting} {alone}"
            );
        }
    }
}
