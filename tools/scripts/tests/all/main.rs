//! The scripts under `scripts/`, each on systems that are made for the test; and what documents and comments say.

mod links;
mod soak;
mod support;
mod system;
mod words;
