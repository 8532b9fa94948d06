//! The quadtree of tiles. Nodes are shared and never change.

use super::extremes::Extremes;
use super::tile::Tile;
use std::sync::Arc;

/// What is edited in a square of 2ˡ × 2ˡ tiles; nothing where there is no node.
pub(crate) type Link = Option<Arc<Node>>;

/// A node of the tree. Tiles have level 0.
#[derive(Debug)]
pub(crate) enum Node {
    Tile(Tile),
    Inner(Inner),
}

/// A node above tiles.
#[derive(Debug)]
pub(crate) struct Inner {
    /// By rows: north-west, north-east, south-west, south-east.
    children: [Link; 4],
    extremes: Extremes,
    /// Tiles and nodes in it, itself too.
    tiles: u32,
    nodes: u32,
}

impl Node {
    pub(crate) fn tile(&self) -> Option<&Tile> {
        match self {
            Self::Tile(tile) => Some(tile),
            Self::Inner(_) => None,
        }
    }

    pub(crate) const fn extremes(&self) -> Extremes {
        match self {
            Self::Tile(tile) => tile.extremes(),
            Self::Inner(inner) => inner.extremes,
        }
    }

    /// Tiles, and nodes of all levels.
    pub(crate) const fn counts(&self) -> [u32; 2] {
        match self {
            Self::Tile(_) => [1, 1],
            Self::Inner(inner) => [inner.tiles, inner.nodes],
        }
    }

    fn inner(children: [Link; 4]) -> Link {
        if children.iter().all(Option::is_none) {
            return None;
        }
        let (mut tiles, mut nodes) = (0, 1);
        let mut extremes: Option<Extremes> = None;
        for child in &children {
            let own = child.as_ref().map_or_else(Extremes::default, |child| {
                let [more_tiles, more_nodes] = child.counts();
                tiles += more_tiles;
                nodes += more_nodes;
                child.extremes()
            });
            extremes = Some(extremes.map_or(own, |known| known.join(own)));
        }
        Some(Arc::new(Self::Inner(Inner {
            children,
            extremes: extremes.unwrap_or_default(),
            tiles,
            nodes,
        })))
    }

    fn child(&self, number: usize) -> &Link {
        match self {
            Self::Tile(_) => &None,
            Self::Inner(inner) => &inner.children[number],
        }
    }
}

/// Which child of a node of `level` a tile lies in.
const fn quarter(level: u32, [x, z]: [u32; 2]) -> usize {
    let bit = level - 1;
    (((z >> bit) & 1) * 2 + ((x >> bit) & 1)) as usize
}

/// The node of level `wanted` in which a tile lies, below a root of `level`.
pub(crate) fn find(root: &Link, level: u32, place: [u32; 2], wanted: u32) -> Option<&Node> {
    let (mut node, mut level) = (root.as_deref()?, level);
    while level > wanted {
        node = node.child(quarter(level, place)).as_deref()?;
        level -= 1;
    }
    Some(node)
}

/// The tree with another tile; all else is shared.
pub(crate) fn set(root: &Link, level: u32, place: [u32; 2], tile: Option<Tile>) -> Link {
    if level == 0 {
        return tile.map(|tile| Arc::new(Node::Tile(tile)));
    }
    let mut children: [Link; 4] = match root.as_deref() {
        Some(Node::Inner(inner)) => inner.children.clone(),
        _ => [const { None }; 4],
    };
    let child = &mut children[quarter(level, place)];
    *child = set(child, level - 1, place, tile);
    Node::inner(children)
}

/// Whether both are the same node, or both are none.
pub(crate) fn same(a: &Link, b: &Link) -> bool {
    match (a, b) {
        (None, None) => true,
        (Some(a), Some(b)) => Arc::ptr_eq(a, b),
        _ => false,
    }
}

/// A node in which two trees differ.
pub(crate) struct Changed<'a> {
    pub level: u32,
    /// In nodes of its level.
    pub place: [u32; 2],
    pub before: Option<&'a Node>,
    pub now: Option<&'a Node>,
}

/// Every node in which two trees of one level differ, from above.
pub(crate) fn differences<'a>(
    before: &'a Link,
    now: &'a Link,
    level: u32,
    place: [u32; 2],
    visit: &mut impl FnMut(Changed<'a>),
) {
    if same(before, now) {
        return;
    }
    let (before, now) = (before.as_deref(), now.as_deref());
    visit(Changed {
        level,
        place,
        before,
        now,
    });
    if level == 0 {
        return;
    }
    for quarter in 0..4_usize {
        let of = |node: Option<&'a Node>| node.map_or(&None, |node| node.child(quarter));
        let [x, z] = place.map(|k| k << 1);
        let place = [x + (quarter as u32 & 1), z + (quarter as u32 >> 1)];
        differences(of(before), of(now), level - 1, place, visit);
    }
}

/// Extremes over tiles `low` to `high`, both included.
pub(crate) fn extremes(
    root: &Link,
    level: u32,
    place: [u32; 2],
    low: [i64; 2],
    high: [i64; 2],
) -> Option<Extremes> {
    let first = place.map(|k| i64::from(k) << level);
    let last = first.map(|k| k + (1 << level) - 1);
    if (0..2).any(|k| last[k] < low[k] || first[k] > high[k]) {
        return None;
    }
    let Some(node) = root.as_deref() else {
        return Some(Extremes::default());
    };
    if level == 0 || (0..2).all(|k| low[k] <= first[k] && last[k] <= high[k]) {
        return Some(node.extremes());
    }
    let parts = (0..4_usize).filter_map(|quarter| {
        let [x, z] = place.map(|k| k << 1);
        let place = [x + (quarter as u32 & 1), z + (quarter as u32 >> 1)];
        extremes(node.child(quarter), level - 1, place, low, high)
    });
    parts.reduce(Extremes::join)
}
