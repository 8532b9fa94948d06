//! The scripts under `scripts/`, each on systems that are made for the test; and what documents,
//! comments and `use` lines say.

mod circles;
mod kinds;
mod links;
mod soak;
mod support;
mod system;
mod texts;
mod words;
