//! The property: what comes out of a file is no farther from what the file means than the report says.
//!
//! A clip is held at the six points 3 cm around every node, which is what the report's metres are of, and at every vertex,
//! at random times: spread over the clip, on the file's keys and between them, between the keys of the result. Beyond the
//! stated error three things are allowed, and nothing else:
//!
//! - [`GRAIN`] of how far things reach, for places, matrices and vertices at rest are kept in 32 bits;
//! - what the reader rounds ([`Reading::ROUNDED`]), computed for the pose at hand;
//! - a jump's own instant: glTF keeps times in 32 bits, so that a jump is two keys a few units of these apart.

use crate::file::document;
use crate::looks;
use crate::play::{Glb, Posed};
use crate::random::Random;
use crate::scene::{Beyond, Curve, Scene, Shows, Stack, TICKS, Target, Way};
use crate::truth::{Pose, Reading, Truth, seconds};
use dolomite_fbx::{
    Conversion, Effort, FbxError, Limits, Options, Origin, Report, Weights, convert,
};
use glam::{DMat3, DVec3};
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// What 32 bits lose of a place, a share of how far things reach: 16 units in the last place, for the chain of some eight
/// transforms between a vertex and the world.
pub const GRAIN: f64 = 1e-6;

/// Metres around a node that its turning is seen at.
const SHELL: f64 = 0.03;

/// Why a file does not hold.
#[derive(Debug, Clone, PartialEq)]
pub struct Failure {
    /// A fixed word.
    pub kind: &'static str,
    /// What is wrong, with numbers.
    pub detail: String,
}

/// What was seen of a file that holds.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Seen {
    /// Poses that were held.
    pub poses: usize,
    /// The conversion was refused with this reason, which is its limits'.
    pub refused: Option<String>,
    /// The largest true error over what is stated and allowed; at most 1.
    pub worst: f64,
}

fn failure<T>(kind: &'static str, detail: impl Into<String>) -> Result<T, Failure> {
    let detail = detail.into();
    Err(Failure { kind, detail })
}

/// A picture of one dot, for materials that name one.
pub const DOT: &[u8] = &[
    0x89, b'P', b'N', b'G', 0x0d, 0x0a, 0x1a, 0x0a, 0, 0, 0, 13, b'I', b'H', b'D', b'R', 0, 0, 0,
    1, 0, 0, 0, 1, 8, 2, 0, 0, 0, 0x90, 0x77, 0x53, 0xde, 0, 0, 0, 12, b'I', b'D', b'A', b'T', 8,
    0xd7, 0x63, 0xf8, 0xcf, 0xc0, 0, 0, 3, 1, 1, 0, 0x18, 0xdd, 0x8d, 0xb0, 0, 0, 0, 0, b'I', b'E',
    b'N', b'D', 0xae, 0x42, 0x60, 0x82,
];

/// Converts the file of a scene as the scene asks.
///
/// # Errors
/// A panic, or what the conversion refuses.
pub fn converted(scene: &Scene) -> Result<Result<Conversion, FbxError>, Failure> {
    let bytes = document(scene);
    let origin = Origin {
        name: "random.fbx".into(),
        files: BTreeMap::from([("dot.png".to_owned(), DOT.to_vec())]),
        ..Origin::default()
    };
    let asked = &scene.asked;
    let options = Options {
        max_error: asked.max_error,
        within_frames: asked.within_frames,
        weights: if asked.eight {
            Weights::Eight
        } else {
            Weights::Four
        },
        effort: if asked.thorough {
            Effort::Thorough
        } else {
            Effort::Quick
        },
        threads: 1,
        // As by default, but that a thorough search has no more than all else: it would be half of a long search's time.
        limits: Some(Limits::of_contents(&bytes)),
        ..Options::default()
    };
    match catch_unwind(AssertUnwindSafe(|| convert(&bytes, &origin, &options))) {
        Ok(made) => Ok(made),
        Err(_) => failure("panic", "the conversion panicked"),
    }
}

/// Holds the file of a scene.
///
/// # Errors
/// The first thing that does not hold.
pub fn hold(scene: &Scene, seed: u64) -> Result<Seen, Failure> {
    let made = match converted(scene)? {
        Ok(made) => made,
        // A file beyond the limits is refused, aloud; so much is promised.
        Err(error @ (FbxError::Memory { .. } | FbxError::Work { .. })) => {
            return Ok(Seen {
                refused: Some(error.to_string()),
                ..Seen::default()
            });
        }
        Err(error) => return failure("refused", error.to_string()),
    };
    let glb = match catch_unwind(AssertUnwindSafe(|| made.to_glb())) {
        Ok(Ok(glb)) => glb,
        Ok(Err(error)) => return failure("refused", error.to_string()),
        Err(_) => return failure("panic", "writing panicked"),
    };
    hold_result(scene, &made.report, &made.sources(), &glb, seed)
}

/// Holds a result: the bytes of a .glb, what the report says, and which vertices its vertices came from.
///
/// # Errors
/// The first thing that does not hold.
pub fn hold_result(
    scene: &Scene,
    report: &Report,
    sources: &BTreeMap<usize, (u32, Vec<u32>)>,
    glb: &[u8],
    seed: u64,
) -> Result<Seen, Failure> {
    let glb = match Glb::read(glb) {
        Ok(glb) => glb,
        Err(reason) => return failure("glb", reason),
    };
    let held = Held {
        pairs: pairs(scene, &glb, sources)?,
        truth: Truth::of(scene, Reading::EXACT),
        rounded: Truth::of(scene, Reading::ROUNDED),
        scene,
        report,
        glb: &glb,
    };
    let mut seen = Seen::default();
    held.pose(None, 0.0, 0.0, 0.0, &mut seen)?;
    let clips = glb.clips();
    if clips.len() != scene.stacks.len() || report.clips.len() != clips.len() {
        return failure(
            "clips",
            format!("{} clips of {} stacks", clips.len(), scene.stacks.len()),
        );
    }
    let mut random = Random::new(seed ^ 0x7469_6d65);
    for (number, stack) in scene.stacks.iter().enumerate() {
        let (begin, end) = (seconds(stack.start), seconds(stack.stop));
        let length = end - begin;
        if clips[number].0 != stack.name || report.clips[number].name != stack.name {
            return failure(
                "clips",
                format!("{} is called {}", stack.name, clips[number].0),
            );
        }
        let off = (clips[number].1 - length)
            .abs()
            .max((report.clips[number].seconds - length).abs());
        // A step at the very end may stand that much before it.
        if off > length * 1e-6 + 2e-6 {
            let said = report.clips[number].seconds;
            return failure(
                "length",
                format!(
                    "{} lasts {length} s; its last key is at {} s, {said} s stated",
                    stack.name, clips[number].1
                ),
            );
        }
        let clip = report.clips[number].error;
        let skin = report.error();
        if !(clip.is_finite() && clip >= 0.0 && skin >= clip) {
            return failure("report", format!("an error of {clip} m, of all {skin} m"));
        }
        let jumps = jumps(stack, begin);
        for time in times(stack, &glb.key_times(number), length, &mut random) {
            let near = 2e-6 + 2.0 * f64::from(f32::EPSILON) * time.abs();
            if jumps.iter().all(|jump| (jump - time).abs() > near) {
                held.pose(Some(number), begin, time, clip, &mut seen)?;
            }
        }
    }
    looks::hold(scene, report, &glb)?;
    Ok(seen)
}

/// A node of the file, and where it is in the result.
struct Pair {
    node: usize,
    /// The joint that has its axes.
    joint: usize,
    /// The node that shows its mesh, and of which of the mesh's vertices.
    shows: Option<(usize, Vec<usize>)>,
}

fn pairs(
    scene: &Scene,
    glb: &Glb,
    sources: &BTreeMap<usize, (u32, Vec<u32>)>,
) -> Result<Vec<Pair>, Failure> {
    let mut out = Vec::new();
    for (number, node) in scene.nodes.iter().enumerate() {
        // Helpers stand between a node and what it shows.
        let own = |joint: usize| {
            let named = |joint: usize| {
                scene
                    .nodes
                    .iter()
                    .any(|node| node.name == glb.nodes[joint].name)
            };
            let mut above = Some(joint);
            while let Some(at) = above.filter(|&at| !named(at)) {
                above = glb.nodes[at].parent;
            }
            let helper = glb.nodes[joint]
                .name
                .strip_prefix(&node.name)
                .is_some_and(|rest| rest.starts_with('.'));
            helper || above.is_some_and(|at| glb.nodes[at].name == node.name)
        };
        let called = |name: &str| (0..glb.nodes.len()).find(|&joint| glb.nodes[joint].name == name);
        let shows = match node.shows {
            Shows::Mesh(mesh) => {
                let Some(shown) = (0..glb.nodes.len())
                    .find(|&joint| own(joint) && glb.nodes[joint].mesh.is_some())
                else {
                    return failure(
                        "missing",
                        format!("nothing shows the mesh of {}", node.name),
                    );
                };
                let source = glb.nodes[shown].mesh.and_then(|mesh| sources.get(&mesh));
                match source {
                    Some((of, vertices)) if *of as usize == mesh => {
                        Some((shown, vertices.iter().map(|&v| v as usize).collect()))
                    }
                    _ => return failure("missing", format!("{} shows another mesh", node.name)),
                }
            }
            _ => None,
        };
        // A scale that children do not inherit stands in a node of its own.
        match called(&format!("{}.scale", node.name)).or_else(|| called(&node.name)) {
            Some(joint) => out.push(Pair {
                node: number,
                joint,
                shows,
            }),
            None => return failure("missing", format!("there is no node {}", node.name)),
        }
    }
    Ok(out)
}

struct Held<'a> {
    scene: &'a Scene,
    report: &'a Report,
    glb: &'a Glb,
    pairs: Vec<Pair>,
    truth: Truth<'a>,
    rounded: Truth<'a>,
}

impl Held<'_> {
    /// One pose, `time` seconds after the clip's begin.
    fn pose(
        &self,
        clip: Option<usize>,
        begin: f64,
        time: f64,
        stated: f64,
        seen: &mut Seen,
    ) -> Result<(), Failure> {
        let posed = self.glb.at(clip, time);
        let pose = self.truth.at(clip, begin + time);
        let mut lost: Option<Pose> = None;
        let grain = GRAIN * reach(self.scene, &pose);
        let mut rounded = || {
            lost.get_or_insert_with(|| self.rounded.at(clip, begin + time))
                .clone()
        };
        seen.poses += 1;
        for pair in &self.pairs {
            let node = &self.scene.nodes[pair.node];
            if self.unseen(pair.node, clip, begin + time) {
                continue;
            }
            let points = |pose: &Pose| around(&pose.nodes[pair.node], &pose.nodes[pair.node].1);
            // Cameras and lights look along other axes in glTF.
            let axes = !matches!(node.shows, Shows::Camera(_) | Shows::Light(_));
            let (wanted, made) = match axes {
                true => (points(&pose), self.played(pair, &posed, &pose)),
                false => (
                    vec![pose.nodes[pair.node].0],
                    vec![posed.worlds[pair.joint].w_axis.truncate()],
                ),
            };
            let off = farthest(&wanted, &made);
            self.bound(off, stated + grain, seen, || {
                farthest(&wanted, &points_of(axes, &rounded(), pair, &pose))
            })
            .or_else(|(off, allowed)| {
                self.report_far("node", &node.name, clip, time, off, allowed, stated)
            })?;
            let Some((shown, vertices)) = &pair.shows else {
                continue;
            };
            let Some((_, truth)) = pose.shapes.iter().find(|shape| shape.0 == pair.node) else {
                continue;
            };
            let made = self.glb.points(*shown, &posed);
            let wanted: Vec<DVec3> = vertices.iter().map(|&v| truth[v]).collect();
            if made.len() != wanted.len() {
                return failure(
                    "missing",
                    format!(
                        "{} has {} vertices of {}",
                        node.name,
                        made.len(),
                        wanted.len()
                    ),
                );
            }
            // Refitted weights are off by themselves.
            let stated = stated + self.report.weight_error;
            let off = farthest(&wanted, &made);
            let lost = || {
                let shapes = rounded().shapes;
                let other = shapes.iter().find(|shape| shape.0 == pair.node);
                other.map_or(0.0, |other| {
                    let other: Vec<DVec3> = vertices.iter().map(|&v| other.1[v]).collect();
                    farthest(&wanted, &other)
                })
            };
            self.bound(off, stated + grain, seen, lost)
                .or_else(|(off, allowed)| {
                    self.report_far("vertex", &node.name, clip, time, off, allowed, stated)
                })?;
        }
        Ok(())
    }

    /// `lost` is what reading rounds off, which is asked for where it matters.
    fn bound(
        &self,
        off: f64,
        allowed: f64,
        seen: &mut Seen,
        lost: impl FnOnce() -> f64,
    ) -> Result<(), (f64, f64)> {
        let allowed = match off > allowed {
            true => allowed + 1.01 * lost(),
            false => allowed,
        };
        seen.worst = seen.worst.max(off / allowed);
        // What is no number is too far.
        match off <= allowed {
            true => Ok(()),
            false => Err((off, allowed)),
        }
    }

    #[expect(clippy::too_many_arguments, reason = "what a message says")]
    fn report_far(
        &self,
        kind: &'static str,
        name: &str,
        clip: Option<usize>,
        time: f64,
        off: f64,
        allowed: f64,
        stated: f64,
    ) -> Result<(), Failure> {
        let (kind, place) = match (clip, kind) {
            (None, _) => ("rest", "at rest".to_owned()),
            (Some(clip), _) => (
                kind,
                format!("{time} s into {}", self.scene.stacks[clip].name),
            ),
        };
        failure(
            kind,
            format!(
                "{name} is off by {off:.3e} m {place}; {stated:.3e} m stated, {allowed:.3e} m allowed"
            ),
        )
    }

    fn played(&self, pair: &Pair, posed: &Posed, pose: &Pose) -> Vec<DVec3> {
        let world = posed.worlds[pair.joint];
        let mut axes = DMat3::from_mat4(world);
        if self.truth.space().mirrored() {
            // What a left hand's axes are mirrored to: every node is, along its X.
            axes.x_axis = -axes.x_axis;
        }
        around(&(world.w_axis.truncate(), axes), &pose.nodes[pair.node].1)
    }

    /// A node that is not visible may be anywhere.
    fn unseen(&self, node: usize, clip: Option<usize>, time: f64) -> bool {
        let Some(clip) = clip else { return false };
        let mut above = Some(node);
        while let Some(at) = above {
            let target = Target::Visibility(at);
            let keyed = self.scene.stacks[clip]
                .layers
                .iter()
                .any(|l| l.tracks.iter().any(|t| t.target == target));
            if keyed && self.truth.number(clip, target, 1.0, time) < 1.0 {
                return true;
            }
            above = self.scene.nodes[at].parent;
        }
        false
    }
}

fn points_of(axes: bool, rounded: &Pose, pair: &Pair, pose: &Pose) -> Vec<DVec3> {
    match axes {
        true => around(&rounded.nodes[pair.node], &pose.nodes[pair.node].1),
        false => vec![rounded.nodes[pair.node].0],
    }
}

/// Six points around a place, on its axes, [`SHELL`] away where the axes are as long as `true_axes`.
fn around((place, axes): &(DVec3, DMat3), true_axes: &DMat3) -> Vec<DVec3> {
    let mut out = Vec::with_capacity(6);
    for axis in 0..3 {
        let by = axes.col(axis) * (SHELL / true_axes.col(axis).length().max(1e-3));
        out.extend([*place + by, *place - by]);
    }
    out
}

pub(crate) fn farthest(a: &[DVec3], b: &[DVec3]) -> f64 {
    let apart = a.iter().zip(b).map(|(a, b)| a.distance(*b));
    // `max` would pass over what is no number.
    apart.fold(0.0, |most, x| if x <= most { most } else { x })
}

/// How far things are from the origin by way of their chains, metres.
pub(crate) fn reach(scene: &Scene, pose: &Pose) -> f64 {
    let mut far = vec![0.0_f64; scene.nodes.len()];
    for (number, node) in scene.nodes.iter().enumerate() {
        let above = node.parent.map_or((0.0, DVec3::ZERO), |parent| {
            (far[parent], pose.nodes[parent].0)
        });
        far[number] = above.0 + above.1.distance(pose.nodes[number].0);
    }
    let most = far.iter().copied().fold(0.0, f64::max);
    let shapes = pose
        .shapes
        .iter()
        .flat_map(|(node, points)| points.iter().map(|p| p.distance(pose.nodes[*node].0)));
    most + shapes.fold(SHELL, f64::max)
}

/// When values jump, seconds from the clip's begin.
fn jumps(stack: &Stack, begin: f64) -> Vec<f64> {
    let mut out = Vec::new();
    for curve in stack.heard().into_iter().flat_map(|layer| layer.curves()) {
        let steps = |way: &Way| matches!(way, Way::Constant | Way::ConstantNext);
        let mut own: Vec<i64> = Vec::new();
        for pair in curve.keys.windows(2) {
            if steps(&pair[0].way) {
                own.extend([pair[0].time, pair[1].time]);
            }
        }
        out.extend(own.iter().map(|&time| seconds(time) - begin));
        repeated(curve, &own, [stack.start, stack.stop], |time| {
            out.push(seconds(time) - begin);
        });
    }
    out.sort_by(f64::total_cmp);
    out.dedup();
    out
}

/// Where `own` times of a curve and its seams come again beyond its keys, within a clip.
fn repeated(curve: &Curve, own: &[i64], clip: [i64; 2], mut say: impl FnMut(i64)) {
    let [first, last] = curve.span();
    let length = last - first;
    for (side, beyond) in curve.beyond.iter().enumerate() {
        let (count, back) = match *beyond {
            Beyond::Again(count) | Beyond::Climbs(count) => (count, false),
            Beyond::Back(count) => (count, true),
            Beyond::Stays | Beyond::Line => continue,
        };
        let past = if side == 0 {
            first - clip[0]
        } else {
            clip[1] - last
        };
        if length <= 0 || past <= 0 {
            continue;
        }
        let most = past / length + 1;
        let most = if count < 0 {
            most
        } else {
            most.min(count.into())
        };
        for number in 1..=most {
            let shift = if side == 0 { -number } else { number } * length;
            let times = own.iter().copied().chain([first, last]);
            times.for_each(|time| {
                say(shift
                    + if back && number % 2 == 1 {
                        first + last - time
                    } else {
                        time
                    });
            });
        }
    }
}

/// Times to look at, seconds from the clip's begin.
fn times(stack: &Stack, made: &[f64], length: f64, random: &mut Random) -> Vec<f64> {
    let mut keys: Vec<i64> = stack
        .heard()
        .into_iter()
        .flat_map(|layer| layer.curves())
        .flat_map(|curve: &Curve| curve.keys.iter().map(|key| key.time))
        .chain([stack.start, stack.stop])
        .filter(|&time| time >= stack.start && time <= stack.stop)
        .collect();
    keys.sort_unstable();
    keys.dedup();
    let keys: Vec<f64> = keys
        .iter()
        .map(|&key| (key - stack.start) as f64 / TICKS as f64)
        .collect();
    let mut out: Vec<f64> = (0..40).map(|_| random.unit() * length).collect();
    for among in [&keys[..], made] {
        let gaps = among.len().saturating_sub(1);
        for i in 0..gaps.min(40) {
            let gap = if gaps > 40 { random.below(gaps) } else { i };
            let (from, to) = (among[gap], among[gap + 1]);
            out.extend([from, f64::midpoint(from, to), random.between(from, to)]);
        }
    }
    out.push(length);
    out.retain(|time| (0.0..=length).contains(time));
    out
}
