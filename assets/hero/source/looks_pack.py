"""Rucksack, roll, straps and belt."""

import numpy as np

import pack
from palette import line, mix, mottle, weave
from sdf import bump, fractal, smoothstep, vec

# Rucksack: moss canvas, lid and base darker, pale roll.

MOSS = vec(0.088, 0.118, 0.052)


def pack_surface(p, n):
    c = mottle(p, MOSS, 0.13, 0.03, 121)
    base = smoothstep(1.070, 1.066, p[:, 1])
    c = mix(c, vec(0.032, 0.035, 0.036), 0.95 * base)
    pocket = bump(np.abs(p[:, 0]), 0.0905, 0.004) * (p[:, 2] < pack.BACK - 0.12)
    c = c * (1 - 0.4 * pocket)[:, None]
    web = smoothstep(0.0135, 0.0120, np.abs(np.abs(p[:, 0]) - 0.058)) * (p[:, 2] < pack.BACK - 0.08)
    c = mix(c, vec(0.030, 0.031, 0.034), 0.95 * web)
    buckle = web * bump(p[:, 1], 1.255, 0.022)
    c = mix(c, vec(0.010, 0.010, 0.011), smoothstep(0.3, 0.4, buckle))
    zip_ = line(p[:, 1] - 1.222, 0.004) * (p[:, 2] < pack.BACK - 0.13) * (np.abs(p[:, 0]) < 0.08)
    c = mix(c, vec(0.020, 0.021, 0.022), 0.9 * zip_)
    return c, np.full(len(p), 0.87)


def pack_height(p):
    web = smoothstep(0.0150, 0.0120, np.abs(np.abs(p[:, 0]) - 0.058)) * (p[:, 2] < pack.BACK - 0.08)
    buckle = web * smoothstep(0.020, 0.016, np.abs(p[:, 1] - 1.255))
    seam = line(p[:, 1] - 1.068, 0.003)
    return (0.00018 * weave(p, 0.0050) + 0.0014 * web + 0.0025 * buckle - 0.001 * seam
            + 0.0010 * fractal(p, (0.02, 0.03, 0.02), 3, 123))


def lid_surface(p, n):
    c, rough = pack_surface(p, n)
    c = mix(mottle(p, MOSS * 0.62, 0.13, 0.03, 125), vec(0.030, 0.031, 0.034),
             0.95 * smoothstep(0.0135, 0.0120, np.abs(np.abs(p[:, 0]) - 0.058)) * (n[:, 2] < 0.3))
    zip_ = line(p[:, 1] - 1.400, 0.004) * (p[:, 2] < pack.BACK - 0.09)
    c = mix(c, vec(0.42, 0.10, 0.03), 0.9 * zip_)
    return c, rough


def lid_height(p):
    web = smoothstep(0.0150, 0.0120, np.abs(np.abs(p[:, 0]) - 0.058))
    seam = line(p[:, 1] - 1.400, 0.003) * (p[:, 2] < pack.BACK - 0.09)
    return 0.00018 * weave(p, 0.0050) + 0.0012 * web - 0.001 * seam + 0.0012 * fractal(p, 0.025, 3, 127)


def roll_surface(p, n):
    c = mottle(p, (0.200, 0.225, 0.235), 0.08, 0.02, 131)
    q = np.sqrt((p[:, 1] - pack.ROLL_Y) ** 2 + (p[:, 2] - pack.ROLL_Z) ** 2)
    angle = np.arctan2(p[:, 1] - pack.ROLL_Y, p[:, 2] - pack.ROLL_Z)
    spiral = np.abs((q / 0.011 + angle / (2 * np.pi)) % 1.0 - 0.5)
    end = smoothstep(0.153, 0.157, np.abs(p[:, 0]))
    c = c * (1 - 0.55 * end * smoothstep(0.22, 0.08, spiral))[:, None]
    strap = smoothstep(0.0145, 0.0130, np.abs(np.abs(p[:, 0]) - 0.085))
    c = mix(c, vec(0.030, 0.031, 0.034), 0.95 * strap)
    return c, np.full(len(p), 0.80)


def roll_height(p):
    return 0.0006 * fractal(p, (0.008, 0.02, 0.02), 2, 133)


def strap_surface(p, n):
    c = mottle(p, (0.034, 0.036, 0.040), 0.15, 0.02, 141)
    return c, np.full(len(p), 0.85)


def belt_surface(p, n):
    """The hip belt, with its buckle in front."""
    c, rough = strap_surface(p, n)
    x = np.abs(p[:, 0])
    on = smoothstep(0.034, 0.033, x) * (p[:, 2] > 0.0)
    c = mix(c, vec(0.012, 0.012, 0.013), on)
    c = mix(c, vec(0.075, 0.076, 0.078), on * np.maximum(bump(x, 0.006, 0.0022), bump(x, 0.0335, 0.0025)))
    return c, rough - 0.45 * on


def belt_height(p):
    return strap_height(p) + 0.0022 * smoothstep(0.035, 0.032, np.abs(p[:, 0])) * (p[:, 2] > 0.0)


def strap_height(p):
    return 0.00016 * weave(p, 0.0050) + 0.0006 * fractal(p, 0.02, 2, 143)
