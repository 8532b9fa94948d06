#!/usr/bin/env python3
"""Cuts sixteen GeoTIFFs that share borders from one, with GDAL (rasterio 1.4.4, GDAL 3.10.3).

    pip install rasterio numpy
    python make_tiles.py

The other files beside it are made for this project after reports from the field.
"""

import os
import numpy as np
import rasterio
from rasterio.transform import from_origin
from rasterio.windows import Window

os.chdir(os.path.join(os.path.dirname(os.path.abspath(__file__)), "tiles"))
SIDE = 4 * 12 + 1
random = np.random.default_rng(4)
z, x = np.mgrid[0:SIDE, 0:SIDE]
hills = (700 + 90 * np.sin(x / 6.0) * np.cos(z / 5.0) + 3 * random.random((SIDE, SIDE))).astype(np.float32)
common = dict(driver="GTiff", count=1, dtype="float32", crs="EPSG:32633", compress="deflate", predictor=3)
with rasterio.open(
    "whole.tif", "w", width=SIDE, height=SIDE, transform=from_origin(412340.0, 5123460.0, 10.0, 10.0), **common
) as to:
    to.write(hills, 1)
with rasterio.open("whole.tif") as whole:
    for row in range(4):
        for column in range(4):
            window = Window(12 * column, 12 * row, 13, 13)
            with rasterio.open(
                f"{row}{column}.tif", "w", width=13, height=13, transform=whole.window_transform(window), **common
            ) as to:
                to.write(whole.read(1, window=window), 1)
