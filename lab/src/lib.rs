//! The lab: f64 oracles, error metrics, and studies of run time against error.
//!
//! `cargo run --release -p dolomite_lab -- noise` runs a study: methods against their oracles over a
//! sweep of a knob, ours and others on the same inputs in the same run. It writes a CSV file and SVG
//! charts, and prints a JSON object. `-- tessellation --cases FILE.jsonl` compares captured patches
//! instead; `-- tessellation-stage` counts cracks and background pixels, and times shadow views; `-- fbx DIR`
//! converts every FBX file of a folder and prints a JSON line for each. Nothing uses the lab.
//!
//! | module | what |
//! |---|---|
//! | [`capsule`] | runs of compute passes in files, for implementations of WebGPU that know no Rust |
//! | [`csv`], [`plot`] | the files that a study writes |
//! | [`measured`], [`tables`] | measured numbers, and the pages of `docs/measured` that are made of them |
//! | [`mod@page`], [`figures`] | a page of figures in one HTML file; that of `docs/figures` |
//! | [`study`], [`studies`] | what a study is, and all of them |
//! | [`scenes`] | grounds, cameras over them, what is true and what is drawn under a place |
//! | [`tessellators`] | what tessellators may be set to, and levels where one may go wrong |
//! | [`cli`] | the command line |
//!
//! What studies share with the tests of the plugins, adapters and passes and metrics, is in
//! `dolomite_testkit`.

pub mod capsule;
pub mod cli;
pub mod csv;
pub mod figures;
pub mod measured;
pub mod page;
pub mod plot;
pub mod scenes;
pub mod studies;
pub mod study;
pub mod tables;
pub mod tessellators;
