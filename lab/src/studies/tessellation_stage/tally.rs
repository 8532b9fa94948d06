//! What pairs of patches come to, counted.

use super::pairs::{TESSELLATORS, tessellator};
use super::report::{domain_name, mode_name, row, spacing_name};
use super::seam::Seam;
use dolomite_tessellation::Tessellator;
use serde_json::{Value, json};

/// How the two patches stand to each other, and who compared them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Kind {
    /// The edge is shared, each asks for its own level.
    Shared,
    /// Each has its own control points and its own level.
    Apart,
    /// Each has its own control points; both ask for the same level.
    ApartEqual,
}

impl Kind {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Shared, Self::Apart, Self::ApartEqual];

    /// As it is named in tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Shared => "shared edge",
            Self::Apart => "not shared, own levels",
            Self::ApartEqual => "not shared, equal levels",
        }
    }
}

/// What the pairs of one kind come to, as they are drawn.
#[derive(Debug, Clone, Default)]
pub struct Tally {
    /// Pairs.
    pub pairs: usize,
    /// Vertices on their common sides.
    pub vertices: usize,
    /// Pairs with an edge that has no counterpart of the same bits.
    pub open_pairs: usize,
    /// Edges without a counterpart.
    pub open_edges: usize,
    /// Pairs whose patches place their vertices otherwise along the side; not asked of the adapter.
    pub other_places: Option<usize>,
    /// (pairs so far, open pairs among them), at doubling numbers of pairs.
    pub curve: Vec<(f64, f64)>,
    /// Open pairs for each tessellator.
    pub of: [(usize, usize); TESSELLATORS],
}

impl Tally {
    /// Adds a pair; `place` is that of its tessellator.
    pub fn add(&mut self, place: usize, seam: Seam) {
        let open = usize::from(seam.open > 0);
        self.pairs += 1;
        self.vertices += seam.vertices;
        self.open_pairs += open;
        self.open_edges += seam.open;
        let of = &mut self.of[place % TESSELLATORS];
        of.0 += 1;
        of.1 += open;
        if self.pairs.is_power_of_two() {
            self.mark();
        }
    }

    /// Puts a point on the curve.
    fn mark(&mut self) {
        let point = (self.pairs as f64, self.open_pairs as f64);
        if self.curve.last() != Some(&point) {
            self.curve.push(point);
        }
    }

    /// For the summary.
    pub fn json(&self) -> Value {
        json!({
            "pairs": self.pairs,
            "vertices": self.vertices,
            "pairs_with_other_bits": self.open_pairs,
            "edges_without_counterpart": self.open_edges,
            "pairs_with_other_places": self.other_places,
        })
    }
}

/// The tallies of one device, one for each of `Kind::ALL`.
#[derive(Debug, Clone, Default)]
pub struct Tallies(pub [Tally; 3]);

impl Tallies {
    /// That of a kind.
    pub fn of(&mut self, kind: Kind) -> &mut Tally {
        &mut self.0[kind as usize]
    }

    /// A row a kind and tessellator.
    pub fn rows(&self, device: &str) -> Vec<crate::csv::Row> {
        let mut rows = Vec::new();
        for (kind, tally) in Kind::ALL.into_iter().zip(&self.0) {
            for (place, (pairs, open)) in tally.of.iter().enumerate() {
                let method = format!("{}, {}", kind.name(), tessellator_name(tessellator(place)));
                let pairs = ("pairs", *pairs as f64);
                let open = ("pairs with other bits", *open as f64, "pairs");
                rows.push(row("cracks", &method, pairs, open, device));
            }
        }
        rows
    }

    /// Ends the curves.
    pub fn finish(&mut self) {
        self.0.iter_mut().for_each(Tally::mark);
    }
}

/// As it is named in tables.
#[must_use]
pub fn tessellator_name(tessellator: Tessellator) -> String {
    format!(
        "{}, {}, {}",
        domain_name(tessellator.domain),
        spacing_name(tessellator.spacing),
        mode_name(tessellator.mode)
    )
}
