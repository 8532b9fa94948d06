#!/usr/bin/env bash
# GDAL, by rasterio: one grid as GeoTIFF, as an ESRI ASCII grid and as an ESRI .bil, each with a place and a nodata value
# of its own, and beside each the same `.aux.xml` that names another place and another nodata value.
#
# Version: rasterio 1.4.3 (PyPI, wheel with GDAL 3.9.3), Python 3.9 to 3.13, Linux x86_64
# Guess:   what `.aux.xml` says outranks what the file says in every format, as GDAL's list of sources has it
#          (`PAM,INTERNAL,TABFILE,WORLDFILE`): place 500 and nodata 7 three times.
# Seen:    `tif 500 7 asc 100 -9999 bil 100 -9999`. The GeoTIFF takes both from beside it, the other two keep their
#          own place and their own nodata value. Whoever puts sidecars and headers in one order for all formats
#          disagrees with GDAL on two of three.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv own >/dev/null
own/bin/pip install --quiet --disable-pip-version-check rasterio==1.4.3
cat >ask.py <<'PYTHON'
import warnings
from pathlib import Path

import numpy
import rasterio
from rasterio.transform import from_origin

warnings.simplefilter("ignore")
heights = numpy.array([[1, 2, 3], [4, 5, -9999]], dtype="<i2")
place = from_origin(100, 200, 10, 10)
with rasterio.open(
    "grid.tif", "w", driver="GTiff", width=3, height=2, count=1, dtype="int16", transform=place, nodata=-9999
) as file:
    file.write(heights, 1)
Path("grid.asc").write_text(
    "ncols 3\nnrows 2\nxllcorner 100\nyllcorner 180\ncellsize 10\nNODATA_value -9999\n1 2 3\n4 5 -9999\n"
)
Path("grid.bil").write_bytes(heights.tobytes())
Path("grid.hdr").write_text(
    "NROWS 2\nNCOLS 3\nNBANDS 1\nNBITS 16\nPIXELTYPE SIGNEDINT\nBYTEORDER I\nLAYOUT BIL\n"
    "ULXMAP 105\nULYMAP 195\nXDIM 10\nYDIM 10\nNODATA -9999\n"
)
beside = (
    "<PAMDataset><GeoTransform>500, 10, 0, 600, 0, -10</GeoTransform>"
    '<PAMRasterBand band="1"><NoDataValue>7</NoDataValue></PAMRasterBand></PAMDataset>'
)
said = []
for kind in ["tif", "asc", "bil"]:
    for known in Path(".").glob("*.aux.xml"):
        known.unlink()
    with rasterio.open(f"grid.{kind}") as file:
        assert (file.transform.c, file.nodata) == (100, -9999), "without it all three say the same"
    Path(f"grid.{kind}.aux.xml").write_text(beside)
    with rasterio.open(f"grid.{kind}") as file:
        said.append(f"{kind} {file.transform.c:.0f} {file.nodata:.0f}")
print(*said)
PYTHON
seen=$(own/bin/python ask.py)
echo "$seen"
[[ $seen == 'tif 500 7 asc 100 -9999 bil 100 -9999' ]]
