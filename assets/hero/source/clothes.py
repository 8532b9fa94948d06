"""The jacket with collar and hem, and the trousers."""

import numpy as np

import skeleton as sk
from sdf import (both, bump, capsule, chain, cut, ellipsoid, fractal, frame_coords, loft,
                 noise, smoothstep, union, vec)

HEM = 0.808
CUFF_U = sk.FOREARM - 0.006  # along the forearm, from the elbow
# The jacket's body: y, centre x, centre z, radius x, radius z, exponent.
TORSO = [
    (HEM - 0.004, 0, -0.006, 0.1860, 0.1380, 2.3),
    (0.850, 0, -0.006, 0.1920, 0.1440, 2.35),
    (0.920, 0, -0.008, 0.1890, 0.1440, 2.35),
    (1.000, 0, -0.004, 0.1760, 0.1320, 2.3),
    (1.080, 0, 0.002, 0.1660, 0.1230, 2.3),
    (1.180, 0, 0.004, 0.1700, 0.1260, 2.3),
    (1.280, 0, 0.000, 0.1800, 0.1330, 2.35),
    (1.350, 0, -0.008, 0.1790, 0.1280, 2.4),
    (1.410, 0, -0.018, 0.1580, 0.1080, 2.3),
    (1.455, 0, -0.026, 0.1100, 0.0840, 2.1),
    (1.490, 0, -0.028, 0.0780, 0.0700, 2.0),
]


def upper_arm_coords(p):
    return frame_coords(p, sk.SHOULDER, sk.ARM_DIR, vec(0, 0, 1))


def forearm_coords(p):
    return frame_coords(p, sk.ELBOW, sk.FOREARM_DIR, vec(0, 0, 1))


def sleeve_folds(p):
    """Folds across the sleeve: pushed together at the elbow and above the cuff."""
    u, v, w = forearm_coords(p)
    phase = 2.2 * noise(p, 0.06, 5)
    inner = smoothstep(-0.03, 0.04, v)  # the crook of the elbow is in front
    elbow = bump(u, 0.0, 0.085) * (0.35 + 0.65 * inner) * np.sin(u / 0.0062 * 0.9 + phase * 2.0 + 12.0 * w)
    wrist = bump(u, CUFF_U - 0.062, 0.065) * np.sin(u / 0.0050 + phase * 2.5 + 25.0 * w)
    pit = ellipsoid(p, sk.SHOULDER + vec(-0.005, -0.085, 0.0), vec(0.07, 0.08, 0.10))
    s = (p - sk.SHOULDER) @ vec(0.80, 0.60, 0.0)
    armpit = smoothstep(0.03, -0.02, pit) * np.sin(s / 0.0075 + 2.0 * phase)
    return 0.0034 * elbow + 0.0030 * wrist + 0.0026 * armpit


def torso_folds(p):
    phase = 2.5 * noise(p, 0.09, 9)
    sag = bump(p[:, 1], HEM + 0.085, 0.07) * np.sin(p[:, 1] / 0.0085 + 1.6 * phase)
    waist = bump(p[:, 1], 1.06, 0.13) * np.sin(p[:, 1] / 0.0115 + 14.0 * np.abs(p[:, 0]) + 2.0 * phase)
    broad = fractal(p, (0.05, 0.10, 0.05), 2, 15)
    return 0.0030 * sag + 0.0030 * waist + 0.0022 * broad


def trunk_field(p):
    """The trunk without the slopes of the shoulders."""
    d = loft(p[:, 1], p[:, 0], p[:, 2], TORSO, 0.012)
    # Shoulder blades, chest.
    d = union(d, ellipsoid(p, vec(0.085, 1.335, 0.060), vec(0.082, 0.062, 0.050)), 0.05)
    return union(d, ellipsoid(p, vec(0.085, 1.345, -0.075), vec(0.080, 0.090, 0.055)), 0.05)


def _torso(p):
    d = trunk_field(p)
    # From the neck over the collar bone to the shoulder.
    slope = chain(p, [vec(0.035, 1.470, -0.030), vec(0.105, 1.438, -0.026), sk.SHOULDER + vec(-0.01, -0.006, 0)],
                  [0.058, 0.055, 0.060], 0.04)
    return union(d, slope, 0.05)


def sleeve_field(p):
    d = chain(p, [sk.SHOULDER + vec(-0.004, -0.004, 0.0), sk.SHOULDER + 0.10 * sk.ARM_DIR,
                  sk.SHOULDER + 0.22 * sk.ARM_DIR, sk.ELBOW + vec(0, 0, -0.004),
                  sk.ELBOW + 0.09 * sk.FOREARM_DIR, sk.ELBOW + 0.20 * sk.FOREARM_DIR,
                  sk.ELBOW + (CUFF_U - 0.02) * sk.FOREARM_DIR],
              [0.0630, 0.0605, 0.0540, 0.0505, 0.0505, 0.0450, 0.0420], 0.03)
    # The gathered cuff.
    u, v, w = forearm_coords(p)
    r = np.sqrt(v * v + w * w)
    d = both(d, u - CUFF_U + 0.028, 0.006)
    cuff = both(r - 0.0405 - 0.0012 * np.cos(np.arctan2(v, w) * 20.0), np.abs(u - CUFF_U + 0.012) - 0.022, 0.008)
    return union(d, cuff, 0.006)


def jacket_field(p):
    d = union(_torso(p), sleeve_field(p), 0.055)
    d = d + torso_folds(p) * smoothstep(0.24, 0.20, p[:, 0]) + sleeve_folds(p)
    # The hem: a tunnel with a cord, drawn in a little.
    hem = loft(p[:, 1], p[:, 0], p[:, 2], [
        (HEM - 0.012, 0, -0.006, 0.1860, 0.1380, 2.3), (HEM + 0.010, 0, -0.006, 0.1930, 0.1450, 2.3),
        (HEM + 0.026, 0, -0.006, 0.1900, 0.1420, 2.3)], 0.010)
    hem = hem + 0.0010 * np.sin(np.arctan2(p[:, 0], p[:, 2]) * 34.0)
    d = union(d, hem, 0.006)
    # The zip under its flap, from hem to throat, and the slanted pockets.
    front = p[:, 2] > 0.02
    d = d - 0.0030 * smoothstep(0.016, 0.0135, np.abs(p[:, 0])) * front * (p[:, 1] < 1.47)
    d = d - 0.0018 * pocket_flap(p)
    return d


def pocket_flap(p):
    """1 on the two hand pockets' welts."""
    across = (p[:, 0] - 0.122) * 0.94 + (p[:, 1] - 0.918) * 0.34
    along = (p[:, 1] - 0.918) * 0.94 - (p[:, 0] - 0.122) * 0.34
    return (smoothstep(0.012, 0.0095, np.abs(across)) * smoothstep(0.058, 0.055, np.abs(along))
            * (p[:, 2] > 0.02))


def jacket_hidden(p):
    """The closed bottom under the hem, inside of sleeve ends and collar."""
    u, v, w = forearm_coords(p)
    in_cuff = (u > CUFF_U - 0.02) & (np.sqrt(v * v + w * w) < 0.028)
    bottom = (p[:, 1] < HEM + 0.012) & (loft(np.full(len(p), 0.85), p[:, 0], p[:, 2], TORSO) < -0.022)
    inner = (np.sqrt(p[:, 0] ** 2 + (p[:, 2] + 0.026) ** 2) < 0.066) & (p[:, 1] > 1.40)
    return in_cuff | bottom | inner


# Trousers: y, centre x, centre z, radius x, radius z, exponent, for the left leg.
LEG = [
    (0.112, 0.0965, -0.010, 0.0700, 0.0790, 2.0),
    (0.150, 0.0965, -0.011, 0.0690, 0.0770, 2.0),
    (0.220, 0.0960, -0.012, 0.0660, 0.0730, 2.0),
    (0.330, 0.0950, -0.015, 0.0680, 0.0745, 2.0),
    (0.420, 0.0940, -0.010, 0.0670, 0.0730, 2.1),
    (0.525, 0.0930, 0.004, 0.0690, 0.0745, 2.1),
    (0.620, 0.0935, 0.003, 0.0760, 0.0830, 2.1),
    (0.760, 0.0930, 0.000, 0.0885, 0.0980, 2.1),
    (0.870, 0.0850, -0.004, 0.0890, 0.1060, 2.1),
    (0.960, 0.0740, -0.006, 0.0880, 0.1060, 2.1),
]


def _leg_folds(p):
    phase = 2.2 * noise(p, 0.07, 41)
    y = p[:, 1]
    knee_back = bump(y, 0.525, 0.11) * smoothstep(0.04, -0.04, p[:, 2]) * np.sin(y / 0.0078 + 2.0 * phase)
    ankle = bump(y, 0.205, 0.085) * np.sin(y / 0.0072 + 2.6 * phase + 16.0 * p[:, 0])
    groin = bump(y, 0.845, 0.08) * np.sin(y / 0.0090 - 45.0 * p[:, 0] + 1.5 * phase) * smoothstep(-0.02, 0.06, p[:, 2])
    broad = fractal(p, (0.04, 0.12, 0.04), 2, 45)
    return 0.0034 * knee_back + 0.0032 * ankle + 0.0024 * groin + 0.0026 * broad


def knee_patch(p):
    """1 on the reinforced front of the knee."""
    a = smoothstep(0.125, 0.120, np.abs(p[:, 1] - 0.525))
    return a * smoothstep(0.006, 0.014, p[:, 2] - 0.02 * np.abs(p[:, 1] - 0.525) / 0.12)


def thigh_pocket(p):
    """1 on the flat pocket at the side of the thigh."""
    return (smoothstep(0.078, 0.075, np.abs(p[:, 1] - 0.715)) * smoothstep(0.056, 0.053, np.abs(p[:, 2]))
            * smoothstep(0.135, 0.14, p[:, 0]))


def trousers_field(p):
    leg = loft(p[:, 1], p[:, 0], p[:, 2], LEG, 0.006)
    leg = union(leg, ellipsoid(p, vec(0.094, 0.345, -0.036), vec(0.050, 0.085, 0.045)), 0.04)
    pelvis = loft(p[:, 1], p[:, 0], p[:, 2], [
        (0.845, 0, -0.006, 0.1500, 0.1050, 2.2), (0.880, 0, -0.006, 0.1620, 0.1180, 2.3),
        (0.960, 0, -0.006, 0.1640, 0.1200, 2.3), (1.020, 0, -0.004, 0.1500, 0.1100, 2.3)], 0.02)
    seat = ellipsoid(p, vec(0.078, 0.880, -0.070), vec(0.078, 0.082, 0.058))
    d = union(leg, pelvis, 0.035)
    d = union(d, seat, 0.03)
    # The legs do not touch: a gap of the mirror plane below the crotch.
    d = cut(d, capsule(p, vec(0, 0.2, 0), vec(0, 0.790, 0.0), 0.004), 0.01)
    d = d + _leg_folds(p)
    return d - 0.0012 * knee_patch(p) - 0.0020 * thigh_pocket(p)


def trousers_hidden(p):
    r = np.sqrt((p[:, 0] - 0.0965) ** 2 + (p[:, 2] + 0.012) ** 2)
    return (p[:, 1] > 0.905) | ((p[:, 1] < 0.140) & (r < 0.046))
