//! The scripts under `scripts/`, each on systems that are made for the test; and the links in the documents.

mod links;
mod support;
mod system;
