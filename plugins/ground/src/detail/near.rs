//! The bound close to the eye, on ground of which samples say too little: who stands on a summit or an islet that they miss
//! sees it as well as is said.

use bevy::math::{DVec2, DVec3};
use dolomite_terrain::Terrain;
use dolomite_testkit::missed::{islets, massif, missed, on_lattice};

use super::cell::DetailCells;
use super::mesh::mesh;
use super::select::select;
use crate::blocks::tests::eyes::{Found, TOLERANCE, eye_at};
use crate::blocks::tests::grounds::{Camera, Random};

/// What a camera sees of the ground about it.
fn look(found: &mut Found, cells: &mut DetailCells, camera: &Camera, random: &mut Random) {
    let selection = select(cells, &camera.bound(TOLERANCE), 1 << 20);
    let mesh = mesh(cells, &selection);
    let place = |k: u32| {
        let vertex = &mesh.vertices[k as usize];
        let xz = vertex.point.to_dvec2();
        DVec3::new(xz.x, f64::from(vertex.height), xz.y)
    };
    let drawn: Vec<_> = mesh.triangles.iter().map(|t| t.map(place)).collect();
    let limit = f64::from(TOLERANCE * selection.held.max(1.0));
    found.look(cells.terrain(), &drawn, limit, camera, random);
}

/// As many views from each of some places.
fn from(terrain: &Terrain, places: &[DVec2], views: usize) -> Found {
    let mut random = Random::new(1);
    let mut cells = DetailCells::new(terrain.clone(), 1.0 / 32.0);
    let mut found = Found::default();
    for &place in places {
        for _ in 0..views {
            let camera = eye_at(terrain, place, &mut random);
            look(&mut found, &mut cells, &camera, &mut random);
        }
    }
    found
}

#[test]
fn who_stands_on_a_summit_that_samples_miss_sees_the_ground_as_well_as_is_said() {
    let terrain = massif();
    let places = missed(&terrain, 1000, 700.0, 1);
    let worst = places.first().map_or(0.0, |worst| worst.beyond);
    assert!(worst > 40.0, "samples miss {worst} m at most");
    let places: Vec<DVec2> = places.iter().map(|missed| missed.place).collect();
    let found = from(&terrain, &places, 12);
    println!("{found:?}");
    assert_eq!((found.above, found.holes), (0, 0), "{found:?}");
    assert!(found.places > 500, "{found:?}");
}

#[test]
fn who_stands_on_an_islet_that_samples_miss_sees_it_as_well_as_is_said() {
    for terrain in [islets(), on_lattice(Some(0.0)), on_lattice(None)] {
        let places = missed(&terrain, 1500, 16.0, 1);
        let places: Vec<DVec2> = places.iter().map(|missed| missed.place).take(16).collect();
        let found = from(&terrain, &places, 2);
        println!("{found:?}");
        assert_eq!((found.above, found.holes), (0, 0), "{found:?}");
        assert!(places.len() > 8 && found.places > 300, "{found:?}");
    }
}
