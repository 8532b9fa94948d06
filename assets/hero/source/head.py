"""The head: skull, face, ears, neck, hair; and the knitted hat on it."""

import numpy as np

from sdf import (bump, capsule, chain, cut, ellipsoid, both, fractal, smoothstep,
                 sphere, union, vec)

EYE = vec(0.0315, 1.6640, 0.0665)
EYE_RADIUS = 0.0128
SKULL = vec(0.0, 1.6830, -0.0120)
SKULL_RADII = vec(0.0770, 0.0970, 0.0985)


def lid_gap(p):
    """How far a point is above the lower and below the upper lid's edge (m)."""
    s = (p[:, 0] - EYE[0]) / 0.0150
    arch = np.clip(1.0 - s * s, 0.0, 1.0)
    beyond = 0.020 * np.clip(np.abs(s) - 0.97, 0.0, 1.0)
    # The outer corner sits a little higher than the inner one.
    line = EYE[1] - 0.0004 + 0.0016 * s
    upper = line - beyond + 0.0046 * arch ** 0.75
    lower = line + beyond - 0.0042 * arch ** 0.85
    return np.minimum(upper - p[:, 1], p[:, 1] - lower)


def mouth_line(x):
    """Height of the line between the lips, x from the middle (m)."""
    return 1.5922 + 4.4 * x * x


def _face(p, fine):
    """Slits and folds narrower than the mesh's edges are in the fine version alone."""
    d = ellipsoid(p, SKULL, SKULL_RADII)
    # Forehead and temples: the skull is flatter at the sides than an egg.
    d = union(d, ellipsoid(p, vec(0, 1.690, 0.030), vec(0.064, 0.060, 0.058)), 0.03)
    # The middle of the face, cheeks, jaw and chin.
    d = union(d, ellipsoid(p, vec(0, 1.620, 0.034), vec(0.054, 0.070, 0.053)), 0.035)
    d = union(d, ellipsoid(p, vec(0.040, 1.637, 0.044), vec(0.024, 0.020, 0.026)), 0.022)
    jaw = chain(p, [vec(0.0555, 1.632, -0.006), vec(0.0480, 1.595, 0.012), vec(0.020, 1.563, 0.066)],
                [0.016, 0.016, 0.0165], 0.02)
    d = union(d, jaw, 0.026)
    d = union(d, ellipsoid(p, vec(0, 1.564, 0.0735), vec(0.021, 0.0165, 0.0165)), 0.018)
    # Mouth region: the teeth push the lips forward.
    d = union(d, ellipsoid(p, vec(0, 1.594, 0.064), vec(0.031, 0.024, 0.026)), 0.016)
    # Sockets, brow ridge.
    d = cut(d, ellipsoid(p, EYE + vec(0.001, 0.0025, 0.0250), vec(0.0215, 0.0135, 0.0170)), 0.020)
    brow = chain(p, [vec(0.008, 1.6815, 0.0800), vec(0.026, 1.6865, 0.0765), vec(0.047, 1.6790, 0.0560)],
                 [0.0060, 0.0068, 0.0060], 0.01)
    d = union(d, brow, 0.014)
    # Nose: bridge, tip, wings.
    nose = chain(p, [vec(0, 1.6760, 0.0800), vec(0, 1.6520, 0.0940), vec(0, 1.6285, 0.1055)],
                 [0.0064, 0.0066, 0.0084], 0.01)
    d = union(d, nose, 0.013)
    d = union(d, sphere(p, vec(0, 1.6265, 0.1065), 0.0088), 0.008)
    d = union(d, ellipsoid(p, vec(0.0102, 1.6228, 0.0955), vec(0.0064, 0.0062, 0.0092)), 0.0055)
    if fine:
        d = cut(d, ellipsoid(p, vec(0.0066, 1.6165, 0.1015), vec(0.0036, 0.0035, 0.0050)), 0.003)
    # Groove from the nose to the lip.
    d = cut(d, capsule(p, vec(0, 1.6140, 0.0985), vec(0, 1.6040, 0.0975), 0.0032), 0.006)
    # Lips, and the line between them: a shallow smile.
    def lip(points, radii):
        return chain(p, [vec(x, mouth_line(x) + dy, z) for x, dy, z in points], radii, 0.006)
    upper = lip([(0, 0.0046, 0.0878), (0.009, 0.0046, 0.0862), (0.0185, 0.0022, 0.0800), (0.0265, 0.0004, 0.0715)],
                [0.0040, 0.0040, 0.0030, 0.0018])
    lower = lip([(0, -0.0050, 0.0868), (0.010, -0.0045, 0.0850), (0.0185, -0.0026, 0.0800), (0.0255, -0.0006, 0.0722)],
                [0.0052, 0.0048, 0.0036, 0.0020])
    d = union(d, union(upper, lower, 0.0015), 0.005)
    slit = lip([(0, 0, 0.0935), (0.010, 0, 0.0915), (0.0190, 0, 0.0850), (0.0262, 0, 0.0770)],
               [0.0014, 0.0013, 0.0011, 0.0006])
    if fine:
        d = cut(d, slit, 0.0022)
    d = cut(d, capsule(p, vec(0, 1.5772, 0.0925), vec(0.010, 1.5780, 0.0895), 0.0035), 0.008)
    # Lids: a shell about the eye with an almond cut into it.
    shell = both(sphere(p, EYE, EYE_RADIUS + 0.0020), -sphere(p, EYE, EYE_RADIUS - 0.004), 0.001)
    front = both(shell, EYE[2] - 0.002 - p[:, 2], 0.002)
    d = union(d, front, 0.0065)
    gap = both(-lid_gap(p), EYE[2] + 0.001 - p[:, 2])  # negative inside of the gap
    opening = both(gap, sphere(p, EYE, EYE_RADIUS + 0.02))
    d = cut(d, opening, 0.0016)
    # The fold of the upper lid.
    s = (p[:, 0] - EYE[0]) / 0.0165
    fold_y = EYE[1] + 0.0022 + 0.0066 * np.clip(1 - s * s, 0, 1) ** 0.6
    fold = bump(p[:, 1], fold_y, 0.0022) * smoothstep(1.1, 0.6, np.abs(s)) * (p[:, 2] > 0.04)
    return d + 0.0011 * fold if fine else d


def _ear(p):
    tilt = 0.22
    turn = np.array([[1, 0, 0], [0, np.cos(tilt), -np.sin(tilt)], [0, np.sin(tilt), np.cos(tilt)]])
    splay = 0.36
    turn = np.array([[np.cos(splay), 0, -np.sin(splay)], [0, 1, 0], [np.sin(splay), 0, np.cos(splay)]]) @ turn
    centre = vec(0.0815, 1.6480, -0.0120)
    q = (p - centre) @ turn
    d = ellipsoid(q, vec(0, 0, 0), vec(0.0075, 0.0300, 0.0172))
    d = union(d, ellipsoid(q, vec(-0.002, -0.022, 0.004), vec(0.006, 0.012, 0.010)), 0.006)
    d = cut(d, ellipsoid(q, vec(0.0095, 0.004, 0.002), vec(0.0068, 0.0190, 0.0100)), 0.004)
    d = union(d, ellipsoid(q, vec(-0.001, -0.003, 0.013), vec(0.0045, 0.006, 0.004)), 0.004)
    return d


def _neck(p):
    d = chain(p, [vec(0, 1.440, -0.036), vec(0, 1.520, -0.026), vec(0, 1.610, -0.018)],
              [0.064, 0.0565, 0.054], 0.03)
    # The muscle from behind the ear to the collar bone, and the larynx.
    d = union(d, capsule(p, vec(0.052, 1.615, -0.018), vec(0.014, 1.470, 0.026), 0.011, 0.010), 0.03)
    return union(d, sphere(p, vec(0, 1.520, 0.0275), 0.010), 0.02)


def hair_amount(p):
    """0 on skin, 1 where the hair is full: temples, above the ears, nape."""
    angle = np.arctan2(np.abs(p[:, 0]), p[:, 2] + 0.012)  # 0 in front, pi behind
    line = np.interp(angle, [0.0, 0.75, 1.05, 1.22, 1.36, 1.50, 2.00, 2.5, np.pi],
                     [1.735, 1.725, 1.700, 1.662, 1.658, 1.692, 1.640, 1.588, 1.574])
    ragged = 0.004 * fractal(p, (0.006, 0.03, 0.006), 2, 11)
    return smoothstep(-0.002, 0.007, p[:, 1] - line + ragged)


def head_field(p, fine=False):
    d = union(_face(p, fine), _neck(p), 0.022)
    hair = hair_amount(p)
    locks = fractal(p, (0.010, 0.045, 0.010), 2, 3) if fine else 0.0
    d = d - hair * (0.0060 + 0.0022 * locks)
    return union(d, _ear(p), 0.006)


def head_fine(p):
    return head_field(p, True)


def eye_field(p):
    return sphere(p, EYE, EYE_RADIUS)


# The hat sits tilted back: low behind, higher on the forehead.

def height_in_hat(p):
    """Metres above the hat's lower edge, along its tilted axis."""
    return (p[:, 1] - 1.7040) * 0.977 - (p[:, 2] - 0.0) * 0.215


def _hat_body(p, swell):
    d = ellipsoid(p, SKULL + vec(0, 0.006, -0.004), SKULL_RADII + vec(swell, 0.017 + swell, swell + 0.001))
    return d


def hat_rib(p):
    """Height of the knitted ribs, 0 to 1, and the way around the hat in ribs."""
    angle = np.arctan2(p[:, 0], p[:, 2] + 0.012)
    ribs = angle * 30.0 / np.pi
    return 0.5 + 0.5 * np.cos(ribs * 2.0 * np.pi), ribs


def hat_field(p):
    h = height_in_hat(p)
    body = _hat_body(p, 0.0115)
    # A slack fold behind and at the top.
    body = body - 0.0030 * fractal(p, 0.05, 2, 21) * smoothstep(0.04, 0.08, h)
    body = both(body, -h, 0.004)
    cuff = _hat_body(p, 0.0180)
    cuff = both(cuff, np.abs(h - 0.0225) - 0.0255, 0.010)
    return union(body, cuff, 0.004)


def hat_cuff(p):
    """1 on the turned-up cuff."""
    return smoothstep(0.0495, 0.0470, height_in_hat(p))


def head_hidden(p):
    """Inside of hat or collar, where no camera looks."""
    under_hat = (height_in_hat(p) > 0.014) & (_hat_body(p, 0.0) < 0.006)
    behind_eye = sphere(p, EYE, EYE_RADIUS) < -0.0010
    return under_hat | behind_eye | (p[:, 1] < 1.490)
