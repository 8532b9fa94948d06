"""Which bones move a vertex, and by how much.

Each rule below gives a soft step across a joint, as a function of the place in
the rest pose alone: what overlaps (sleeve and hand, trousers and boot, jacket and
trousers) follows the same rule and so moves together. The result is smoothed over
the mesh and cut to the four largest weights.
"""

import numpy as np

import clothes
import extremities
import sdf
import skeleton as sk
from sdf import length, smoothstep, unit, vec

LIMIT = 4


class Table:
    """Weights (vertices x bones), filled by handing shares from bone to bone."""

    def __init__(self, count, first):
        self.w = np.zeros((count, len(sk.NAMES)))
        self.w[:, sk.INDEX[first]] = 1.0

    def hand_on(self, source, target, share):
        i, j = sk.INDEX[source], sk.INDEX[target]
        moved = self.w[:, i] * share
        self.w[:, i] -= moved
        self.w[:, j] += moved


def _spine(table, p):
    y = p[:, 1]
    table.hand_on("hips", "spine_1", smoothstep(1.005, 1.105, y))
    table.hand_on("spine_1", "spine_2", smoothstep(1.125, 1.235, y))
    table.hand_on("spine_2", "chest", smoothstep(1.245, 1.365, y))


def _neck(table, p, share=1.0):
    # The line from nape to chin climbs forward.
    s = p[:, 1] + 0.5 * (p[:, 2] + 0.02)
    table.hand_on("chest", "neck", share * smoothstep(1.455, 1.530, s))
    table.hand_on("neck", "head", share * smoothstep(1.510, 1.592, s))


def _leg(table, p):
    x, y, z = p.T
    thigh = smoothstep(1.000, 0.835, y - 0.35 * (np.abs(x) - 0.088) - 0.10 * z)
    width = 0.008 + 0.060 * smoothstep(0.800, 0.880, y)
    left = smoothstep(-width, width, x)
    table.hand_on("hips", "upper_leg_r", thigh * (1.0 - left))
    rest = thigh * left / np.maximum(1.0 - thigh * (1.0 - left), 1e-6)
    table.hand_on("hips", "upper_leg_l", rest)
    table.hand_on("upper_leg_l", "lower_leg_l", smoothstep(0.590, 0.460, y + 0.10 * z))


def _foot(table, p):
    y, z = p[:, 1], p[:, 2]
    table.hand_on("lower_leg_l", "foot_l", smoothstep(0.175, 0.080, y - 0.25 * (z + 0.012)))
    table.hand_on("foot_l", "toes_l", smoothstep(0.090, 0.122, z + 0.15 * y))


def _arm(table, p):
    sleeve, torso = clothes.sleeve_field(p), clothes.trunk_field(p)
    along = (p - sk.SHOULDER) @ unit(sk.ARM_DIR + vec(0.6, 0.0, 0.0))
    apart = smoothstep(-0.045, 0.040, torso - sleeve)
    arm = np.minimum(smoothstep(-0.050, 0.060, along), apart)
    girdle = smoothstep(0.035, 0.150, p[:, 0]) * smoothstep(1.300, 1.420, p[:, 1])
    table.hand_on("chest", "shoulder_l", 0.85 * girdle)
    for bone in ("chest", "spine_2", "shoulder_l", "spine_1", "hips"):
        table.hand_on(bone, "upper_arm_l", arm)
    bend = (p - sk.ELBOW) @ unit(sk.ARM_DIR + sk.FOREARM_DIR)
    table.hand_on("upper_arm_l", "lower_arm_l", smoothstep(-0.060, 0.060, bend))


def _wrist(table, p):
    u, _, _ = extremities.hand_coords(p)
    table.hand_on("lower_arm_l", "hand_l", smoothstep(-0.030, 0.024, u))


def _fingers(table, p):
    def to_chain(points):
        return sdf.chain(p, points, [0.0] * len(points), 0.0)
    chains = {"index": [sk.FINGERS["index"]], "thumb": [sk.THUMB],
              "fingers": [sk.FINGERS[n] for n in ("middle", "ring", "little")]}
    distance = {k: np.min([to_chain(c) for c in v], axis=0) for k, v in chains.items()}
    own = {k: smoothstep(0.004, -0.004, d - np.min([distance[o] for o in distance if o != k], axis=0))
           for k, d in distance.items()}
    for name, blend in (("thumb", 0.014), ("index", 0.010), ("fingers", 0.010)):
        first, second = name + "_1_l", name + "_2_l"
        a, b, c = sk.HEAD[first], sk.HEAD[second], sk.TAIL[second]
        s1 = (p - a) @ unit(b - a)
        s2 = (p - b) @ unit(unit(b - a) + unit(c - b))
        table.hand_on("hand_l", first, own[name] * smoothstep(-blend, blend, s1))
        table.hand_on(first, second, smoothstep(-0.7 * blend, 0.7 * blend, s2))


def _pack(count):
    table = Table(count, "chest")
    table.hand_on("chest", "spine_2", np.full(count, 0.35))
    return table


def _smooth(w, faces, amount, rounds):
    src = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    src = np.concatenate([src, src[:, ::-1]])
    for _ in range(rounds):
        total = np.zeros_like(w)
        count = np.zeros(len(w))
        np.add.at(total, src[:, 1], w[src[:, 0]])
        np.add.at(count, src[:, 1], 1.0)
        w = (1 - amount) * w + amount * total / np.maximum(count, 1.0)[:, None]
    return w


def _symmetric(w, p):
    """On the mirror plane both sides pull alike."""
    turn = [sk.INDEX[sk.mirrored(n)] for n in sk.NAMES]
    on = np.abs(p[:, 0]) < 1e-6
    w[on] = 0.5 * (w[on] + w[on][:, turn])
    return w


def limit(w):
    """The four largest, their sum 1; less than 1 % is dropped."""
    order = np.argsort(-w, axis=1, kind="stable")
    cut = np.zeros_like(w)
    rows = np.arange(len(w))[:, None]
    best = order[:, :LIMIT]
    cut[rows, best] = w[rows, best]
    cut[cut < 0.01 * cut.sum(axis=1, keepdims=True)] = 0.0
    return cut / cut.sum(axis=1, keepdims=True)


def of_body(name, p, faces, rigid):
    """Weights of a part's half, over sk.NAMES. `rigid`: the one bone that moves a part."""
    if name in rigid:
        return Table(len(p), rigid[name]).w
    if name in ("pack", "lid", "roll"):
        return _pack(len(p)).w
    table = Table(len(p), "hips")
    if name == "head":
        table = Table(len(p), "chest")
        _neck(table, p)
    elif name == "hand":
        table = Table(len(p), "lower_arm_l")
        _wrist(table, p)
        _fingers(table, p)
        return limit(_smooth(table.w, faces, 0.4, 2))
    elif name == "jacket":
        _spine(table, p)
        _neck(table, p, 0.45)
        _arm(table, p)
        _wrist(table, p)
        _leg(table, p)
    elif name == "trousers":
        _spine(table, p)
        _leg(table, p)
        _foot(table, p)
    elif name == "boot":
        table = Table(len(p), "lower_leg_l")
        _foot(table, p)
        return limit(_smooth(table.w, faces, 0.3, 1))
    rounds = 3 if name == "head" else 6
    return limit(_symmetric(_smooth(table.w, faces, 0.5, rounds), p))


def of_ribbon(p, jacket_points, jacket_weights, pack=True):
    """A strap moves as the jacket under it does; its ends, where there is a rucksack, as that does."""
    w = np.zeros((len(p), len(sk.NAMES)))
    for i, q in enumerate(p):
        d = length(jacket_points - q)
        near = np.argsort(d, kind="stable")[:4]
        share = 1.0 / (d[near] + 0.004)
        w[i] = (share[:, None] * jacket_weights[near]).sum(axis=0) / share.sum()
    if pack:
        behind = smoothstep(-0.085, -0.135, p[:, 2])[:, None]
        w = w * (1 - behind) + _pack(len(p)).w * behind
    return limit(_symmetric(w, p))


def of_all(halves, rigid, worn=()):
    """`rigid`: the bone of each part that one bone moves. `worn`: parts that lie on the jacket and move with it."""
    out = {}
    pack = any(h.name == "pack" for h in halves)
    for half in halves:
        if half.name in rigid or not (half.ribbon or half.name in worn):
            out[half.name] = of_body(half.name, half.verts, half.faces, rigid)
    jacket = next(h for h in halves if h.name == "jacket")
    for half in halves:
        if half.name not in out:
            out[half.name] = of_ribbon(half.verts, jacket.verts, out["jacket"], pack)
    return out
