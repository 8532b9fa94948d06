//! The relief map: gradient and sky occlusion of the whole terrain at a fixed spacing.
//!
//! Far away a triangle is larger than the relief within it. The map keeps that relief in the
//! shading, filtered by mip levels: the means of gradients, as the normals of a rough surface
//! should be averaged (Olano and Baker, "LEAN mapping", 2010, first moments).

use crate::cover::TerrainView;
use crate::material::{GroundMaterial, Sea};
use crate::shown::ShownTerrains;
use bevy::asset::RenderAssetUsages;
use bevy::ecs::entity::EntityHashMap;
use bevy::image::{ImageAddressMode, ImageFilterMode, ImageSampler, ImageSamplerDescriptor};
use bevy::math::DVec2;
use bevy::platform::time::Instant;
use bevy::prelude::*;
use bevy::render::render_resource::{Extent3d, TextureDimension, TextureFormat};
use bevy::tasks::{AsyncComputeTaskPool, Task, TaskPool, block_on, poll_once};
use dolomite_terrain::{GroundPoint, HeightTile, Planes, Terrain};
use half::f16;
use std::time::Duration;

/// The relief map of a terrain; made in the background by the plugin for a terrain that is drawn, and taken away
/// when it is hidden or no camera has a [`TerrainView`] any more.
#[derive(Component, Clone, Debug, Reflect)]
#[reflect(Component)]
pub struct TerrainRelief {
    /// `Rgba16Float` over a square from the extent's least corner: dh/dx, dh/dz, sky occlusion,
    /// unused.
    pub image: Handle<Image>,
    /// Side of a texel, metres.
    pub texel: f32,
    /// Texels of a side.
    pub side: u32,
}

/// Side of relief maps, texels; 0: none are made.
#[derive(Resource, Clone, Copy, Debug)]
pub(crate) struct ReliefSide(pub u32);

impl ReliefSide {
    /// A power of two from 64 to 8192, or 0.
    fn texels(self) -> Option<u32> {
        (self.0 > 0).then(|| self.0.clamp(64, 8192).next_power_of_two())
    }
}

/// A relief map being made for an entity, and its side.
#[derive(Component)]
pub(crate) struct ReliefTask(Task<Image>, u32);

/// Takes the relief maps away of terrains that are no longer drawn. Without a side the maps are not the plugin's.
pub(crate) fn forget(
    mut commands: Commands,
    side: Res<ReliefSide>,
    shown: Res<ShownTerrains>,
    views: Query<(), With<TerrainView>>,
    made: Query<Entity, Or<(With<TerrainRelief>, With<ReliefTask>)>>,
) {
    if side.texels().is_none() {
        return;
    }
    for entity in &made {
        if views.is_empty() || !shown.entities().any(|drawn| drawn == entity) {
            commands
                .entity(entity)
                .remove::<(TerrainRelief, ReliefTask)>();
        }
    }
}

/// Starts a relief map for every drawn terrain that is new or has changed. Where it was edited the old map is seen until the
/// new one is there, which is begun when nobody has edited for two seconds: it is of the whole ground.
pub(crate) fn start(
    mut commands: Commands,
    side: Res<ReliefSide>,
    shown: Res<ShownTerrains>,
    views: Query<(), With<TerrainView>>,
    terrains: Query<(Entity, Ref<Terrain>, Has<Sea>), With<GroundMaterial>>,
    known: Query<(), Or<(With<TerrainRelief>, With<ReliefTask>)>>,
    mut edited: Local<EntityHashMap<Edited>>,
) {
    let Some(side) = side.texels() else {
        return;
    };
    if views.is_empty() {
        return;
    }
    for (entity, terrain, sea) in terrains.iter_many(shown.entities()) {
        let terrain_now = drawn(&terrain, sea);
        if known.contains(entity) {
            let last = edited.get_mut(&entity);
            match last.filter(|last| last.terrain.same_base(&terrain_now)) {
                // Edits alone: the map stays until nobody has edited for a while.
                Some(last) if terrain.is_changed() => {
                    if !last.terrain.same(&terrain_now) {
                        last.since = Some(Instant::now());
                        last.terrain = terrain_now;
                    }
                    continue;
                }
                Some(last) if last.since.is_some_and(|since| since.elapsed() > RESTS) => {
                    last.since = None;
                }
                Some(_) => continue,
                None if !terrain.is_changed() => continue,
                None => {
                    commands.entity(entity).remove::<TerrainRelief>();
                }
            }
        }
        edited.insert(
            entity,
            Edited {
                terrain: terrain_now.clone(),
                since: None,
            },
        );
        let task = AsyncComputeTaskPool::get().spawn(async move { relief_map(&terrain_now, side) });
        commands.entity(entity).insert(ReliefTask(task, side));
    }
}

/// How long nobody edits a ground before its relief map is made anew.
const RESTS: Duration = Duration::from_secs(2);

/// The ground that a map is of, or will be when nobody edits it any more.
#[derive(Debug)]
pub(crate) struct Edited {
    terrain: Terrain,
    /// Since when it is another one than the map is of.
    since: Option<Instant>,
}

/// The ground as it is drawn: without a sea its water is not there.
pub(crate) fn drawn(terrain: &Terrain, sea: bool) -> Terrain {
    if sea {
        terrain.clone()
    } else {
        terrain.without_sea()
    }
}

/// Puts finished relief maps beside their terrains.
pub(crate) fn finish(
    mut commands: Commands,
    mut tasks: Query<(Entity, &Terrain, &mut ReliefTask)>,
    mut images: ResMut<Assets<Image>>,
) {
    for (entity, terrain, mut task) in &mut tasks {
        if let Some(image) = block_on(poll_once(&mut task.0)) {
            let side = task.1;
            let relief = TerrainRelief {
                image: images.add(image),
                texel: texel(terrain, side) as f32,
                side,
            };
            commands
                .entity(entity)
                .remove::<ReliefTask>()
                .insert(relief);
        }
    }
}

/// Side of a texel of a square map over the longer side of the extent, metres.
fn texel(terrain: &Terrain, side: u32) -> f64 {
    terrain.extent().size().max_element() / f64::from(side)
}

/// Samples the terrain on `side` × `side` texel centres from the extent's least corner, by this thread and those for
/// work in the background.
pub fn relief_map(terrain: &Terrain, side: u32) -> Image {
    let n = side as usize;
    let spacing = texel(terrain, side);
    let origin = GroundPoint::new(terrain.extent().min + spacing * 0.5);
    let tile = HeightTile {
        origin,
        spacing: DVec2::splat(spacing),
        width: n,
        height: n,
    };
    let mut heights = vec![0.0; n * n];
    let (mut dx, mut dz) = (vec![0.0; n * n], vec![0.0; n * n]);
    let planes = Planes {
        value: &mut heights,
        dx: &mut dx,
        dz: &mut dz,
    };
    // Systems of the frames meanwhile have the compute task pool for themselves: on two cores it is one thread, behind
    // whose bands of a map they once waited for longer than a second.
    let pool = AsyncComputeTaskPool::get_or_init(TaskPool::default);
    let filled = terrain.fill_tile_on(pool, &tile, planes);
    debug_assert!(filled.is_ok(), "the planes have the tile's size");
    if let Some(sea) = terrain.sea_level() {
        for height in &mut heights {
            *height = height.max(sea);
        }
    }
    let occlusion = sky_occlusion(&heights, n, spacing);
    let mut level: Vec<[f32; 3]> = (0..n * n).map(|i| [dx[i], dz[i], occlusion[i]]).collect();
    let mut data = Vec::with_capacity(n * n * 8 * 4 / 3 + 64);
    let mut width = n;
    loop {
        for [x, z, o] in &level {
            for value in [*x, *z, *o, 1.0] {
                data.extend_from_slice(
                    &f16::from_f32(value.clamp(-65504.0, 65504.0)).to_le_bytes(),
                );
            }
        }
        if width == 1 {
            break;
        }
        level = halve(&level, width);
        width /= 2;
    }
    let size = Extent3d {
        width: side,
        height: side,
        depth_or_array_layers: 1,
    };
    let mut image = Image::new_uninit(
        size,
        TextureDimension::D2,
        TextureFormat::Rgba16Float,
        RenderAssetUsages::RENDER_WORLD,
    );
    image.data = Some(data);
    image.texture_descriptor.mip_level_count = side.ilog2() + 1;
    image.sampler = ImageSampler::Descriptor(ImageSamplerDescriptor {
        label: Some("terrain_relief".into()),
        anisotropy_clamp: 1,
        address_mode_u: ImageAddressMode::ClampToEdge,
        address_mode_v: ImageAddressMode::ClampToEdge,
        mag_filter: ImageFilterMode::Linear,
        min_filter: ImageFilterMode::Linear,
        mipmap_filter: ImageFilterMode::Linear,
        ..default()
    });
    image
}

fn halve(level: &[[f32; 3]], width: usize) -> Vec<[f32; 3]> {
    let half = width / 2;
    let mut out = Vec::with_capacity(half * half);
    for z in 0..half {
        for x in 0..half {
            let at = |dx, dz| level[(2 * z + dz) * width + 2 * x + dx];
            let four = [at(0, 0), at(1, 0), at(0, 1), at(1, 1)];
            out.push([0, 1, 2].map(|c| four.iter().map(|texel| texel[c]).sum::<f32>() / 4.0));
        }
    }
    out
}

/// Share of the sky that each texel sees: 1 − mean over eight directions of sin²(horizon), which
/// is the cosine-weighted share of an evenly bright sky in a slice (Max, "Horizon mapping", 1988).
///
/// The horizon is looked for at distances of 1, 2, 4 … 128 texels.
fn sky_occlusion(heights: &[f32], n: usize, spacing: f64) -> Vec<f32> {
    const DIRECTIONS: [(isize, isize); 8] = [
        (1, 0),
        (1, 1),
        (0, 1),
        (-1, 1),
        (-1, 0),
        (-1, -1),
        (0, -1),
        (1, -1),
    ];
    let row = |z: usize| {
        (0..n).map(move |x| {
            let here = heights[z * n + x];
            let mut blocked = 0.0;
            for (dx, dz) in DIRECTIONS {
                let step = (((dx * dx + dz * dz) as f64).sqrt() * spacing) as f32;
                let mut steepest = 0.0_f32;
                for reach in (0..8).map(|power| 1_isize << power) {
                    let (sx, sz) = (x as isize + dx * reach, z as isize + dz * reach);
                    let (Ok(sx), Ok(sz)) = (usize::try_from(sx), usize::try_from(sz)) else {
                        break;
                    };
                    if sx >= n || sz >= n {
                        break;
                    }
                    steepest = steepest.max((heights[sz * n + sx] - here) / (step * reach as f32));
                }
                // sin² of the angle whose tangent is `steepest`.
                blocked += steepest * steepest / (1.0 + steepest * steepest);
            }
            1.0 - blocked / DIRECTIONS.len() as f32
        })
    };
    (0..n).flat_map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::MOST_TERRAINS;
    use crate::shown::follow_terrains;
    use dolomite_terrain::{GroundRect, TerrainData};

    #[test]
    fn flat_ground_sees_the_whole_sky() {
        assert!(
            sky_occlusion(&[5.0; 256], 16, 1.0)
                .iter()
                .all(|&o| o == 1.0)
        );
    }

    #[test]
    fn the_bottom_of_a_shaft_sees_next_to_none() {
        let mut heights = vec![1000.0; 256];
        heights[8 * 16 + 8] = 0.0;
        let occlusion = sky_occlusion(&heights, 16, 1.0);
        // Walls 1000 times as high as far (√2 on the diagonals): cos² of the horizon is below 2e-6.
        assert!(occlusion[8 * 16 + 8] < 2e-6);
        assert_eq!(occlusion[0], 1.0, "the rim sees everything");
    }

    #[test]
    fn maps_are_there_for_terrains_that_are_drawn_alone() {
        let mut app = App::new();
        app.add_plugins(MinimalPlugins)
            .insert_resource(ReliefSide(64))
            .init_resource::<ShownTerrains>()
            .init_resource::<Assets<Image>>()
            .add_systems(Update, (forget, start, finish).chain())
            .add_systems(PostUpdate, follow_terrains);
        let terrain = Terrain::new(TerrainData {
            extent: GroundRect::square(DVec2::ZERO, 10.0),
            layers: Vec::new(),
            base: 0.0,
            sea_level: None,
        });
        let terrain = terrain.expect("valid");
        let ground = (terrain, GroundMaterial::default(), Visibility::Inherited);
        let all: Vec<Entity> = (0..=MOST_TERRAINS)
            .map(|_| app.world_mut().spawn(ground.clone()).id())
            .collect();
        let made = |app: &mut App| {
            // One frame says what is shown, the next one makes and drops.
            app.update();
            app.update();
            let has = |entity: &Entity| {
                let entity = app.world().entity(*entity);
                entity.contains::<TerrainRelief>() || entity.contains::<ReliefTask>()
            };
            all.iter().map(has).collect::<Vec<bool>>()
        };
        assert_eq!(made(&mut app), [false; 5], "nobody looks");
        let view = app.world_mut().spawn(TerrainView).id();
        assert_eq!(made(&mut app), [true, true, true, true, false]);
        app.world_mut()
            .entity_mut(all[0])
            .insert(Visibility::Hidden);
        assert_eq!(made(&mut app), [false, true, true, true, true]);
        app.world_mut().despawn(view);
        assert_eq!(made(&mut app), [false; 5]);
    }
}
