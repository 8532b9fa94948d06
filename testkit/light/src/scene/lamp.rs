//! Lights, as Bevy's components have them.

use glam::DVec3;

/// A light without extent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lamp {
    /// Linear colour, a factor a channel.
    pub colour: DVec3,
    /// Illuminance in lux of a directional light; luminous power in lumens of a point or spot light, which is 4π times
    /// the intensity in candela for both (Bevy 0.19 does not make a spot light brighter as its cone gets narrower).
    pub power: f64,
    /// Whether objects block it.
    pub shadows: bool,
    /// Where it shines from.
    pub kind: LampKind,
}

/// Kinds of lights.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LampKind {
    /// From infinitely far away.
    Directional {
        /// The way that the light travels; any length but 0.
        direction: DVec3,
    },
    /// From a point to all sides.
    Point {
        /// Metres.
        position: DVec3,
        /// There is no light at this distance and beyond, in metres; it may be infinite.
        range: f64,
    },
    /// From a point into a cone.
    Spot {
        /// Metres.
        position: DVec3,
        /// There is no light at this distance and beyond, in metres; it may be infinite.
        range: f64,
        /// Axis of the cone, the way that the light travels; any length but 0.
        direction: DVec3,
        /// Angle from the axis within which the light is full, in radians.
        inner: f64,
        /// Angle from the axis at which it has become 0, in radians, below π/2.
        outer: f64,
    },
}

/// Light from everywhere.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Ambient {
    /// Linear colour.
    pub colour: DVec3,
    /// Luminance in cd/m².
    pub brightness: f64,
}

impl Lamp {
    /// A white light that casts shadows.
    pub fn new(power: f64, kind: LampKind) -> Self {
        Self {
            colour: DVec3::ONE,
            power,
            shadows: true,
            kind,
        }
    }

    /// Moves it; a directional light is everywhere.
    pub fn shift(&mut self, by: DVec3) {
        match &mut self.kind {
            LampKind::Directional { .. } => {}
            LampKind::Point { position, .. } | LampKind::Spot { position, .. } => *position += by,
        }
    }

    /// Where it is, if it is somewhere.
    pub fn position(&self) -> Option<DVec3> {
        match self.kind {
            LampKind::Directional { .. } => None,
            LampKind::Point { position, .. } | LampKind::Spot { position, .. } => Some(position),
        }
    }
}
