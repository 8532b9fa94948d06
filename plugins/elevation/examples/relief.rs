//! What a file of elevation is, and a picture of it.
//!
//! `cargo run -p dolomite_elevation --example relief -- alps.tif alps.png`

use dolomite_elevation::{Elevation, Options, fill_holes, write};
use std::error::Error;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let mut files = std::env::args_os().skip(1);
    let (Some(from), Some(to)) = (files.next(), files.next()) else {
        return Err("write: relief FILE OUT.png".into());
    };
    let mut map = Elevation::read(Path::new(&from), &Options::default())?;
    println!("{:#?}", map.about);
    if let Some(filled) = fill_holes(&mut map.samples, map.size[0] as usize) {
        println!(
            "{} samples in {} holes filled",
            filled.samples, filled.holes
        );
    }
    write(Path::new(&to), &map, None)?;
    Ok(())
}
