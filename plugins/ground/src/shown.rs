//! Which terrains are drawn.

use bevy::prelude::*;
use dolomite_terrain::Terrain;

use crate::material::GroundMaterial;

/// Terrains that are drawn at a time. Each takes pools and blocks of its own in every view that sees it.
pub const MOST_TERRAINS: usize = 4;

/// The terrains that are drawn: visible, with a [`GroundMaterial`]. Each keeps its slot while it is shown; the first
/// slot is never empty where there are any.
#[derive(Resource, Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct ShownTerrains {
    slots: [Option<Entity>; MOST_TERRAINS],
    /// Visible terrains for which there is no slot.
    beyond: usize,
}

impl ShownTerrains {
    /// The terrain of a slot.
    pub fn slot(&self, slot: usize) -> Option<Entity> {
        self.slots.get(slot).copied().flatten()
    }

    /// All that are drawn.
    #[cfg(feature = "render")]
    pub fn entities(&self) -> impl Iterator<Item = Entity> + '_ {
        self.slots.iter().flatten().copied()
    }

    /// How many are drawn.
    pub fn count(&self) -> usize {
        self.slots.iter().flatten().count()
    }

    /// Takes over which terrains there are, in the order of their entities.
    fn follow(&mut self, visible: &[Entity]) {
        for slot in &mut self.slots {
            *slot = slot.filter(|known| visible.contains(known));
        }
        if self.slots[0].is_none()
            && let Some(other) = self.slots.iter_mut().find(|slot| slot.is_some())
        {
            self.slots[0] = other.take();
        }
        self.beyond = 0;
        for entity in visible {
            if self.slots.contains(&Some(*entity)) {
                continue;
            }
            match self.slots.iter_mut().find(|slot| slot.is_none()) {
                Some(free) => *free = Some(*entity),
                None => self.beyond += 1,
            }
        }
    }
}

/// Whether an entity is shown, as Bevy's propagation finds it; read off the components, since an app without a
/// renderer propagates nothing.
#[cfg(feature = "render")]
fn is_shown(entity: Entity, chain: &Query<(Option<&Visibility>, Option<&ChildOf>)>) -> bool {
    let mut at = entity;
    while let Ok((visibility, parent)) = chain.get(at) {
        match (visibility, parent) {
            (Some(Visibility::Hidden), _) => return false,
            (Some(Visibility::Visible), _) | (_, None) => return true,
            (_, Some(parent)) => at = parent.parent(),
        }
    }
    true
}

/// Follows the terrains of the world. A hidden one is not drawn, and keeps nothing on the GPU.
pub(crate) fn follow_terrains(
    mut shown: ResMut<ShownTerrains>,
    terrains: Query<Entity, (With<Terrain>, With<GroundMaterial>)>,
    #[cfg(feature = "render")] chain: Query<(Option<&Visibility>, Option<&ChildOf>)>,
    mut told: Local<bool>,
) {
    let mut visible: Vec<Entity> = terrains.iter().collect();
    #[cfg(feature = "render")]
    visible.retain(|entity| is_shown(*entity, &chain));
    visible.sort_unstable_by_key(|entity| entity.index_u32());
    let mut next = shown.clone();
    next.follow(&visible);
    shown.set_if_neq(next);
    if shown.beyond > 0 && !*told {
        *told = true;
        tell!(
            "{} terrains are visible, and {MOST_TERRAINS} are drawn at a time: hide those that are far away",
            visible.len()
        );
    }
}

#[cfg(all(test, feature = "render"))]
mod tests {
    use super::*;
    use bevy::math::DVec2;
    use dolomite_terrain::{GroundRect, TerrainData};

    #[test]
    fn hidden_terrains_are_not_shown() {
        let mut app = App::new();
        app.init_resource::<ShownTerrains>()
            .add_systems(Update, follow_terrains);
        let terrain = Terrain::new(TerrainData {
            extent: GroundRect::square(DVec2::ZERO, 10.0),
            layers: Vec::new(),
            base: 0.0,
            sea_level: None,
        })
        .expect("valid");
        let mut spawn = |visibility: Visibility| {
            let ground = (terrain.clone(), GroundMaterial::default(), visibility);
            app.world_mut().spawn(ground).id()
        };
        let [plain, hidden, child] = [
            Visibility::Inherited,
            Visibility::Hidden,
            Visibility::Inherited,
        ]
        .map(&mut spawn);
        let parent = app.world_mut().spawn(Visibility::Hidden).id();
        app.world_mut().entity_mut(child).insert(ChildOf(parent));
        app.update();
        let shown = |app: &App| app.world().resource::<ShownTerrains>().slots;
        assert_eq!(shown(&app), [Some(plain), None, None, None]);
        app.world_mut()
            .entity_mut(hidden)
            .insert(Visibility::Visible);
        app.world_mut()
            .entity_mut(child)
            .insert(Visibility::Visible);
        app.update();
        assert_eq!(shown(&app), [Some(plain), Some(hidden), Some(child), None]);
    }

    #[test]
    fn terrains_keep_their_slots() {
        let entity = |index: u32| Entity::from_raw_u32(index).expect("small");
        let [a, b, c, d, e, f] = [1, 2, 3, 4, 5, 6].map(entity);
        let mut shown = ShownTerrains::default();
        shown.follow(&[a, b, c]);
        assert_eq!(shown.slots, [Some(a), Some(b), Some(c), None]);
        shown.follow(&[a, c, d, e, f]);
        // d takes the place of b.
        assert_eq!(shown.slots, [Some(a), Some(d), Some(c), Some(e)]);
        assert_eq!((shown.beyond, shown.count()), (1, 4));
        shown.follow(&[c, f]);
        assert_eq!(shown.slots, [Some(c), Some(f), None, None]);
        assert_eq!(shown.beyond, 0);
    }
}
