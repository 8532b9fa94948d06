"""Straps: flat bands that lie on the jacket, made ring by ring along a line."""

import numpy as np

import pack
import sdf
from sdf import vec


def _line(points, count):
    """`count` points at even distances along a smooth line through `points`."""
    points = np.array(points)
    t = np.arange(len(points), dtype=float)
    fine = np.linspace(0, len(points) - 1, 400)
    path = np.stack([sdf.curve(fine, t, points[:, a]) for a in range(3)], axis=1)
    walk = np.concatenate([[0.0], np.cumsum(sdf.length(np.diff(path, axis=0)))])
    even = np.linspace(0, walk[-1], count)
    return np.stack([np.interp(even, walk, path[:, a]) for a in range(3)], axis=1), walk[-1]


def ribbon(name, field, points, count, half_width, thickness, detail, free=(0, 0)):
    """`free` rings at the beginning and at the end are not laid on the jacket."""
    from parts import Half
    centre, total = _line(points, count)
    laid = centre.copy()
    for _ in range(3):
        on = sdf.project(field, laid, 6)
        keep = slice(free[0], count - free[1])
        laid[keep] = on[keep]
        mid = 0.5 * laid[1:-1] + 0.25 * (laid[2:] + laid[:-2])
        laid[1:-1] = mid
    normal = sdf.unit(sdf.gradient(field, laid, 0.01))
    along = sdf.unit(np.gradient(laid, axis=0))
    normal = sdf.unit(normal - along * np.einsum("ij,ij->i", normal, along)[:, None])
    across = np.cross(along, normal)
    # A flat section with rounded edges, sunk a little into the cloth.
    section = [(-1.0, -0.5), (-0.93, 0.75), (-0.5, 1.0), (0.5, 1.0), (0.93, 0.75), (1.0, -0.5)]
    verts, normals = [], []
    for s, h in section:
        side = laid + across * (s * half_width)
        # The edges follow the cloth beside the middle line.
        down = field(side)
        g = sdf.unit(sdf.gradient(field, side, 0.008))
        side = side - g * (0.8 * np.where(np.abs(down) < 0.02, down, 0.0))[:, None]
        verts.append(side + normal * (h * thickness))
        tilt = {1.0: 1.0, 0.93: 0.8, 0.5: 0.15}[abs(s)] * np.sign(s)
        normals.append(sdf.unit(normal * (1.0 - 0.8 * abs(tilt)) + across * tilt))
    m = len(section)
    verts = np.stack(verts, axis=1).reshape(-1, 3)
    normals = np.stack(normals, axis=1).reshape(-1, 3)
    faces, uv = [], []
    width = np.concatenate([[0.0], np.cumsum([0.012, half_width * 0.5, half_width, half_width * 0.5, 0.012])])
    v = np.linspace(0.0, total, count)
    for i in range(count - 1):
        for j in range(m - 1):
            a, b = i * m + j, i * m + j + 1
            c, d = a + m, b + m
            ta, tb = (width[j], v[i]), (width[j + 1], v[i])
            tc, td = (width[j], v[i + 1]), (width[j + 1], v[i + 1])
            faces += [(a, c, b), (b, c, d)]
            uv += [(ta, tc, tb), (tb, tc, td)]
    faces, uv = np.array(faces), np.array(uv)
    flat = np.cross(verts[faces[:, 1]] - verts[faces[:, 0]], verts[faces[:, 2]] - verts[faces[:, 0]])
    if np.einsum("ij,ij->i", flat, normals[faces].mean(axis=1)).sum() < 0.0:
        faces, uv = faces[:, ::-1].copy(), uv[:, ::-1].copy()
    verts[np.abs(verts[:, 0]) < 1e-6, 0] = 0.0
    return Half(name, verts, faces, normals, np.zeros(len(faces), int), detail, uv, True)


COLLAR = [  # up the section: share of the height, metres outwards
    (-0.30, 0.010), (0.10, 0.0070), (0.55, 0.0075), (0.88, 0.0090), (1.00, 0.0040), (0.95, -0.0020), (0.60, -0.0050),
    (0.10, -0.0060)]


def collar(count=19, detail=1.1):
    """The standing collar, open at the throat: a band from the zip to the nape."""
    from parts import Half
    a = np.linspace(0.0, np.pi, count)
    # It parts at the zip: the front edge leans outwards and dips.
    throat = np.exp(-(a / 0.42) ** 2)
    verts, widths = [], [0.0]
    for share, out in COLLAR:
        h = share * (0.078 - 0.026 * throat)
        radius = 0.0765 + out + 0.030 * max(0.0, -share) + 0.010 * throat * max(share, 0.0)
        x = np.sin(a) * radius
        z = np.cos(a) * radius * 1.02 - 0.0235 + 0.16 * h
        y = 1.472 - 0.030 * np.cos(a) * (1.0 - 0.2 * share) + h
        if share > 0.0:
            x = x + 0.010 * share * np.exp(-(a / 0.16) ** 2)
        verts.append(np.stack([x, y, z], axis=1))
    rings = np.stack(verts, axis=1)
    for j in range(1, len(COLLAR)):
        widths.append(widths[-1] + np.median(sdf.length(rings[:, j] - rings[:, j - 1])))
    m = len(COLLAR)
    along = np.concatenate([[0.0], np.cumsum(sdf.length(np.diff(rings[:, 2], axis=0)))])
    verts = rings.reshape(-1, 3)
    faces, uv = [], []
    for i in range(count - 1):
        for j in range(m - 1):
            p, q = i * m + j, i * m + j + 1
            r, s = p + m, q + m
            tp, tq = (widths[j], along[i]), (widths[j + 1], along[i])
            tr, ts = (widths[j], along[i + 1]), (widths[j + 1], along[i + 1])
            faces += [(p, r, q), (q, r, s)]
            uv += [(tp, tr, tq), (tq, tr, ts)]
    faces, uv = np.array(faces), np.array(uv)
    normals = np.zeros_like(verts)
    flat = np.cross(verts[faces[:, 1]] - verts[faces[:, 0]], verts[faces[:, 2]] - verts[faces[:, 0]])
    outer = sdf.unit(verts[faces].mean(axis=1) * vec(1, 0, 1) + vec(0, 0, 0.0235))
    low = (faces % m).max(axis=1) <= 2
    if np.einsum("ij,ij->i", flat[low], outer[low]).sum() < 0.0:
        faces, uv, flat = faces[:, ::-1].copy(), uv[:, ::-1].copy(), -flat
    for c in range(3):
        np.add.at(normals, faces[:, c], flat)
    verts[m * (count - 1):, 0] = 0.0
    normals[m * (count - 1):, 0] = 0.0
    return Half("collar", verts, faces, sdf.unit(normals), np.zeros(len(faces), int), detail, uv, True)


def build_all(jacket):
    return [
        ribbon("strap", jacket, pack.strap_points(), 22, 0.029, 0.0075, 1.0, free=(1, 1)),
        ribbon("belt", jacket, pack.hip_belt_points(), 16, 0.024, 0.006, 1.0, free=(1, 0)),
        collar(),
    ]
