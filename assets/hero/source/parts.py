"""The list of parts: each a closed body of its own, half of it made and mirrored.

Where parts meet, one goes into the other (the hand into the cuff, the leg into
the boot) with the same weights at the place, so that no gap can open.
"""

from dataclasses import dataclass
from typing import Callable

import numpy as np

import clothes
import extremities
import head
import mesher
import pack
import sdf
import skeleton as sk
from sdf import length, smoothstep, vec


@dataclass
class Part:
    name: str
    field: Callable          # points -> distance (m)
    low: tuple               # box that holds the half, m
    high: tuple
    cell: float              # of the first grid, m
    sizing: Callable         # points -> length of edges (m)
    hidden: Callable         # points -> where no camera looks
    charts: Callable         # points, normals -> an integer; charts are unwrapped apart
    detail: float = 1.0      # texels a metre, against the others


def _never(p):
    return np.zeros(len(p), dtype=bool)


def _even(size):
    return lambda p: np.full(len(p), size)


def _head_sizing(p):
    face = smoothstep(0.035, 0.075, p[:, 2]) * smoothstep(1.545, 1.56, p[:, 1])
    size = 0.0210 - 0.0112 * face
    eye = length((p - head.EYE) * vec(0.8, 1.0, 0.6))
    size = np.minimum(size, 0.0037 + 0.0065 * smoothstep(0.013, 0.028, eye))
    mouth = length((p - vec(0.010, 1.592, 0.088)) * vec(0.6, 1.0, 0.7))
    size = np.minimum(size, 0.0052 + 0.006 * smoothstep(0.010, 0.024, mouth))
    nose = length(p - vec(0.004, 1.622, 0.102))
    size = np.minimum(size, 0.0056 + 0.006 * smoothstep(0.010, 0.022, nose))
    ear = length((p - vec(0.080, 1.650, -0.013)) * vec(1.0, 0.7, 1.0))
    return np.minimum(size, 0.0072 + 0.014 * smoothstep(0.022, 0.035, ear))


def _hat_sizing(p):
    return 0.0115 + 0.0065 * smoothstep(0.006, 0.02, head.height_in_hat(p))


def _hand_sizing(p):
    u, _, _ = extremities.hand_coords(p)
    return 0.0155 - 0.0075 * smoothstep(0.04, 0.095, u)


def _jacket_sizing(p):
    size = 0.0365 * np.ones(len(p))
    u, _, _ = clothes.forearm_coords(p)
    arm = smoothstep(0.21, 0.25, p[:, 0])
    size -= 0.009 * arm
    size -= 0.010 * arm * sdf.bump(u, 0.0, 0.09)
    size -= 0.011 * arm * smoothstep(clothes.CUFF_U - 0.06, clothes.CUFF_U - 0.03, u)
    shoulder = length(p - sk.SHOULDER - vec(0.0, -0.02, 0.0))
    size = np.minimum(size, 0.027 + 0.012 * smoothstep(0.08, 0.15, shoulder))
    return np.minimum(size, 0.023 + 0.016 * smoothstep(0.02, 0.06, p[:, 1] - clothes.HEM))


def _trousers_sizing(p):
    size = 0.035 - 0.011 * sdf.bump(p[:, 1], 0.525, 0.12)
    size = np.minimum(size, 0.023 + 0.011 * smoothstep(0.13, 0.20, p[:, 1]))
    return np.minimum(size, 0.028 + 0.007 * smoothstep(0.86, 0.75, p[:, 1]))


def _boot_sizing(p):
    size = 0.0235 - 0.0075 * smoothstep(0.05, 0.03, p[:, 1])
    laces = (p[:, 2] > 0.025) & (p[:, 2] < 0.14) & (extremities.lacing(p) < 0.03) & (p[:, 1] > 0.05)
    return np.where(laces, 0.0155, size)


# Charts: front and back halves, cut where a tailor would.

def _jacket_charts(p, n):
    arm = (p - sk.SHOULDER - vec(-0.012, 0, 0)) @ vec(0.82, 0.42, 0.0)
    u, v, _ = clothes.forearm_coords(p)
    sleeve = (arm > 0.0) & (p[:, 0] > 0.16)
    upper = clothes.upper_arm_coords(p)[1]
    front_sleeve = np.where(u > 0.0, v, upper) > 0.0
    front = p[:, 2] - 0.75 * (p[:, 1] - 1.43) * (p[:, 1] > 1.43) > -0.012
    under = (n[:, 1] < -0.75) & (p[:, 1] < 0.86)
    label = np.where(front, 0, 1)
    label = np.where(sleeve, np.where(front_sleeve, 2, 3), label)
    return np.where(under, 6, label)


def _trousers_charts(p, n):
    return np.where(p[:, 2] > -0.006, 0, 1) + np.where(n[:, 1] < -0.8, 2, 0)


def _hand_charts(p, n):
    return (n @ sk.HAND_PALM > 0.0).astype(int)


def _boot_charts(p, n):
    sole = (n[:, 1] < -0.6) & (p[:, 1] < 0.03)
    inner = p[:, 0] < extremities.BOOT_X + 0.003
    return np.where(sole, 2, inner.astype(int))


def _head_charts(p, n):
    ear_back = (length((p - vec(0.083, 1.650, -0.022)) * vec(1, 0.7, 1)) < 0.032) & (n[:, 2] < -0.25) & (p[:, 0] > 0.072)
    return np.where(ear_back, 1, 0)


def _hat_charts(p, n):
    return np.where((p[:, 2] > -0.015), 0, 1)


def _box_charts(p, n):
    side = np.argmax(np.abs(n) * vec(1.0, 1.0, 1.05), axis=1)
    return side * 2 + (np.take_along_axis(n, side[:, None], 1)[:, 0] > 0)


def bodies():
    hand_low = np.minimum(sk.WRIST, sk.hand_point(0.2, 0, 0)) - 0.09
    hand_high = np.maximum(sk.WRIST, sk.hand_point(0.2, 0, 0)) + 0.09
    return [
        Part("head", head.head_field, (0, 1.45, -0.13), (0.105, 1.80, 0.13), 0.0042, _head_sizing,
             head.head_hidden, _head_charts, 2.6),
        Part("eye", head.eye_field, (0.01, 1.64, 0.04), (0.05, 1.69, 0.09), 0.004, _even(0.0055),
             lambda p: p[:, 2] < head.EYE[2] - 0.002, lambda p, n: np.zeros(len(p), int), 3.0),
        Part("hat", head.hat_field, (0, 1.62, -0.15), (0.13, 1.84, 0.13), 0.006, _hat_sizing,
             lambda p: sdf.ellipsoid(p, head.SKULL, head.SKULL_RADII) < 0.002, _hat_charts, 1.5),
        Part("hand", extremities.hand_field, hand_low, hand_high, 0.0022, _hand_sizing,
             extremities.hand_hidden, _hand_charts, 1.5),
        Part("jacket", clothes.jacket_field, (0, 0.80, -0.22), (0.62, 1.58, 0.20), 0.0105, _jacket_sizing,
             clothes.jacket_hidden, _jacket_charts, 1.0),
        Part("trousers", clothes.trousers_field, (0, 0.09, -0.18), (0.24, 1.05, 0.18), 0.012, _trousers_sizing,
             clothes.trousers_hidden, _trousers_charts, 0.9),
        Part("boot", extremities.boot_field, (0.02, -0.01, -0.12), (0.18, 0.22, 0.24), 0.0055, _boot_sizing,
             extremities.boot_hidden, _boot_charts, 1.1),
        Part("pack", pack.body_field, (0, 0.98, -0.36), (0.20, 1.45, -0.05), 0.010, _even(0.031),
             pack.hidden, _box_charts, 0.9),
        Part("lid", pack.lid_field, (0, 1.30, -0.36), (0.17, 1.49, -0.05), 0.009, _even(0.030),
             lambda p: (pack.body_field(p) < -0.012), _box_charts, 0.9),
        Part("roll", pack.roll_field, (0, 0.90, -0.31), (0.21, 1.07, -0.12), 0.009, _even(0.025),
             _never, lambda p, n: np.where(np.abs(n[:, 0]) > 0.6, 2, (n[:, 1] > 0).astype(int)), 0.8),
    ]


@dataclass
class Half:
    """A part's mesh for x >= 0."""
    name: str
    verts: np.ndarray
    faces: np.ndarray
    normals: np.ndarray
    chart: np.ndarray        # of each face
    detail: float
    uv: np.ndarray = None    # of each face's corner, (n, 3, 2)
    ribbon: bool = False     # made with its own uv
    right: bool = False      # there is no left one: what a hand holds


def _drop_hidden(part, verts, faces):
    keep = ~part.hidden(verts)[faces].all(axis=1)
    faces = faces[keep]
    used = np.unique(faces)
    renumber = np.full(len(verts), -1)
    renumber[used] = np.arange(len(used))
    return verts[used], renumber[faces]


def _tidy_charts(label, verts, faces):
    """Charts without crumbs: each face takes the commonest label around it."""
    edges = {}
    for f, (a, b, c) in enumerate(faces):
        for e in ((a, b), (b, c), (c, a)):
            edges.setdefault((min(e), max(e)), []).append(f)
    near = [[] for _ in faces]
    for fs in edges.values():
        if len(fs) == 2:
            near[fs[0]].append(fs[1])
            near[fs[1]].append(fs[0])
    label = label.copy()
    for _ in range(4):
        new = label.copy()
        for f, others in enumerate(near):
            around = [label[o] for o in others]
            for value in around:
                if around.count(value) >= 2 and value != label[f]:
                    new[f] = value
        if (new == label).all():
            break
        label = new
    return label


def build(part):
    field = sdf.mirror_field(part.field)
    verts, quads = mesher.surface_nets(field, part.low, part.high, part.cell)
    verts, faces = mesher.remesh(verts, quads, field, part.sizing)
    verts, faces = _drop_hidden(part, verts, faces)
    normals = sdf.unit(sdf.gradient(field, verts, 0.0015))
    centre = verts[faces].mean(axis=1)
    flat = sdf.unit(np.cross(verts[faces[:, 1]] - verts[faces[:, 0]], verts[faces[:, 2]] - verts[faces[:, 0]]))
    if np.einsum("ij,ij->i", flat, sdf.gradient(field, centre)).mean() < 0.0:
        faces = faces[:, ::-1].copy()
        flat = -flat
    chart = _tidy_charts(part.charts(centre, flat), verts, faces)
    return Half(part.name, verts, faces, normals, chart, part.detail)


def build_all(all_bodies, all_ribbons, log=print):
    """`all_ribbons`: from the jacket's field to halves that bring their own uv."""
    halves = []
    for part in all_bodies:
        half = build(part)
        log(f"{part.name:9} {len(half.verts):5} vertices {len(half.faces):5} triangles (half)")
        halves.append(half)
    for half in all_ribbons(sdf.mirror_field(clothes.jacket_field)):
        log(f"{half.name:9} {len(half.verts):5} vertices {len(half.faces):5} triangles (half)")
        halves.append(half)
    return halves
