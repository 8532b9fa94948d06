//! The lab: f64 oracles, error metrics, and studies of run time against error.
//!
//! `cargo run --release -p dolomite_lab -- noise` runs a study: methods against their oracles over a
//! sweep of a knob, ours and others on the same inputs in the same run. It writes a CSV file and SVG
//! charts, and prints a JSON object. `-- tessellation --cases FILE.jsonl` compares captured patches
//! instead; `-- tessellation-stage` counts cracks and background pixels, and times shadow views; `-- fbx DIR`
//! converts every FBX file of a folder and prints a JSON line for each. Nothing but tests uses the lab.
//!
//! | module | what |
//! |---|---|
//! | [`metrics`] | errors, medians, hashes |
//! | [`csv`], [`plot`] | the files that a study writes |
//! | [`study`], [`studies`] | what a study is, and all of them |
//! | [`gpu`] | compute shaders on whatever adapter there is, without a window |
//! | [`stage`] | the passes of the tessellation stage, without Bevy's renderer |
//! | [`draw`] | what they emitted, drawn, stored or evaluated by the draw |
//! | [`raster`] | pixels that triangles leave uncovered |
//! | [`cli`] | the command line |

pub mod cli;
pub mod csv;
pub mod detail;
pub mod draw;
pub mod gpu;
pub mod metrics;
pub mod plot;
pub mod raster;
pub mod stage;
pub mod studies;
pub mod study;
