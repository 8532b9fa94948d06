#!/usr/bin/env bash
# `tiff`, LZW tiles at the right border of a picture, as GDAL writes them.
#
# Version: tiff 0.11.3 with weezl 0.1.12 (crates.io), rustc 1.95.0; the files by rasterio 1.4.4 (PyPI), which brings GDAL 3.10.3
# Guess:   `read_chunk` gives the samples of each tile of 16 x 16 of a 41 x 37 picture of 16-bit integers, those at the right
#          border too, whatever the predictor; deflate and LZW alike.
# Seen:    `lzw, predictor 1: refused 2: no lzw end code found`, the same with predictor 2, and `deflate, predictor 2: all 9 tiles`.
#          Some LZW tiles that reach over the right border are refused, though the file is right and GDAL reads it: which ones depends
#          on their numbers (with noise it was tiles 2 and 5, with predictor 2 alone). Tiles of the last row, of which the lower part
#          is left over, are read. Elevation by GDAL with -co COMPRESS=LZW -co TILED=YES is of this kind wherever the width is no
#          multiple of the tile's.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

python3 -m venv own
own/bin/pip install --quiet --disable-pip-version-check rasterio==1.4.4 numpy==2.2.6
cat >write.py <<'PY'
import numpy as np
import rasterio

rows, columns = np.mgrid[0:37, 0:41]
hills = (500 * np.sin(columns / 9.0) * np.cos(rows / 7.0)).astype(np.int16)
for name, options in {
    "lzw1": {"compress": "lzw", "predictor": 1},
    "lzw2": {"compress": "lzw", "predictor": 2},
    "deflate2": {"compress": "deflate", "predictor": 2},
}.items():
    tiles = {"tiled": True, "blockxsize": 16, "blockysize": 16, **options}
    with rasterio.open(f"{name}.tif", "w", driver="GTiff", width=41, height=37, count=1, dtype="int16", **tiles) as file:
        file.write(hills, 1)
    # It is a valid file: who wrote it reads it.
    with rasterio.open(f"{name}.tif") as file:
        assert (file.read(1) == hills).all()
PY
own/bin/python -W ignore write.py

cargo init --quiet --vcs none --name tiles . 2>/dev/null
printf 'tiff = "=0.11.3"\nweezl = "=0.1.12"\n' >>Cargo.toml
cat >src/main.rs <<'RS'
use std::{error::Error, fs::File, io::BufReader};

fn main() -> Result<(), Box<dyn Error>> {
    for (name, what) in [
        ("lzw1", "lzw, predictor 1"),
        ("lzw2", "lzw, predictor 2"),
        ("deflate2", "deflate, predictor 2"),
    ] {
        let mut file = tiff::decoder::Decoder::new(BufReader::new(File::open(format!("{name}.tif"))?))?;
        let tiles = file.tile_count()?;
        let mut refused = Vec::new();
        let mut why = String::new();
        for tile in 0..tiles {
            if let Err(error) = file.read_chunk(tile) {
                refused.push(tile.to_string());
                why = error.to_string();
            }
        }
        if refused.is_empty() {
            println!("{what}: all {tiles} tiles");
        } else {
            println!("{what}: refused {}: {why}", refused.join(", "));
        }
    }
    Ok(())
}
RS
cargo run --quiet | tee seen
diff seen - <<'TEXT'
lzw, predictor 1: refused 2: no lzw end code found
lzw, predictor 2: refused 2: no lzw end code found
deflate, predictor 2: all 9 tiles
TEXT
