//! A broad-leaved tree: branches by space colonization (A. Runions, B. Lane, P. Prusinkiewicz, *Modeling Trees with a
//! Space Colonization Algorithm*, Eurographics Workshop on Natural Phenomena 2007), as thick as the pipe model says.

use glam::{Quat, Vec3};

use crate::model::{Leaf, Model, Ring};
use crate::plant::Plant;
use crate::random::Random;

/// From one node of a branch to the next, metres.
const STEP: f32 = 0.28;
/// Points pull nodes from as far away.
const PULL: f32 = 2.6;
/// A point is reached by a node as near as this.
const REACHED: f32 = 0.55;
/// Radius of the thinnest twig, metres.
const TWIG: f32 = 0.011;
/// Radii of children to this power sum to that of the parent.
const PIPE: f32 = 2.25;

const BARK: Vec3 = Vec3::new(0.090, 0.066, 0.046);
const LEAF_LOW: Vec3 = Vec3::new(0.040, 0.085, 0.014);
const LEAF_HIGH: Vec3 = Vec3::new(0.088, 0.155, 0.028);

/// The crown: balls that overlap.
struct Crown(Vec<(Vec3, f32)>);

impl Crown {
    fn new(random: &mut Random) -> Self {
        let middle = Vec3::new(0.0, 5.3, 0.0);
        let mut balls = vec![(middle, 1.9)];
        for k in 0..17 {
            // Around the middle by the golden angle, so that no side is bare, and a bit by chance.
            let up = 1.0 - 1.75 * (k as f32 + 0.5) / 17.0;
            let around = Quat::from_rotation_y(2.399_963 * k as f32 + random.within(-0.3, 0.3));
            let out = around * Vec3::new((1.0 - up * up).max(0.05).sqrt(), 0.0, 0.0);
            let away = random.within(1.8, 2.5);
            let ball = middle + Vec3::new(out.x * away * 1.3, up * away, out.z * away * 1.3);
            balls.push((ball, random.within(1.0, 1.6)));
        }
        Self(balls)
    }

    /// Distance to the surface, negative inside.
    fn outside(&self, at: Vec3) -> f32 {
        let distances = self
            .0
            .iter()
            .map(|(ball, radius)| at.distance(*ball) - radius);
        distances.fold(f32::MAX, f32::min)
    }

    /// Which way is out.
    fn out(&self, at: Vec3) -> Vec3 {
        let sum: Vec3 = self
            .0
            .iter()
            .map(|(ball, radius)| {
                let away = at - *ball;
                let near = (1.25 - away.length() / radius).max(0.0);
                away.normalize_or_zero() * near
            })
            .sum();
        let whole = (at - Vec3::new(0.0, 4.6, 0.0)).normalize_or(Vec3::Y);
        (sum.normalize_or_zero() + 0.7 * whole).normalize_or(whole)
    }

    fn point(&self, random: &mut Random) -> Vec3 {
        loop {
            let at = random.in_ball() * 5.2 + Vec3::new(0.0, 5.3, 0.0);
            if self.outside(at) < 0.0 {
                return at;
            }
        }
    }
}

struct Node {
    at: Vec3,
    parent: usize,
    children: u32,
    radius: f32,
}

/// Trunk and branches: nodes, each after its parent.
fn grown(crown: &Crown, random: &mut Random) -> Vec<Node> {
    let node = |at, parent| Node {
        at,
        parent,
        children: 0,
        radius: 0.0,
    };
    let mut nodes = vec![node(Vec3::ZERO, 0)];
    let mut lean = Vec3::ZERO;
    while nodes[nodes.len() - 1].at.y < 1.7 {
        lean += random.in_ball() * 0.035;
        let last = nodes.len() - 1;
        nodes.push(node(
            nodes[last].at + (Vec3::Y + lean).normalize() * STEP,
            last,
        ));
    }
    let mut points: Vec<Vec3> = (0..700).map(|_| crown.point(random)).collect();
    for _ in 0..90 {
        let mut pulls = vec![Vec3::ZERO; nodes.len()];
        points.retain(|point| {
            let near = nodes
                .iter()
                .enumerate()
                .map(|(k, node)| (k, node.at.distance_squared(*point)))
                .min_by(|a, b| a.1.total_cmp(&b.1));
            let Some((k, far)) = near else { return false };
            if far < REACHED * REACHED {
                return false;
            }
            if far < PULL * PULL {
                pulls[k] += (*point - nodes[k].at).normalize_or_zero();
            }
            true
        });
        let before = nodes.len();
        for (k, pull) in pulls.into_iter().enumerate() {
            if pull != Vec3::ZERO {
                let heading = nodes[k].at - nodes[nodes[k].parent].at;
                let way = pull.normalize()
                    + 0.6 * heading.normalize_or(Vec3::Y)
                    + random.in_ball() * 0.35;
                nodes.push(node(nodes[k].at + way.normalize() * STEP, k));
            }
        }
        if nodes.len() == before || nodes.len() > 4000 {
            break;
        }
    }
    for k in (1..nodes.len()).rev() {
        let parent = nodes[k].parent;
        nodes[parent].children += 1;
    }
    // Children come after their parents, so that one way back sums all of them.
    let mut sums = vec![0.0_f32; nodes.len()];
    for k in (0..nodes.len()).rev() {
        nodes[k].radius = if nodes[k].children == 0 {
            TWIG
        } else {
            power(sums[k], 1.0 / PIPE)
        };
        if k > 0 {
            sums[nodes[k].parent] += power(nodes[k].radius, PIPE);
        }
    }
    nodes
}

#[expect(
    clippy::disallowed_methods,
    reason = "a tool whose result is committed"
)]
fn power(x: f32, y: f32) -> f32 {
    x.powf(y)
}

/// Wood as tubes: from each fork the thickest child goes on, the others begin at the fork.
fn wood(nodes: &[Node]) -> Model {
    let mut main = vec![usize::MAX; nodes.len()];
    for (k, node) in nodes.iter().enumerate().skip(1) {
        let of = &mut main[node.parent];
        if *of == usize::MAX || nodes[*of].radius < node.radius {
            *of = k;
        }
    }
    let mut model = Model::default();
    for (start, node) in nodes.iter().enumerate() {
        if start > 0 && main[node.parent] == start {
            continue;
        }
        let mut rings = Vec::new();
        if start > 0 {
            // Its first ring is inside of the parent.
            rings.push((
                nodes[node.parent].at,
                node.radius.min(nodes[node.parent].radius),
            ));
        }
        let mut k = start;
        while k != usize::MAX {
            rings.push((nodes[k].at, nodes[k].radius));
            k = main[k];
        }
        if node.radius < 1.3 * TWIG || rings.len() < 3 {
            continue;
        }
        let sides = if node.radius > 0.12 {
            10
        } else if node.radius > 0.04 {
            6
        } else {
            3
        };
        let rings: Vec<Ring> = rings
            .into_iter()
            .map(|(middle, radius)| {
                // Roots: the trunk is wider at its foot.
                let low = (1.0 - middle.y / 0.9).max(0.0);
                let shade =
                    0.55 + 0.45 * (middle.y / 3.0).min(1.0) - 0.3 * (middle.y / 7.0).min(1.0);
                Ring {
                    middle: middle - Vec3::Y * (0.5 * low * low),
                    radius: radius * (1.0 + 1.1 * low * low),
                    colour: BARK * shade,
                }
            })
            .collect();
        model.tube(&rings, sides);
    }
    model
}

fn leaves(nodes: &[Node], crown: &Crown, random: &mut Random) -> Vec<Leaf> {
    let mut leaves = Vec::new();
    // At the twigs, and in the shell of the crown between them, where twigs are too thin to be drawn.
    let mut feet = Vec::new();
    let twigs = nodes
        .iter()
        .filter(|node| node.radius < 1.75 * TWIG && node.at.y > 2.2);
    for node in twigs {
        let count = if node.children == 0 { 3 } else { 1 };
        feet.extend((0..count).map(|_| node.at + random.in_ball() * 0.42));
    }
    while feet.len() < 2100 {
        let at = crown.point(random);
        if crown.outside(at) > -0.55 {
            feet.push(at);
        }
    }
    for foot in feet {
        let out = crown.out(foot);
        let along = (random.direction() + 0.55 * out - 0.25 * Vec3::Y).normalize_or(out);
        let across = along
            .cross(random.direction())
            .normalize_or(along.any_orthonormal_vector());
        let plane = along.cross(across);
        let plane = if plane.dot(out) < 0.0 { -plane } else { plane };
        let length = random.within(0.30, 0.52);
        // Inside and below it is darker: what little light comes there has come through leaves.
        let depth = (1.0 + crown.outside(foot) / 1.15).clamp(0.0, 1.0);
        let sky = 0.72 + 0.28 * out.y;
        let light = (0.30 + 0.70 * depth * depth) * sky;
        let tint = random.unit();
        let hue = Vec3::new(1.0 + 0.30 * (tint - 0.4), 1.0, 1.0 - 0.2 * tint);
        let green = LEAF_LOW.lerp(LEAF_HIGH, 0.25 + 0.6 * random.unit()) * hue * light;
        leaves.push(Leaf {
            foot,
            along: along * length,
            across: across * (0.38 * length),
            normal: (0.45 * plane + out).normalize_or(out),
            colour: [green * 0.82, green * 1.12],
        });
    }
    // In random order: a level takes the first ones.
    for k in (1..leaves.len()).rev() {
        leaves.swap(k, (random.unit() * (k + 1) as f32) as usize);
    }
    leaves
}

/// The tree of a seed.
#[must_use]
pub fn broadleaf(seed: u32) -> Plant {
    let mut random = Random::new(seed);
    let crown = Crown::new(&mut random);
    let nodes = grown(&crown, &mut random);
    Plant {
        solid: wood(&nodes),
        leaves: leaves(&nodes, &crown, &mut random),
        solid_shares: [1.0, 0.22, 0.06, 0.015],
        leaf_shares: [1.0, 0.40, 0.16, 0.065],
    }
}
