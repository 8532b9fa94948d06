//! Makes the trees and rocks of the game: triangles with colours, four levels of detail each, as glTF.
//!
//! | part | what it does |
//! |---|---|
//! | [`broadleaf`], [`conifer`], [`boulder`] | the models |
//! | [`model`] | tubes and leaves |
//! | [`plant`] | levels of detail |
//! | [`glb`] | files |
//! | [`preview`] | a picture |

pub mod boulder;
pub mod broadleaf;
pub mod conifer;
pub mod glb;
pub mod model;
pub mod noise;
pub mod plant;
pub mod preview;
pub mod random;
