//! Where things lie in a file of tiles.
//!
//! | bytes | what |
//! |---|---|
//! | 0 | [`HEAD`] bytes: mark, version, key, size, lengths, a sum of all that stands before the tiles |
//! | 64 | [`NOTE`] bytes for what the map's file says (`note.rs`), which is known last |
//! | then | for each tile of level 0 its lowest and highest sample and the largest step to a next one, three floats |
//! | then | for each stored tile its sum, the coarsest level first |
//! | then | tiles of stored levels, the coarsest first: heights, slopes, deviations; last those of level 0, heights alone, unless the map's own file is read |

use super::derive::TILE;

/// Bytes of the head.
pub(super) const HEAD: usize = 64;
/// What a file of tiles begins with; the last letter is its version.
pub(super) const MARK: [u8; 8] = *b"DOLOTIL2";
/// The finest level that is stored with slopes and deviations: those between it and level 0 are made from the latter, which
/// takes a tile's reader some milliseconds and saves sixteen times the bytes.
pub(super) const STORED: u32 = 3;
/// Room for what the map's file says.
pub(super) const NOTE: u64 = 1 << 16;
/// Bytes of a tile's heights.
pub(super) const PLANE: u64 = 4 * (TILE * TILE) as u64;

/// The places of everything, which follow from the size of the map.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Form {
    pub size: [u32; 2],
    /// The coarsest level: it is one tile.
    pub top: u32,
    /// Whether level 0 is stored here.
    pub base: bool,
}

/// Samples of a level along an axis with so many on level 0: the last may stand beyond the border.
pub(super) const fn along(samples: u32, level: u32) -> u32 {
    let steps = samples as u64 - 1;
    (steps.div_ceil(1 << level) + 1) as u32
}

impl Form {
    pub fn new(size: [u32; 2], base: bool) -> Self {
        let is_one = |level: &u32| size.iter().all(|&n| along(n, *level) <= TILE as u32);
        // 32 halvings bring any size below a tile.
        let top = (0..32).find(is_one).unwrap_or(32);
        Self { size, top, base }
    }

    /// Columns and rows of a level's samples.
    pub fn samples(&self, level: u32) -> [u32; 2] {
        self.size.map(|n| along(n, level))
    }

    /// Columns and rows of a level's tiles.
    pub fn tiles(&self, level: u32) -> [u32; 2] {
        self.samples(level).map(|n| n.div_ceil(TILE as u32))
    }

    fn count(&self, level: u32) -> u64 {
        let [columns, rows] = self.tiles(level);
        u64::from(columns) * u64::from(rows)
    }

    /// Number of a tile in its level.
    pub fn number(&self, level: u32, [column, row]: [u32; 2]) -> u64 {
        u64::from(row) * u64::from(self.tiles(level)[0]) + u64::from(column)
    }

    /// Levels that are stored, as they lie in the file.
    fn stored(&self) -> impl Iterator<Item = u32> + use<> {
        let base = self.base.then_some(0);
        (STORED..=self.top).rev().chain(base)
    }

    pub fn is_stored(&self, level: u32) -> bool {
        self.stored().any(|stored| stored == level)
    }

    /// Tiles with a sum.
    pub fn sums(&self) -> u64 {
        self.stored().map(|level| self.count(level)).sum()
    }

    /// Place of a tile's sum among all.
    pub fn sum(&self, level: u32, at: [u32; 2]) -> u64 {
        let before = self.stored().take_while(|&other| other != level);
        before.map(|level| self.count(level)).sum::<u64>() + self.number(level, at)
    }

    /// Bytes of the extremes of level 0.
    pub fn extremes(&self) -> u64 {
        12 * self.count(0)
    }

    /// Bytes before the first tile.
    pub fn before(&self) -> u64 {
        HEAD as u64 + NOTE + self.extremes() + 8 * self.sums()
    }

    /// Bytes of a tile of a level.
    pub const fn bytes(level: u32) -> u64 {
        if level == 0 { PLANE } else { 3 * PLANE }
    }

    /// Where a stored tile begins.
    pub fn tile(&self, level: u32, at: [u32; 2]) -> u64 {
        let before = self.stored().take_while(|&other| other != level);
        let before: u64 = before
            .map(|level| self.count(level) * Self::bytes(level))
            .sum();
        self.before().next_multiple_of(4096) + before + self.number(level, at) * Self::bytes(level)
    }

    /// Bytes of the whole file.
    pub fn all(&self) -> u64 {
        let all: u64 = self
            .stored()
            .map(|level| self.count(level) * Self::bytes(level))
            .sum();
        self.before().next_multiple_of(4096) + all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_lie_side_by_side_and_fill_the_file() {
        for (size, base) in [
            ([5000, 3001], true),
            ([2049, 1], false),
            ([100, 40], true),
            ([1, 1], false),
        ] {
            let form = Form::new(size, base);
            let mut places = Vec::new();
            let mut sums = Vec::new();
            for level in 0..=form.top {
                let [columns, rows] = form.tiles(level);
                if !form.is_stored(level) {
                    continue;
                }
                for at in (0..rows).flat_map(|row| (0..columns).map(move |column| [column, row])) {
                    let begin = form.tile(level, at);
                    places.push([begin, begin + Form::bytes(level)]);
                    sums.push(form.sum(level, at));
                }
            }
            places.sort_unstable();
            sums.sort_unstable();
            assert!(sums.iter().copied().eq(0..form.sums()));
            assert!(
                places.array_windows().all(|[a, b]| a[1] == b[0]),
                "{size:?}"
            );
            let first = places.first().map_or(form.all(), |place| place[0]);
            assert!(first >= form.before() && first % 4096 == 0);
            assert_eq!(
                places.last().map_or(form.all(), |place| place[1]),
                form.all()
            );
        }
        let form = Form::new([65_536; 2], false);
        assert_eq!(
            (form.top, form.samples(1), form.samples(9)),
            (10, [32_769; 2], [129; 2])
        );
        // A twelfth of the map's own bytes as u16.
        assert!(form.all() < (65_536_u64 * 65_536 * 2) / 7, "{}", form.all());
    }
}
