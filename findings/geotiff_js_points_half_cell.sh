#!/usr/bin/env bash
# One grid of heights written by GDAL twice, once registered by areas and once by points: where geotiff.js says that it lies.
#
# Version: geotiff 3.0.5 (npm; 2.1.3 gives the same), node 18 or newer; rasterio 1.4.3 with GDAL 3.9.3 (pip)
# Guess:   both files have the same bounding box in both libraries, as GDAL wrote both for one and the same place: the
#          registration (GTRasterTypeGeoKey) says only whether the tie point is a corner or a centre of the first cell.
# Seen:    GDAL has one box for both. geotiff.js says that a file registered by points lies half a cell farther right and
#          down, 15 m with cells of 30 m: `getOrigin` and `getBoundingBox` take the tie point for a corner although
#          `pixelIsArea()` is false. Whoever asks for a place, by the option `bbox` of `readRasters` too, is off by that;
#          digital elevation models are often registered by points. Shift the box by half a cell where `pixelIsArea()`
#          is false.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

python3 -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check rasterio==1.4.3
npm init --yes >/dev/null
npm install --silent --no-audit --no-fund geotiff@3.0.5 >/dev/null

cat >write.py <<'PY'
import numpy
import rasterio
from rasterio.transform import from_origin

heights = numpy.arange(12, dtype="float32").reshape(3, 4)
for registration in ("Area", "Point"):
    name = f"{registration}.tif"
    place = from_origin(500000, 5000000, 30, 30)
    with rasterio.open(name, "w", driver="GTiff", width=4, height=3, count=1, dtype="float32",
                       crs="EPSG:32632", transform=place) as file:
        file.write(heights, 1)
        file.update_tags(AREA_OR_POINT=registration)
    with rasterio.open(name) as file:
        print("GDAL", registration, *(f"{edge:.0f}" for edge in file.bounds))
PY
cat >read.mjs <<'JS'
import { readFileSync } from 'node:fs';
import { fromArrayBuffer } from 'geotiff';
for (const registration of ['Area', 'Point']) {
  const bytes = readFileSync(`${registration}.tif`);
  const buffer = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length);
  const image = await (await fromArrayBuffer(buffer)).getImage();
  console.log('geotiff.js', registration, ...image.getBoundingBox(), 'areas', image.pixelIsArea());
}
JS
{ venv/bin/python write.py; node read.mjs; } | tee seen
diff seen - <<'SEEN'
GDAL Area 500000 4999910 500120 5000000
GDAL Point 500000 4999910 500120 5000000
geotiff.js Area 500000 4999910 500120 5000000 areas true
geotiff.js Point 500015 4999895 500135 4999985 areas false
SEEN
