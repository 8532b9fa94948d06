//! Collision: volumes, trees of triangles, watertight rays, swept ellipsoids.

pub mod geometry;
#[cfg(feature = "terrain")]
pub mod ground;
pub mod mesh;
pub mod motion;
pub mod plugin;
#[cfg(feature = "rapier")]
pub mod rapier;
pub mod roots;
pub mod sweep;
pub mod tree;
pub mod volume;

pub use geometry::Feature;
pub use mesh::{MeshError, TriangleMesh};
pub use motion::{
    Body, MoveContact, MoveError, MoveOutcome, MoveSettings, Mover, Pose, Scratch, World, advance,
    advance_all,
};
pub use plugin::{
    BetweenSteps, Blocker, CharacterBody, Collider, CollisionCounters, CollisionPlugin,
    CollisionSystems, MeetsMovers, MoveState, MoveWish, Trigger, TriggerKind, TriggerMessage,
};
pub use sweep::{Contact, SweepError, sweep};
pub use tree::{Nearest, RayHit, TreeKind, TreeSettings, TriangleTree};
pub use volume::{Aabb, Capsule, Ellipsoid, FitError, Ray, RayError, Sphere, Volume};
