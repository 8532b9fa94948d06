"""Skin, hair, eyes and hands."""

import numpy as np

import extremities
import head
import sdf
import skeleton as sk
from palette import both_sides, flat, mix, mottle
from sdf import bump, fractal, length, noise, smoothstep, vec

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
    p = both_sides(p)
    c = mottle(p, SKIN, 0.07, 0.012, 73)
    warm = np.exp(-(length((p - vec(0.041, 1.632, 0.066)) / vec(0.022, 0.016, 0.03))) ** 2)
    warm = np.maximum(warm, 0.8 * np.exp(-(length((p - vec(0, 1.626, 0.110)) / vec(0.014, 0.012, 0.014))) ** 2))
    ear = np.exp(-(length((p - vec(0.082, 1.650, -0.012)) / vec(0.012, 0.034, 0.02))) ** 2)
    c = mix(c, BLOOD, 0.42 * np.maximum(warm, 0.8 * ear))
    shell = np.exp(-(length((p - vec(0.0885, 1.651, -0.008)) / vec(0.012, 0.017, 0.008))) ** 2)
    c = mix(c, vec(0.20, 0.075, 0.05), 0.75 * shell)
    # Shade in the sockets and beside the nose, as thin skin has it.
    socket = np.exp(-(length((p - head.EYE - vec(-0.004, -0.006, 0.006)) / vec(0.020, 0.012, 0.02))) ** 2)
    c = mix(c, vec(0.36, 0.18, 0.14), 0.30 * socket)
    c = mix(c, vec(0.27, 0.155, 0.110), 0.42 * _stubble(p) * (0.8 + 0.3 * noise(p, 0.0022, 75)))
    c = mix(c, LIP, 0.75 * _lips(p))
    slit = bump(p[:, 1], head.mouth_line(p[:, 0]), 0.0020) * smoothstep(0.0285, 0.0240, p[:, 0]) * (p[:, 2] > 0.06)
    c = mix(c, vec(0.10, 0.028, 0.025), 0.85 * slit)
    # The lids' edges with their lashes.
    eye = length(p - head.EYE)
    gap = head.lid_gap(p)
    lash = smoothstep(-0.0034, -0.0012, gap) * smoothstep(0.020, 0.016, eye) * (p[:, 2] > head.EYE[2] + 0.001)
    lash = lash * smoothstep(0.0168, 0.0150, np.abs(p[:, 0] - head.EYE[0]))
    upper = smoothstep(-0.001, 0.002, p[:, 1] - head.EYE[1])
    c = mix(c, vec(0.035, 0.018, 0.012), lash * (0.30 + 0.65 * upper))
    c = mix(c, HAIR, 0.92 * _brow(p))
    nostril = np.exp(-(length((p - vec(0.0066, 1.6160, 0.1005)) / vec(0.0035, 0.0030, 0.0045))) ** 2)
    c = mix(c, vec(0.10, 0.03, 0.025), 0.8 * nostril)
    hair = head.hair_amount(p)
    strands = 0.5 + 0.5 * fractal(p, (0.0024, 0.020, 0.0024), 3, 77)
    c = mix(c, HAIR[None] * (0.55 + 1.1 * strands[:, None]), hair)
    rough = 0.56 + 0.06 * fractal(p, 0.01, 2, 79) - 0.14 * _lips(p)
    rough = rough * (1 - hair) + 0.62 * hair
    return c, rough


def head_height(p):
    p = both_sides(p)
    hair = head.hair_amount(p)
    pores = 0.00010 * fractal(p, 0.0030, 2, 81)
    strands = 0.0011 * fractal(p, (0.0030, 0.022, 0.0030), 2, 77)
    brow = 0.0007 * _brow(p)
    lip_lines = 0.00012 * np.sin(p[:, 0] / 0.00035) * _lips(p)
    return pores * (1 - hair) + strands * hair + brow + lip_lines


def eye_surface(p, n):
    q = p - head.EYE
    r = np.sqrt(q[:, 0] ** 2 + q[:, 1] ** 2)
    c = flat(p, (0.62, 0.58, 0.54))
    c = mix(c, vec(0.45, 0.30, 0.27), smoothstep(0.0065, 0.0110, r) * 0.6)
    angle = np.arctan2(q[:, 1], q[:, 0])
    rays = 0.5 + 0.5 * np.sin(angle * 23.0 + 3.0 * np.sin(angle * 7.0))
    iris = vec(0.085, 0.150, 0.165)[None] * (0.6 + 0.8 * rays[:, None] * smoothstep(0.0026, 0.0056, r)[:, None])
    c = mix(c, iris, smoothstep(0.0069, 0.0064, r))
    c = mix(c, vec(0.02, 0.03, 0.035), bump(r, 0.0066, 0.0009) * 0.7)
    c = mix(c, vec(0.004, 0.004, 0.004), smoothstep(0.0031, 0.0027, r))
    # The upper lid's shadow, and a spark of sky.
    c = c * (1 - 0.45 * smoothstep(0.0015, 0.0058, q[:, 1]))[:, None]
    spark = smoothstep(0.0011, 0.0007, np.hypot(q[:, 0] + 0.0018, q[:, 1] - 0.0022))
    c = mix(c, vec(0.85, 0.9, 0.95), spark)
    return c, np.full(len(p), 0.12)


# Hands: bare, a little redder at the knuckles and tips; short nails.

def hand_surface(p, n):
    q = both_sides(p)
    u, t, palm = extremities.hand_coords(q)
    c = mottle(q, SKIN, 0.07, 0.010, 151)
    knuckles = np.zeros(len(p))
    for points in sk.FINGERS.values():
        for j in points[:3]:
            knuckles = np.maximum(knuckles, np.exp(-(length(q - j + 0.006 * sk.HAND_PALM) / 0.008) ** 2))
        knuckles = np.maximum(knuckles, 0.8 * np.exp(-(length(q - points[3]) / 0.010) ** 2))
    c = mix(c, BLOOD, 0.35 * knuckles)
    back = n @ sk.HAND_PALM < 0.0
    nail = np.zeros(len(p))
    for name, points in list(sk.FINGERS.items()):
        tip = points[3] - 0.006 * sdf.unit(points[3] - points[2]) - 0.006 * sk.HAND_PALM
        nail = np.maximum(nail, smoothstep(1.0, 0.8, length((q - tip) / 0.0056)))
    c = mix(c, vec(0.62, 0.40, 0.32), 0.7 * nail * back)
    c = mix(c, vec(0.60, 0.33, 0.23), 0.3 * smoothstep(0.0, 0.012, palm))
    return c, 0.58 - 0.2 * nail


def hand_height(p):
    q = both_sides(p)
    h = 0.00012 * fractal(q, 0.0035, 2, 153)
    for points in sk.FINGERS.values():
        for j in points[1:3]:
            d = length(q - j)
            h = h - 0.0003 * np.exp(-(d / 0.009) ** 2) * np.cos((q - j) @ sdf.unit(points[2] - points[1]) / 0.0007)
    return h
