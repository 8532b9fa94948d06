"""The rucksack with its straps, and the rolled mat under its lid."""

import numpy as np

from sdf import box, bump, ellipsoid, fractal, union, vec

BACK = -0.145  # where the rucksack touches the jacket (z, m)


def body_field(p):
    d = box(p, vec(0, 1.215, BACK - 0.062), vec(0.128, 0.185, 0.078), 0.055)
    d = union(d, ellipsoid(p, vec(0, 1.130, BACK - 0.085), vec(0.115, 0.100, 0.075)), 0.05)
    # A front pocket, side pockets.
    d = union(d, box(p, vec(0, 1.165, BACK - 0.135), vec(0.088, 0.085, 0.034), 0.026), 0.012)
    d = union(d, box(p, vec(0.128, 1.125, BACK - 0.060), vec(0.026, 0.075, 0.050), 0.020), 0.012)
    folds = 0.0028 * fractal(p, (0.05, 0.06, 0.05), 2, 61)
    seams = 0.0020 * bump(np.abs(p[:, 0]), 0.100, 0.004) * (p[:, 2] < BACK - 0.10)
    return d + folds + seams


def lid_field(p):
    d = box(p, vec(0, 1.405, BACK - 0.060), vec(0.124, 0.042, 0.094), 0.034)
    # It droops over the front.
    d = union(d, box(p, vec(0, 1.375, BACK - 0.128), vec(0.106, 0.045, 0.028), 0.020), 0.03)
    return d + 0.0022 * fractal(p, (0.05, 0.04, 0.05), 2, 65)


ROLL_Y, ROLL_Z = 0.985, BACK - 0.070


def roll_field(p):
    q = np.sqrt((p[:, 1] - ROLL_Y) ** 2 + (p[:, 2] - ROLL_Z) ** 2)
    end = np.abs(p[:, 0]) - 0.160
    side = q - 0.056
    d = -union(-side, -end, 0.012)
    # Two straps hold it.
    return d + 0.0045 * bump(p[:, 0], 0.085, 0.022)


def strap_points():
    """The left shoulder strap, from the top of the back over the shoulder to the ribs."""
    return [vec(0.060, 1.425, -0.150), vec(0.078, 1.482, -0.095), vec(0.092, 1.492, -0.030),
            vec(0.102, 1.462, 0.048), vec(0.108, 1.395, 0.108), vec(0.122, 1.300, 0.128),
            vec(0.150, 1.200, 0.095), vec(0.168, 1.140, 0.020), vec(0.150, 1.100, -0.080),
            vec(0.120, 1.080, -0.150)]


def hip_belt_points():
    return [vec(0.110, 1.030, -0.150), vec(0.155, 1.020, -0.085), vec(0.178, 1.010, 0.0),
            vec(0.150, 1.002, 0.078), vec(0.090, 0.998, 0.122), vec(0.0, 0.996, 0.134)]


def hidden(p):
    """What lies against the back."""
    return (p[:, 2] > BACK + 0.008) & (np.abs(p[:, 0]) < 0.10)
