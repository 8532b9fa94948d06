//! A ground, and a view of it in which no rounding decides.

use std::collections::HashSet;

use bevy::math::{DMat4, DQuat, DVec2, DVec3, EulerRot, UVec2, Vec2, Vec3};
use dolomite_ground::blocks::choose::{AHEAD, Choice, Limits, choose, settle};
use dolomite_ground::blocks::kept::KeptBlocks;
use dolomite_ground::blocks::layout::MOST_MADE;
use dolomite_ground::blocks::mesh::{BlockMesh, mesh};
use dolomite_ground::detail::{CullView, DetailView, Lens, Metric, TerrainLod};
use dolomite_terrain::{
    Fractal, GroundPoint, GroundRect, Hill, Layer, Mask, Source, Terrain, TerrainData,
};
use dolomite_testkit::random::Random;

/// Room for vertices and triangles.
pub(super) const POOLS: [u32; 2] = [1 << 12, 1 << 13];
/// Side of the smallest cell, metres.
pub(super) const FINEST: f32 = 4.0;
/// By which factor of 1 the tolerance may change without another triangle.
const MARGIN: f32 = 5e-4;
/// How far a corner may be moved along each axis without another triangle left out, metres: some units in the last place of
/// the largest height.
const MOVED: f32 = 2e-4;
/// Views that are tried.
const TRIES: u32 = 64;
/// Tangent of half the angle between the lower and the upper edge, pixels, and the least depth, metres.
const TANGENT: f64 = 0.6;
const SIZE: UVec2 = UVec2::new(960, 540);
const NEAR: f64 = 0.1;

/// Hills on rough ground, a sea, at 10⁵ m from the origin.
pub(super) fn terrain() -> Terrain {
    let fractal = |seed, octaves, amplitude, wavelength| {
        Source::Fractal(Fractal {
            seed,
            octaves,
            amplitude,
            wavelength,
            ..Fractal::default()
        })
    };
    let centre = DVec2::new(1e5, -1e5);
    let half = DVec2::new(512.0, 256.0);
    let hill = Hill {
        centre: centre + DVec2::new(60.0, 40.0),
        radius: 50.0,
        height: 30.0,
    };
    let rough = Mask {
        low: 5.0,
        high: 40.0,
    };
    let layers = [
        (fractal(1, 8, 120.0, 600.0), None),
        (Source::Hill(hill), None),
        (fractal(2, 3, 3.0, 60.0), Some(rough)),
    ];
    Terrain::new(TerrainData {
        extent: GroundRect::new(centre - half, centre + half),
        layers: Vec::from(layers.map(|(source, mask)| Layer { source, mask })),
        base: 10.0,
        sea_level: Some(0.0),
    })
    .expect("valid")
}

/// A view from somewhere over the ground, the height that its heights are relative to, and what is in view.
fn view(terrain: &Terrain, metric: Metric, random: &mut Random) -> (DetailView, f32, CullView) {
    let centre = DVec2::new(1e5, -1e5);
    let place = DVec2::new(random.signed_unit() * 400.0, random.signed_unit() * 200.0);
    let xz = centre + place;
    let ground = terrain.sample_f64(xz).height.max(0.0);
    let eye = DVec3::new(xz.x, ground + 2.0 + 60.0 * random.unit(), xz.y);
    let turn = DQuat::from_euler(EulerRot::YXZ, 6.3 * random.unit(), -0.3, 0.0);
    let mut view = DetailView::new(eye, turn, Lens::Perspective(TANGENT), SIZE, NEAR);
    view.set_metric(&TerrainLod {
        metric,
        ..TerrainLod::default()
    });
    let anchor_height = eye.y.floor();
    let anchor = view.anchor().as_dvec2();
    let from_anchor = eye - DVec3::new(anchor.x, anchor_height, anchor.y);
    let aspect = f64::from(SIZE.x) / f64::from(SIZE.y);
    let angle = 2.0 * f64::from(bevy::math::ops::atan(TANGENT as f32));
    let lens = DMat4::perspective_infinite_reverse_rh(angle, aspect, NEAR);
    let picture = CullView {
        clip: (lens * DMat4::from_rotation_translation(turn, from_anchor).inverse()).as_mat4(),
        half_size: Vec2::new(SIZE.x as f32, SIZE.y as f32) / 2.0,
        one_sided: true,
    };
    (view, anchor_height as f32, picture)
}

/// A view, what is chosen for it, and the triangles of that.
pub(super) struct Chosen {
    pub view: DetailView,
    pub anchor_height: f32,
    /// Where what the picture does not show is left out.
    pub picture: Option<CullView>,
    pub choice: Choice,
    pub mesh: BlockMesh,
    /// Those that are seen, all where none is left out.
    pub seen: Vec<[u32; 3]>,
    /// How often it is chosen until all that it asks for is made, and that is seen.
    pub rounds: u32,
    /// Centres of the blocks that there are then.
    pub made: Vec<UVec2>,
}

impl Chosen {
    /// Where a vertex stands relative to the view's anchor.
    pub fn place(&self, blocks: &KeptBlocks, number: u32) -> Vec3 {
        place(blocks, &self.mesh, (&self.view, self.anchor_height), number)
    }
}

fn place(
    blocks: &KeptBlocks,
    mesh: &BlockMesh,
    (view, anchor_height): (&DetailView, f32),
    number: u32,
) -> Vec3 {
    let anchor = GroundPoint::from(view.anchor().as_dvec2());
    let vertex = &mesh.vertices[number as usize];
    let at = blocks.lattice.point(vertex.at).relative_to(anchor);
    Vec3::new(at.x, vertex.height - anchor_height, at.y)
}

/// The places of a mesh's triangles, sorted, each from its least corner on.
fn triangles(mesh: &BlockMesh) -> Vec<[[u32; 2]; 3]> {
    let mut all: Vec<_> = mesh
        .triangles
        .iter()
        .map(|triangle| {
            let mut corners = triangle.map(|k| mesh.vertices[k as usize].at.to_array());
            let least = (0..3).min_by_key(|&k| corners[k]).expect("three");
            corners.rotate_left(least);
            corners
        })
        .collect();
    all.sort_unstable();
    all
}

/// The blocks that there are once a view has all that it asks for, if there were only the roots before.
fn made(blocks: &KeptBlocks, choice: &Choice) -> Vec<UVec2> {
    let roots = blocks.roots().iter().map(|&slot| blocks.place(slot));
    let exist = choice.blocks.iter();
    let exist = exist.filter(|block| choice.exists(block, blocks));
    let wished = exist.flat_map(|block| {
        let is_wished = |&quarter: &usize| block.quadrants[quarter] >= AHEAD;
        let wished = (0..4).filter(is_wished);
        wished.filter_map(|quarter| block.place.child(quarter))
    });
    let mut centres: Vec<_> = roots
        .chain(wished)
        .map(|block| block.cell().centre)
        .collect();
    centres.sort_unstable_by_key(|centre| centre.to_array());
    centres
}

/// Which triangles are in view of a picture; `None` if roundings might decide over one.
fn seen(picture: &CullView, mesh: &BlockMesh, at: impl Fn(u32) -> Vec3) -> Option<Vec<[u32; 3]>> {
    let offsets = [
        Vec3::ZERO,
        Vec3::X,
        Vec3::Y,
        Vec3::Z,
        Vec3::NEG_X,
        Vec3::NEG_Y,
        Vec3::NEG_Z,
    ];
    let mut seen = Vec::new();
    for triangle in &mesh.triangles {
        let corners = triangle.map(&at);
        let hidden = picture.hides(corners);
        let is_same = (0..3).all(|k| {
            offsets.iter().all(|offset| {
                let mut moved = corners;
                moved[k] += *offset * MOVED;
                picture.hides(moved) == hidden
            })
        });
        if !is_same {
            return None;
        }
        if !hidden {
            seen.push(*triangle);
        }
    }
    Some(seen)
}

/// How often a ground that has only its roots chooses until nothing is left to be made, and once more.
fn rounds(terrain: &Terrain, view: &DetailView) -> u32 {
    let mut blocks = KeptBlocks::new(terrain.clone(), FINEST);
    let limits = Limits {
        made: MOST_MADE as usize,
        ..Limits::default()
    };
    let mut rounds = 1;
    let mut before = 0;
    while blocks.len() > before {
        before = blocks.len();
        choose(&mut blocks, view, limits);
        rounds += 1;
    }
    rounds
}

/// The first view of a seed that roundings do not decide in; `culled`: nor over what is in view.
pub(super) fn chosen(
    blocks: &mut KeptBlocks,
    metric: Metric,
    culled: bool,
    seed: u32,
) -> Option<Chosen> {
    let mut random = Random::new(seed);
    let terrain = blocks.terrain().clone();
    let limits = Limits::default();
    (0..TRIES).find_map(|_| {
        let (view, anchor_height, picture) = view(&terrain, metric, &mut random);
        let mut of = |factor: f32| {
            let mut view = view;
            view.inverse_tolerance *= factor;
            let choice = settle(blocks, &view, limits);
            let (mesh, made) = (mesh(blocks, &choice), made(blocks, &choice));
            (choice, mesh, made)
        };
        let (choice, mesh, made) = of(1.0);
        let own = triangles(&mesh);
        // Not twice, not in two blocks.
        let once = own.iter().collect::<HashSet<_>>().len() == own.len();
        let fits = choice.coarsening == 1.0 && once && (200..4000).contains(&own.len());
        let mut same = |factor| {
            let (_, other, other_made) = of(factor);
            triangles(&other) == own && other_made == made
        };
        if !(fits && same(1.0 - MARGIN) && same(1.0 + MARGIN)) {
            return None;
        }
        let at = |k: u32| place(blocks, &mesh, (&view, anchor_height), k);
        let seen = match culled {
            true => seen(&picture, &mesh, at)?,
            false => mesh.triangles.clone(),
        };
        Some(Chosen {
            rounds: rounds(&terrain, &view),
            picture: culled.then_some(picture),
            view,
            anchor_height,
            choice,
            mesh,
            seen,
            made,
        })
    })
}
