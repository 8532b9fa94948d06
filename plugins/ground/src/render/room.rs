//! Keeps an eye on the room that is left for what is made and kept.

/// Choices that a thing may rest through before it is dropped, at first.
const LONGEST_REST: u32 = 256;

/// Choices from a sweep to the next: counters are three frames old.
const BETWEEN_SWEEPS: u32 = 4;

/// When what nobody has looked at for long is dropped, and how long that is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Room {
    /// Choices that a thing may rest through.
    rest: u32,
    /// The choice before which there is no other sweep.
    next: u32,
}

impl Default for Room {
    fn default() -> Self {
        Self {
            rest: LONGEST_REST,
            next: 0,
        }
    }
}

impl Room {
    /// Things that no choice from the number on that is given has looked at are to be dropped; `None`: there is
    /// room. That is where `used` ones leave less than an eighth of it; or less than half, and most of these are
    /// not of the newest choices, which look at `needed`, so that a camera that jumps finds room for all that it
    /// sees. The oldest choice of a view that draws has the number `views`.
    pub fn sweep(
        &mut self,
        capacity: u32,
        stamp: u32,
        used: u32,
        needed: u32,
        views: u32,
    ) -> Option<u32> {
        let crowded = used > capacity / 2 && used / 2 > needed;
        if !(crowded || used > capacity / 8 * 7) {
            self.rest = LONGEST_REST;
            return None;
        }
        if stamp < self.next {
            return None;
        }
        self.next = stamp.saturating_add(BETWEEN_SWEEPS);
        let oldest = stamp.saturating_sub(self.rest).min(views);
        self.rest = (self.rest / 2).max(1);
        Some(oldest)
    }

    /// Whether sweeps have come to what the newest choices do not look at: there is nothing left to drop.
    pub const fn is_swept(&self) -> bool {
        self.rest <= 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_oldest_cells_go_first_and_those_of_a_view_stay() {
        let mut room = Room::default();
        let mut sweep = |stamp, used, views| room.sweep(1000, stamp, used, 200, views);
        assert_eq!(sweep(1000, 500, 1000), None, "half is free");
        assert_eq!(sweep(1000, 600, 1000), Some(1000 - 256));
        assert_eq!(sweep(1001, 600, 1001), None, "no counter is back yet");
        assert_eq!(sweep(1004, 600, 1004), Some(1004 - 128));
        assert_eq!(sweep(1008, 600, 900), Some(900), "a view rests since 900");
        assert_eq!(sweep(1012, 400, 1012), None);
        assert_eq!(
            sweep(1013, 600, 1013),
            Some(1013 - 256),
            "from the beginning"
        );
    }

    #[test]
    fn a_view_that_needs_its_room_keeps_it() {
        let mut room = Room::default();
        assert_eq!(room.sweep(1000, 5, 700, 600, 5), None);
        assert_eq!(room.sweep(1000, 5, 900, 600, 5), Some(0));
    }

    #[test]
    fn a_full_room_has_been_swept_in_the_end() {
        let mut room = Room::default();
        for stamp in (1000..).step_by(4).take(8) {
            assert!(!room.is_swept());
            assert!(room.sweep(1000, stamp, 900, 900, stamp).is_some());
        }
        assert!(room.is_swept());
    }
}
