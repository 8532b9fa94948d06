"""The crossbow that a soldier holds in the right hand: tubes along lines, bound to that hand.

It is made for the left hand, whose frame the skeleton has, and mirrored. Its axes are: forward, where the bolt
flies; up, out of the stock's upper side; aside, along the bow.
"""

import math

import numpy as np

import sdf
import skeleton as sk
from parts import Half
from sdf import unit, vec

# Where the fist closes around the stock.
GRIP = sk.hand_point(0.078, 0.004, 0.024)
_A = math.radians(16.0)
FORWARD = unit(math.cos(_A) * sk.HAND_ALONG + math.sin(_A) * sk.HAND_THUMB)
UP = unit(math.cos(_A) * sk.HAND_THUMB - math.sin(_A) * sk.HAND_ALONG)
ASIDE = np.cross(UP, FORWARD)

BUTT = -0.285     # ends of the stock, forward of the grip (m)
MUZZLE = 0.375
NUT = 0.105       # where the drawn string lies
SUPPORT = 0.215   # where the other hand is
BOW = 0.300       # half width of the bow


def place(forward, up=0.0, aside=0.0):
    """A point of the weapon, metres from the grip, in the rest pose of the left hand."""
    return GRIP + forward * FORWARD + up * UP + aside * ASIDE


def coords(p):
    q = p - GRIP
    return q @ FORWARD, q @ UP, q @ ASIDE


class Tubes:
    """A mesh of tubes with caps, each with texture coordinates in metres."""

    def __init__(self):
        self.verts, self.faces, self.normals, self.chart, self.uv = [], [], [], [], []
        self.count, self.charts = 0, 0

    def tube(self, centres, wide, high, across, sides=8, square=2.0, closed=False):
        """Rings of half sizes `wide` along `across` and `high` square to it; `square` 2 is round, more is boxier."""
        centres = np.array(centres, dtype=float)
        n = len(centres)
        wide, high = np.broadcast_to(wide, n), np.broadcast_to(high, n)
        along = np.roll(centres, -1, 0) - np.roll(centres, 1, 0) if closed else np.gradient(centres, axis=0)
        along = unit(along)
        x = unit(across - along * (along @ across)[:, None])
        y = np.cross(along, x)
        a = 2 * math.pi * np.arange(sides) / sides + math.pi / sides
        c, s = np.cos(a), np.sin(a)
        k = (np.abs(c) ** square + np.abs(s) ** square) ** (-1.0 / square)
        c, s = c * k, s * k
        rings = (centres[:, None] + x[:, None] * (c[None] * wide[:, None])[..., None]
                 + y[:, None] * (s[None] * high[:, None])[..., None])
        nx, ny = np.sign(c) * np.abs(c) ** (square - 1), np.sign(s) * np.abs(s) ** (square - 1)
        out = unit(x[:, None] * (nx[None] / wide[:, None])[..., None] + y[:, None] * (ny[None] / high[:, None])[..., None])
        steps = np.diff(centres, axis=0, append=centres[:1] if closed else centres[-1:])
        v = np.concatenate([[0.0], np.cumsum(sdf.length(steps))])
        around = 2 * math.pi * float(np.mean(wide + high)) / 2 / sides
        start = self.count
        at = lambda i, j: start + (i % n) * sides + j % sides
        for i in range(n if closed else n - 1):
            for j in range(sides):
                p, q, r, t = at(i, j), at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)
                up, uq = (j * around, v[i]), ((j + 1) * around, v[i])
                ur, ut = (j * around, v[i + 1]), ((j + 1) * around, v[i + 1])
                self.faces += [(p, q, r), (q, t, r)]
                self.uv += [(up, uq, ur), (uq, ut, ur)]
                self.chart += [self.charts] * 2
        self.verts.append(rings.reshape(-1, 3))
        self.normals.append(out.reshape(-1, 3))
        self.count += n * sides
        self.charts += 1
        if not closed:
            for end, sign in ((0, -1.0), (n - 1, 1.0)):
                self._cap(rings[end], centres[end], along[end] * sign, c * wide[end], s * high[end], sign > 0)

    def _cap(self, ring, centre, normal, u, v, forward):
        sides = len(ring)
        start = self.count
        self.verts.append(np.concatenate([ring, centre[None]]))
        self.normals.append(np.tile(normal, (sides + 1, 1)))
        for j in range(sides):
            k = (j + 1) % sides
            a, b = ((u[j], v[j]), (u[k], v[k]))
            face, flat = ((start + j, start + k, start + sides), (a, b, (0.0, 0.0)))
            self.faces.append(face if forward else face[::-1])
            self.uv.append(flat if forward else flat[::-1])
            self.chart.append(self.charts)
        self.count += sides + 1
        self.charts += 1

    def half(self, name, detail):
        return Half(name, np.concatenate(self.verts), np.array(self.faces), np.concatenate(self.normals),
                    np.array(self.chart), detail, np.array(self.uv, dtype=float), True, True)


def _bow(t):
    """The bow's line at t in -1..1, bent back as it is while the string is drawn."""
    return place(MUZZLE - 0.020 - 0.105 * t * t, 0.006, BOW * math.copysign(abs(t) ** 1.04, t))


def halves():
    tubes = Tubes()
    # The stock: slim at the grip, a cheek at the butt.
    f = [BUTT, -0.20, -0.08, 0.0, 0.10, 0.24, MUZZLE]
    tubes.tube([place(x, u) for x, u in zip(f, [-0.030, -0.022, -0.006, 0.0, 0.003, 0.004, 0.004])],
               np.array([0.013, 0.015, 0.014, 0.0145, 0.018, 0.018, 0.016]),
               np.array([0.030, 0.026, 0.018, 0.0165, 0.020, 0.019, 0.017]), ASIDE, 8, 3.2)
    t = np.linspace(-1.0, 1.0, 15)
    thick = 0.0105 - 0.0045 * t * t
    tubes.tube([_bow(x) for x in t], thick * 0.75, thick * 1.25, FORWARD, 6)
    # The string, from tip to nut to tip.
    tip = 0.985
    nut = place(NUT, 0.026)
    string = [_bow(-tip), 0.5 * (_bow(-tip) + nut), nut - 0.012 * ASIDE, nut + 0.012 * ASIDE,
              0.5 * (_bow(tip) + nut), _bow(tip)]
    tubes.tube(string, 0.0032, 0.0032, UP, 5)
    # The bolt on its groove, with a head.
    tubes.tube([place(x, 0.0275) for x in (NUT + 0.006, 0.25, 0.40, 0.408, 0.436)],
               np.array([0.0045, 0.0045, 0.0045, 0.0075, 0.0012]), np.array([0.0045, 0.0045, 0.0045, 0.0075, 0.0012]),
               ASIDE, 6)
    tubes.tube([place(x, 0.0275) for x in (NUT + 0.012, NUT + 0.062)], 0.0135, 0.0010, ASIDE, 4)
    # Lever, and the stirrup that a foot goes into to draw it.
    tubes.tube([place(x, u) for x, u in ((0.050, -0.016), (0.030, -0.032), (-0.05, -0.044), (-0.150, -0.062))],
               0.0052, 0.0052, ASIDE, 6)
    ring = [place(MUZZLE + 0.030 + 0.038 * math.cos(a), 0.004, 0.036 * math.sin(a))
            for a in np.linspace(0, 2 * math.pi, 14, endpoint=False)]
    tubes.tube(ring, 0.0042, 0.0042, UP, 5, closed=True)
    return [tubes.half("crossbow", 0.9)]
