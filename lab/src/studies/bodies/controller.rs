//! Rapier's character controller over a mesh.

use super::messages::ProgramError;
use super::method::{RADIUS, SECONDS, Walkers, timed};
use super::terrain::Terrain;
use bevy::math::{DVec3, Vec3};
use bevy_rapier3d::rapier::control::{
    CharacterAutostep, CharacterLength, KinematicCharacterController,
};
use bevy_rapier3d::rapier::parry::query::DefaultQueryDispatcher;
use bevy_rapier3d::rapier::prelude::{
    Ball, CCDSolver, ColliderBuilder, ColliderSet, DefaultBroadPhase, ImpulseJointSet,
    IntegrationParameters, IslandManager, MultibodyJointSet, NarrowPhase, PhysicsPipeline, Pose,
    QueryFilter, RigidBodySet,
};

/// Balls that it moves.
pub struct Controller {
    broad_phase: DefaultBroadPhase,
    bodies: RigidBodySet,
    colliders: ColliderSet,
    controller: KinematicCharacterController,
    shape: Ball,
    places: Vec<Vec3>,
}

impl Controller {
    /// Over a terrain; `climbs`: with steps of 0.35 m, ground held within 0.3 m and slopes to 50° as ours has.
    pub fn new(terrain: &Terrain, places: &[DVec3], climbs: bool) -> Self {
        let mut colliders = ColliderSet::new();
        let mesh = ColliderBuilder::trimesh(terrain.vertices.clone(), terrain.triangles.clone());
        colliders.insert(mesh.expect("terrains have triangles"));
        let (mut bodies, mut broad_phase) = (RigidBodySet::new(), DefaultBroadPhase::new());
        // One step, after which its tree knows the mesh.
        PhysicsPipeline::new().step(
            Vec3::ZERO,
            &IntegrationParameters::default(),
            &mut IslandManager::new(),
            &mut broad_phase,
            &mut NarrowPhase::new(),
            &mut bodies,
            &mut colliders,
            &mut ImpulseJointSet::new(),
            &mut MultibodyJointSet::new(),
            &mut CCDSolver::new(),
            &(),
            &(),
        );
        let mut controller = KinematicCharacterController::default();
        if climbs {
            controller.autostep = Some(CharacterAutostep {
                max_height: CharacterLength::Absolute(0.35),
                min_width: CharacterLength::Absolute(0.1),
                include_dynamic_bodies: false,
            });
            controller.snap_to_ground = Some(CharacterLength::Absolute(0.3));
            controller.max_slope_climb_angle = 50.0_f32.to_radians();
            controller.min_slope_slide_angle = 50.0_f32.to_radians();
        }
        Self {
            broad_phase,
            bodies,
            colliders,
            controller,
            shape: Ball::new(RADIUS as f32),
            places: places.iter().map(|place| place.as_vec3()).collect(),
        }
    }

    /// One step of one ball, and whether it stands then.
    fn advance(&mut self, ball: usize, wish: DVec3) -> bool {
        let queries = self.broad_phase.as_query_pipeline(
            &DefaultQueryDispatcher,
            &self.bodies,
            &self.colliders,
            QueryFilter::default(),
        );
        let moved = self.controller.move_shape(
            SECONDS as f32,
            &queries,
            &self.shape,
            &Pose::from_translation(self.places[ball]),
            wish.as_vec3(),
            |_| {},
        );
        self.places[ball] += moved.translation;
        moved.grounded
    }
}

impl Walkers for Controller {
    fn step(&mut self, wishes: &[DVec3], stands: &mut [bool]) -> Result<f64, ProgramError> {
        Ok(timed(wishes, stands, |ball, wish| self.advance(ball, wish)))
    }

    fn center(&self, ball: usize) -> DVec3 {
        self.places[ball].as_dvec3()
    }
}
