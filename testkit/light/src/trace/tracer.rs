//! The first thing that a ray meets, and whether anything lies between two points.

use glam::DVec3;

use super::Ray;
use super::bounds::Bounds;
use super::build::{DEEPEST, Node, build};
use super::primitive::{Exact, Triangle, primitives};
use crate::scene::Scene;

/// Which sides are hit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sides {
    /// Those from which the corners are counter-clockwise, and spheres from outside: what a camera sees. Planes have two
    /// such sides.
    Front,
    /// Both: what blocks light.
    Both,
}

/// Where a ray met something.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// The ray's parameter.
    pub t: f64,
    what: What,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum What {
    Triangle(u32),
    Sphere(u32),
    Plane(u32),
}

/// The surface at a hit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surface {
    /// Metres.
    pub position: DVec3,
    /// The unit normal that light is computed with; of a plane, on the side that the ray came from.
    pub normal: DVec3,
    /// The unit normal of the triangle, or that of the exact shape.
    pub face: DVec3,
    /// Index into [`Scene::objects`].
    pub object: usize,
    /// Index into [`Scene::materials`].
    pub material: usize,
    /// Corners, their normals, and the weights of the second and third; for triangles.
    pub triangle: Option<([DVec3; 3], [DVec3; 3], [f64; 2])>,
}

/// A scene, made ready for rays.
#[derive(Debug)]
pub struct Tracer {
    nodes: Vec<Node>,
    order: Vec<u32>,
    triangles: Vec<Triangle>,
    spheres: Vec<Exact>,
    planes: Vec<Exact>,
    materials: Vec<usize>,
}

impl Tracer {
    /// Builds the hierarchy: n log n.
    pub fn new(scene: &Scene) -> Self {
        let (triangles, spheres, planes) = primitives(scene);
        let mut bounds: Vec<Bounds> = triangles.iter().map(Triangle::bounds).collect();
        bounds.extend(spheres.iter().map(|s| s.bounds));
        let mut order: Vec<u32> = (0..bounds.len() as u32).collect();
        let nodes = build(&bounds, &mut order);
        Self {
            nodes,
            order,
            triangles,
            spheres,
            planes,
            materials: scene.objects.iter().map(|o| o.material).collect(),
        }
    }

    /// The first hit between `near` and `far`, both excluded.
    pub fn hit(&self, ray: &Ray, near: f64, far: f64, sides: Sides) -> Option<Hit> {
        let mut best: Option<Hit> = None;
        self.walk(ray, near, far, sides, |hit| {
            let nearer = best.is_none_or(|b| hit.t < b.t);
            if nearer {
                best = Some(hit);
            }
            best.map(|b| b.t)
        });
        best
    }

    /// Whether anything lies strictly between `near` and `far`.
    pub fn blocked(&self, ray: &Ray, near: f64, far: f64) -> bool {
        let mut blocked = false;
        self.walk(ray, near, far, Sides::Both, |_| {
            blocked = true;
            None
        });
        blocked
    }

    /// Tells `found` of hits; it answers up to where the search goes on, or `None` if that is enough.
    fn walk(
        &self,
        ray: &Ray,
        near: f64,
        mut far: f64,
        sides: Sides,
        mut found: impl FnMut(Hit) -> Option<f64>,
    ) {
        for (plane, k) in self.planes.iter().zip(0..) {
            if let Some(t) = plane.plane(ray).filter(|t| *t > near && *t < far) {
                match found(Hit {
                    t,
                    what: What::Plane(k),
                }) {
                    Some(end) => far = end,
                    None => return,
                }
            }
        }
        let mut stack = [0_u32; DEEPEST];
        let mut height = usize::from(!self.nodes.is_empty());
        while height > 0 {
            height -= 1;
            let index = stack[height] as usize;
            let node = &self.nodes[index];
            if node.bounds.enter(ray, near, far).is_none() {
                continue;
            }
            if node.count == 0 {
                let children = [index + 1, node.first as usize];
                let at = children.map(|c| self.nodes[c].bounds.enter(ray, near, far));
                // The nearer one on top.
                let swap = matches!(at, [Some(a), Some(b)] if b < a);
                let nearer = usize::from(swap);
                for child in [1 - nearer, nearer] {
                    if at[child].is_some() {
                        stack[height] = children[child] as u32;
                        height += 1;
                    }
                }
                continue;
            }
            for k in &self.order[node.first as usize..(node.first + node.count) as usize] {
                let hit = self.primitive(*k, ray, near, far, sides);
                if let Some(hit) = hit {
                    match found(hit) {
                        Some(end) => far = end,
                        None => return,
                    }
                }
            }
        }
    }

    fn primitive(&self, k: u32, ray: &Ray, near: f64, far: f64, sides: Sides) -> Option<Hit> {
        let within = |t: &f64| *t > near && *t < far;
        if let Some(triangle) = self.triangles.get(k as usize) {
            let (t, _, front) = ray.triangle(&triangle.corners)?;
            let seen = within(&t) && (front || sides == Sides::Both);
            seen.then_some(Hit {
                t,
                what: What::Triangle(k),
            })
        } else {
            let k = k - self.triangles.len() as u32;
            let [enter, leave] = self.spheres[k as usize].sphere(ray)?;
            let t = match sides {
                Sides::Front => Some(enter).filter(within),
                Sides::Both => [enter, leave].into_iter().find(within),
            };
            t.map(|t| Hit {
                t,
                what: What::Sphere(k),
            })
        }
    }

    /// The surface at a hit of this ray.
    pub fn surface(&self, ray: &Ray, hit: &Hit) -> Surface {
        let position = ray.at(hit.t);
        let plain = |normal: DVec3, object: u32| Surface {
            position,
            normal,
            face: normal,
            object: object as usize,
            material: self.materials[object as usize],
            triangle: None,
        };
        match hit.what {
            What::Triangle(k) => {
                let triangle = &self.triangles[k as usize];
                let weights = ray.triangle(&triangle.corners).map_or([0.0; 2], |h| h.1);
                Surface {
                    normal: triangle.normal(weights),
                    face: triangle.face(),
                    triangle: Some((triangle.corners, triangle.normals, weights)),
                    ..plain(DVec3::Y, triangle.object)
                }
            }
            What::Sphere(k) => {
                let sphere = &self.spheres[k as usize];
                plain(sphere.sphere_normal(position), sphere.object)
            }
            What::Plane(k) => {
                let plane = &self.planes[k as usize];
                let normal = plane.plane_normal();
                let facing = normal.dot(ray.direction) <= 0.0;
                plain(if facing { normal } else { -normal }, plane.object)
            }
        }
    }
}
