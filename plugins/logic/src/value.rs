//! What can be queried, set, and sent with an action.

use crate::names::Key;
use bevy::ecs::entity::Entity;
use bevy::math::Vec3;
use thiserror::Error;

/// One value of one kind.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Value {
    /// Nothing: an action without a parameter. Cannot be set.
    #[default]
    None,
    /// Yes or no.
    Bool(bool),
    /// A whole number.
    Int(i32),
    /// A number, always finite where it is set.
    Float(f32),
    /// A place or a direction, always finite where it is set.
    Vec3(Vec3),
    /// An entity, which may be gone by now.
    Entity(Entity),
    /// A name.
    Key(Key),
}

/// What a value is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// Nothing.
    None,
    /// Yes or no.
    Bool,
    /// A whole number.
    Int,
    /// A number.
    Float,
    /// A place or a direction.
    Vec3,
    /// An entity.
    Entity,
    /// A name.
    Key,
}

/// A value that cannot be set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum ValueError {
    /// NaN or infinite.
    #[error("a number that is not finite cannot be set")]
    NotFinite,
    /// Another kind than before.
    #[error("a {given:?} was given for a value that is a {has:?}")]
    Kind {
        /// What it has been since it was set first.
        has: Kind,
        /// What was given.
        given: Kind,
    },
    /// The entity has no values, or there is none.
    #[error("the entity has no values")]
    NoValues,
}

impl Value {
    /// What it is.
    #[inline]
    #[must_use]
    pub const fn kind(&self) -> Kind {
        match self {
            Self::None => Kind::None,
            Self::Bool(_) => Kind::Bool,
            Self::Int(_) => Kind::Int,
            Self::Float(_) => Kind::Float,
            Self::Vec3(_) => Kind::Vec3,
            Self::Entity(_) => Kind::Entity,
            Self::Key(_) => Kind::Key,
        }
    }

    /// Whether each number in it is finite.
    #[inline]
    #[must_use]
    pub fn is_finite(&self) -> bool {
        match self {
            Self::Float(x) => x.is_finite(),
            Self::Vec3(v) => v.is_finite(),
            _ => true,
        }
    }

    /// As a number: yes is 1 and no is 0, whole numbers are rounded to f32, a vector is its length, an entity or name
    /// is 1 because it is there.
    #[inline]
    #[must_use]
    pub fn number(&self) -> f32 {
        match *self {
            Self::None => 0.0,
            Self::Bool(yes) => f32::from(u8::from(yes)),
            Self::Int(n) => n as f32,
            Self::Float(x) => x,
            Self::Vec3(v) => v.length(),
            Self::Entity(_) | Self::Key(_) => 1.0,
        }
    }

    /// Words for a hash of the state: kind, then the bits.
    #[must_use]
    pub fn bits(&self) -> [u32; 4] {
        let kind = self.kind() as u32;
        match *self {
            Self::None => [kind, 0, 0, 0],
            Self::Bool(yes) => [kind, u32::from(yes), 0, 0],
            Self::Int(n) => [kind, n as u32, 0, 0],
            Self::Float(x) => [kind, x.to_bits(), 0, 0],
            Self::Vec3(v) => [kind, v.x.to_bits(), v.y.to_bits(), v.z.to_bits()],
            Self::Entity(entity) => {
                let bits = entity.to_bits();
                [kind, bits as u32, (bits >> 32) as u32, 0]
            }
            Self::Key(key) => [kind, key.number(), 0, 0],
        }
    }
}

/// A type that a value may be read as.
pub trait Typed: Copy {
    /// `None` of another kind.
    fn read(value: Value) -> Option<Self>;
}

macro_rules! typed {
    ($($type:ty, $kind:ident;)*) => {
        $(impl Typed for $type {
            #[inline]
            fn read(value: Value) -> Option<Self> {
                match value {
                    Value::$kind(inner) => Some(inner),
                    _ => None,
                }
            }
        }

        impl From<$type> for Value {
            #[inline]
            fn from(inner: $type) -> Self {
                Self::$kind(inner)
            }
        })*
    };
}

typed! {
    bool, Bool;
    i32, Int;
    f32, Float;
    Vec3, Vec3;
    Entity, Entity;
    Key, Key;
}

impl From<()> for Value {
    fn from((): ()) -> Self {
        Self::None
    }
}
