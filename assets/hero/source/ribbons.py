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


def ribbon(name, field, points, count, half_width, thickness, detail, free=0):
    """`free` rings at each end keep their place and are not laid on the jacket."""
    from parts import Half
    centre, total = _line(points, count)
    laid = centre.copy()
    for _ in range(3):
        on = sdf.project(field, laid, 6)
        keep = slice(free, count - free) if free else slice(None)
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
        if free < count // 2:
            down = field(side)
            g = sdf.unit(sdf.gradient(field, side, 0.008))
            move = np.where(np.abs(down) < 0.02, down, 0.0)
            # An edge follows the cloth beside the middle line by half.
            side = side - g * (0.8 * move)[:, None]
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


def build_all(jacket):
    return [
        ribbon("strap", jacket, pack.strap_points(), 30, 0.029, 0.0075, 1.0, free=1),
        ribbon("belt", jacket, pack.hip_belt_points(), 16, 0.024, 0.006, 1.0, free=1),
    ]
