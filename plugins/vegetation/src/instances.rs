//! Trees and rocks around a point: which stand where, as a function of the place, on the true (f64) surface.
//!
//! They stand on `Terrain::sample_f64`, not on the triangles that are drawn: the difference is that of the level of
//! detail, which a bounded view keeps below its tolerance; `sink` hides it.

use bevy::math::{DVec2, DVec3, Quat, Vec3};
use dolomite_terrain::{GroundPoint, GroundRect, Terrain};

use crate::density::Growth;
use crate::kind::{Kind, Kinds, Mesh, Shape};
use crate::place::{Lattice, Root, salted, unit};

/// Side of the squares whose bounds are asked for before any candidate is looked at, metres.
const TILE: f64 = 64.0;

/// A kind of meshes with where it grows.
struct Grown<'a> {
    number: usize,
    kind: &'a Kind,
    mesh: &'a Mesh,
    growth: Growth,
    /// Others that it keeps off, each with the distance.
    off: Vec<(Growth, f32)>,
}

/// One instance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instance {
    /// Which kind of the list.
    pub kind: usize,
    /// The cell of its root, by which it is known.
    pub cell: [i32; 2],
    /// Its rank, below 2²⁴.
    pub rank: u32,
    /// Its origin in the world, metres.
    pub place: DVec3,
    /// How it is turned.
    pub turn: Quat,
    /// How large it is.
    pub scale: f32,
    /// Which of the kind's files it is.
    pub file: usize,
}

/// What was found around a point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Around {
    /// Instances, by kind and by place.
    pub instances: Vec<Instance>,
    /// How many candidates were looked at.
    pub candidates: u64,
    /// How many squares of [64 m](self) were passed over, since nothing can grow there.
    pub empty: u64,
    /// How many were left out, since there were more than asked for: those of the highest ranks.
    pub over: u64,
}

/// The ground at a candidate: its place, height above the sea, gradient and height.
fn ground_at(terrain: &Terrain, place: DVec2) -> (f64, DVec2, f64) {
    let sample = terrain.sample_f64(place);
    let sea = f64::from(terrain.sea_level().unwrap_or(0.0));
    (sample.height - sea, sample.gradient, sample.height)
}

fn stands(growth: &Growth, root: Root, terrain: &Terrain) -> Option<(DVec2, DVec2, f64)> {
    // Nothing to sample where no height would do.
    if root.rank >= crate::place::threshold(growth.full) {
        return None;
    }
    let place = growth.lattice.place(root).to_dvec2();
    if !terrain.extent().contains(place) {
        return None;
    }
    let (above, gradient, height) = ground_at(terrain, place);
    growth
        .stands(root, above as f32, gradient.length() as f32)
        .then_some((place, gradient, height))
}

/// Whether a root of `other` stands within `distance` of a place. What `other` itself keeps off is not asked.
fn near(other: &Growth, distance: f32, place: DVec2, terrain: &Terrain) -> bool {
    let reach = DVec2::splat(f64::from(distance));
    let [least, most] = [place - reach, place + reach].map(GroundPoint::new);
    other.lattice.cells(least, most).any(|cell| {
        let root = other.lattice.root(cell);
        let there = other.lattice.place(root).to_dvec2();
        there.distance_squared(place) < reach.x * reach.x && stands(other, root, terrain).is_some()
    })
}

fn instance(of: &Grown, root: Root, place: DVec2, gradient: DVec2, height: f64) -> Instance {
    let own = |salt| unit(salted(root.hash, salt));
    let (small, large) = of.mesh.scale;
    // More small ones than large ones.
    let size = own(4) * own(4);
    let scale = small + (large - small) * (0.35 * own(5) + 0.65 * size);
    let normal = DVec3::new(-gradient.x, 1.0, -gradient.y)
        .normalize()
        .as_vec3();
    let lean = Quat::from_rotation_arc(Vec3::Y, Vec3::Y.lerp(normal, of.mesh.follow).normalize());
    let files = of.mesh.files.len();
    Instance {
        kind: of.number,
        cell: root.cell,
        rank: root.rank,
        place: DVec3::new(place.x, height - f64::from(of.mesh.sink * scale), place.y),
        turn: lean * Quat::from_rotation_y(std::f32::consts::TAU * own(6)),
        scale,
        file: ((own(7) * files as f32) as usize).min(files.saturating_sub(1)),
    }
}

/// Trees and rocks of a list within their reach of a point, at most `most` of them.
///
/// `density` and `reach` are shares of the kinds' own. Some 10 µs for each candidate that may stand there: for a task.
#[must_use]
pub fn around(
    kinds: &Kinds,
    seed: u32,
    terrain: &Terrain,
    focus: DVec2,
    density: f32,
    reach: f32,
    most: usize,
) -> Around {
    let growth_of = |kind: &Kind| Growth::new(kind, seed).thinned(density);
    let mut found = Around::default();
    if !focus.is_finite() {
        return found;
    }
    let grown = kinds.kinds.iter().enumerate().filter_map(|(number, kind)| {
        let Shape::Mesh(mesh) = &kind.shape else {
            return None;
        };
        let off = kind.keeps_off.iter().filter_map(|off| {
            let (_, other) = kinds.find(&off.kind)?;
            Some((growth_of(other), off.distance))
        });
        Some(Grown {
            number,
            kind,
            mesh,
            growth: growth_of(kind),
            off: off.collect(),
        })
    });
    let sea = terrain.sea_level().unwrap_or(0.0);
    let grown: Vec<Grown> = grown.collect();
    let farthest = grown
        .iter()
        .map(|of| f64::from(of.kind.reach * reach))
        .fold(0.0, f64::max);
    let [first, last] =
        [focus - farthest, focus + farthest].map(|k| (k / TILE).floor().as_i64vec2());
    for z in first.y..=last.y {
        for x in first.x..=last.x {
            let corner = DVec2::new(x as f64, z as f64) * TILE;
            let tile = GroundRect::new(corner, corner + TILE);
            let distance = tile.distance(focus);
            if distance > farthest || terrain.extent().distance(tile.centre()) > TILE {
                continue;
            }
            let bounds = terrain.bounds(&tile);
            let mut looked = false;
            for of in &grown {
                let reach = f64::from(of.kind.reach * reach);
                if distance > reach
                    || !of
                        .growth
                        .possible(bounds.min - sea, bounds.max - sea, bounds.max_slope)
                {
                    continue;
                }
                looked = true;
                look(of, &tile, terrain, focus, reach, &mut found);
            }
            found.empty += u64::from(!looked);
        }
    }
    thin(&mut found, most);
    found.instances.sort_by_key(|i| (i.kind, i.cell));
    found
}

/// Candidates of a square, which belong to it by their places.
fn look(
    of: &Grown,
    tile: &GroundRect,
    terrain: &Terrain,
    focus: DVec2,
    reach: f64,
    found: &mut Around,
) {
    let lattice: Lattice = of.growth.lattice;
    let [least, most] = [tile.min, tile.max].map(GroundPoint::new);
    for cell in lattice.cells(least, most) {
        let root = lattice.root(cell);
        let place = lattice.place(root).to_dvec2();
        let inside = place.cmpge(tile.min).all() && place.cmplt(tile.max).all();
        if !inside || place.distance_squared(focus) > reach * reach {
            continue;
        }
        found.candidates += 1;
        let Some((place, gradient, height)) = stands(&of.growth, root, terrain) else {
            continue;
        };
        if of
            .off
            .iter()
            .any(|(other, distance)| near(other, *distance, place, terrain))
        {
            continue;
        }
        found
            .instances
            .push(instance(of, root, place, gradient, height));
    }
}

/// Of more than `most` those of the lowest ranks are kept, of all kinds alike.
fn thin(found: &mut Around, most: usize) {
    if found.instances.len() > most {
        found.over = (found.instances.len() - most) as u64;
        found.instances.sort_by_key(|i| (i.rank, i.kind, i.cell));
        found.instances.truncate(most);
    }
}

/// Which of `levels` levels of detail is fine enough for a mesh of some height at a distance, metres: a level for
/// each 2.5 times of the distance beyond four heights.
#[must_use]
pub fn level_at(height: f32, distance: f32, levels: usize) -> usize {
    let mut level = 0;
    let mut fine = 4.0 * height;
    while level + 1 < levels && distance > fine {
        level += 1;
        fine *= 2.5;
    }
    level
}

#[cfg(test)]
mod tests {
    use super::*;
    use dolomite_terrain::{Layer, Source, TerrainData};

    fn island() -> Terrain {
        Terrain::new(TerrainData {
            extent: GroundRect::square(DVec2::ZERO, 4000.0),
            layers: vec![Layer {
                source: Source::Fractal(dolomite_terrain::Fractal::default()),
                mask: None,
            }],
            base: 90.0,
            sea_level: Some(0.0),
        })
        .expect("a terrain")
    }

    fn kinds() -> Kinds {
        Kinds::small_set()
    }

    /// Whatever the camera: what stands in both of two views is the same to the bit, and all of it within its bands.
    #[test]
    fn cameras_move_nothing() {
        let (terrain, kinds) = (island(), kinds());
        let all = |focus| around(&kinds, 1, &terrain, focus, 1.0, 0.4, usize::MAX);
        let [one, other] = [DVec2::new(20.0, -30.0), DVec2::new(140.0, 35.0)].map(all);
        assert!(one.instances.len() > 200, "{}", one.instances.len());
        let mut both = 0;
        for instance in &other.instances {
            let reach = f64::from(kinds.kinds[instance.kind].reach * 0.4);
            let flat = DVec2::new(instance.place.x, instance.place.z);
            if flat.distance(DVec2::new(20.0, -30.0)) < reach {
                both += 1;
                assert!(one.instances.contains(instance), "{instance:?}");
            }
            let kind = &kinds.kinds[instance.kind];
            let (above, gradient, height) = ground_at(&terrain, flat);
            assert!(above > f64::from(kind.height.from) && above < f64::from(kind.height.to));
            assert!(gradient.length() < f64::from(kind.slope.to));
            assert!((instance.place.y - height).abs() < 10.0);
        }
        assert!(both > 100, "{both}");
        assert_eq!(one, all(DVec2::new(20.0, -30.0)), "look away and back");
    }

    /// Nobody stands nearer to what it keeps off than it says; without the rule somebody does.
    #[test]
    fn kinds_keep_off_each_other() {
        let terrain = island();
        let mut kinds = kinds();
        for kind in &mut kinds.kinds {
            kind.density *= 4.0;
        }
        let close = |kinds: &Kinds| {
            let found = around(kinds, 1, &terrain, DVec2::ZERO, 1.0, 0.6, usize::MAX).instances;
            let mut close = 0;
            for one in &found {
                for off in &kinds.kinds[one.kind].keeps_off {
                    let (other, _) = kinds.find(&off.kind).expect("checked");
                    let too_near = |k: &&Instance| {
                        k.kind == other
                            && k.place.distance(one.place) < f64::from(off.distance) - 1e-6
                    };
                    close += found.iter().filter(too_near).count();
                }
            }
            close
        };
        assert_eq!(close(&kinds), 0);
        let wanted: Vec<_> = kinds
            .kinds
            .iter()
            .map(|kind| kind.keeps_off.clone())
            .collect();
        for kind in &mut kinds.kinds {
            for off in &mut kind.keeps_off {
                off.distance = 0.0;
            }
        }
        let mut counted = kinds.clone();
        for (kind, keeps_off) in counted.kinds.iter_mut().zip(wanted) {
            kind.keeps_off = keeps_off;
        }
        let loose = around(&kinds, 1, &terrain, DVec2::ZERO, 1.0, 0.6, usize::MAX);
        let strict = around(&counted, 1, &terrain, DVec2::ZERO, 1.0, 0.6, usize::MAX);
        assert!(loose.instances.len() > strict.instances.len());
    }

    /// Fewer are those of the lowest ranks: a smaller number is a part of a larger one; density 0 looks at nothing.
    #[test]
    fn limits_are_kept_by_rank() {
        let (terrain, kinds) = (island(), kinds());
        let with = |density, most| around(&kinds, 1, &terrain, DVec2::ZERO, density, 0.3, most);
        let all = with(1.0, usize::MAX);
        let some = with(1.0, 50);
        assert_eq!(some.instances.len(), 50);
        assert_eq!(some.over as usize, all.instances.len() - 50);
        assert!(some.instances.iter().all(|i| all.instances.contains(i)));
        let nothing = with(0.0, usize::MAX);
        assert!(nothing.instances.is_empty() && nothing.candidates == 0 && nothing.empty > 0);
        let nan = around(&kinds, 1, &terrain, DVec2::NAN, 1.0, 1.0, 10);
        assert!(nan.instances.is_empty());
    }

    #[test]
    fn levels_follow_the_distance() {
        assert_eq!(
            [10.0, 39.0, 41.0, 120.0, 1e6].map(|d| level_at(10.0, d, 4)),
            [0, 0, 1, 2, 3]
        );
        assert_eq!(level_at(10.0, f32::INFINITY, 1), 0);
    }
}
