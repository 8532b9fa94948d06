#!/usr/bin/env bash
# trimesh, meshes of glTF: whether it reads what an accessor says about its numbers.
#
# Version: trimesh 5.2.0 with numpy 2.2.6 (PyPI), Python 3.10 or newer
# Guess:   positions in normalized shorts (KHR_mesh_quantization, which the file says is required) are fractions of 1, so that the
#          node's scale of 2 puts them between -2 and 2, or the file is refused by the extension's name; a sparse accessor's
#          values replace those below, so that the triangle is 5 high.
# Seen:    `quantized: -65534.0 .. 65534.0` and `sparse: 1.0 high`. Both load without a word: the shorts are taken for metres, the
#          required extension is not looked at, and sparse values are left out. Whoever checks a packer with it measures neither.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

python3 -m venv own
own/bin/pip install --quiet --disable-pip-version-check trimesh==5.2.0 numpy==2.2.6

cat >look.py <<'PY'
import base64
import json
import struct

import trimesh


def triangle(name, data, views, accessor, **more):
    """A scene of one triangle, of which only the positions matter."""
    file = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "buffers": [
            {
                "byteLength": len(data),
                "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode(),
            }
        ],
        "bufferViews": views,
        "accessors": [{"bufferView": 0, "count": 3, "type": "VEC3", **accessor}],
        **more,
    }
    with open(name, "w") as out:
        json.dump(file, out)
    return trimesh.load(name).bounds


shorts = b"".join(struct.pack("<4h", *at) for at in [(-32767, 0, 0, 0), (32767, 0, 0, 0), (0, 16384, 0, 0)])
low, high = triangle(
    "quantized.gltf",
    shorts,
    [{"buffer": 0, "byteLength": len(shorts), "byteStride": 8}],
    {"componentType": 5122, "normalized": True, "min": [-32767, 0, 0], "max": [32767, 16384, 0]},
    extensionsUsed=["KHR_mesh_quantization"],
    extensionsRequired=["KHR_mesh_quantization"],
    nodes=[{"mesh": 0, "scale": [2, 2, 2]}],
)
print(f"quantized: {low[0]} .. {high[0]}")

below = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)
which = struct.pack("<HH", 2, 0)
instead = struct.pack("<3f", 0, 5, 0)
low, high = triangle(
    "sparse.gltf",
    below + which + instead,
    [
        {"buffer": 0, "byteLength": 36},
        {"buffer": 0, "byteOffset": 36, "byteLength": 2},
        {"buffer": 0, "byteOffset": 40, "byteLength": 12},
    ],
    {
        "componentType": 5126,
        "min": [0, 0, 0],
        "max": [1, 5, 0],
        "sparse": {
            "count": 1,
            "indices": {"bufferView": 1, "componentType": 5123},
            "values": {"bufferView": 2},
        },
    },
)
print(f"sparse: {high[1] - low[1]} high")
PY
own/bin/python look.py | tee seen
diff seen - <<'TEXT'
quantized: -65534.0 .. 65534.0
sparse: 1.0 high
TEXT
