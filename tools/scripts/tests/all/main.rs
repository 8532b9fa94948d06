//! The scripts under `scripts/`, each on systems that are made for the test; and the documents' links.

mod links;
mod soak;
mod support;
mod system;
