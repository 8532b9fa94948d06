"""Signed distance fields in numpy: the clay that the person is made of.

A field maps points, an array (n, 3) in metres, to distances (n,), negative
inside. Axes are glTF's: +x is the person's left, +y up, +z forward. Most fields
here are bounds of the true distance, not the distance itself: their zero set is
exact and `project` walks to it by Newton's method.
"""

import numpy as np


def vec(*xyz):
    return np.array(xyz, dtype=np.float64)


def length(v):
    return np.sqrt(np.einsum("...i,...i->...", v, v))


def unit(v):
    return v / np.maximum(length(v), 1e-12)[..., None]


def smoothstep(a, b, x):
    """0 at a, 1 at b, flat at both ends (a > b falls instead of rises)."""
    t = np.clip((x - a) / (b - a), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


def bump(x, centre, width):
    """A smooth hill: 1 at centre, 0 from width on."""
    t = np.clip(np.abs(x - centre) / width, 0.0, 1.0)
    return (1.0 - t * t) ** 2


def union(a, b, k=0.0):
    """The union, blended over the distance k (m)."""
    if k <= 0.0:
        return np.minimum(a, b)
    h = np.maximum(k - np.abs(a - b), 0.0) / k
    return np.minimum(a, b) - h * h * k * 0.25


def cut(a, b, k=0.0):
    """What of a is outside of b, the rim rounded over k (m)."""
    return -union(-a, b, k)


def both(a, b, k=0.0):
    """The intersection, its rim rounded over k (m)."""
    return -union(-a, -b, k)


def sphere(p, centre, radius):
    return length(p - centre) - radius


def ellipsoid(p, centre, radii, turn=None):
    """`turn`: a 3 x 3 matrix whose columns are the ellipsoid's axes."""
    q = p - centre
    if turn is not None:
        q = q @ turn
    radii = np.asarray(radii)
    k0 = length(q / radii)
    k1 = length(q / (radii * radii))
    return k0 * (k0 - 1.0) / np.maximum(k1, 1e-9)


def capsule(p, a, b, ra, rb=None):
    """A rod from a to b whose radius goes from ra to rb."""
    rb = ra if rb is None else rb
    ab = b - a
    t = np.clip((p - a) @ ab / (ab @ ab), 0.0, 1.0)
    return length(p - a - t[:, None] * ab) - (ra + (rb - ra) * t)


def chain(p, points, radii, k):
    """Rods from point to point, blended over k (m)."""
    d = None
    for i in range(len(points) - 1):
        c = capsule(p, points[i], points[i + 1], radii[i], radii[i + 1])
        d = c if d is None else union(d, c, k)
    return d


def box(p, centre, half, rounding, turn=None):
    """A box with rounded edges; `half` are its half sizes with the rounding."""
    q = p - centre
    if turn is not None:
        q = q @ turn
    q = np.abs(q) - (np.asarray(half) - rounding)
    return length(np.maximum(q, 0.0)) + np.minimum(q.max(axis=1), 0.0) - rounding


def curve(x, knots, values):
    """A smooth line through (knots, values): cubic Hermite with Catmull-Rom
    slopes, level beyond the ends."""
    knots = np.asarray(knots, dtype=np.float64)
    values = np.asarray(values, dtype=np.float64)
    slopes = np.gradient(values, knots)
    slopes[0] = slopes[-1] = 0.0
    x = np.clip(x, knots[0], knots[-1])
    i = np.clip(np.searchsorted(knots, x) - 1, 0, len(knots) - 2)
    w = knots[i + 1] - knots[i]
    t = (x - knots[i]) / w
    return ((1 + 2 * t) * (1 - t) ** 2 * values[i] + t * (1 - t) ** 2 * w * slopes[i]
            + t * t * (3 - 2 * t) * values[i + 1] - t * t * (1 - t) * w * slopes[i + 1])


def loft(u, v, w, sections, round_ends=0.01):
    """A body along u with superelliptic sections across it.

    `sections`: rows (u, centre v, centre w, radius v, radius w, exponent); 2 is
    an ellipse, larger is boxier.
    """
    s = np.asarray(sections, dtype=np.float64)
    cv, cw, rv, rw, n = (curve(u, s[:, 0], s[:, i]) for i in range(1, 6))
    qv, qw = v - cv, w - cw
    norm = (np.abs(qv / rv) ** n + np.abs(qw / rw) ** n + 1e-12) ** (1.0 / n)
    r = np.sqrt(qv * qv + qw * qw) + 1e-9
    side = r - r / norm
    ends = np.maximum(s[0, 0] - u, u - s[-1, 0])
    return both(side, ends, round_ends)


def frame_coords(p, origin, along, across):
    """p in the frame whose u axis is `along`; v is `across` made square to it."""
    u = along / np.linalg.norm(along)
    v = across - u * (across @ u)
    v = v / np.linalg.norm(v)
    w = np.cross(u, v)
    q = p - origin
    return q @ u, q @ v, q @ w


def gradient(field, p, eps=5e-4):
    """The field's slope by central differences."""
    g = np.empty_like(p)
    for axis in range(3):
        step = np.zeros(3)
        step[axis] = eps
        g[:, axis] = (field(p + step) - field(p - step)) / (2.0 * eps)
    return g


def project(field, p, steps=4):
    """The points moved onto the zero set."""
    p = p.copy()
    for _ in range(steps):
        g = gradient(field, p)
        d = field(p)
        move = d / np.maximum(np.einsum("ij,ij->i", g, g), 0.05)
        # A field that bends sharply can overshoot; no step is longer than 2 cm.
        move = np.clip(move, -0.02, 0.02)
        p -= g * move[:, None]
    return p


def mirror_field(field):
    """The field made symmetric in x."""
    def mirrored(p):
        q = p.copy()
        q[:, 0] = np.abs(q[:, 0])
        return field(q)
    return mirrored


# Noise from an integer hash: the same on every machine, with no state.

def _hash(ix, iy, iz, seed):
    h = (ix.astype(np.int64) * 374761393 + iy.astype(np.int64) * 668265263
         + iz.astype(np.int64) * 2147483647 + seed * 1274126177) & 0xFFFFFFFF
    h = ((h ^ (h >> 13)) * 1274126177) & 0xFFFFFFFF
    h = ((h ^ (h >> 16)) * 2246822519) & 0xFFFFFFFF
    return ((h ^ (h >> 15)) & 0xFFFF) / 65535.0


def noise(p, scale, seed=0):
    """Value noise in -1..1 with cells of `scale` (m, or one for each axis)."""
    q = p / np.asarray(scale)
    i = np.floor(q).astype(np.int64)
    f = q - i
    f = f * f * f * (f * (f * 6.0 - 15.0) + 10.0)
    total = 0.0
    for dx in (0, 1):
        for dy in (0, 1):
            for dz in (0, 1):
                w = ((f[:, 0] if dx else 1 - f[:, 0]) * (f[:, 1] if dy else 1 - f[:, 1])
                     * (f[:, 2] if dz else 1 - f[:, 2]))
                total = total + w * _hash(i[:, 0] + dx, i[:, 1] + dy, i[:, 2] + dz, seed)
    return total * 2.0 - 1.0


def fractal(p, scale, octaves=3, seed=0):
    """Sum of noises, each half as wide and half as strong, about -1..1."""
    total, weight = 0.0, 0.0
    for o in range(octaves):
        total = total + noise(p, np.asarray(scale) / 2.0 ** o, seed + o) / 2.0 ** o
        weight += 1.0 / 2.0 ** o
    return total / weight
