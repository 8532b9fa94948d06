"""What a soldier wears over the hiker's cut of clothes: a kettle hat and a breastplate."""

import numpy as np

import clothes
import extremities
import head
import parts
import sdf
import skeleton as sk
from parts import Half, Part
from sdf import both, smoothstep, vec

# The kettle hat: an iron bowl with a comb, and a brim that slopes outwards. Its own height is counted from the
# brim's plane, which dips a little towards the back.
BRIM_Y = 1.7130
TILT = 0.10
BOWL = vec(0.0900, 0.1130, 0.1140)   # half width at the brim, height, half length (m)
BRIM = 1.50                          # the brim's edge, in widths of the bowl


def hat_height(p):
    return p[:, 1] - BRIM_Y - TILT * (p[:, 2] + 0.012)


def hat_radius(p):
    """1 where the bowl meets the brim."""
    return np.sqrt((p[:, 0] / BOWL[0]) ** 2 + ((p[:, 2] + 0.012) / BOWL[2]) ** 2) + 1e-9


def _slope(r):
    """Metres that the brim is lower there than at the bowl."""
    return 0.034 * np.clip(r - 1.0, 0.0, None)


def _profile():
    """From the top down the bowl, out over the brim, around its edge and back below it: (radius in widths of the
    bowl, height in m)."""
    turn = np.linspace(0.0, 0.5 * np.pi, 9)
    points = [(np.sin(a) ** 0.94, BOWL[1] * np.cos(a) ** 0.96) for a in turn[:-1]] + [(1.0, 0.004)]
    points += [(r, 0.0034 - _slope(r)) for r in (1.06, 1.22, BRIM - 0.03)]
    edge = -_slope(BRIM)
    points += [(BRIM + 0.015, edge + 0.0050), (BRIM + 0.050, edge), (BRIM + 0.015, edge - 0.0055)]
    points += [(r, -0.0030 - _slope(r)) for r in (BRIM - 0.03, 1.20, 0.96)] + [(0.90, 0.030)]
    return np.array(points)


def helmet(columns=17):
    """Half of the hat, from the front over the left side to the back."""
    profile = _profile()
    a = np.linspace(0.0, np.pi, columns)
    r, h = profile[:, 0], profile[:, 1]
    x = BOWL[0] * np.sin(a)[:, None] * r
    z = BOWL[2] * np.cos(a)[:, None] * r
    y = BRIM_Y + TILT * z + h
    verts = np.stack([x, y, z - 0.012], axis=2)
    verts[0, :, 0] = verts[-1, :, 0] = 0.0
    rows = len(profile)
    along = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(r) * 0.10, np.diff(h)))])
    around = a * 0.10
    faces, uv = [], []
    for i in range(columns - 1):
        for j in range(rows - 1):
            corners = [(i, j), (i, j + 1), (i + 1, j + 1), (i + 1, j)]
            flat = [(around[c], along[k]) for c, k in corners]
            number = [c * rows + k for c, k in corners]
            faces += [[number[k] for k in t] for t in ((0, 1, 2), (0, 2, 3))]
            uv += [[flat[k] for k in t] for t in ((0, 1, 2), (0, 2, 3))]
    verts, faces, uv = verts.reshape(-1, 3), np.array(faces), np.array(uv)
    flat = np.cross(verts[faces[:, 1]] - verts[faces[:, 0]], verts[faces[:, 2]] - verts[faces[:, 0]])
    whole = sdf.length(flat) > 1e-10   # the top is one point
    faces, uv, flat = faces[whole], uv[whole], flat[whole]
    crown = (faces % rows).max(axis=1) < 7
    out = verts[faces].mean(axis=1) - vec(0.0, BRIM_Y, -0.012)
    if np.einsum("ij,ij->i", flat[crown], out[crown]).sum() < 0.0:
        faces, uv, flat = faces[:, ::-1].copy(), uv[:, ::-1].copy(), -flat
    normals = np.zeros_like(verts)
    for c in range(3):
        np.add.at(normals, faces[:, c], flat)
    normals[sdf.length(normals) < 1e-12] = vec(0.0, 1.0, 0.0)
    top = np.arange(len(verts)) % rows == 0
    normals[top] = vec(0.0, 1.0, 0.0)
    return Half("helmet", verts, faces, sdf.unit(normals), np.zeros(len(faces), int), 1.3, uv, True)


# The breastplate: the trunk blown up by the thickness of a padded coat, cut at waist, armholes and throat.
WAIST = 1.075


def armhole(p):
    """Metres beyond the plate's edge at the arm."""
    q = np.abs(p[:, 0]) - 0.145 + 0.22 * np.clip(1.36 - p[:, 1], 0.0, 0.06) * -1.0
    return q - 0.05 * smoothstep(1.34, 1.16, p[:, 1])


def throat(p):
    """Metres above the plate's upper edge."""
    front = smoothstep(-0.03, 0.01, p[:, 2])
    return p[:, 1] - (1.428 - 0.022 * front * smoothstep(0.090, 0.0, np.abs(p[:, 0])))


def _edge(p):
    return sdf.both(sdf.both(WAIST - p[:, 1], throat(p), 0.03), armhole(p), 0.03)


def plate_field(p):
    # A ridge down the middle of the chest.
    ridge = 0.007 * np.exp(-(p[:, 0] / 0.022) ** 2) * smoothstep(0.02, 0.06, p[:, 2]) * smoothstep(1.40, 1.30, p[:, 1])
    d = clothes.trunk_field(p) - 0.0150 - ridge
    return both(d, _edge(p), 0.008)


def plate_hidden(p):
    return clothes.trunk_field(p) < 0.0035


def _plate_sizing(p):
    return 0.040 - 0.0270 * smoothstep(-0.030, -0.004, _edge(p))


def _plate_charts(p, n):
    inner = (clothes.trunk_field(p) < 0.009).astype(int) * 2
    return np.where(p[:, 2] > -0.008, 0, 1) + inner


def head_hidden(p):
    under_hat = (hat_height(p) > 0.004) & (sdf.ellipsoid(p, head.SKULL, head.SKULL_RADII) < 0.012)
    behind_eye = sdf.sphere(p, head.EYE, head.EYE_RADIUS) < -0.0010
    return under_hat | behind_eye | (p[:, 1] < 1.490)


def bodies():
    """The hiker's head, hands, coat, trousers and boots, and iron in place of hat and rucksack."""
    left_out = ("hat", "pack", "lid", "roll", "head")
    kept = [part for part in parts.bodies() if part.name not in left_out]
    own = next(part for part in parts.bodies() if part.name == "head")
    own.hidden = head_hidden
    return [own] + kept + [
        Part("plate", plate_field, (0, 1.05, -0.20), (0.23, 1.45, 0.20), 0.0060, _plate_sizing,
             plate_hidden, _plate_charts, 1.0),
    ]
