//! How large the pools of a view are: as large as its choices need, up to what it may have.
//!
//! What a choice needs comes back some frames later. Meanwhile it raises its tolerance to what has room, and says so. So
//! there is always more room than was needed last: a view that turns slowly never runs out.

use std::collections::HashMap;
use std::marker::PhantomData;

use bevy::prelude::*;

/// Vertices that a view begins with.
pub const FIRST: u32 = 1 << 15;
/// Rooms are multiples of it.
const STEP: u32 = 1 << 12;
/// Choices or frames in a row that need less than a quarter of the room until half of it is given back: a view of the sky
/// does not cost the ground its room.
const PATIENCE: u32 = 1024;

/// Room of one view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct PoolRoom {
    /// Vertices.
    vertices: u32,
    /// Frames that needed little of it.
    idle: u32,
}

impl Default for PoolRoom {
    fn default() -> Self {
        Self {
            vertices: FIRST,
            idle: 0,
        }
    }
}

impl PoolRoom {
    /// Follows a choice that needs so many vertices; whether it makes another room for the next.
    fn fit(&mut self, needed: u32, most: u32) -> bool {
        let before = self.vertices.min(most);
        self.idle = if needed < before / 4 {
            self.idle + 1
        } else {
            0
        };
        let spare = needed.saturating_add(needed / 4);
        if needed > before - before / 16 {
            self.vertices = spare.min(most).next_multiple_of(STEP).min(most);
        } else if self.idle > PATIENCE && before > FIRST {
            self.vertices = (before / 2).max(FIRST).next_multiple_of(STEP);
            self.idle = 0;
        }
        self.vertices.min(most) != before
    }
}

/// Rooms of the views of a kind of ground.
#[derive(Resource)]
pub struct PoolRooms<K> {
    rooms: HashMap<Entity, PoolRoom>,
    kind: PhantomData<fn() -> K>,
}

impl<K> Default for PoolRooms<K> {
    fn default() -> Self {
        Self {
            rooms: HashMap::new(),
            kind: PhantomData,
        }
    }
}

impl<K> PoolRooms<K> {
    /// Vertices of a view that may have so many at most.
    pub fn vertices(&self, view: Entity, most: u32) -> u32 {
        let room = self.rooms.get(&view).copied().unwrap_or_default();
        room.vertices.min(most)
    }

    /// Follows a choice of a view that needs so many vertices; whether the next has another room.
    pub fn fit(&mut self, view: Entity, needed: u32, most: u32) -> bool {
        self.rooms.entry(view).or_default().fit(needed, most)
    }

    /// Forgets all views but some.
    pub fn keep(&mut self, is_kept: impl Fn(&Entity) -> bool) {
        self.rooms.retain(|view, _| is_kept(view));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn room_is_made_before_it_runs_out() {
        let mut room = PoolRoom::default();
        assert!(!room.fit(FIRST / 2, 1 << 18));
        // A sixteenth is left at least.
        assert!(room.fit(FIRST - FIRST / 16 + 1, 1 << 18));
        assert!(room.vertices > FIRST && room.vertices < FIRST + FIRST / 2);
        // A view that asks for a twentieth more from frame to frame never asks for more than there is.
        let mut needed = FIRST;
        while needed < 200_000 {
            let next = needed + needed / 20;
            assert!(next <= room.vertices, "{next} of {}", room.vertices);
            room.fit(next, 1 << 18);
            needed = next;
        }
        // Not beyond what it may have; there it stays.
        assert!(room.fit(u32::MAX, 1 << 18));
        assert_eq!(room.vertices, 1 << 18);
        assert!(!room.fit(u32::MAX, 1 << 18));
    }

    #[test]
    fn room_is_given_back_after_a_while() {
        let mut room = PoolRoom::default();
        room.fit(100_000, 1 << 18);
        let large = room.vertices;
        for _ in 0..PATIENCE {
            assert!(!room.fit(10, 1 << 18));
        }
        assert!(room.fit(10, 1 << 18) && room.vertices <= large / 2 + STEP);
        // A look at the ground in between begins the wait anew.
        for k in 0..4 * PATIENCE {
            let needed = if k % PATIENCE == 0 { 50_000 } else { 10 };
            assert!(!room.fit(needed, 1 << 18));
        }
        for _ in 0..8 * PATIENCE {
            room.fit(10, 1 << 18);
        }
        assert_eq!(room.vertices, FIRST);
        // Tiny views have tiny rooms.
        assert!(!PoolRoom::default().fit(5000, 1 << 10));
    }
}
