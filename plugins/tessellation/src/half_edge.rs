//! Whether triangles form an oriented manifold, and where its border runs.
//!
//! Every triangle has three directed half-edges. In an oriented manifold each is used once, and its
//! opposite at most once; half-edges without an opposite are the border.

use std::collections::HashMap;

use thiserror::Error;

/// What was found about triangles that form an oriented manifold.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Manifold {
    /// The border as closed loops of vertices, each in the order of the triangles' orientation.
    pub borders: Vec<Vec<u32>>,
    /// Vertices − edges + triangles: 1 for a disc, 2 for a sphere, 0 for a torus. Vertices that no
    /// triangle uses do not count.
    pub euler: i64,
}

/// Why triangles do not form an oriented manifold.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum TopologyError {
    /// An index beyond the vertices.
    #[error("triangle {triangle} uses vertex {vertex}, but there are {vertices}")]
    OutOfRange {
        /// Which triangle.
        triangle: usize,
        /// The vertex that it names.
        vertex: u32,
        /// How many there are.
        vertices: usize,
    },
    /// A triangle that uses one vertex twice.
    #[error("triangle {triangle} uses vertex {vertex} twice")]
    Degenerate {
        /// Which triangle.
        triangle: usize,
        /// The vertex.
        vertex: u32,
    },
    /// Three triangles at an edge, or two of opposite orientation.
    #[error("triangles {first} and {second} both run from vertex {from} to vertex {to}")]
    SharedHalfEdge {
        /// Start of the half-edge.
        from: u32,
        /// Its end.
        to: u32,
        /// A triangle that has it.
        first: usize,
        /// Another one.
        second: usize,
    },
    /// Two sheets that meet in one border vertex.
    #[error("the border passes vertex {vertex} more than once")]
    BorderTouches {
        /// Where.
        vertex: u32,
    },
}

/// Checks `triangles` over `vertices` vertices; gives border and Euler characteristic.
///
/// # Errors
/// [`TopologyError`]: the first fault that is met.
pub fn check(triangles: &[[u32; 3]], vertices: usize) -> Result<Manifold, TopologyError> {
    let mut half_edges = HashMap::with_capacity(3 * triangles.len());
    let mut used = vec![false; vertices];
    for (triangle, corners) in triangles.iter().enumerate() {
        for k in 0..3 {
            let (from, to) = (corners[k], corners[(k + 1) % 3]);
            let Some(used) = used.get_mut(from as usize) else {
                return Err(TopologyError::OutOfRange {
                    triangle,
                    vertex: from,
                    vertices,
                });
            };
            *used = true;
            if from == to {
                return Err(TopologyError::Degenerate {
                    triangle,
                    vertex: from,
                });
            }
            if let Some(first) = half_edges.insert((from, to), triangle) {
                return Err(TopologyError::SharedHalfEdge {
                    from,
                    to,
                    first,
                    second: triangle,
                });
            }
        }
    }
    // From the start of each border half-edge to its end.
    let mut next = HashMap::new();
    for &(from, to) in half_edges.keys() {
        if !half_edges.contains_key(&(to, from)) && next.insert(from, to).is_some() {
            return Err(TopologyError::BorderTouches { vertex: from });
        }
    }
    let edges = (half_edges.len() + next.len()) / 2;
    let euler =
        used.iter().filter(|used| **used).count() as i64 - edges as i64 + triangles.len() as i64;
    let mut starts: Vec<u32> = next.keys().copied().collect();
    starts.sort_unstable();
    let mut borders = Vec::new();
    for start in starts {
        let mut border = Vec::new();
        let mut at = start;
        while let Some(to) = next.remove(&at) {
            border.push(at);
            at = to;
        }
        if !border.is_empty() {
            borders.push(border);
        }
    }
    Ok(Manifold { borders, euler })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_disc_a_sphere_and_two_discs() {
        let disc = check(&[[0, 1, 2], [0, 2, 3]], 4).expect("a disc");
        assert_eq!(
            disc,
            Manifold {
                borders: vec![vec![0, 1, 2, 3]],
                euler: 1
            }
        );
        let sphere = check(&[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]], 4).expect("a sphere");
        assert_eq!(
            sphere,
            Manifold {
                borders: vec![],
                euler: 2
            }
        );
        let two = check(&[[0, 1, 2], [3, 4, 5]], 6).expect("two discs");
        assert_eq!(two.borders, [vec![0, 1, 2], vec![3, 4, 5]]);
    }

    #[test]
    fn every_fault_is_named() {
        let fault = |triangles: &[[u32; 3]]| check(triangles, 5).expect_err("a fault");
        assert!(matches!(
            fault(&[[0, 1, 5]]),
            TopologyError::OutOfRange { vertex: 5, .. }
        ));
        assert!(matches!(
            fault(&[[0, 1, 1]]),
            TopologyError::Degenerate { vertex: 1, .. }
        ));
        assert!(matches!(
            fault(&[[0, 1, 2], [0, 1, 3]]),
            TopologyError::SharedHalfEdge {
                from: 0,
                to: 1,
                first: 0,
                second: 1
            }
        ));
        assert!(matches!(
            fault(&[[0, 1, 2], [0, 3, 4]]),
            TopologyError::BorderTouches { vertex: 0 }
        ));
    }
}
