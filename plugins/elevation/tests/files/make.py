#!/usr/bin/env python3
"""Writes the files beside it: the same few grounds in every kind, by software that is not ours.

The name before the first `-` is the ground: NAME.f32 holds its numbers, row after row from the north, NaN where
there is no data. The rest of a name says who wrote it and how.

    pip install rasterio tifffile imagecodecs numpy pypng
    python make.py

Written with GDAL 3.10.3 (rasterio 1.4.4), tifffile 2026.3.3, NumPy 2.4.6 and pypng 0.20231004.0.
"""

import os
import tempfile
import numpy as np
import png
import rasterio
import tifffile
from rasterio.transform import from_origin, Affine
from rasterio.shutil import copy

os.chdir(os.path.dirname(os.path.abspath(__file__)))
# What drivers that only copy are copied from.
SOURCE = os.path.join(tempfile.mkdtemp(), "source.tif")
HIGH, WIDE = 37, 41
random = np.random.default_rng(24)
z, x = np.mgrid[0:HIGH, 0:WIDE]
hills = 900 + 500 * np.sin(x / 9.0) * np.cos(z / 7.0) + 40 * random.random((HIGH, WIDE))
grounds = {
    "u8": (hills / 6).astype(np.uint8),
    "i8": (hills / 20 - 40).astype(np.int8),
    "u16": (hills * 40).astype(np.uint16),
    "i16": (hills - 1000).astype(np.int16),
    "u32": (hills * 1e5).astype(np.uint32),
    "i32": ((hills - 900) * 1e5).astype(np.int32),
    "f32": (hills * 1.2345678).astype(np.float32),
    "f64": hills * 1.2345678901234,
    # Two holes, one of them at the border.
    "h16": (hills - 1000).astype(np.int16),
    "hf": (hills * 1.2345678).astype(np.float32),
    "n16": (hills * 40).astype(np.uint16),
}
HOLE = np.zeros((HIGH, WIDE), bool)
HOLE[5:11, 7:19] = True
HOLE[30:, 36:] = True


def expected(name):
    values = grounds[name].astype(np.float32)
    if name in ("h16", "hf", "n16"):
        values = values.copy()
        values[HOLE] = np.nan
    return values


for name in grounds:
    expected(name).astype("<f4").tofile(f"{name}.f32")


def with_nodata(name, nodata):
    values = grounds[name].copy()
    values[HOLE] = nodata
    return values


UTM = dict(crs="EPSG:32633", transform=from_origin(412340.0, 5123460.0, 30.0, 25.0))
DEGREES = dict(crs="EPSG:4326", transform=from_origin(15.25, 46.5, 1 / 1200, 1 / 1200))


def gdal(path, values, driver="GTiff", place=UTM, nodata=None, tags=None, **options):
    bands = values if values.ndim == 3 else values[None]
    with rasterio.open(
        path, "w", driver=driver, width=WIDE, height=HIGH, count=len(bands),
        dtype=values.dtype, nodata=nodata, **place, **options,
    ) as to:
        to.write(bands)
        if tags:
            to.update_tags(**tags)


for name in ["u8", "i8", "u16", "i16", "u32", "i32", "f32", "f64"]:
    gdal(f"{name}-gdal-strips.tif", grounds[name])
for name, predictor in [("i16", 2), ("u16", 2), ("u32", 2), ("f32", 3), ("f32", 2), ("f64", 3)]:
    for pack in ["lzw", "deflate"]:
        gdal(
            f"{name}-gdal-{pack}-p{predictor}-tiles.tif", grounds[name], compress=pack,
            predictor=predictor, tiled=True, blockxsize=16, blockysize=16,
        )
gdal("i16-gdal-lzw-p1.tif", grounds["i16"], compress="lzw")
gdal("i16-gdal-packbits.tif", grounds["i16"], compress="packbits")
gdal("i16-gdal-big.tif", grounds["i16"], ENDIANNESS="BIG")
gdal("f32-gdal-bigtiff-big-tiles.tif", grounds["f32"], BIGTIFF="YES", ENDIANNESS="BIG",
     tiled=True, blockxsize=32, blockysize=16)
gdal("f32-gdal-bigtiff-deflate-p3.tif", grounds["f32"], BIGTIFF="YES", compress="deflate", predictor=3)
gdal("i16-gdal-degrees-area.tif", grounds["i16"], place=DEGREES)
gdal("i16-gdal-degrees-point.tif", grounds["i16"], place=DEGREES, tags={"AREA_OR_POINT": "Point"})
gdal("i16-gdal-feet.tif", grounds["i16"], place=dict(crs="EPSG:2263", transform=from_origin(980000.0, 200000.0, 100.0, 100.0)))
gdal("i16-gdal-mercator.tif", grounds["i16"], place=dict(crs="EPSG:3857", transform=from_origin(1697625.0, 5860000.0, 38.2, 38.2)))
gdal("h16-gdal-nodata.tif", with_nodata("h16", -32768), nodata=-32768)
gdal("h16-gdal-untold.tif", with_nodata("h16", -9999))
gdal("hf-gdal-nodata.tif", with_nodata("hf", np.float32(-3.4028234663852886e38)), nodata=-3.4028234663852886e38, compress="lzw", predictor=3)
gdal("hf-gdal-nan.tif", with_nodata("hf", np.nan), nodata=np.nan, compress="deflate")
gdal("hf-gdal-nan-untold.tif", with_nodata("hf", np.nan))
three = np.stack([grounds["u16"] // 2, grounds["u16"], grounds["u16"] // 3])
gdal("u16-gdal-bands-pixel.tif", three, interleave="pixel", compress="deflate", predictor=2)
gdal("u16-gdal-bands-band.tif", three, interleave="band")
gdal("i16-gdal-zstd.tif", grounds["i16"], compress="zstd")
gdal("i16-gdal-rotated.tif", grounds["i16"], place=dict(crs="EPSG:32633", transform=Affine(20, 5, 412340.0, 5, -20, 5123460.0)))
# A scale of the file's own.
gdal("i16-gdal-scaled.tif", grounds["i16"])
with rasterio.open("i16-gdal-scaled.tif", "r+") as to:
    to.scales, to.offsets, to.units = (0.25,), (-100.0,), ("ft",)
# Sparse: only the tiles of the first row of tiles are there.
for pack in ["none", "deflate"]:
    with rasterio.open(
        f"i16-gdal-sparse-{pack}.tif", "w", driver="GTiff", width=WIDE, height=HIGH, count=1, dtype="int16",
        tiled=True, blockxsize=16, blockysize=16, SPARSE_OK=True, compress=pack, **UTM,
    ) as to:
        to.write(grounds["i16"][:16], 1, window=((0, 16), (0, WIDE)))
# Cloud-optimised, with overviews.
gdal(SOURCE, grounds["f32"])
copy(SOURCE, "f32-gdal-cog.tif", driver="COG", blocksize=128, compress="deflate", predictor="floating_point", overview_count=2)

for name, options in [
    ("u16-tifffile", {}),
    ("u16-tifffile-big-bigtiff", dict(byteorder=">", bigtiff=True)),
    ("i16-tifffile-zlib-p2-tiles", dict(compression="zlib", predictor=2, tile=(16, 32))),
    ("f32-tifffile-zlib-p3", dict(compression="zlib", predictor=3, rowsperstrip=5)),
    ("f32-tifffile-big-lzw", dict(byteorder=">", compression="lzw")),
    ("f64-tifffile-tiles", dict(tile=(16, 16))),
]:
    tifffile.imwrite(f"{name}.tif", grounds[name.split("-")[0]], photometric="minisblack", **options)
tifffile.imwrite("u16-tifffile-white.tif", 65535 - (65535 - grounds["u16"]), photometric="miniswhite")
tifffile.imwrite("f32-tifffile-white.tif", grounds["f32"], photometric="miniswhite")

gdal("u16-gdal.png", grounds["u16"], driver="PNG", place={})
gdal("u8-gdal.png", grounds["u8"], driver="PNG", place={})
gdal("n16-gdal-trns.png", with_nodata("n16", 7), driver="PNG", place={}, nodata=7)
for path in os.listdir():
    if path.endswith(".aux.xml"):
        os.remove(path)


def pypng(path, values, bits, extra=b"", **options):
    rows = values.reshape(HIGH, -1).tolist()
    with open(path, "wb") as to:
        png.Writer(WIDE, HIGH, bitdepth=bits, **options).write(to, rows)


pypng("u16-pypng-interlaced-gamma.png", grounds["u16"], 16, greyscale=True, interlace=True, gamma=0.45455)
pypng("u8-pypng-interlaced.png", grounds["u8"], 8, greyscale=True, interlace=True)
pypng("n16-pypng-trns-interlaced.png", with_nodata("n16", 65535), 16, greyscale=True, interlace=True, transparent=65535)
opaque = np.where(HOLE, 0, 65535).astype(np.uint16)
pypng("n16-pypng-alpha.png", np.stack([grounds["n16"], opaque], -1), 16, greyscale=True, alpha=True)
pypng("u16-pypng-colour.png", np.stack([grounds["u16"] // 2, grounds["u16"], grounds["u16"] * 0], -1), 16, greyscale=False)

for name in ["i16", "f32", "h16"]:
    nodata = -9999 if name == "h16" else None
    values = with_nodata("h16", -9999) if nodata else grounds[name]
    gdal(SOURCE, values, place=DEGREES if name == "i16" else UTM, nodata=nodata)
    copy(SOURCE, f"{name}-gdal.asc", driver="AAIGrid", **({"SIGNIFICANT_DIGITS": "9"} if name == "f32" else {}))
    if name == "i16":
        os.remove("i16-gdal.prj")
for path in os.listdir():
    if path.endswith(".aux.xml"):
        os.remove(path)

grounds["u16"].astype(">u2").tofile("u16-numpy-big.raw")
grounds["i16"].astype("<i2").tofile("i16-numpy.raw")
grounds["u16"].astype("<u2").tofile("u16-numpy.r16")
grounds["u8"].tofile("u8-numpy.raw")
grounds["u32"].astype(">u4").tofile("u32-numpy-big.raw")
grounds["f32"].astype(">f4").tofile("f32-numpy-big.raw")
padded = np.zeros((HIGH, WIDE + 3), "<f4")
padded[:, :WIDE] = grounds["f32"][::-1]
with open("f32-numpy-header-padding-flip.raw", "wb") as to:
    to.write(b"eleven byte")
    padded.tofile(to)
