"""Poses: turns of bones about the person's own axes, and the legs and arms that
reach for a place.

A pose gives each bone a turn in the rest axes (x left, y up, z forward) against
its parent: turning about +x bends a spine forward and takes a hanging leg back,
about +y turns to the left, about +z tips to the right (raises what is left).
"""

import math

import numpy as np

import skeleton as sk
from sdf import unit


def turn(axis, radians):
    """The matrix that turns about a unit axis (Rodrigues)."""
    x, y, z = axis
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + math.sin(radians) * k + (1 - math.cos(radians)) * (k @ k)


def turn_x(degrees):
    return turn((1, 0, 0), math.radians(degrees))


def turn_y(degrees):
    return turn((0, 1, 0), math.radians(degrees))


def turn_z(degrees):
    return turn((0, 0, 1), math.radians(degrees))


def between(a, b):
    """The shortest turn that takes direction a to b."""
    a, b = unit(a), unit(b)
    axis = np.cross(a, b)
    s = np.linalg.norm(axis)
    if s < 1e-9:
        return np.eye(3)
    return turn(axis / s, math.atan2(s, a @ b))


def frames_to(along, hinge):
    """Axes with y along a limb and x along its hinge made square to it."""
    y = unit(along)
    x = unit(hinge - y * (hinge @ y))
    return np.stack([x, y, np.cross(x, y)], axis=1)


class Pose:
    def __init__(self):
        self.local = {name: np.eye(3) for name in sk.NAMES}
        self.shift = np.zeros(3)  # of the hips, m

    def turned(self, bone, *turns):
        """Turns the bone further, the first turn outermost."""
        for t in turns:
            self.local[bone] = self.local[bone] @ t
        return self

    def world(self):
        """Each bone's turn and the place of its head."""
        turns, places = {}, {}
        for name in sk.NAMES:
            parent = sk.PARENT[name]
            if parent is None:
                turns[name], places[name] = self.local[name], sk.HEAD[name].copy()
                continue
            places[name] = places[parent] + turns[parent] @ (sk.HEAD[name] - sk.HEAD[parent])
            if name == "hips":
                places[name] = places[name] + self.shift
            turns[name] = turns[parent] @ self.local[name]
        return turns, places

    def set_world(self, name, want, turns):
        """Makes the bone's turn in the world `want`; `turns` is kept up to date."""
        self.local[name] = turns[sk.PARENT[name]].T @ want
        turns[name] = want


# A leg never reaches further than this share of its length, so no knee locks.
STRAIGHTEST = 0.9965


def reach_leg(pose, side, ankle, foot_turn, toes_bend=0.0, knee_out=0.0):
    """Bends hip and knee so that the ankle comes to `ankle` with the foot turned by
    `foot_turn` (3 x 3). `knee_out`: degrees that the knee points outwards. What is out
    of reach the leg points to (check.py would see that foot slide)."""
    s = "_l" if side > 0 else "_r"
    turns, places = pose.world()
    hip = places["upper_leg" + s]
    want = ankle - hip
    reach = min(np.linalg.norm(want), STRAIGHTEST * (sk.THIGH + sk.SHANK))
    thigh = np.linalg.norm(sk.KNEE - sk.HIP)
    shank = np.linalg.norm(sk.ANKLE - sk.KNEE)
    cos_hip = (thigh ** 2 + reach ** 2 - shank ** 2) / (2 * thigh * reach)
    bend = math.acos(max(-1.0, min(1.0, cos_hip)))
    # The knee goes where the foot and the hips look, on average.
    ahead = unit(foot_turn @ np.array([0, 0, 1.0]) + turns["hips"] @ np.array([0, 0, 1.0]))
    ahead = turn_y(side * knee_out) @ ahead
    down = unit(want)
    hinge = unit(np.cross(ahead, down))  # turning about -hinge takes the thigh forward
    thigh_dir = turn(hinge, -bend) @ down
    knee = hip + thigh * thigh_dir
    shank_dir = unit(hip + reach * down - knee)
    flip = np.array([side, 1.0, 1.0])
    rest_hinge = np.array([1.0, 0.0, 0.0])
    rest_thigh = (sk.KNEE - sk.HIP) * flip
    rest_shank = (sk.ANKLE - sk.KNEE) * flip
    g_thigh = frames_to(thigh_dir, hinge) @ frames_to(rest_thigh, rest_hinge).T
    g_shank = frames_to(shank_dir, hinge) @ frames_to(rest_shank, rest_hinge).T
    pose.set_world("upper_leg" + s, g_thigh, turns)
    pose.set_world("lower_leg" + s, g_shank, turns)
    pose.set_world("foot" + s, foot_turn, turns)
    pose.local["toes" + s] = turn_x(-toes_bend)


def arm(pose, side, forward, out, elbow, twist=0.0, wrist=0.0):
    """The arm from hanging straight down: degrees forward, out, bent at the elbow.
    `twist` turns the upper arm inwards, `wrist` bends the hand to the palm."""
    s = "_l" if side > 0 else "_r"
    flip = np.diag([side, 1.0, 1.0])
    # From the rest pose to hanging: the shoulder is turned by the rest's angle.
    hang = turn_z(-math.degrees(sk.ARM_ANGLE))
    g = turn_x(-forward) @ turn_z(out) @ turn_y(-twist) @ hang
    pose.local["upper_arm" + s] = flip @ g @ flip
    # The elbow's hinge in the rest pose: it takes the forearm towards +z.
    hinge = unit(np.cross(sk.ARM_DIR, np.array([0, 0, 1.0])))
    pose.local["lower_arm" + s] = flip @ turn(hinge, math.radians(elbow)) @ flip
    palm = unit(np.cross(sk.HAND_ALONG, sk.HAND_PALM))
    pose.local["hand" + s] = flip @ turn(palm, math.radians(wrist)) @ flip


def fingers(pose, side, curl, thumb=0.0, index=None):
    """Bends the fingers by `curl` degrees at each joint beyond the rest pose."""
    s = "_l" if side > 0 else "_r"
    flip = np.diag([side, 1.0, 1.0])
    axis = unit(np.cross(sk.HAND_ALONG, sk.HAND_PALM))
    for name, amount in (("fingers", curl), ("index", curl if index is None else index)):
        t = flip @ turn(axis, math.radians(amount)) @ flip
        pose.local[name + "_1" + s] = t
        pose.local[name + "_2" + s] = t
    across = unit(np.cross(unit(sk.THUMB[1] - sk.THUMB[0]), sk.HAND_PALM * 0.4 - sk.HAND_THUMB))
    t = flip @ turn(across, math.radians(thumb)) @ flip
    pose.local["thumb_1" + s] = t
    pose.local["thumb_2" + s] = t


def quaternion(m):
    """(w, x, y, z) of a turn, w >= 0 where it can be told."""
    t = np.trace(m)
    candidates = np.array([t, m[0, 0], m[1, 1], m[2, 2]])
    i = int(np.argmax(candidates))
    if i == 0:
        q = np.array([1 + t, m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]])
    else:
        a, b, c = [(0, 1, 2), (1, 2, 0), (2, 0, 1)][i - 1]
        q = np.zeros(4)
        q[0] = m[c, b] - m[b, c]
        q[1 + a] = 1 + m[a, a] - m[b, b] - m[c, c]
        q[1 + b] = m[b, a] + m[a, b]
        q[1 + c] = m[c, a] + m[a, c]
    return q / np.linalg.norm(q)


def blend(a, b, share):
    """A pose between two: each turn goes its shortest way."""
    out = Pose()
    out.shift = (1 - share) * a.shift + share * b.shift
    for name in sk.NAMES:
        qa, qb = quaternion(a.local[name]), quaternion(b.local[name])
        if qa @ qb < 0.0:
            qb = -qb
        angle = math.acos(min(1.0, qa @ qb))
        if angle < 1e-6:
            q = qa
        else:
            q = (math.sin((1 - share) * angle) * qa + math.sin(share * angle) * qb) / math.sin(angle)
        out.local[name] = matrix(q)
    return out


def matrix(q):
    w, x, y, z = q / np.linalg.norm(q)
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])
