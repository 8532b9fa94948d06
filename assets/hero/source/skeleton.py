"""Where the joints are, in metres, with the person standing in the rest pose.

Axes are glTF's: +x is the person's left, +y up, +z where the person looks; the
origin is on the ground between the feet. Lengths follow the segment table of
Winter, "Biomechanics and Motor Control of Human Movement" (4th ed., fig. 4.1)
for 1.755 m, on soles of 25 mm: 1.78 m in boots. The arms hang at 42 degrees from
the vertical, between where they mostly are and where a wave lifts them.
"""

import math

import numpy as np

from sdf import unit, vec

STATURE = 1.78
SOLE = 0.025
THIGH = 0.430
SHANK = 0.432
UPPER_ARM = 0.295
FOREARM = 0.255

HIP = vec(0.088, 0.955, 0.0)
KNEE = vec(0.092, HIP[1] - THIGH, 0.004)
ANKLE = vec(0.096, 0.093, -0.006)
BALL = vec(0.098, 0.007, 0.122)
TOE = vec(0.098, 0.012, 0.205)
HEEL = vec(0.096, 0.0, -0.072)

ARM_ANGLE = math.radians(42.0)
SHOULDER = vec(0.177, 1.430, -0.018)
ARM_DIR = vec(math.sin(ARM_ANGLE), -math.cos(ARM_ANGLE), 0.0)
ELBOW = SHOULDER + UPPER_ARM * ARM_DIR
# The forearm is bent forward a little: no elbow is ever quite straight.
_BEND = math.radians(9.0)
FOREARM_DIR = ARM_DIR * math.cos(_BEND) + vec(0.0, 0.0, 1.0) * math.sin(_BEND)
WRIST = ELBOW + FOREARM * FOREARM_DIR

# The hand's frame: along the fingers, towards the thumb, out of the palm.
HAND_ALONG = FOREARM_DIR
HAND_THUMB = unit(vec(0.0, 0.0, 1.0) - FOREARM_DIR * FOREARM_DIR[2])
HAND_PALM = np.cross(HAND_THUMB, HAND_ALONG)
if HAND_PALM[0] > 0.0:
    HAND_PALM = -HAND_PALM


def hand_point(along, thumb, palm):
    """A point of the left hand: metres from the wrist in the hand's frame."""
    return WRIST + along * HAND_ALONG + thumb * HAND_THUMB + palm * HAND_PALM


# Fingers from the thumb's side to the little one: knuckle, middle joint, end joint, tip.
def _finger(along, thumb, lengths, spread, curl):
    joints = [hand_point(along, thumb, 0.0)]
    direction = math.radians(curl)
    u, t, n = along, thumb, 0.0
    for i, l in enumerate(lengths):
        a = direction * (i + 0.6)
        u += l * math.cos(a) * math.cos(spread)
        t += l * math.cos(a) * math.sin(spread)
        n += l * math.sin(a)
        joints.append(hand_point(u, t, n))
    return joints


FINGERS = {
    "index": _finger(0.089, 0.028, (0.044, 0.026, 0.020), 0.10, 14.0),
    "middle": _finger(0.093, 0.0085, (0.048, 0.029, 0.021), 0.025, 15.0),
    "ring": _finger(0.090, -0.0110, (0.045, 0.027, 0.021), -0.06, 16.5),
    "little": _finger(0.082, -0.0295, (0.036, 0.021, 0.019), -0.15, 18.0),
}
THUMB = [hand_point(0.022, 0.022, 0.012), hand_point(0.052, 0.046, 0.024),
         hand_point(0.080, 0.058, 0.030), hand_point(0.104, 0.064, 0.033)]

_HIPS = vec(0.0, 0.985, -0.005)
_SPINE = [vec(0.0, 1.060, -0.008), vec(0.0, 1.180, -0.006), vec(0.0, 1.305, -0.018)]
_NECK = vec(0.0, 1.475, -0.030)
_HEAD = vec(0.0, 1.572, -0.016)


def _bones():
    """(name, parent, head, tail), parents first. Names of a side end in _l or _r."""
    bones = [
        ("root", None, vec(0, 0, 0), vec(0, 0, 0.2)),
        ("hips", "root", _HIPS, _SPINE[0]),
        ("spine_1", "hips", _SPINE[0], _SPINE[1]),
        ("spine_2", "spine_1", _SPINE[1], _SPINE[2]),
        ("chest", "spine_2", _SPINE[2], _NECK),
        ("neck", "chest", _NECK, _HEAD),
        ("head", "neck", _HEAD, vec(0.0, 1.78, -0.016)),
    ]
    left = [
        ("shoulder", "chest", vec(0.028, 1.425, 0.010), SHOULDER),
        ("upper_arm", "shoulder", SHOULDER, ELBOW),
        ("lower_arm", "upper_arm", ELBOW, WRIST),
        ("hand", "lower_arm", WRIST, FINGERS["middle"][0]),
        ("thumb_1", "hand", THUMB[0], THUMB[1]),
        ("thumb_2", "thumb_1", THUMB[1], THUMB[3]),
        ("index_1", "hand", FINGERS["index"][0], FINGERS["index"][1]),
        ("index_2", "index_1", FINGERS["index"][1], FINGERS["index"][3]),
        # Middle, ring and little finger share two bones, those of the ring and middle's mean.
        ("fingers_1", "hand", 0.5 * (FINGERS["middle"][0] + FINGERS["ring"][0]),
         0.5 * (FINGERS["middle"][1] + FINGERS["ring"][1])),
        ("fingers_2", "fingers_1", 0.5 * (FINGERS["middle"][1] + FINGERS["ring"][1]),
         0.5 * (FINGERS["middle"][3] + FINGERS["ring"][3])),
        ("upper_leg", "hips", HIP, KNEE),
        ("lower_leg", "upper_leg", KNEE, ANKLE),
        ("foot", "lower_leg", ANKLE, BALL),
        ("toes", "foot", BALL, TOE),
    ]
    flip = vec(-1, 1, 1)
    central = {name for name, *_ in bones}
    for side, turn in (("_l", vec(1, 1, 1)), ("_r", flip)):
        for name, parent, head, tail in left:
            parent = parent if parent in central else parent + side
            bones.append((name + side, parent, head * turn, tail * turn))
    return bones


BONES = _bones()
NAMES = [b[0] for b in BONES]
INDEX = {name: i for i, name in enumerate(NAMES)}
PARENT = {b[0]: b[1] for b in BONES}
HEAD = {b[0]: b[2] for b in BONES}
TAIL = {b[0]: b[3] for b in BONES}


def mirrored(name):
    """The bone of the other side, or the same one on the middle line."""
    if name.endswith("_l"):
        return name[:-2] + "_r"
    if name.endswith("_r"):
        return name[:-2] + "_l"
    return name
