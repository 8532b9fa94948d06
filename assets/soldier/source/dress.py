"""Colour, roughness and relief of a soldier: iron, a quilted coat of dark blue, a beard."""

import numpy as np

import clothes
import crossbow
import extremities
import head
import looks
import looks_body as body
import looks_clothes as cloth
import looks_pack as gear
import ribbons
import sdf
import shapes
from looks import Look
from palette import both_sides, line, mix, mottle, nothing, weave
from sdf import bump, fractal, smoothstep, vec

# Iron: no metal in the material, so it is a grey that shines.
IRON = vec(0.235, 0.240, 0.250)
RUST = vec(0.150, 0.070, 0.032)
BLUE = vec(0.034, 0.062, 0.150)
SAND = vec(0.300, 0.235, 0.140)
LEATHER = vec(0.092, 0.048, 0.022)
ASH = vec(0.235, 0.130, 0.058)


def _iron(p, seed):
    hammered = fractal(p, 0.016, 2, seed)
    spots = smoothstep(0.35, 0.75, fractal(p, 0.020, 3, seed + 1))
    c = mottle(p, IRON, 0.10, 0.012, seed + 2) * (1.0 + 0.10 * hammered)[:, None]
    return mix(c, RUST, 0.45 * spots), 0.36 + 0.22 * spots + 0.06 * hammered


def helmet_surface(p, n):
    c, rough = _iron(p, 201)
    r = shapes.hat_radius(p)
    under = smoothstep(0.1, -0.2, n[:, 1])
    c = mix(c, vec(0.055, 0.050, 0.046), 0.75 * under)
    # Rivets around the bowl, above the brim.
    h = shapes.hat_height(p)
    angle = np.arctan2(p[:, 0], p[:, 2] + 0.012)
    rivet = bump(np.abs(((angle / (2 * np.pi) * 22) % 1.0) - 0.5), 0.0, 0.16) * bump(h, 0.016, 0.006)
    c = mix(c, IRON * 1.5, 0.8 * rivet * (r < 1.08))
    return c, rough + 0.2 * under


def helmet_height(p):
    h = shapes.hat_height(p)
    angle = np.arctan2(p[:, 0], p[:, 2] + 0.012)
    rivet = bump(np.abs(((angle / (2 * np.pi) * 22) % 1.0) - 0.5), 0.0, 0.16) * bump(h, 0.016, 0.006)
    comb = 0.0060 * np.exp(-(p[:, 0] / 0.0060) ** 2) * smoothstep(0.02, 0.05, h)
    return 0.0008 * fractal(p, 0.014, 2, 201) + 0.0016 * rivet + comb


def plate_surface(p, n):
    c, rough = _iron(p, 211)
    inner = smoothstep(0.009, 0.005, clothes.trunk_field(both_sides(p)))
    c = mix(c, vec(0.05, 0.045, 0.04), inner)
    # A stripe of the town's colour over the left breast would not survive the mirror: both sides have one.
    q = both_sides(p)
    strap = smoothstep(0.0165, 0.0150, np.abs(p[:, 1] - 1.150)) * (q[:, 0] > 0.115) * (np.abs(p[:, 2]) < 0.07)
    return mix(c, LEATHER, 0.95 * strap), rough + 0.4 * strap


def plate_height(p):
    q = both_sides(p)
    strap = smoothstep(0.0165, 0.0140, np.abs(p[:, 1] - 1.150)) * (q[:, 0] > 0.115) * (np.abs(p[:, 2]) < 0.07)
    return 0.0008 * fractal(p, 0.018, 2, 211) + 0.0014 * strap


# The coat: quilted in upright tubes on the trunk, and along the sleeves.

def _quilt(p):
    """0 on a seam, 1 in the middle of a tube."""
    q = both_sides(p)
    angle = np.arctan2(q[:, 0], q[:, 2] + 0.004)
    trunk = np.abs(((angle * 9.0) % 1.0) - 0.5)
    u, v, w = clothes.forearm_coords(q)
    arm = np.abs(((np.arctan2(v, w) * 2.6) % 1.0) - 0.5)
    on_arm = smoothstep(-0.02, 0.02, cloth._armhole(q)) * (q[:, 0] > 0.14)
    share = (1.0 - on_arm) * trunk + on_arm * arm
    return smoothstep(0.5, 0.36, share)


def _strap(q):
    """1 on the straps that carry the plate over the shoulders."""
    return smoothstep(0.0185, 0.0165, np.abs(q[:, 0] - 0.108)) * (q[:, 1] > 1.36)


def coat_surface(p, n):
    q = both_sides(p)
    c = mottle(p, BLUE, 0.16, 0.05, 221)
    u, _, _ = clothes.forearm_coords(q)
    cuff = smoothstep(-0.034, -0.030, u - clothes.CUFF_U) * (q[:, 0] > 0.3)
    hem = smoothstep(clothes.HEM + 0.036, clothes.HEM + 0.032, p[:, 1]) * (q[:, 0] < 0.3)
    c = mix(c, SAND, 0.92 * np.maximum(cuff, hem))
    c = c * (0.60 + 0.40 * _quilt(p))[:, None]
    worn = smoothstep(0.1, 0.9, fractal(p, 0.03, 3, 223))
    c = mix(c, c * 1.4 + 0.006, 0.35 * worn)
    front = smoothstep(0.0060, 0.0045, np.abs(p[:, 0])) * (p[:, 2] > 0.02)
    c = mix(c, BLUE * 0.45, 0.9 * front)
    c = mix(c, LEATHER, 0.95 * _strap(q))
    return c, np.clip(0.86 + 0.05 * fractal(p, 0.04, 2, 225), 0.5, 0.98)


def coat_height(p):
    strap = _strap(both_sides(p))
    return 0.0022 * _quilt(p) * (1.0 - strap) + 0.0020 * strap + 0.00012 * weave(p) + 0.0008 * fractal(p, (0.018, 0.026, 0.018), 3, 227)


def collar_surface(p, n):
    c = mottle(p, BLUE * 0.8, 0.12, 0.04, 229)
    inside = smoothstep(0.1, -0.1, n[:, 0] * p[:, 0] + n[:, 2] * (p[:, 2] + 0.015))
    return mix(c, SAND * 0.8, inside), 0.84 + 0.10 * inside


def hose_surface(p, n):
    c = mottle(p, vec(0.070, 0.058, 0.042), 0.16, 0.04, 231)
    for d in cloth.trousers_lines(p):
        c = c * (1.0 - 0.30 * line(d, 0.0030))[:, None]
    dust = smoothstep(0.36, 0.12, p[:, 1]) * (0.55 + 0.45 * fractal(p, 0.035, 3, 233))
    c = mix(c, vec(0.150, 0.128, 0.098), 0.55 * np.clip(dust, 0, 1))
    return c, np.clip(0.88 + 0.05 * fractal(p, 0.03, 2, 235), 0, 1)


def hose_height(p):
    return 0.00014 * weave(p, 0.0046) + 0.0012 * fractal(p, (0.018, 0.030, 0.018), 3, 237)


def head_surface(p, n):
    """The hiker's, with a beard and darker hair."""
    c, rough = body.head_surface(p, n)
    q = both_sides(p)
    beard = body._stubble(q) * (0.75 + 0.25 * fractal(q, (0.003, 0.012, 0.003), 2, 241))
    hair = vec(0.030, 0.018, 0.011)
    c = mix(c, hair[None] * (0.7 + 0.9 * (0.5 + 0.5 * fractal(q, (0.0024, 0.014, 0.0024), 3, 243)))[:, None],
            np.clip(1.15 * beard, 0, 0.94))
    c = mix(c, hair, 0.7 * head.hair_amount(q))
    return c, rough + 0.1 * beard


def head_height(p):
    q = both_sides(p)
    return body.head_height(p) + 0.0016 * body._stubble(q) * (0.5 + 0.5 * fractal(q, (0.0030, 0.016, 0.0030), 2, 245))


def belt_surface(p, n):
    c = mottle(p, LEATHER, 0.18, 0.02, 251)
    x = np.abs(p[:, 0])
    buckle = smoothstep(0.030, 0.029, x) * (p[:, 2] > 0.0) * smoothstep(0.014, 0.018, x)
    return mix(c, vec(0.300, 0.220, 0.090), buckle), 0.62 - 0.25 * buckle


def crossbow_surface(p, n):
    f, up, aside = crossbow.coords(both_sides(p))
    c = mottle(p, ASH, 0.22, (0.006, 0.040, 0.006), 261)
    grain = fractal(np.stack([f * 0.15, up, aside], axis=1), 0.004, 2, 263)
    c = c * (1.0 + 0.18 * grain)[:, None]
    rough = np.full(len(p), 0.58)
    steel = (np.abs(aside) > 0.0225) & (f > 0.215)
    steel |= f > crossbow.MUZZLE + 0.001
    steel |= (up < -0.026) & (f > -0.17) & (np.abs(aside) < 0.007)
    c[steel], rough[steel] = IRON * 0.75, 0.40
    # From tip to nut the string runs straight: it is as far back of the bow as it is far from the tip.
    half = np.abs(aside)
    on_line = crossbow.NUT + (half - 0.012) / (crossbow.BOW - 0.012) * (crossbow.MUZZLE - 0.125 - crossbow.NUT)
    string = (np.abs(f - on_line) < 0.012) & (half < crossbow.BOW - 0.012) & (up > -0.004) & ((half > 0.021) | (up > 0.0235))
    string &= ~((half < 0.014) & (f > crossbow.NUT + 0.008))
    c[string], rough[string] = vec(0.42, 0.36, 0.25), 0.9
    bolt = (up > 0.0228) & (half < 0.0145) & (f > crossbow.NUT + 0.004) & ~string
    c[bolt], rough[bolt] = vec(0.34, 0.25, 0.14), 0.7
    feathers = bolt & (f < crossbow.NUT + 0.066) & (np.abs(up - 0.0275) < 0.003) & (half > 0.0046)
    c[feathers] = vec(0.50, 0.47, 0.42)
    return c, rough


def all_looks():
    table = dict(looks.LOOKS)
    jacket = sdf.mirror_field(clothes.jacket_field)
    table.update({
        "head": Look(head_surface, head_height, sdf.mirror_field(head.head_fine)),
        "helmet": Look(helmet_surface, helmet_height),
        "plate": Look(plate_surface, plate_height, sdf.mirror_field(shapes.plate_field)),
        "jacket": Look(coat_surface, coat_height, jacket),
        "trousers": Look(hose_surface, hose_height, sdf.mirror_field(clothes.trousers_field)),
        "collar": Look(collar_surface, cloth.collar_height),
        "belt": Look(belt_surface, gear.strap_height),
        "crossbow": Look(crossbow_surface, nothing),
    })
    return table
