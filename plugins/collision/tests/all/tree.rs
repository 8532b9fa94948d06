//! Trees answer as a list of all triangles does, for meshes of all kinds.

use crate::support::meshes::{self, all, closed, soup};
use crate::support::random::{direction, place, size, turn, volume};
use bevy::math::{DVec3, Vec3};
use bevy::tasks::{ComputeTaskPool, TaskPoolBuilder};
use dolomite_collision::{
    Aabb, Ellipsoid, MeshError, Ray, SweepError, TreeKind, TreeSettings, TriangleMesh,
    TriangleTree, Volume,
};
use dolomite_testkit::metrics::Hash64;
use dolomite_testkit::random::Random;

fn settings(kind: TreeKind, leaf_triangles: usize, depth: u32) -> TreeSettings {
    TreeSettings {
        kind,
        leaf_triangles,
        depth,
    }
}

const ALL: [(TreeKind, usize, u32); 6] = [
    (TreeKind::Octree, 4, 21),
    (TreeKind::Octree, 1, 21),
    (TreeKind::Octree, 8, 2),
    (TreeKind::Octree, 100, 1),
    (TreeKind::Bvh, 4, 21),
    (TreeKind::Bvh, 1, 21),
];

/// A place near a mesh: in its box, or somewhat around it; exactly a vertex at times.
fn near(random: &mut Random, mesh: &TriangleMesh) -> DVec3 {
    let count = mesh.vertices().len();
    let vertex = mesh.places().nth(random.below(count.max(1)));
    match (random.below(4), vertex) {
        (0, Some(vertex)) => vertex,
        (1, Some(vertex)) => vertex + place(random, 1e-3),
        (_, vertex) => vertex.unwrap_or(DVec3::ZERO) + place(random, 4.0),
    }
}

/// Rays through it, past it, from inside, along axes, and at its vertices and edges.
fn ray(random: &mut Random, mesh: &TriangleMesh) -> Ray {
    let target = near(random, mesh);
    let from = near(random, mesh);
    let mut ray = match random.below(5) {
        0 => Ray::between(from, target),
        1 => Ray::new(from, [DVec3::X, DVec3::NEG_Y, DVec3::Z][random.below(3)]),
        2 => {
            let far = direction(random) * size(random, 10.0, 1e6);
            Ray::new(target - far, far * size(random, 1e-3, 1e3))
        }
        3 => Ray::new(target, direction(random)),
        _ => Ray::new(from, target - from),
    };
    if random.below(6) == 0 {
        ray.end = random.unit();
    }
    ray
}

/// Counts answers that differ from those of `truth`; also how many there were.
fn differences(tree: &TriangleTree, truth: &TriangleTree, count: usize, seed: u32) -> [usize; 2] {
    let mut random = Random::new(seed);
    let mesh = truth.mesh();
    let (mut wrong, mut found) = (0, 0);
    for number in 0..count {
        let ray = ray(&mut random, mesh);
        let hit = truth.first_hit(&ray);
        wrong += usize::from(tree.first_hit(&ray) != hit);
        wrong += usize::from(tree.blocked(&ray) != hit.is_some());
        let mut body = volume(&mut random, number % 4);
        body =
            crate::support::convex::moved(&body, near(&mut random, mesh) - body.bounds().center());
        let overlapping = truth.overlapping(&body);
        wrong += usize::from(tree.overlapping(&body) != overlapping);
        let place = near(&mut random, mesh);
        let within = [f64::INFINITY, 0.5, 0.0][number % 3];
        let nearest = truth.nearest(place, within);
        wrong += usize::from(tree.nearest(place, within) != nearest);
        let radii = DVec3::new(
            size(&mut random, 0.01, 2.0),
            size(&mut random, 0.01, 2.0),
            0.3,
        );
        let ellipsoid = Ellipsoid {
            center: near(&mut random, mesh),
            radii,
            rotation: turn(&mut random),
        };
        let way = near(&mut random, mesh) - ellipsoid.center;
        let contact = truth.sweep(&ellipsoid, way);
        wrong += usize::from(tree.sweep(&ellipsoid, way) != contact);
        found += usize::from(hit.is_some())
            + overlapping.len()
            + usize::from(nearest.is_some())
            + usize::from(contact.is_ok_and(|contact| contact.is_some()));
    }
    [wrong, found]
}

#[test]
fn trees_answer_as_lists_do() {
    let mut random = Random::new(31);
    for (name, mesh) in all(&mut random) {
        let truth = TriangleTree::new(mesh.clone(), settings(TreeKind::List, 1, 1));
        for (kind, leaf, depth) in ALL {
            let tree = TriangleTree::new(mesh.clone(), settings(kind, leaf, depth));
            let [wrong, found] = differences(&tree, &truth, 50, 32);
            assert_eq!(wrong, 0, "{name}, {kind:?} {leaf} {depth}");
            assert!(found > 20 || mesh.triangles().is_empty(), "{name}: {found}");
            assert_eq!(tree.bounds(), truth.bounds());
        }
    }
}

/// The comparison sees a tree that lacks a few triangles.
#[test]
fn a_tree_of_fewer_triangles_is_seen() {
    let mut random = Random::new(33);
    let triangles = soup(&mut random, 2000, 5.0, 0.5);
    let tree = |triangles: &[[DVec3; 3]]| {
        let mesh = TriangleMesh::from_triangles(triangles).unwrap();
        TriangleTree::new(mesh, settings(TreeKind::Octree, 4, 21))
    };
    let [wrong, _] = differences(&tree(&triangles[..1990]), &tree(&triangles), 300, 34);
    assert!(wrong > 0);
}

#[test]
fn refitted_trees_answer_as_new_ones() {
    let mut random = Random::new(35);
    for (kind, leaf, depth) in ALL {
        let mesh = TriangleMesh::from_triangles(&soup(&mut random, 800, 5.0, 0.5)).unwrap();
        let mut tree = TriangleTree::new(mesh, settings(kind, leaf, depth));
        let moved: Vec<Vec3> = tree
            .mesh()
            .vertices()
            .iter()
            .map(|v| *v * 1.5 + place(&mut random, 2.0).as_vec3())
            .collect();
        tree.refit(&moved).unwrap();
        let truth = TriangleTree::new(tree.mesh().clone(), settings(TreeKind::List, 1, 1));
        assert_eq!(differences(&tree, &truth, 150, 36)[0], 0, "{kind:?}");
        let broken = vec![Vec3::NAN; moved.len()];
        assert!(matches!(
            tree.refit(&broken),
            Err(MeshError::Vertex { index: 0, .. })
        ));
        assert!(matches!(
            tree.refit(&moved[1..]),
            Err(MeshError::Count { .. })
        ));
        assert_eq!(differences(&tree, &truth, 20, 37)[0], 0, "it is as it was");
    }
}

/// Möller and Trumbore's test in f32 with edges that belong to nobody: the leak count's counterpart.
fn leaks_of_open_edges(mesh: &TriangleMesh, ray: &Ray) -> bool {
    let (origin, way) = (
        (ray.origin - mesh.origin()).as_vec3(),
        ray.direction.as_vec3(),
    );
    (0..mesh.triangles().len() as u32).all(|i| {
        let [a, b, c] = mesh.local_corners(i);
        let (ab, ac) = (b - a, c - a);
        let p = way.cross(ac);
        let determinant = ab.dot(p);
        let s = origin - a;
        let u = s.dot(p) / determinant;
        let v = way.dot(s.cross(ab)) / determinant;
        let time = ac.dot(s.cross(ab)) / determinant;
        !(time > 0.0 && u > 0.0 && v > 0.0 && u + v < 1.0)
    })
}

/// Rays at vertices and at edges of closed meshes, from outside: none passes through.
#[test]
fn closed_meshes_do_not_leak() {
    let mut random = Random::new(38);
    let (mut leaks, mut others) = (0, 0);
    for number in 0..8 {
        let origin = place(&mut random, 1e4);
        let mesh = closed(&mut random, 8 + number, origin);
        let inside = origin;
        for (kind, leaf, depth) in [ALL[0], ALL[4]] {
            let tree = TriangleTree::new(mesh.clone(), settings(kind, leaf, depth));
            for count in 0..20_000 {
                let triangle = random.below(mesh.triangles().len()) as u32;
                let corners = mesh.corners(triangle);
                let along = if count % 2 == 0 { 0.0 } else { random.unit() };
                let target = corners[0].lerp(corners[1], along);
                // From the inside through it, so that the surface must be met.
                let way = target - inside;
                let from = inside + place(&mut random, 0.05);
                let ray = Ray::new(from, target - from);
                leaks += usize::from(tree.first_hit(&ray).is_none());
                let outside = Ray::new(inside + way * 40.0, -way);
                leaks += usize::from(tree.first_hit(&outside).is_none());
                if count < 1000 {
                    others += usize::from(leaks_of_open_edges(&mesh, &ray));
                }
            }
        }
    }
    assert_eq!(leaks, 0);
    // The rays do meet edges: a test that gives those to nobody lets many through.
    assert!(others > 1000, "{others}");
}

#[test]
fn times_are_those_of_the_plane() {
    let mut random = Random::new(39);
    let mut worst = 0.0_f64;
    for _ in 0..20_000 {
        let corners = soup(&mut random, 1, 100.0, 2.0);
        let [a, b, c] = corners[0].map(|corner| corner.as_vec3().as_dvec3());
        let tree = TriangleTree::new(
            TriangleMesh::new(
                DVec3::ZERO,
                [a, b, c].map(|p| p.as_vec3()).to_vec(),
                vec![[0, 1, 2]],
            )
            .unwrap(),
            TreeSettings::default(),
        );
        let normal = (b - a).cross(c - a).normalize();
        let aim = (a + b + c) / 3.0;
        let way = direction(&mut random) * 10.0;
        if way.dot(normal).abs() < 1.0 {
            continue;
        }
        let hit = tree
            .first_hit(&Ray::new(aim - way, way))
            .expect("through its middle");
        worst = worst.max((hit.time - 1.0).abs());
        let sum: f64 = hit.barycentric.iter().sum();
        assert!((sum - 1.0).abs() < 1e-12);
    }
    assert!(worst < 1e-12, "{worst:e}");
}

/// No leaf is hidden by a later one: a ray from the viewer through one leaf's box meets only later leaves after it.
#[test]
fn octrees_go_from_front_to_back() {
    let mut random = Random::new(40);
    // Triangles far smaller than their cells, so that boxes are within them.
    let mesh = TriangleMesh::from_triangles(&soup(&mut random, 3000, 10.0, 1e-6)).unwrap();
    let tree = TriangleTree::new(mesh, settings(TreeKind::Octree, 4, 21));
    for _ in 0..20 {
        let viewer = place(&mut random, 20.0);
        let mut leaves: Vec<Aabb> = Vec::new();
        let mut seen = 0;
        tree.front_to_back(
            viewer,
            |_| true,
            |triangles| {
                let points: Vec<DVec3> = triangles
                    .iter()
                    .flat_map(|&i| tree.mesh().corners(i))
                    .collect();
                leaves.push(Aabb::fit(&points).unwrap());
                seen += triangles.len();
            },
        );
        assert_eq!(seen, 3000);
        for _ in 0..300 {
            let first = random.below(leaves.len());
            let target = leaves[first].min.lerp(leaves[first].max, random.unit());
            let onward = Ray {
                end: 1e3,
                ..Ray::new(target, target - viewer)
            };
            for (other, leaf) in leaves.iter().enumerate() {
                if other < first && leaf.enter(&onward).is_some_and(|time| time <= onward.end) {
                    assert!(leaf.overlaps_box(&leaves[first]), "{other} hides {first}");
                }
            }
        }
    }
    // What is not kept is passed over.
    let half = |aabb: &Aabb| aabb.max.x > 0.0;
    let mut kept = 0;
    tree.front_to_back(DVec3::ZERO, half, |triangles| kept += triangles.len());
    assert!((1400..2000).contains(&kept), "{kept}");
}

trait OverlapsBox {
    fn overlaps_box(&self, other: &Aabb) -> bool;
}

impl OverlapsBox for Aabb {
    fn overlaps_box(&self, other: &Aabb) -> bool {
        Volume::Aabb(*self).overlaps(&Volume::Aabb(*other))
    }
}

#[test]
fn leaves_keep_their_limits() {
    let mut random = Random::new(41);
    let mesh = TriangleMesh::from_triangles(&soup(&mut random, 5000, 5.0, 0.1)).unwrap();
    for (kind, leaf) in [
        (TreeKind::Octree, 4),
        (TreeKind::Octree, 16),
        (TreeKind::Bvh, 8),
    ] {
        let tree = TriangleTree::new(mesh.clone(), settings(kind, leaf, 21));
        assert!(
            tree.largest_leaf() <= leaf,
            "{kind:?}: {}",
            tree.largest_leaf()
        );
    }
    // At the depth's end a leaf takes what there is: a million triangles in one cell are still answered.
    let many = vec![soup(&mut random, 1, 1.0, 1.0)[0]; 1_000_000];
    let mesh = TriangleMesh::from_triangles(&many).unwrap();
    let tree = TriangleTree::new(mesh, settings(TreeKind::Octree, 4, 21));
    assert_eq!(tree.largest_leaf(), 1_000_000);
    let center = (many[0][0] + many[0][1] + many[0][2]) / 3.0;
    let first = |tree: &TriangleTree| {
        let hit = tree.first_hit(&Ray::new(center - DVec3::ONE, DVec3::ONE));
        hit.map(|hit| hit.triangle)
    };
    assert_eq!(first(&tree), Some(0));
    // The other tree halves their list, by fewer as `obvhs` is not optimised in tests.
    let mesh = TriangleMesh::from_triangles(&many[..100_000]).unwrap();
    let tree = TriangleTree::new(mesh, settings(TreeKind::Bvh, 8, 21));
    assert_eq!((tree.largest_leaf() <= 8, first(&tree)), (true, Some(0)));
}

#[test]
fn what_is_no_mesh_is_refused() {
    let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
    let new = |vertices, triangles| TriangleMesh::new(DVec3::ZERO, vertices, triangles);
    assert!(new(corners.clone(), vec![[0, 1, 2]]).is_ok());
    assert!(matches!(
        new(corners.clone(), vec![[0, 1, 3]]),
        Err(MeshError::Index { .. })
    ));
    let nan = vec![Vec3::ZERO, Vec3::NAN, Vec3::Y];
    let said = new(nan, vec![]).unwrap_err().to_string();
    assert!(said.starts_with("vertex 1 at"), "{said}");
    let wide = vec![Vec3::splat(1e13)];
    assert!(matches!(new(wide, vec![]), Err(MeshError::Vertex { .. })));
    assert!(matches!(
        TriangleMesh::new(DVec3::splat(f64::NAN), corners, vec![]),
        Err(MeshError::Origin(_))
    ));
}

/// Numbers that f32 does not hold run over in the tests of boxes: children that are none are still not looked at.
#[test]
fn ways_that_are_longer_than_f32_are_survived() {
    let mut random = Random::new(37);
    let triangles = soup(&mut random, 300, 5.0, 0.5);
    let mesh = TriangleMesh::from_triangles(&triangles).unwrap();
    let truth = TriangleTree::new(mesh.clone(), settings(TreeKind::List, 1, 1));
    let figure = Ellipsoid::upright(DVec3::Y * 9.0, DVec3::ONE);
    let far = Ellipsoid::upright(DVec3::Y * 1e50, DVec3::ONE);
    for (kind, leaf, depth) in ALL {
        let tree = TriangleTree::new(mesh.clone(), settings(kind, leaf, depth));
        for way in [1e38, 1e40, 4e44, 1e50] {
            let way = DVec3::Y * -way;
            let found = tree.sweep(&figure, way);
            assert!(matches!(found, Ok(Some(_))), "{kind:?} {way}");
            assert_eq!(found, truth.sweep(&figure, way), "{kind:?} {way}");
        }
        assert_eq!(tree.sweep(&far, DVec3::X), Ok(None));
        for way in [
            DVec3::Y * -1e300,
            DVec3::NAN,
            DVec3::new(0.0, f64::NAN, 0.0),
        ] {
            assert!(matches!(tree.sweep(&figure, way), Err(SweepError::Way(_))));
        }
        let ray = Ray::between(DVec3::Y * 1e150, DVec3::Y * -1e150);
        assert_eq!(tree.first_hit(&ray), truth.first_hit(&ray));
    }
    // A mesh that is nowhere near.
    let nowhere = TriangleMesh::new(
        DVec3::Y * 1e300,
        vec![Vec3::ZERO, Vec3::X, Vec3::Z],
        vec![[0, 1, 2]],
    );
    let nowhere = TriangleTree::new(nowhere.unwrap(), TreeSettings::default());
    assert_eq!(nowhere.sweep(&figure, DVec3::Y), Ok(None));
}

/// The same on any number of threads, whatever the profile: each of the two runs in a process of its own.
fn hash_of_answers(threads: usize) -> u64 {
    ComputeTaskPool::get_or_init(|| TaskPoolBuilder::new().num_threads(threads).build());
    let mut random = Random::new(42);
    let mesh = meshes::floor(100, 0.3, |x, z| (x * z).fract() + 0.1 * (x - z).fract());
    let mut hash = Hash64::default();
    for kind in [TreeKind::Octree, TreeKind::Bvh] {
        let tree = TriangleTree::new(mesh.clone(), settings(kind, 4, 21));
        let rays: Vec<Ray> = (0..5000).map(|_| ray(&mut random, &mesh)).collect();
        let mut hits = vec![None; rays.len()];
        tree.first_hits(&rays, &mut hits);
        for (ray, hit) in rays.iter().zip(&hits) {
            assert_eq!(*hit, tree.first_hit(ray));
            hash.add(hit.map_or(0, |hit| hit.time.to_bits() ^ u64::from(hit.triangle)));
        }
        let mut leaves = Hash64::default();
        tree.front_to_back(
            DVec3::ONE,
            |_| true,
            |triangles| {
                triangles
                    .iter()
                    .for_each(|&triangle| leaves.add(u64::from(triangle)));
            },
        );
        hash.add(leaves.finish());
    }
    hash.finish()
}

const HASH: u64 = 2_943_909_144_366_314_969;

#[test]
fn one_thread_answers_the_same() {
    assert_eq!(hash_of_answers(1), HASH);
}

#[test]
fn two_threads_answer_the_same() {
    assert_eq!(hash_of_answers(2), HASH);
}
