"""What the looks of all parts share: mixing, mottling, lines and weave.

Colours are linear reflectances. Heights are metres outwards.
"""

import numpy as np

from sdf import fractal, smoothstep


def mix(a, b, share):
    return a + (np.asarray(b) - a) * share[:, None]


def flat(p, colour):
    return np.tile(np.asarray(colour, dtype=float), (len(p), 1))


def mottle(p, colour, strength, scale=0.03, seed=1):
    return flat(p, colour) * (1.0 + strength * fractal(p, scale, 3, seed))[:, None]


def nothing(p):
    return np.zeros(len(p))


def both_sides(p):
    q = p.copy()
    q[:, 0] = np.abs(q[:, 0])
    return q


def line(d, width):
    """1 on a line of that half width (m), d the distance from it."""
    return smoothstep(width, 0.4 * width, np.abs(d))


def weave(p, n_scale=0.0042):
    """A coarse cloth: two sets of threads along the body's own slant."""
    a = p[:, 1] / n_scale
    b = (p[:, 0] * 0.9 + p[:, 2] * 1.1) / n_scale
    return np.sin(a * np.pi) * np.sin(b * np.pi)
