"""Hat, jacket, collar, trousers and boots."""

import numpy as np

import clothes
import extremities
import head
import sdf
import skeleton as sk
from palette import both_sides, line, mix, mottle, weave
from sdf import bump, fractal, noise, smoothstep, vec

# The hat: mustard wool with a darker turned-up cuff.

def hat_surface(p, n):
    rib, _ = head.hat_rib(p)
    wool = mottle(p, (0.400, 0.205, 0.030), 0.16, (0.006, 0.012, 0.006), 83)
    c = mix(wool, vec(0.300, 0.145, 0.020), head.hat_cuff(p) * 0.55)
    c = c * (0.55 + 0.45 * rib ** 0.6)[:, None]
    return c, np.full(len(p), 0.94)


def hat_height(p):
    rib, ribs = head.hat_rib(p)
    rows = p[:, 1] / 0.0052
    v = np.sin((rows + np.abs((ribs % 1.0) - 0.5) * 1.6) * 2 * np.pi)
    crown = smoothstep(0.150, 0.110, head.height_in_hat(p))
    return (0.0022 * np.sqrt(rib + 0.02) + 0.0005 * v) * crown


# The jacket: a rust-red shell with a charcoal yoke, storm flap and cuffs.

RUST = vec(0.420, 0.075, 0.026)
CHARCOAL = vec(0.040, 0.043, 0.050)


def _yoke_edge(p):
    """Metres inside of the yoke's edge: low in the middle of the chest and the back, up
    to the armhole, and around the cap of the sleeve."""
    p = both_sides(p)
    x = p[:, 0]
    front = 1.352 + 0.080 * smoothstep(0.02, 0.15, x)
    back = 1.318 + 0.095 * smoothstep(0.02, 0.15, x)
    trunk = p[:, 1] - (back + (front - back) * smoothstep(-0.03, 0.01, p[:, 2]))
    u = clothes.upper_arm_coords(p)[0]
    sleeve = sdf.union(0.100 - u, p[:, 1] - 1.385, 0.06)
    return np.where(_armhole(p) > 0.0, sleeve, trunk)


def _armhole(p):
    """Metres beyond the seam of the sleeve."""
    return (p - sk.SHOULDER) @ sdf.unit(vec(0.88, 0.42, 0.0)) + 0.010


def yoke(p):
    """1 on the yoke over shoulders and upper back."""
    return smoothstep(-0.0008, 0.0008, _yoke_edge(p)) * (np.abs(p[:, 0]) < 0.33)


def jacket_lines(p):
    """Signed distances (m) from the seams: yoke, side, armhole, hem, pockets."""
    p = both_sides(p)
    y, x = p[:, 1], p[:, 0]
    arm = _armhole(p)
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
    q = both_sides(p)
    c = mottle(p, RUST, 0.10, 0.05, 91)
    c = mix(c, CHARCOAL, 0.96 * yoke(p))
    u, v, w = clothes.forearm_coords(q)
    cuff = smoothstep(-0.030, -0.028, u - clothes.CUFF_U) * (q[:, 0] > 0.3)
    c = mix(c, CHARCOAL * 1.1, 0.96 * cuff)
    flap = smoothstep(0.0150, 0.0140, np.abs(p[:, 0])) * (p[:, 2] > 0.02)
    c = mix(c, CHARCOAL, 0.96 * flap)
    zip_ = smoothstep(0.0042, 0.0036, np.abs(p[:, 0])) * (p[:, 2] > 0.02)
    c = mix(c, vec(0.018, 0.019, 0.022), zip_)
    pocket = clothes.pocket_flap(q)
    c = mix(c, CHARCOAL, 0.9 * pocket)
    for d in jacket_lines(p).values():
        c = c * (1.0 - 0.35 * line(d, 0.0028))[:, None]
    # Worn, paler on the folds' backs; dust at the hem.
    worn = smoothstep(0.1, 0.9, fractal(p, 0.03, 3, 95))
    c = mix(c, c * 1.25 + 0.008, 0.35 * worn)
    rough = 0.74 + 0.06 * fractal(p, 0.04, 2, 97) + 0.08 * yoke(p)
    return c, np.clip(rough, 0.5, 0.95)


def jacket_height(p):
    h = 0.00010 * weave(p)
    for name, d in jacket_lines(p).items():
        h = h - 0.0011 * np.exp(-(d / 0.0016) ** 2) + 0.0006 * np.exp(-((d - 0.005) / 0.003) ** 2)
    q = both_sides(p)
    teeth = 0.0006 * np.sin(p[:, 1] / 0.0012) * smoothstep(0.0040, 0.0030, np.abs(p[:, 0])) * (p[:, 2] > 0.02)
    small = 0.0010 * fractal(p, (0.018, 0.026, 0.018), 3, 99)
    return h + teeth + small + 0.0006 * yoke(p) + 0.0005 * clothes.pocket_flap(q)


# The collar: charcoal outside, lined with soft fleece.

def collar_surface(p, n):
    c = mottle(p, CHARCOAL, 0.10, 0.04, 145)
    inside = smoothstep(0.1, -0.1, n[:, 0] * p[:, 0] + n[:, 2] * (p[:, 2] + 0.015))
    c = mix(c, vec(0.30, 0.062, 0.024) * (1 + 0.2 * noise(p, 0.006, 147))[:, None], inside)
    zip_ = smoothstep(0.0060, 0.0050, np.abs(p[:, 0])) * (p[:, 2] > 0.02)
    return mix(c, vec(0.018, 0.019, 0.022), zip_), 0.80 + 0.14 * inside


def collar_height(p):
    return 0.00010 * weave(p) + 0.0008 * fractal(p, (0.03, 0.015, 0.03), 2, 149)


# Trousers: slate-grey with darker knees and seat.

SLATE = vec(0.062, 0.070, 0.078)


def trousers_lines(p):
    q = both_sides(p)
    big = np.full(len(p), 1.0)
    side = np.where(q[:, 0] > 0.10, p[:, 2] + 0.004, big)
    inseam = np.where((q[:, 0] < 0.06) & (p[:, 1] < 0.80), p[:, 2] + 0.006, big)
    middle = np.where(p[:, 1] > 0.78, q[:, 0], big)
    return side, inseam, middle, p[:, 1] - 0.152


def trousers_surface(p, n):
    q = both_sides(p)
    c = mottle(p, SLATE, 0.14, 0.04, 101)
    c = mix(c, SLATE * 0.48, 0.95 * clothes.knee_patch(q))
    c = mix(c, SLATE * 0.80, clothes.thigh_pocket(q))
    for d in trousers_lines(p):
        c = c * (1.0 - 0.35 * line(d, 0.0030))[:, None]
    dust = smoothstep(0.36, 0.12, p[:, 1]) * (0.55 + 0.45 * fractal(p, 0.035, 3, 103))
    c = mix(c, vec(0.150, 0.128, 0.098), 0.55 * np.clip(dust, 0, 1))
    return c, np.clip(0.86 + 0.05 * fractal(p, 0.03, 2, 105), 0, 1)


def trousers_height(p):
    q = both_sides(p)
    h = 0.00014 * weave(p, 0.0046)
    for d in trousers_lines(p):
        h = h - 0.0012 * np.exp(-(d / 0.0018) ** 2) + 0.0005 * np.exp(-((d - 0.005) / 0.003) ** 2)
    rim = np.abs(clothes.knee_patch(q) - 0.5) < 0.45
    return h + 0.0012 * fractal(p, (0.018, 0.030, 0.018), 3, 107) - 0.0006 * rim


# Boots: brown leather, black rubber, red laces.

LEATHER = vec(0.135, 0.066, 0.028)
RUBBER = vec(0.022, 0.021, 0.020)


def boot_surface(p, n):
    c = mottle(p, LEATHER, 0.22, 0.02, 111)
    rand = smoothstep(0.0535, 0.0510, p[:, 1] - 0.012 * smoothstep(0.12, 0.18, p[:, 2]))
    c = mix(c, RUBBER, 0.97 * rand)
    midsole = bump(p[:, 1], 0.0285, 0.0035)
    c = mix(c, vec(0.10, 0.088, 0.07), 0.6 * midsole)
    collar = smoothstep(0.156, 0.160, p[:, 1])
    c = mix(c, vec(0.030, 0.030, 0.033), 0.95 * collar)
    on_top = smoothstep(0.018, 0.026, p[:, 2]) * smoothstep(0.148, 0.142, p[:, 2]) * (p[:, 1] > 0.06)
    x = p[:, 0] - extremities.BOOT_X - 0.003
    tongue = smoothstep(0.0150, 0.0135, np.abs(x)) * on_top
    c = mix(c, LEATHER * 0.45, 0.9 * tongue)
    lace = np.zeros(len(p))
    for i in range(6):
        z = 0.040 + 0.0165 * i
        for side in (-1, 1):
            d = np.abs(p[:, 2] - (z + side * 0.008 * x / 0.019))
            lace = np.maximum(lace, smoothstep(0.0042, 0.0030, d) * smoothstep(0.0225, 0.0205, np.abs(x)))
    c = mix(c, vec(0.330, 0.050, 0.030), 0.95 * lace * (p[:, 1] > 0.058) * (n[:, 1] > 0.2))
    dust = smoothstep(0.10, 0.02, p[:, 1]) * (0.5 + 0.5 * fractal(p, 0.02, 3, 113))
    c = mix(c, vec(0.155, 0.130, 0.098), 0.45 * np.clip(dust, 0, 1))
    return c, np.clip(0.58 + 0.25 * rand + 0.2 * collar + 0.08 * fractal(p, 0.01, 2, 115), 0, 1)


def boot_height(p):
    grain = 0.00022 * fractal(p, 0.0045, 2, 117)
    cap = line(p[:, 2] - 0.150 + 0.35 * (np.abs(p[:, 0] - extremities.BOOT_X) - 0.02), 0.0026)
    quarter = line(p[:, 2] + 0.030 - 0.3 * (p[:, 1] - 0.08), 0.0026)
    return grain - 0.0009 * np.maximum(cap, quarter) * (p[:, 1] > 0.055)
