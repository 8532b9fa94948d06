"""Hands and boots."""

import numpy as np

import skeleton as sk
from sdf import (both, bump, capsule, chain, curve, cut, ellipsoid, loft, smoothstep,
                 union, vec)


def hand_coords(p):
    """Along the hand, towards the thumb, out of the palm; from the wrist."""
    q = p - sk.WRIST
    return q @ sk.HAND_ALONG, q @ sk.HAND_THUMB, q @ sk.HAND_PALM


FINGER_RADII = {
    "index": (0.0094, 0.0087, 0.0079, 0.0068),
    "middle": (0.0096, 0.0089, 0.0081, 0.0069),
    "ring": (0.0093, 0.0085, 0.0077, 0.0066),
    "little": (0.0084, 0.0077, 0.0071, 0.0061),
}


def _shorter(points, radii):
    """The same joints with the last one drawn back by its radius, so that the tip
    of the flesh is the tip of the bone."""
    last = points[-1] - points[-2]
    return points[:-1] + [points[-1] - last / np.linalg.norm(last) * radii[-1]]


def hand_field(p):
    u, t, n = hand_coords(p)
    palm = loft(u, t, n, [
        (-0.060, 0.000, 0.000, 0.0285, 0.0225, 2.0),
        (0.000, 0.000, 0.000, 0.0280, 0.0200, 2.2),
        (0.030, 0.001, 0.001, 0.0360, 0.0180, 2.3),
        (0.065, 0.000, 0.001, 0.0410, 0.0150, 2.5),
        (0.092, -0.001, 0.000, 0.0405, 0.0120, 2.6)], 0.010)
    fingers = None
    for name, radii in FINGER_RADII.items():
        points = sk.FINGERS[name]
        root = points[0] - 0.030 * sk.HAND_ALONG
        f = chain(p, [root] + _shorter(points, radii), (radii[0],) + radii, 0.004)
        fingers = f if fingers is None else union(fingers, f, 0.0010)
    d = union(palm, fingers, 0.009)
    radii = (0.0150, 0.0118, 0.0102, 0.0080)
    thumb = chain(p, _shorter(sk.THUMB, radii), radii, 0.006)
    ball = ellipsoid(p, sk.hand_point(0.038, 0.026, 0.013), vec(0.020, 0.027, 0.018))
    d = union(d, union(thumb, ball, 0.012), 0.012)
    heel = capsule(p, sk.hand_point(0.018, -0.018, 0.008), sk.hand_point(0.062, -0.026, 0.006), 0.0125)
    d = union(d, heel, 0.012)
    for name in FINGER_RADII:
        knuckle = sk.FINGERS[name][0] - sk.HAND_PALM * 0.0035
        d = union(d, ellipsoid(p, knuckle, vec(0.0085, 0.0085, 0.0085)), 0.006)
    # Webs: hollows of the palm.
    return cut(d, ellipsoid(p, sk.hand_point(0.055, -0.002, 0.026), vec(0.016, 0.022, 0.016)), 0.012)


def hand_hidden(p):
    return hand_coords(p)[0] < -0.034


# Boots. The outline of the sole: z, centre x (from the ankle's), half width.
_SOLE = [(-0.088, 0.000, 0.012), (-0.078, 0.000, 0.030), (-0.045, 0.000, 0.0395), (0.010, 0.002, 0.0390),
         (0.070, 0.004, 0.0445), (0.125, 0.005, 0.0510), (0.165, 0.003, 0.0480), (0.200, -0.002, 0.0350),
         (0.2155, -0.004, 0.0140)]
BOOT_X = float(sk.ANKLE[0])


def sole_field(p):
    z = p[:, 2]
    s = np.array(_SOLE)
    centre, half = curve(z, s[:, 0], s[:, 1]), curve(z, s[:, 0], s[:, 2])
    ends = np.maximum(s[0, 0] - z, z - s[-1, 0])
    outline = both(np.abs(p[:, 0] - BOOT_X - centre) - half, ends, 0.02)
    # Flat on the ground; the toe springs up a little, the heel is a block of its own.
    bottom = 0.012 * smoothstep(0.15, 0.216, z) ** 2 + 0.011 * smoothstep(-0.071, -0.092, z)
    arch = 0.010 * bump(z, 0.030, 0.030)
    # Lugs at the sole's edge.
    lugs = 0.0022 * smoothstep(0.25, 0.45, np.abs(((z / 0.021) % 1.0) - 0.5)) * smoothstep(0.017, 0.013, p[:, 1])
    d = both(outline + lugs, np.maximum(bottom + arch - p[:, 1], p[:, 1] - 0.034 - 0.7 * bottom), 0.005)
    return d


def _upper(p):
    # Along z, with the height of the boot's back and its half width.
    z = p[:, 2]
    x = p[:, 0] - BOOT_X
    top = curve(z, [-0.09, -0.05, 0.00, 0.045, 0.090, 0.130, 0.170, 0.205],
                [0.085, 0.105, 0.118, 0.112, 0.090, 0.072, 0.064, 0.045])
    half = curve(z, [-0.085, -0.05, 0.0, 0.07, 0.125, 0.165, 0.200, 0.212],
                 [0.022, 0.0345, 0.0350, 0.0400, 0.0465, 0.0440, 0.0320, 0.0150])
    centre = curve(z, [-0.09, 0.07, 0.125, 0.20], [0.0, 0.004, 0.005, -0.003])
    y0 = 0.020
    h = np.clip((p[:, 1] - y0) / (top - y0), 0.0, None)
    q = (np.abs((x - centre) / half) ** 2.3 + h ** 2.6 + 1e-9) ** (1 / 2.45)
    body = (q - 1.0) * np.minimum(half, top - y0) * 0.8
    body = both(body, y0 - p[:, 1], 0.004)
    body = both(body, np.maximum(-0.083 - z, z - 0.209), 0.02)
    shaft = loft(p[:, 1], x, z, [
        (0.060, 0, -0.022, 0.0400, 0.0560, 2.0), (0.100, 0, -0.014, 0.0430, 0.0560, 2.0),
        (0.150, 0, -0.012, 0.0470, 0.0560, 2.0), (0.200, 0, -0.014, 0.0510, 0.0580, 2.0)], 0.006)
    d = union(body, shaft, 0.030)
    heel = ellipsoid(p, vec(BOOT_X, 0.062, -0.050), vec(0.034, 0.040, 0.033))
    return union(d, heel, 0.02)


def lacing(p):
    """Distance ahead of the boot's front line, for the tongue and laces (m)."""
    return np.abs(p[:, 0] - BOOT_X - 0.003)


def boot_field(p):
    d = _upper(p)
    # The rand of rubber above the sole, the padded collar, the tongue with laces.
    rand = 0.0026 * smoothstep(0.054, 0.050, p[:, 1] - 0.012 * smoothstep(0.12, 0.18, p[:, 2]))
    d = d - rand
    collar = 0.0060 * bump(p[:, 1], 0.180, 0.030)
    d = d - collar
    on_top = smoothstep(0.015, 0.035, p[:, 2]) * smoothstep(0.150, 0.135, p[:, 2])
    d = d + 0.0030 * smoothstep(0.0150, 0.0125, lacing(p)) * on_top
    for i in range(6):
        z = 0.040 + 0.0165 * i
        y = 0.128 - 0.0115 * i if i else 0.134
        for side in (-1, 1):
            a = vec(BOOT_X + 0.003 - 0.019, y, z)
            b = vec(BOOT_X + 0.003 + 0.019, y, z)
            shift = vec(0, 0.0, 0.008 * side)
            d = union(d, capsule(p, a - shift + vec(0, -0.012, 0), b + shift + vec(0, -0.012, 0), 0.0028), 0.002)
    return union(d, sole_field(p), 0.004)


def boot_hidden(p):
    return p[:, 1] > 0.192
