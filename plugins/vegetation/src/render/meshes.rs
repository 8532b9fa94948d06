//! Trees and rocks in the picture: entities with meshes of Bevy's around the camera, at most
//! [`Vegetation::most_meshes`].
//!
//! Which stand where is found by a task, when the camera has gone `STEP` metres; then those that are new are spawned,
//! `A_FRAME` a frame and nearest first, and those that are too far away are removed. Levels of detail are the meshes
//! of a glTF file, by distance.

use std::collections::HashMap;
use std::sync::Arc;

use bevy::light::NotShadowCaster;
use bevy::math::DVec2;
use bevy::prelude::*;
use bevy::tasks::{AsyncComputeTaskPool, Task, block_on, poll_once};
use dolomite_terrain::Terrain;

use crate::components::{Vegetation, VegetationState, VegetationView};
use crate::instances::{Around, Instance, around, level_at};
use crate::kind::{Kinds, Shape};

/// How far the camera goes before instances are looked for anew, metres.
const STEP: f64 = 24.0;

/// Entities spawned in a frame.
const A_FRAME: usize = 128;

/// Levels of detail of a file.
const LEVELS: usize = 4;

/// Beyond this level nothing casts a shadow: it is smaller than a texel of the far cascades.
const LAST_SHADOW: usize = 1;

/// A tree or a rock of a [`Vegetation`].
#[derive(Component, Clone, Copy, Debug)]
pub struct VegetationInstance {
    /// What it is.
    pub instance: Instance,
    /// Its level of detail.
    pub level: usize,
}

/// How many instances there are, and what finding them took.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq)]
pub struct MeshStats {
    /// Entities.
    pub entities: usize,
    /// Entities that are still to be spawned.
    pub waiting: usize,
    /// Candidates of the last search.
    pub candidates: u64,
    /// Instances left out by the limit.
    pub over: u64,
    /// Milliseconds that the last search took, in a task.
    pub search_ms: f64,
}

/// By which an instance is known.
type Key = (usize, [i32; 2]);

/// What a search depends on.
#[derive(Clone)]
struct Asked {
    terrain: Terrain,
    kinds: Arc<Kinds>,
    numbers: [f32; 2],
    seed: u32,
    most: usize,
    focus: DVec2,
}

impl Asked {
    /// Whether what stands is the same but for what comes and goes at the borders, and where the ground was edited.
    fn same_world(&self, other: &Self) -> bool {
        self.terrain.same_base(&other.terrain)
            && Arc::ptr_eq(&self.kinds, &other.kinds)
            && self.seed == other.seed
    }

    /// Whether another terrain is this one with edits that no plant of the search, or of the next one, stands on.
    fn is_beyond(&self, terrain: &Terrain) -> bool {
        let reaches = self.kinds.kinds.iter().map(|kind| kind.reach);
        let farthest = reaches.fold(0.0, f32::max) * self.numbers[1];
        // Who keeps off another stands no farther than this from it.
        let farthest = f64::from(farthest) + STEP + 100.0;
        terrain.changed_since(&self.terrain).is_some_and(|rects| {
            rects
                .iter()
                .all(|rect| rect.distance(self.focus) > farthest)
        })
    }

    fn fits(&self, other: &Self) -> bool {
        self.same_world(other)
            && self.terrain.same(&other.terrain)
            && self.terrain.same_arrived(&other.terrain)
            && self.numbers == other.numbers
            && self.most == other.most
            && self.focus.distance(other.focus) < STEP
    }
}

#[derive(Resource, Default)]
struct Standing {
    asked: Option<Asked>,
    task: Option<Task<(Around, f64)>>,
    wanted: HashMap<Key, Instance>,
    /// To be spawned, the nearest last.
    queue: Vec<Key>,
    entities: HashMap<Key, Entity>,
    meshes: HashMap<(usize, usize, usize), Handle<Mesh>>,
    material: Handle<StandardMaterial>,
}

/// Adds the systems.
pub(super) fn build(app: &mut App) {
    app.init_resource::<Standing>()
        .init_resource::<MeshStats>()
        .add_systems(
            PostUpdate,
            (search, stand, refine)
                .chain()
                .in_set(crate::sets::VegetationSystems::Place)
                .run_if(
                    |all: Query<(), With<Vegetation>>, standing: Res<Standing>| {
                        !all.is_empty() || standing.asked.is_some()
                    },
                ),
        );
}

/// Asks for what stands around the camera, if that has changed, and takes it over.
fn search(
    mut commands: Commands,
    mut standing: ResMut<Standing>,
    mut stats: ResMut<MeshStats>,
    all: Query<(&Vegetation, &VegetationState, &Terrain)>,
    views: Query<&GlobalTransform, With<VegetationView>>,
) {
    let standing = &mut *standing;
    let focus = views
        .iter()
        .next()
        .map(|view| view.translation().as_dvec3());
    let asked = all
        .iter()
        .next()
        .zip(focus)
        .and_then(|((vegetation, state, terrain), at)| {
            Some(Asked {
                terrain: terrain.clone(),
                kinds: Arc::clone(state.kinds.as_ref()?),
                numbers: [vegetation.density, vegetation.reach.clamp(0.0, 4.0)],
                seed: vegetation.seed,
                most: vegetation.most_meshes,
                focus: DVec2::new(at.x, at.z),
            })
        });
    let Some(asked) = asked else {
        clear(standing, &mut commands);
        *stats = MeshStats::default();
        return;
    };
    if standing
        .asked
        .as_ref()
        .is_some_and(|known| !known.same_world(&asked))
    {
        clear(standing, &mut commands);
    }
    if let Some(known) = &mut standing.asked
        && known.same_world(&asked)
        && known.is_beyond(&asked.terrain)
    {
        known.terrain = asked.terrain.clone();
    }
    let current = standing
        .asked
        .as_ref()
        .is_some_and(|known| known.fits(&asked));
    if !current && standing.task.is_none() {
        standing.asked = Some(asked.clone());
        standing.task = Some(AsyncComputeTaskPool::get().spawn(async move {
            let start = std::time::Instant::now();
            let [density, reach] = asked.numbers;
            let found = around(
                &asked.kinds,
                asked.seed,
                &asked.terrain,
                asked.focus,
                density,
                reach,
                asked.most,
            );
            (found, start.elapsed().as_secs_f64() * 1e3)
        }));
    }
    let Some((found, ms)) = standing
        .task
        .as_mut()
        .and_then(|task| block_on(poll_once(task)))
    else {
        return;
    };
    standing.task = None;
    stats.candidates = found.candidates;
    stats.over = found.over;
    stats.search_ms = ms;
    let before = std::mem::take(&mut standing.wanted);
    standing.wanted = found
        .instances
        .iter()
        .map(|i| ((i.kind, i.cell), *i))
        .collect();
    let wanted = &standing.wanted;
    standing.entities.retain(|key, entity| {
        // Where the ground was edited, roots have moved.
        let stays = wanted
            .get(key)
            .is_some_and(|now| before.get(key) == Some(now));
        if !stays {
            commands.entity(*entity).despawn();
        }
        stays
    });
    let focus = standing
        .asked
        .as_ref()
        .map_or(DVec2::ZERO, |asked| asked.focus);
    let mut queue: Vec<Key> = wanted
        .keys()
        .filter(|key| !standing.entities.contains_key(*key))
        .copied()
        .collect();
    let far = |key: &Key| {
        let place = wanted[key].place;
        DVec2::new(place.x, place.z).distance_squared(focus)
    };
    queue.sort_by(|a, b| far(b).total_cmp(&far(a)).then(a.cmp(b)));
    standing.queue = queue;
}

fn clear(standing: &mut Standing, commands: &mut Commands) {
    for (_, entity) in standing.entities.drain() {
        commands.entity(entity).despawn();
    }
    *standing = Standing::default();
}

/// The handle of a level of a file of a kind.
fn mesh(
    known: &mut HashMap<(usize, usize, usize), Handle<Mesh>>,
    assets: &AssetServer,
    kinds: &Kinds,
    [kind, file, level]: [usize; 3],
) -> Option<Handle<Mesh>> {
    let Shape::Mesh(mesh) = &kinds.kinds.get(kind)?.shape else {
        return None;
    };
    let path = mesh.files.get(file)?;
    Some(
        known
            .entry((kind, file, level))
            .or_insert_with(|| assets.load(format!("{path}#Mesh{level}/Primitive0")))
            .clone(),
    )
}

/// The level of an instance from an eye.
fn level_of(kinds: &Kinds, instance: &Instance, eye: Vec3) -> usize {
    let height = match kinds.kinds.get(instance.kind).map(|kind| &kind.shape) {
        Some(Shape::Mesh(mesh)) => mesh.height * instance.scale,
        _ => 1.0,
    };
    level_at(height, instance.place.as_vec3().distance(eye), LEVELS)
}

/// Spawns some of those that wait.
fn stand(
    mut commands: Commands,
    mut standing: ResMut<Standing>,
    mut stats: ResMut<MeshStats>,
    assets: Res<AssetServer>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    views: Query<&GlobalTransform, With<VegetationView>>,
) {
    if standing.queue.is_empty() {
        if stats.waiting != 0 {
            stats.waiting = 0;
        }
        return;
    }
    let standing = &mut *standing;
    let Some(asked) = &standing.asked else { return };
    let eye = views
        .iter()
        .next()
        .map_or(Vec3::ZERO, GlobalTransform::translation);
    if standing.material == Handle::default() {
        // Colours are those of the vertices.
        standing.material = materials.add(StandardMaterial {
            perceptual_roughness: 0.92,
            reflectance: 0.25,
            ..default()
        });
    }
    for _ in 0..A_FRAME {
        let Some(key) = standing.queue.pop() else {
            break;
        };
        let Some(instance) = standing.wanted.get(&key).copied() else {
            continue;
        };
        let level = level_of(&asked.kinds, &instance, eye);
        let wanted = [instance.kind, instance.file, level];
        let Some(mesh) = mesh(&mut standing.meshes, &assets, &asked.kinds, wanted) else {
            continue;
        };
        let mut entity = commands.spawn((
            VegetationInstance { instance, level },
            Mesh3d(mesh),
            MeshMaterial3d(standing.material.clone()),
            Transform {
                translation: instance.place.as_vec3(),
                rotation: instance.turn,
                scale: Vec3::splat(instance.scale),
            },
        ));
        if level > LAST_SHADOW {
            entity.insert(NotShadowCaster);
        }
        standing.entities.insert(key, entity.id());
    }
    stats.entities = standing.entities.len();
    stats.waiting = standing.queue.len();
}

/// Changes levels where the camera has come nearer or gone.
fn refine(
    mut commands: Commands,
    mut standing: ResMut<Standing>,
    mut stats: ResMut<MeshStats>,
    assets: Res<AssetServer>,
    views: Query<Ref<GlobalTransform>, With<VegetationView>>,
    mut all: Query<(Entity, &mut VegetationInstance, &mut Mesh3d)>,
) {
    if stats.entities != standing.entities.len() {
        stats.entities = standing.entities.len();
    }
    let Some(view) = views.iter().next() else {
        return;
    };
    if !view.is_changed() {
        return;
    }
    let standing = &mut *standing;
    let Some(asked) = &standing.asked else { return };
    let eye = view.translation();
    for (entity, mut shown, mut shape) in &mut all {
        let level = level_of(&asked.kinds, &shown.instance, eye);
        if level == shown.level {
            continue;
        }
        let wanted = [shown.instance.kind, shown.instance.file, level];
        if let Some(mesh) = mesh(&mut standing.meshes, &assets, &asked.kinds, wanted) {
            shape.0 = mesh;
            shown.level = level;
            if level > LAST_SHADOW {
                commands.entity(entity).insert(NotShadowCaster);
            } else {
                commands.entity(entity).remove::<NotShadowCaster>();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::instances;
    use bevy::asset::AssetPlugin;
    use dolomite_terrain::{Fractal, GroundRect, Layer, Source, TerrainData};

    fn terrain() -> Terrain {
        Terrain::new(TerrainData {
            extent: GroundRect::square(DVec2::ZERO, 4000.0),
            layers: vec![Layer {
                source: Source::Fractal(Fractal::default()),
                mask: None,
            }],
            base: 90.0,
            sea_level: Some(0.0),
        })
        .expect("a terrain")
    }

    fn app() -> (App, Entity, Entity) {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, AssetPlugin::default()))
            .init_asset::<Mesh>()
            .init_asset::<StandardMaterial>();
        build(&mut app);
        let kinds = Arc::new(Kinds::small_set());
        let vegetation = Vegetation {
            kinds: Arc::clone(&kinds),
            reach: 0.3,
            ..default()
        };
        let state = VegetationState {
            kinds: Some(kinds),
            fault: None,
        };
        let ground = app.world_mut().spawn((vegetation, state, terrain())).id();
        let view = app
            .world_mut()
            .spawn((VegetationView, GlobalTransform::default()))
            .id();
        (app, ground, view)
    }

    /// Runs until all that is wanted stands.
    fn settle(app: &mut App) {
        for _ in 0..2000 {
            app.update();
            let standing = app.world().resource::<Standing>();
            if standing.task.is_none() && standing.queue.is_empty() && standing.asked.is_some() {
                return;
            }
            std::thread::sleep(std::time::Duration::from_millis(2));
        }
        panic!("not settled");
    }

    fn instances(app: &mut App) -> Vec<Instance> {
        let mut all: Vec<Instance> = app
            .world_mut()
            .query::<&VegetationInstance>()
            .iter(app.world())
            .map(|shown| shown.instance)
            .collect();
        all.sort_by_key(|i| (i.kind, i.cell));
        all
    }

    /// What stands is what the place says; a small step looks for nothing; away and back it is the same; without a
    /// `Vegetation` nothing is left.
    #[test]
    fn entities_are_those_of_the_place() {
        let (mut app, ground, view) = app();
        settle(&mut app);
        let first = instances(&mut app);
        let kinds = app
            .world()
            .get::<Vegetation>(ground)
            .expect("there")
            .kinds
            .clone();
        let found = instances::around(&kinds, 1, &terrain(), DVec2::ZERO, 1.0, 0.3, usize::MAX);
        assert!(
            first.len() > 30 && first == found.instances,
            "{}",
            first.len()
        );
        let go = |app: &mut App, x: f32| {
            *app.world_mut()
                .get_mut::<GlobalTransform>(view)
                .expect("there") = GlobalTransform::from_xyz(x, 0.0, 0.0);
        };
        go(&mut app, 1.0);
        app.update();
        assert!(app.world().resource::<Standing>().task.is_none());
        go(&mut app, 700.0);
        settle(&mut app);
        assert_ne!(instances(&mut app), first);
        go(&mut app, 0.0);
        settle(&mut app);
        assert_eq!(instances(&mut app), first);
        app.world_mut().entity_mut(ground).remove::<Vegetation>();
        app.update();
        assert!(instances(&mut app).is_empty());
        assert_eq!(*app.world().resource::<MeshStats>(), MeshStats::default());
    }

    /// The limit holds, and says how many it left out.
    #[test]
    fn limit_holds() {
        let (mut app, ground, _) = app();
        app.world_mut()
            .get_mut::<Vegetation>(ground)
            .expect("there")
            .most_meshes = 20;
        settle(&mut app);
        app.update();
        assert_eq!(instances(&mut app).len(), 20);
        let stats = app.world().resource::<MeshStats>();
        assert!(stats.entities == 20 && stats.over > 0, "{stats:?}");
    }
}
