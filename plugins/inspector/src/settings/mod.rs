//! Settings by reflection: found, read, written within their ranges, and taken back. Nothing here draws.
//!
//! | file | concern |
//! |---|---|
//! | [`kinds`](mod@kinds) | what can be set: what the app's registry knows |
//! | [`place`] | where a value is, and how that is written |
//! | [`described`] | ranges and units |
//! | [`edit`] | reading and writing; undo |

pub mod described;
pub mod edit;
pub mod kinds;
pub mod place;
