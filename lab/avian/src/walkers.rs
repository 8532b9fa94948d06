//! Balls that avian's `MoveAndSlide` moves over a mesh.

use avian3d::prelude::{
    Collider, MoveAndSlide, MoveAndSlideConfig, MoveAndSlideHitResponse, PhysicsPlugins, RigidBody,
    SpatialQueryFilter,
};
use bevy::MinimalPlugins;
use bevy::app::App;
use bevy::ecs::system::SystemState;
use bevy::math::{Quat, Vec3};
use bevy::time::TimeUpdateStrategy;
use bevy::transform::TransformPlugin;
use std::time::Duration;
use thiserror::Error;

/// What balls walk on.
pub struct Ground {
    /// Metres.
    pub vertices: Vec<Vec3>,
    /// Three vertices each.
    pub triangles: Vec<[u32; 3]>,
}

/// Why no ball is moved.
#[derive(Debug, Error)]
pub enum WalkError {
    /// A number that is not finite, or out of its range.
    #[error("{0} is not a number that balls can be moved with")]
    Number(&'static str),
    /// A triangle names a vertex that is not there.
    #[error("a triangle has vertex {0}, which does not exist")]
    Vertex(u32),
    /// Avian makes no collider of the triangles.
    #[error("the triangles make no mesh: {0}")]
    Mesh(String),
    /// Avian's queries did not find the mesh.
    #[error("the mesh is not found by avian's queries")]
    NotFound,
    /// There are more or fewer wishes than balls.
    #[error("there are {wishes} wishes for {balls} balls")]
    Count {
        /// Wishes.
        wishes: usize,
        /// Balls.
        balls: usize,
    },
}

/// Balls over a mesh. They do not meet each other.
pub struct Walkers {
    app: App,
    queries: SystemState<MoveAndSlide<'static, 'static>>,
    ball: Collider,
    config: MoveAndSlideConfig,
    seconds: Duration,
    walkable: f32,
    snap: f32,
    places: Vec<Vec3>,
    stands: Vec<bool>,
}

impl Walkers {
    /// Balls of this radius (metres) at these places, in steps of so many seconds. `walkable` is the cosine of the
    /// steepest slope that is stood on. With a `snap` of 0 it is `MoveAndSlide` alone, as avian has it; else ground so
    /// many metres below a ball that stood still holds it, it does not slip from where it stands, and what is too steep
    /// is a wall to it.
    ///
    /// # Errors
    /// [`WalkError`].
    pub fn new(
        ground: Ground,
        places: Vec<Vec3>,
        radius: f32,
        seconds: Duration,
        walkable: f32,
        snap: f32,
    ) -> Result<Self, WalkError> {
        let numbers = [
            ("radius", radius.is_finite() && radius > 0.0),
            ("seconds", !seconds.is_zero()),
            ("walkable", (0.0..=1.0).contains(&walkable)),
            ("snap", snap.is_finite() && snap >= 0.0),
            ("vertices", ground.vertices.iter().all(|at| at.is_finite())),
            ("places", places.iter().all(|at| at.is_finite())),
        ];
        if let Some((name, _)) = numbers.into_iter().find(|(_, right)| !right) {
            return Err(WalkError::Number(name));
        }
        let count = ground.vertices.len();
        let mut named = ground.triangles.iter().flatten();
        if let Some(vertex) = named.find(|vertex| **vertex as usize >= count) {
            return Err(WalkError::Vertex(*vertex));
        }
        let somewhere = ground
            .triangles
            .first()
            .map(|corners| ground.vertices[corners[0] as usize]);
        let mesh = Collider::try_trimesh(ground.vertices, ground.triangles)
            .map_err(|error| WalkError::Mesh(error.to_string()))?;
        let mut app = app(mesh);
        let mut queries = SystemState::new(app.world_mut());
        let ball = Collider::sphere(radius);
        let mover = get(&mut queries, &app)?;
        let mut found = false;
        // Is the mesh in avian's tree? A ball that touches it has to say so.
        mover.intersections(
            &ball,
            somewhere.unwrap_or_default(),
            Quat::IDENTITY,
            radius,
            &SpatialQueryFilter::default(),
            |_, _, _| {
                found = true;
                false
            },
        );
        if !found {
            return Err(WalkError::NotFound);
        }
        Ok(Self {
            app,
            queries,
            ball,
            config: MoveAndSlideConfig::default(),
            seconds,
            walkable,
            snap,
            stands: vec![false; places.len()],
            places,
        })
    }

    /// Moves each ball by its wish, metres.
    ///
    /// # Errors
    /// [`WalkError::Count`], [`WalkError::Number`]; no ball was moved then.
    pub fn step(&mut self, wishes: &[Vec3]) -> Result<(), WalkError> {
        if wishes.len() != self.places.len() {
            return Err(WalkError::Count {
                wishes: wishes.len(),
                balls: self.places.len(),
            });
        }
        if !wishes.iter().all(|wish| wish.is_finite()) {
            return Err(WalkError::Number("a wish"));
        }
        let mover = get(&mut self.queries, &self.app)?;
        let filter = SpatialQueryFilter::default();
        let part = 1.0 / self.seconds.as_secs_f32();
        let held = self.snap > 0.0;
        let balls = self.places.iter_mut().zip(&mut self.stands);
        for ((place, stands), wish) in balls.zip(wishes) {
            let (stood, mut touches) = (*stands, false);
            let slid = mover.move_and_slide(
                &self.ball,
                *place,
                Quat::IDENTITY,
                *wish * part,
                self.seconds,
                &self.config,
                &filter,
                |hit| {
                    let walkable = hit.normal.y >= self.walkable;
                    touches |= walkable;
                    if held && walkable {
                        // What presses it onto the ground does not move it down the slope.
                        hit.velocity.y = hit.velocity.y.max(0.0);
                    } else if held && stood && hit.normal.y > 0.0 {
                        let level = hit.normal.as_vec3().with_y(0.0);
                        *hit.normal = level.try_into().unwrap_or(*hit.normal);
                    }
                    MoveAndSlideHitResponse::Accept
                },
            );
            *place = slid.position;
            if held && stood && !touches {
                let below = mover.cast_move(
                    &self.ball,
                    *place,
                    Quat::IDENTITY,
                    Vec3::NEG_Y * self.snap,
                    self.config.skin_width,
                    &filter,
                );
                if let Some(ground) = below.filter(|hit| hit.normal1.y >= self.walkable) {
                    place.y -= ground.distance;
                    touches = true;
                }
            }
            *stands = touches;
        }
        Ok(())
    }

    /// Where the centers are, metres.
    pub fn places(&self) -> &[Vec3] {
        &self.places
    }

    /// Which of them touch ground that is not too steep since the last step.
    pub fn stands(&self) -> &[bool] {
        &self.stands
    }
}

/// An app with the mesh in it, after some steps of physics: then avian's tree of colliders has it.
fn app(mesh: Collider) -> App {
    // Two steps of physics, which are of 1/64 s.
    let update = Duration::from_secs_f64(1.0 / 32.0);
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, PhysicsPlugins::default()))
        .insert_resource(TimeUpdateStrategy::ManualDuration(update));
    app.finish();
    app.cleanup();
    app.world_mut().spawn((RigidBody::Static, mesh));
    // The first takes no time.
    for _ in 0..3 {
        app.update();
    }
    app
}

fn get<'a>(
    queries: &'a mut SystemState<MoveAndSlide<'static, 'static>>,
    app: &'a App,
) -> Result<MoveAndSlide<'a, 'a>, WalkError> {
    queries.get(app.world()).map_err(|_| WalkError::NotFound)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Length of a step.
    const SECONDS: f32 = 1.0 / 60.0;

    /// What gravity adds to the wish of a ball that stands.
    const DOWN: f32 = 9.81 * SECONDS * SECONDS;

    /// 20 m by 20 m of cells of 1 m, with heights by the place along X.
    fn ground(height: impl Fn(f32) -> f32) -> Ground {
        let vertices = (0..=20).flat_map(|x| (0..=20).map(move |z| (x as f32 - 10.0, z as f32)));
        let vertices = vertices
            .map(|(x, z)| Vec3::new(x, height(x), z - 10.0))
            .collect();
        let triangles = (0..20)
            .flat_map(|x| (0..20).map(move |z| x * 21 + z))
            .flat_map(|nw: u32| [[nw, nw + 1, nw + 21], [nw + 1, nw + 22, nw + 21]])
            .collect();
        Ground {
            vertices,
            triangles,
        }
    }

    fn walkers(ground: Ground, place: Vec3, snap: f32) -> Walkers {
        let seconds = Duration::from_secs_f32(SECONDS);
        Walkers::new(ground, vec![place], 0.4, seconds, 0.642_787_6, snap).unwrap()
    }

    /// Falls onto the ground and comes to rest.
    fn rest(walkers: &mut Walkers) {
        for _ in 0..20 {
            walkers.step(&[Vec3::NEG_Y * 0.02]).unwrap();
        }
        assert_eq!(walkers.stands(), [true]);
    }

    #[test]
    fn a_ball_on_a_flat_floor_stays_on_it() {
        for snap in [0.0, 0.3] {
            let start = Vec3::new(-8.0, 0.5, -4.3);
            let mut walkers = walkers(ground(|_| 0.0), start, snap);
            rest(&mut walkers);
            // Over the seams of some twenty triangles, not along a side of any.
            for step in 0..220 {
                walkers.step(&[Vec3::new(0.07, -DOWN, 0.02)]).unwrap();
                let gap = walkers.places()[0].y - 0.4;
                // It keeps the skin of 1 cm, and depenetration leaves at most 1e-4 of it.
                assert!((gap - 0.01).abs() <= 2e-4, "{snap} {step}: {gap}");
                assert_eq!(walkers.stands(), [true], "{snap} {step}");
            }
            let way = walkers.places()[0] - start;
            assert!(
                (way.x - 15.4).abs() < 0.01 && (way.z - 4.4).abs() < 0.01,
                "{way}"
            );
            // The counterpart: beyond the border there is no floor.
            for _ in 0..60 {
                walkers.step(&[Vec3::new(0.07, -0.05, 0.0)]).unwrap();
            }
            assert_eq!(walkers.stands(), [false]);
            assert!(walkers.places()[0].y < 0.0);
        }
    }

    #[test]
    fn who_is_held_stands_on_a_slope_and_stays_on_it_downhill() {
        // 30°, down along X.
        let slope = |x: f32| -x * 0.577_35;
        let start = Vec3::new(-5.0, slope(-5.0) + 0.6, 0.3);
        let [alone, held] = [0.0, 0.3].map(|snap| {
            let mut walkers = walkers(ground(slope), start, snap);
            rest(&mut walkers);
            let before = walkers.places()[0];
            for _ in 0..60 {
                walkers.step(&[Vec3::NEG_Y * DOWN]).unwrap();
            }
            let slipped = walkers.places()[0].distance(before);
            let mut flown = 0;
            for _ in 0..60 {
                walkers.step(&[Vec3::new(0.07, -DOWN, 0.0)]).unwrap();
                flown += u32::from(!walkers.stands()[0]);
            }
            (slipped, flown)
        });
        assert!(held.0 < 1e-3 && held.1 == 0, "{held:?}");
        // By itself it does neither.
        assert!(alone.0 > 0.02 && alone.1 > 30, "{alone:?}");
    }

    #[test]
    fn who_is_held_does_not_climb_what_is_too_steep() {
        // 60° from the origin on.
        let bank = |x: f32| x.max(0.0) * 1.732;
        let start = Vec3::new(-2.0, 0.5, 0.3);
        let [alone, held] = [0.0, 0.3].map(|snap| {
            let mut walkers = walkers(ground(bank), start, snap);
            rest(&mut walkers);
            let steps = (0..60).map(|_| {
                walkers.step(&[Vec3::new(0.07, -DOWN, 0.0)]).unwrap();
                walkers.places()[0].y
            });
            steps.fold(0.0, f32::max)
        });
        assert!(held < 0.45 && alone > 0.6, "{alone} {held}");
    }
}
