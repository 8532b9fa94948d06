//! The maps of the skies that cameras see: made once for all cameras that see the same, anew when the
//! sun has gone far enough, and in the background where it has not gone far, or where other sizes of the same sky are there.

use bevy::prelude::*;
use bevy::tasks::{AsyncComputeTaskPool, Task, TaskPool, block_on, poll_once};

use super::cube::Cores;
use super::maps::SkyMaps;
use crate::heavens::Heavens;
use crate::seen::SeenSky;

/// How far the sun may be from where it was when the maps were made, degrees, for new ones to be made
/// in the background: beyond it the old ones would be of another hour.
const NEAR: f32 = 2.0;

/// How far the exposure may be from that for which maps were made, stops: f16 has ten bits more than a
/// display needs, and the maps are scaled by the exposure.
const STOPS: f32 = 4.0;

/// What maps are made for.
#[derive(Clone, Copy, Debug, PartialEq)]
struct MapKey {
    towards_sun: Vec3,
    ev100: f32,
    sea: bool,
    dust: f32,
    milky_way: f32,
    side: u32,
}

impl MapKey {
    fn new(seen: &SeenSky, ev100: f32) -> Self {
        Self {
            towards_sun: seen.heavens.towards_sun,
            ev100,
            sea: seen.sky.sea,
            dust: seen.sky.dust,
            milky_way: seen.sky.milky_way,
            side: seen.sky.side,
        }
    }

    /// How far the sun has gone from there to here, degrees; `None` where something else differs but the maps' sides.
    fn away(&self, other: &Self) -> Option<f32> {
        let same = Self {
            towards_sun: other.towards_sun,
            ev100: other.ev100,
            side: other.side,
            ..*self
        } == *other;
        let near = (self.ev100 - other.ev100).abs() <= STOPS;
        let chord = self.towards_sun.distance(other.towards_sun);
        (same && near).then_some(chord.to_degrees())
    }
}

/// Maps as they are drawn.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct MapHandles {
    pub seen: Handle<Image>,
    pub diffuse: Handle<Image>,
    pub specular: Handle<Image>,
    /// Luminance of 1 in the maps, cd/m².
    pub scale: f32,
}

struct Kept {
    key: MapKey,
    maps: MapHandles,
    used: bool,
}

/// The maps in use.
#[derive(Resource, Default)]
pub(super) struct MapStore {
    kept: Vec<Kept>,
    making: Option<(MapKey, Task<SkyMaps>)>,
}

/// Makes all maps of a key.
fn make(key: MapKey, heavens: &Heavens, cores: Cores) -> SkyMaps {
    SkyMaps::new(
        |direction| heavens.radiance(direction),
        key.ev100,
        key.side,
        cores,
    )
}

impl MapStore {
    /// Whether there is nothing to let go of.
    pub fn is_empty(&self) -> bool {
        self.kept.is_empty() && self.making.is_none()
    }

    /// Takes over what the background has made; from then on maps are unused until asked for.
    pub fn receive(&mut self, images: &mut Assets<Image>) {
        for kept in &mut self.kept {
            kept.used = false;
        }
        let Some((key, task)) = &mut self.making else {
            return;
        };
        if let Some(maps) = block_on(poll_once(task)) {
            let key = *key;
            self.making = None;
            self.keep(key, maps, images);
        }
    }

    /// The maps of a sky seen with an exposure, or ones of a sun not farther than `step` degrees from
    /// it; meanwhile, where the sun has gone but a little or the maps are to have another side, those that there are.
    pub fn find(
        &mut self,
        seen: &SeenSky,
        ev100: f32,
        step: f32,
        images: &mut Assets<Image>,
    ) -> &MapHandles {
        let key = MapKey::new(seen, ev100);
        let nearest = |fits: &dyn Fn(&MapKey, f32) -> bool| {
            self.kept
                .iter()
                .enumerate()
                .filter_map(|(k, kept)| Some((k, kept.key.away(&key)?)))
                .filter(|(k, away)| fits(&self.kept[*k].key, *away))
                .min_by(|(_, a), (_, b)| a.total_cmp(b))
                .map(|(k, _)| k)
        };
        let exact = nearest(&|kept, away| kept.side == key.side && away <= step);
        let found = match (exact, nearest(&|_, away| away <= NEAR)) {
            (Some(k), _) => k,
            (None, Some(k)) => {
                let heavens = seen.heavens;
                self.making.get_or_insert_with(|| {
                    let pool = AsyncComputeTaskPool::get_or_init(TaskPool::default);
                    (
                        key,
                        pool.spawn(async move { make(key, &heavens, Cores::One) }),
                    )
                });
                k
            }
            (None, None) => {
                self.keep(key, make(key, &seen.heavens, Cores::All), images);
                self.kept.len() - 1
            }
        };
        let kept = &mut self.kept[found];
        kept.used = true;
        &kept.maps
    }

    /// Lets go of what nobody has asked for since [`Self::receive`].
    pub fn drop_unused(&mut self) {
        self.kept.retain(|kept| kept.used);
        if self.kept.is_empty() {
            self.making = None;
        }
    }

    fn keep(&mut self, key: MapKey, maps: SkyMaps, images: &mut Assets<Image>) {
        let maps = MapHandles {
            seen: images.add(maps.seen),
            diffuse: images.add(maps.diffuse),
            specular: images.add(maps.specular),
            scale: maps.scale,
        };
        self.kept.push(Kept {
            key,
            maps,
            used: false,
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::components::{Sky, Sun};

    fn seen(elevation: f32, sky: Sky) -> SeenSky {
        let sun = Sun {
            elevation,
            ..Sun::default()
        };
        SeenSky::new(sun, &Sky { side: 8, ..sky }).expect("a place")
    }

    /// The maps of a frame in which so many skies are seen.
    fn frame(
        store: &mut MapStore,
        images: &mut Assets<Image>,
        skies: &[(SeenSky, f32)],
    ) -> Vec<MapHandles> {
        store.receive(images);
        let found = skies
            .iter()
            .map(|(seen, step)| store.find(seen, seen.ev100, *step, images).clone())
            .collect();
        store.drop_unused();
        found
    }

    #[test]
    fn cameras_that_see_the_same_share_their_maps_and_others_do_not() {
        let (mut store, mut images) = (MapStore::default(), Assets::<Image>::default());
        let sky = seen(30.0, Sky::default());
        let sea = seen(
            30.0,
            Sky {
                sea: true,
                ..Sky::default()
            },
        );
        let found = frame(
            &mut store,
            &mut images,
            &[(sky, 0.0), (sky, 0.0), (sea, 0.0)],
        );
        assert_eq!(found[0], found[1]);
        assert_ne!(found[0], found[2]);
        assert_eq!((store.kept.len(), images.len()), (2, 6));
        frame(&mut store, &mut images, &[(sea, 0.0)]);
        assert_eq!(store.kept.len(), 1, "what no camera sees is let go of");
        frame(&mut store, &mut images, &[]);
        assert!(store.is_empty());
    }

    #[test]
    fn a_sun_that_moves_has_new_maps_a_step_and_exact_ones_once_it_rests() {
        let (mut store, mut images) = (MapStore::default(), Assets::<Image>::default());
        let sky = |elevation| seen(elevation, Sky::default());
        let first = frame(&mut store, &mut images, &[(sky(30.0), 0.25)]);
        let moved = frame(&mut store, &mut images, &[(sky(30.2), 0.25)]);
        assert_eq!(first, moved, "less than a step");
        assert!(store.making.is_none());
        // At rest there is no step: the maps are made in the background, and taken over when done.
        let mut found = frame(&mut store, &mut images, &[(sky(30.2), 0.0)]);
        assert_eq!(first, found);
        assert!(store.making.is_some());
        let limit = std::time::Instant::now() + std::time::Duration::from_secs(60);
        while found == first && std::time::Instant::now() < limit {
            found = frame(&mut store, &mut images, &[(sky(30.2), 0.0)]);
        }
        assert_ne!(found, first);
        assert_eq!(
            (
                store.kept.len(),
                store.kept[0].key.away(&MapKey::new(&sky(30.2), 12.9))
            ),
            (1, Some(0.0))
        );
        // Larger maps of the same sky: the small ones are seen until they are there.
        let mut large = sky(30.2);
        large.sky.side = 16;
        let small = found;
        let mut found = frame(&mut store, &mut images, &[(large, 0.25)]);
        assert_eq!(small, found);
        while found == small && std::time::Instant::now() < limit {
            found = frame(&mut store, &mut images, &[(large, 0.25)]);
        }
        assert_ne!(found, small);
        assert_eq!((store.kept.len(), store.kept[0].key.side), (1, 16));
        // A leap is not waited for.
        let leapt = frame(&mut store, &mut images, &[(sky(40.0), 0.25)]);
        assert_ne!(leapt, found);
        assert!(store.making.is_none());
    }
}
