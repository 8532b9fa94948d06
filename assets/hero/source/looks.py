"""Colours, roughness and fine relief of each part, as functions of the place.

Colours are linear reflectances. Heights are metres outwards.
"""

from dataclasses import dataclass
from typing import Callable, Optional

import numpy as np

import clothes
import extremities
import head
import pack
import sdf
import skeleton as sk
from sdf import bump, fractal, length, noise, smoothstep, vec


@dataclass
class Look:
    surface: Callable                 # points, normals -> colour (n, 3), roughness (n,)
    height: Callable                  # points -> relief (m)
    field: Optional[Callable] = None  # the body's fine field


def _mix(a, b, share):
    return a + (np.asarray(b) - a) * share[:, None]


def _flat(p, colour):
    return np.tile(np.asarray(colour, dtype=float), (len(p), 1))


def _mottle(p, colour, strength, scale=0.03, seed=1):
    return _flat(p, colour) * (1.0 + strength * fractal(p, scale, 3, seed))[:, None]


def _none(p):
    return np.zeros(len(p))


def _abs(p):
    q = p.copy()
    q[:, 0] = np.abs(q[:, 0])
    return q


# Skin, hair, eyes.

SKIN = vec(0.520, 0.285, 0.180)
BLOOD = vec(0.520, 0.180, 0.120)
HAIR = vec(0.075, 0.040, 0.020)
LIP = vec(0.400, 0.165, 0.125)


def _brow(p):
    """1 on the eyebrows."""
    s = (p[:, 0] - 0.0300) / 0.0210
    line = 1.6826 + 0.0026 * (1 - (s - 0.25) ** 2) + 0.0002 * s
    thick = 0.0046 * (1.0 - 0.45 * smoothstep(0.0, 1.0, s))
    hairs = 0.5 * fractal(p, (0.0016, 0.006, 0.004), 2, 71)
    return (smoothstep(1.15, 0.55, np.abs(p[:, 1] - line) / thick + 0.4 * hairs)
            * smoothstep(1.08, 0.85, np.abs(s)) * (p[:, 2] > 0.045))


def _lips(p):
    x = np.abs(p[:, 0])
    s = np.clip(x / 0.0275, 0, 1)
    top = head.mouth_line(x) + 0.0078 - 0.0012 * np.exp(-(x / 0.003) ** 2) - 0.0072 * s ** 2.0
    low = head.mouth_line(x) - 0.0092 + 0.0088 * s ** 2.4
    inside = np.minimum(top - p[:, 1], p[:, 1] - low)
    return smoothstep(-0.0008, 0.0012, inside) * smoothstep(0.0280, 0.0255, x) * (p[:, 2] > 0.06)


def _stubble(p):
    """Where a beard would grow, a day old."""
    jaw = smoothstep(1.622, 1.600, p[:, 1] - 0.35 * (0.05 - p[:, 2]).clip(0, 0.1))
    moustache = bump(p[:, 1], 1.6075, 0.012) * smoothstep(0.034, 0.02, np.abs(p[:, 0]))
    area = np.maximum(jaw, moustache) * smoothstep(1.515, 1.545, p[:, 1] + 0.3 * (p[:, 2] - 0.03).clip(-0.1, 0))
    return area * (1 - _lips(p)) * smoothstep(-0.02, 0.015, p[:, 2])


def head_surface(p, n):
    p = _abs(p)
    c = _mottle(p, SKIN, 0.07, 0.012, 73)
    warm = np.exp(-(length((p - vec(0.041, 1.632, 0.066)) / vec(0.022, 0.016, 0.03))) ** 2)
    warm = np.maximum(warm, 0.8 * np.exp(-(length((p - vec(0, 1.626, 0.110)) / vec(0.014, 0.012, 0.014))) ** 2))
    ear = np.exp(-(length((p - vec(0.082, 1.650, -0.012)) / vec(0.012, 0.034, 0.02))) ** 2)
    c = _mix(c, BLOOD, 0.42 * np.maximum(warm, 0.8 * ear))
    shell = np.exp(-(length((p - vec(0.0885, 1.651, -0.008)) / vec(0.012, 0.017, 0.008))) ** 2)
    c = _mix(c, vec(0.20, 0.075, 0.05), 0.75 * shell)
    # Shade in the sockets and beside the nose, as thin skin has it.
    socket = np.exp(-(length((p - head.EYE - vec(-0.004, -0.006, 0.006)) / vec(0.020, 0.012, 0.02))) ** 2)
    c = _mix(c, vec(0.36, 0.18, 0.14), 0.30 * socket)
    c = _mix(c, vec(0.27, 0.155, 0.110), 0.42 * _stubble(p) * (0.8 + 0.3 * noise(p, 0.0022, 75)))
    c = _mix(c, LIP, 0.75 * _lips(p))
    slit = bump(p[:, 1], head.mouth_line(p[:, 0]), 0.0020) * smoothstep(0.0285, 0.0240, p[:, 0]) * (p[:, 2] > 0.06)
    c = _mix(c, vec(0.10, 0.028, 0.025), 0.85 * slit)
    # The lids' edges with their lashes.
    eye = length(p - head.EYE)
    gap = head._lid_gap(p)
    lash = smoothstep(-0.0034, -0.0012, gap) * smoothstep(0.020, 0.016, eye) * (p[:, 2] > head.EYE[2] + 0.001)
    lash = lash * smoothstep(0.0168, 0.0150, np.abs(p[:, 0] - head.EYE[0]))
    upper = smoothstep(-0.001, 0.002, p[:, 1] - head.EYE[1])
    c = _mix(c, vec(0.035, 0.018, 0.012), lash * (0.30 + 0.65 * upper))
    c = _mix(c, HAIR, 0.92 * _brow(p))
    nostril = np.exp(-(length((p - vec(0.0066, 1.6160, 0.1005)) / vec(0.0035, 0.0030, 0.0045))) ** 2)
    c = _mix(c, vec(0.10, 0.03, 0.025), 0.8 * nostril)
    hair = head.hair_amount(p)
    strands = 0.5 + 0.5 * fractal(p, (0.0024, 0.020, 0.0024), 3, 77)
    c = _mix(c, HAIR[None] * (0.55 + 1.1 * strands[:, None]), hair)
    rough = 0.56 + 0.06 * fractal(p, 0.01, 2, 79) - 0.14 * _lips(p)
    rough = rough * (1 - hair) + 0.62 * hair
    return c, rough


def head_height(p):
    p = _abs(p)
    hair = head.hair_amount(p)
    pores = 0.00010 * fractal(p, 0.0030, 2, 81)
    strands = 0.0011 * fractal(p, (0.0030, 0.022, 0.0030), 2, 77)
    brow = 0.0007 * _brow(p)
    lip_lines = 0.00012 * np.sin(p[:, 0] / 0.00035) * _lips(p)
    return pores * (1 - hair) + strands * hair + brow + lip_lines


def eye_surface(p, n):
    q = p - head.EYE
    r = np.sqrt(q[:, 0] ** 2 + q[:, 1] ** 2)
    c = _flat(p, (0.62, 0.58, 0.54))
    c = _mix(c, vec(0.45, 0.30, 0.27), smoothstep(0.0065, 0.0110, r) * 0.6)
    angle = np.arctan2(q[:, 1], q[:, 0])
    rays = 0.5 + 0.5 * np.sin(angle * 23.0 + 3.0 * np.sin(angle * 7.0))
    iris = vec(0.085, 0.150, 0.165)[None] * (0.6 + 0.8 * rays[:, None] * smoothstep(0.0026, 0.0056, r)[:, None])
    c = _mix(c, iris, smoothstep(0.0069, 0.0064, r))
    c = _mix(c, vec(0.02, 0.03, 0.035), bump(r, 0.0066, 0.0009) * 0.7)
    c = _mix(c, vec(0.004, 0.004, 0.004), smoothstep(0.0031, 0.0027, r))
    # The upper lid's shadow, and a spark of sky.
    c = c * (1 - 0.45 * smoothstep(0.0015, 0.0058, q[:, 1]))[:, None]
    spark = smoothstep(0.0011, 0.0007, np.hypot(q[:, 0] + 0.0018, q[:, 1] - 0.0022))
    c = _mix(c, vec(0.85, 0.9, 0.95), spark)
    return c, np.full(len(p), 0.12)


# The hat: mustard wool with a darker turned-up cuff.

def hat_surface(p, n):
    rib, _ = head.hat_rib(p)
    wool = _mottle(p, (0.400, 0.205, 0.030), 0.16, (0.006, 0.012, 0.006), 83)
    c = _mix(wool, vec(0.300, 0.145, 0.020), head.hat_cuff(p) * 0.55)
    c = c * (0.55 + 0.45 * rib ** 0.6)[:, None]
    return c, np.full(len(p), 0.94)


def hat_height(p):
    rib, ribs = head.hat_rib(p)
    rows = p[:, 1] / 0.0052
    v = np.sin((rows + np.abs((ribs % 1.0) - 0.5) * 1.6) * 2 * np.pi)
    crown = smoothstep(0.150, 0.110, head._hat_height(p))
    return (0.0022 * np.sqrt(rib + 0.02) + 0.0005 * v) * crown


# The jacket: a rust-red shell with a charcoal yoke, storm flap and cuffs.

RUST = vec(0.420, 0.075, 0.026)
CHARCOAL = vec(0.040, 0.043, 0.050)


def _yoke_edge(p):
    """Metres above the yoke's lower edge: low in the middle of the back and the chest,
    up over the armpits, and down again around the cap of the sleeve."""
    x = np.abs(p[:, 0])
    front = 1.352 + 0.085 * smoothstep(0.02, 0.15, x)
    back = 1.318 + 0.105 * smoothstep(0.02, 0.15, x)
    share = smoothstep(-0.03, 0.01, p[:, 2])
    return p[:, 1] - (back + (front - back) * share) + 0.66 * np.clip(x - 0.165, 0.0, None)


def yoke(p):
    """1 on the yoke over shoulders and upper back."""
    return smoothstep(-0.0008, 0.0008, _yoke_edge(p)) * (np.abs(p[:, 0]) < 0.33)


def _line(d, width):
    return smoothstep(width, 0.4 * width, np.abs(d))


def jacket_lines(p):
    """Signed distances (m) from the seams: yoke, side, armhole, hem, pockets."""
    p = _abs(p)
    y, x = p[:, 1], p[:, 0]
    arm = (p - sk.SHOULDER) @ sdf.unit(vec(0.88, 0.42, 0.0)) + 0.010
    hem = y - clothes.HEM - 0.034
    u, v, _ = clothes.forearm_coords(p)
    cuff = u - clothes.CUFF_U + 0.036
    on_arm = arm > 0.0
    big = np.full(len(p), 1.0)
    return {
        "yoke": np.where(x < 0.33, _yoke_edge(p), big),
        "armhole": np.where((y > 1.25) & (x > 0.12), arm, big),
        "hem": hem,
        "side": np.where(~on_arm & (y > clothes.HEM) & (y < 1.32) & (x > 0.08), p[:, 2] + 0.006, big),
        "cuff": np.where(on_arm, cuff, big),
        "sleeve": np.where(on_arm & (u > -0.25), np.where(u > 0, v, clothes.upper_arm_coords(p)[1]) + 0.030, big),
    }


def jacket_surface(p, n):
    q = _abs(p)
    c = _mottle(p, RUST, 0.10, 0.05, 91)
    c = _mix(c, CHARCOAL, 0.96 * yoke(p))
    u, v, w = clothes.forearm_coords(q)
    cuff = smoothstep(-0.030, -0.028, u - clothes.CUFF_U) * (q[:, 0] > 0.3)
    c = _mix(c, CHARCOAL * 1.1, 0.96 * cuff)
    flap = smoothstep(0.0150, 0.0140, np.abs(p[:, 0])) * (p[:, 2] > 0.02)
    c = _mix(c, CHARCOAL, 0.96 * flap)
    zip_ = smoothstep(0.0042, 0.0036, np.abs(p[:, 0])) * (p[:, 2] > 0.02)
    c = _mix(c, vec(0.018, 0.019, 0.022), zip_)
    pocket = clothes.pocket_flap(q)
    c = _mix(c, CHARCOAL, 0.9 * pocket)
    for d in jacket_lines(p).values():
        c = c * (1.0 - 0.35 * _line(d, 0.0028))[:, None]
    # Worn, paler on the folds' backs; dust at the hem.
    worn = smoothstep(0.1, 0.9, fractal(p, 0.03, 3, 95))
    c = _mix(c, c * 1.25 + 0.008, 0.35 * worn)
    rough = 0.74 + 0.06 * fractal(p, 0.04, 2, 97) + 0.08 * yoke(p)
    return c, np.clip(rough, 0.5, 0.95)


def _weave(p, n_scale=0.0042):
    """A coarse cloth: two sets of threads along the body's own slant."""
    a = p[:, 1] / n_scale
    b = (p[:, 0] * 0.9 + p[:, 2] * 1.1) / n_scale
    return np.sin(a * np.pi) * np.sin(b * np.pi)


def jacket_height(p):
    h = 0.00010 * _weave(p)
    for name, d in jacket_lines(p).items():
        h = h - 0.0011 * np.exp(-(d / 0.0016) ** 2) + 0.0006 * np.exp(-((d - 0.005) / 0.003) ** 2)
    q = _abs(p)
    teeth = 0.0006 * np.sin(p[:, 1] / 0.0012) * smoothstep(0.0040, 0.0030, np.abs(p[:, 0])) * (p[:, 2] > 0.02)
    small = 0.0010 * fractal(p, (0.018, 0.026, 0.018), 3, 99)
    return h + teeth + small + 0.0006 * yoke(p) + 0.0005 * clothes.pocket_flap(q)


# Trousers: slate-grey with darker knees and seat.

SLATE = vec(0.062, 0.070, 0.078)


def trousers_lines(p):
    q = _abs(p)
    big = np.full(len(p), 1.0)
    side = np.where(q[:, 0] > 0.10, p[:, 2] + 0.004, big)
    inseam = np.where((q[:, 0] < 0.06) & (p[:, 1] < 0.80), p[:, 2] + 0.006, big)
    middle = np.where(p[:, 1] > 0.78, q[:, 0], big)
    return side, inseam, middle, p[:, 1] - 0.152


def trousers_surface(p, n):
    q = _abs(p)
    c = _mottle(p, SLATE, 0.14, 0.04, 101)
    c = _mix(c, SLATE * 0.48, 0.95 * clothes.knee_patch(q))
    c = _mix(c, SLATE * 0.80, clothes.thigh_pocket(q))
    for d in trousers_lines(p):
        c = c * (1.0 - 0.35 * _line(d, 0.0030))[:, None]
    dust = smoothstep(0.36, 0.12, p[:, 1]) * (0.55 + 0.45 * fractal(p, 0.035, 3, 103))
    c = _mix(c, vec(0.150, 0.128, 0.098), 0.55 * np.clip(dust, 0, 1))
    return c, np.clip(0.86 + 0.05 * fractal(p, 0.03, 2, 105), 0, 1)


def trousers_height(p):
    q = _abs(p)
    h = 0.00014 * _weave(p, 0.0046)
    for d in trousers_lines(p):
        h = h - 0.0012 * np.exp(-(d / 0.0018) ** 2) + 0.0005 * np.exp(-((d - 0.005) / 0.003) ** 2)
    rim = np.abs(clothes.knee_patch(q) - 0.5) < 0.45
    return h + 0.0012 * fractal(p, (0.018, 0.030, 0.018), 3, 107) - 0.0006 * rim


# Boots: brown leather, black rubber, red laces.

LEATHER = vec(0.135, 0.066, 0.028)
RUBBER = vec(0.022, 0.021, 0.020)


def boot_surface(p, n):
    c = _mottle(p, LEATHER, 0.22, 0.02, 111)
    rand = smoothstep(0.0535, 0.0510, p[:, 1] - 0.012 * smoothstep(0.12, 0.18, p[:, 2]))
    c = _mix(c, RUBBER, 0.97 * rand)
    midsole = bump(p[:, 1], 0.0285, 0.0035)
    c = _mix(c, vec(0.10, 0.088, 0.07), 0.6 * midsole)
    collar = smoothstep(0.156, 0.160, p[:, 1])
    c = _mix(c, vec(0.030, 0.030, 0.033), 0.95 * collar)
    on_top = smoothstep(0.018, 0.026, p[:, 2]) * smoothstep(0.148, 0.142, p[:, 2]) * (p[:, 1] > 0.06)
    x = p[:, 0] - extremities.BOOT_X - 0.003
    tongue = smoothstep(0.0150, 0.0135, np.abs(x)) * on_top
    c = _mix(c, LEATHER * 0.45, 0.9 * tongue)
    lace = np.zeros(len(p))
    for i in range(6):
        z = 0.040 + 0.0165 * i
        for side in (-1, 1):
            d = np.abs(p[:, 2] - (z + side * 0.008 * x / 0.019))
            lace = np.maximum(lace, smoothstep(0.0042, 0.0030, d) * smoothstep(0.0225, 0.0205, np.abs(x)))
    c = _mix(c, vec(0.330, 0.050, 0.030), 0.95 * lace * (p[:, 1] > 0.058) * (n[:, 1] > 0.2))
    dust = smoothstep(0.10, 0.02, p[:, 1]) * (0.5 + 0.5 * fractal(p, 0.02, 3, 113))
    c = _mix(c, vec(0.155, 0.130, 0.098), 0.45 * np.clip(dust, 0, 1))
    return c, np.clip(0.58 + 0.25 * rand + 0.2 * collar + 0.08 * fractal(p, 0.01, 2, 115), 0, 1)


def boot_height(p):
    grain = 0.00022 * fractal(p, 0.0045, 2, 117)
    cap = _line(p[:, 2] - 0.150 + 0.35 * (np.abs(p[:, 0] - extremities.BOOT_X) - 0.02), 0.0026)
    quarter = _line(p[:, 2] + 0.030 - 0.3 * (p[:, 1] - 0.08), 0.0026)
    return grain - 0.0009 * np.maximum(cap, quarter) * (p[:, 1] > 0.055)


# Rucksack: moss canvas, lid and base darker, pale roll.

MOSS = vec(0.088, 0.118, 0.052)


def pack_surface(p, n):
    c = _mottle(p, MOSS, 0.13, 0.03, 121)
    base = smoothstep(1.070, 1.066, p[:, 1])
    c = _mix(c, vec(0.032, 0.035, 0.036), 0.95 * base)
    pocket = bump(np.abs(p[:, 0]) - 0.0, 0.0905, 0.004) * (p[:, 2] < pack.BACK - 0.12)
    c = c * (1 - 0.4 * pocket)[:, None]
    for x in (0.058,):
        web = smoothstep(0.0135, 0.0120, np.abs(np.abs(p[:, 0]) - x)) * (p[:, 2] < pack.BACK - 0.08)
        c = _mix(c, vec(0.030, 0.031, 0.034), 0.95 * web)
        buckle = web * bump(p[:, 1], 1.255, 0.022)
        c = _mix(c, vec(0.010, 0.010, 0.011), smoothstep(0.3, 0.4, buckle))
    zip_ = _line(p[:, 1] - 1.222 + 0.0, 0.004) * (p[:, 2] < pack.BACK - 0.13) * (np.abs(p[:, 0]) < 0.08)
    c = _mix(c, vec(0.020, 0.021, 0.022), 0.9 * zip_)
    return c, np.full(len(p), 0.87)


def pack_height(p):
    web = smoothstep(0.0150, 0.0120, np.abs(np.abs(p[:, 0]) - 0.058)) * (p[:, 2] < pack.BACK - 0.08)
    buckle = web * smoothstep(0.020, 0.016, np.abs(p[:, 1] - 1.255))
    seam = _line(p[:, 1] - 1.068, 0.003)
    return (0.00018 * _weave(p, 0.0050) + 0.0014 * web + 0.0025 * buckle - 0.001 * seam
            + 0.0010 * fractal(p, (0.02, 0.03, 0.02), 3, 123))


def lid_surface(p, n):
    c, rough = pack_surface(p, n)
    c = _mix(_mottle(p, MOSS * 0.62, 0.13, 0.03, 125), vec(0.030, 0.031, 0.034),
             0.95 * smoothstep(0.0135, 0.0120, np.abs(np.abs(p[:, 0]) - 0.058)) * (n[:, 2] < 0.3))
    zip_ = _line(p[:, 1] - 1.400, 0.004) * (p[:, 2] < pack.BACK - 0.09)
    c = _mix(c, vec(0.42, 0.10, 0.03), 0.9 * zip_)
    return c, rough


def lid_height(p):
    web = smoothstep(0.0150, 0.0120, np.abs(np.abs(p[:, 0]) - 0.058))
    seam = _line(p[:, 1] - 1.400, 0.003) * (p[:, 2] < pack.BACK - 0.09)
    return 0.00018 * _weave(p, 0.0050) + 0.0012 * web - 0.001 * seam + 0.0012 * fractal(p, 0.025, 3, 127)


def roll_surface(p, n):
    c = _mottle(p, (0.200, 0.225, 0.235), 0.08, 0.02, 131)
    q = np.sqrt((p[:, 1] - pack.ROLL_Y) ** 2 + (p[:, 2] - pack.ROLL_Z) ** 2)
    angle = np.arctan2(p[:, 1] - pack.ROLL_Y, p[:, 2] - pack.ROLL_Z)
    spiral = np.abs((q / 0.011 + angle / (2 * np.pi)) % 1.0 - 0.5)
    end = smoothstep(0.153, 0.157, np.abs(p[:, 0]))
    c = c * (1 - 0.55 * end * smoothstep(0.22, 0.08, spiral))[:, None]
    strap = smoothstep(0.0145, 0.0130, np.abs(np.abs(p[:, 0]) - 0.085))
    c = _mix(c, vec(0.030, 0.031, 0.034), 0.95 * strap)
    return c, np.full(len(p), 0.80)


def roll_height(p):
    return 0.0006 * fractal(p, (0.008, 0.02, 0.02), 2, 133)


def strap_surface(p, n):
    c = _mottle(p, (0.034, 0.036, 0.040), 0.15, 0.02, 141)
    return c, np.full(len(p), 0.85)


def belt_surface(p, n):
    """The hip belt, with its buckle in front."""
    c, rough = strap_surface(p, n)
    x = np.abs(p[:, 0])
    on = smoothstep(0.034, 0.033, x) * (p[:, 2] > 0.0)
    c = _mix(c, vec(0.012, 0.012, 0.013), on)
    c = _mix(c, vec(0.075, 0.076, 0.078), on * np.maximum(bump(x, 0.006, 0.0022), bump(x, 0.0335, 0.0025)))
    return c, rough - 0.45 * on


def belt_height(p):
    return strap_height(p) + 0.0022 * smoothstep(0.035, 0.032, np.abs(p[:, 0])) * (p[:, 2] > 0.0)


def strap_height(p):
    return 0.00016 * _weave(p, 0.0050) + 0.0006 * fractal(p, 0.02, 2, 143)


# The collar: charcoal outside, lined with soft fleece.

def collar_surface(p, n):
    c = _mottle(p, CHARCOAL, 0.10, 0.04, 145)
    inside = smoothstep(0.1, -0.1, n[:, 0] * p[:, 0] + n[:, 2] * (p[:, 2] + 0.015))
    c = _mix(c, vec(0.30, 0.062, 0.024) * (1 + 0.2 * noise(p, 0.006, 147))[:, None], inside)
    zip_ = smoothstep(0.0060, 0.0050, np.abs(p[:, 0])) * (p[:, 2] > 0.02)
    return _mix(c, vec(0.018, 0.019, 0.022), zip_), 0.80 + 0.14 * inside


def collar_height(p):
    return 0.00010 * _weave(p) + 0.0008 * fractal(p, (0.03, 0.015, 0.03), 2, 149)


# Hands: bare, a little redder at the knuckles and tips; short nails.

def hand_surface(p, n):
    q = _abs(p)
    u, t, palm = extremities.hand_coords(q)
    c = _mottle(q, SKIN, 0.07, 0.010, 151)
    knuckles = np.zeros(len(p))
    for points in sk.FINGERS.values():
        for j in points[:3]:
            knuckles = np.maximum(knuckles, np.exp(-(length(q - j + 0.006 * sk.HAND_PALM) / 0.008) ** 2))
        knuckles = np.maximum(knuckles, 0.8 * np.exp(-(length(q - points[3]) / 0.010) ** 2))
    c = _mix(c, BLOOD, 0.35 * knuckles)
    back = (n * np.sign(p[:, :1]) * 0 + n) @ sk.HAND_PALM < 0.0
    nail = np.zeros(len(p))
    for name, points in list(sk.FINGERS.items()):
        tip = points[3] - 0.006 * sdf.unit(points[3] - points[2]) - 0.006 * sk.HAND_PALM
        nail = np.maximum(nail, smoothstep(1.0, 0.8, length((q - tip) / 0.0056)))
    c = _mix(c, vec(0.62, 0.40, 0.32), 0.7 * nail * back)
    c = _mix(c, vec(0.60, 0.33, 0.23), 0.3 * smoothstep(0.0, 0.012, palm))
    return c, 0.58 - 0.2 * nail


def hand_height(p):
    q = _abs(p)
    h = 0.00012 * fractal(q, 0.0035, 2, 153)
    for points in sk.FINGERS.values():
        for j in points[1:3]:
            d = length(q - j)
            h = h - 0.0003 * np.exp(-(d / 0.009) ** 2) * np.cos((q - j) @ sdf.unit(points[2] - points[1]) / 0.0007)
    return h


LOOKS = {
    "head": Look(head_surface, head_height, sdf.mirror_field(head.head_fine)),
    "eye": Look(eye_surface, _none),
    "hat": Look(hat_surface, hat_height, sdf.mirror_field(head.hat_field)),
    "hand": Look(hand_surface, hand_height, sdf.mirror_field(extremities.hand_field)),
    "jacket": Look(jacket_surface, jacket_height, sdf.mirror_field(clothes.jacket_field)),
    "trousers": Look(trousers_surface, trousers_height, sdf.mirror_field(clothes.trousers_field)),
    "boot": Look(boot_surface, boot_height, sdf.mirror_field(extremities.boot_field)),
    "pack": Look(pack_surface, pack_height, sdf.mirror_field(pack.body_field)),
    "lid": Look(lid_surface, lid_height, sdf.mirror_field(pack.lid_field)),
    "roll": Look(roll_surface, roll_height, sdf.mirror_field(pack.roll_field)),
    "strap": Look(strap_surface, strap_height),
    "belt": Look(belt_surface, belt_height),
    "collar": Look(collar_surface, collar_height),
}
