"""Arms that hold a crossbow: where it is says where both hands are."""

import math

import numpy as np

import crossbow
import skeleton as sk
from pose import STRAIGHTEST, between, fingers, frames_to, matrix, quaternion, turn
from sdf import unit

MIRROR = np.array([-1.0, 1.0, 1.0])


def _flip(side):
    return np.array([side, 1.0, 1.0])


def reach_arm(pose, side, wrist, hand, elbow):
    """Bends shoulder and elbow so that the wrist comes to `wrist` with the hand turned by `hand` (3 x 3); the elbow
    goes towards `elbow`, a direction. Half of the hand's twist is taken by the forearm."""
    s = "_l" if side > 0 else "_r"
    flip = _flip(side)
    turns, places = pose.world()
    shoulder = places["upper_arm" + s]
    want = wrist - shoulder
    reach = min(float(np.linalg.norm(want)), STRAIGHTEST * (sk.UPPER_ARM + sk.FOREARM))
    cos = (sk.UPPER_ARM ** 2 + reach ** 2 - sk.FOREARM ** 2) / (2 * sk.UPPER_ARM * reach)
    bend = math.acos(max(-1.0, min(1.0, cos)))
    to = unit(want)
    aside = unit(elbow - to * (elbow @ to))
    upper = math.cos(bend) * to + math.sin(bend) * aside
    fore = unit(shoulder + reach * to - (shoulder + sk.UPPER_ARM * upper))
    hinge = unit(np.cross(upper, fore))
    rest_upper, rest_fore = sk.ARM_DIR * flip, sk.FOREARM_DIR * flip
    rest_hinge = unit(np.cross(rest_upper, rest_fore))
    g_upper = frames_to(upper, hinge) @ frames_to(rest_upper, rest_hinge).T
    g_fore = frames_to(fore, hinge) @ frames_to(rest_fore, rest_hinge).T
    # The hand as it would be without a bent wrist says how far the forearm is twisted.
    straight = between(hand @ rest_fore, fore) @ hand
    apart = g_fore.T @ straight
    axis = rest_fore
    twist = math.atan2(axis @ np.array([apart[2, 1] - apart[1, 2], apart[0, 2] - apart[2, 0],
                                        apart[1, 0] - apart[0, 1]]), np.trace(apart) - 1.0)
    g_fore = g_fore @ turn(axis, 0.5 * twist)
    pose.set_world("upper_arm" + s, g_upper, turns)
    pose.set_world("lower_arm" + s, g_fore, turns)
    pose.set_world("hand" + s, hand, turns)


def _axes(forward, up):
    f = unit(np.asarray(forward, dtype=float))
    u = np.asarray(up, dtype=float)
    u = unit(u - f * (u @ f))
    return np.stack([f, u, np.cross(f, u)], axis=1)


# The weapon's axes in the rest pose, where it lies in the right hand.
_REST = _axes(crossbow.FORWARD * MIRROR, crossbow.UP * MIRROR)
_GRIP = (crossbow.GRIP - sk.WRIST) * MIRROR   # from the right wrist


class Weapon:
    """A crossbow somewhere: its grip (m) and where it points, about the person's axes."""

    def __init__(self, grip, forward, up=(0.0, 1.0, 0.0)):
        self.grip = np.asarray(grip, dtype=float)
        self.axes = _axes(forward, up)

    def point(self, forward, up=0.0, left=0.0):
        f, u, s = self.axes.T
        return self.grip + forward * f + up * u - left * s

    def between(self, other, share):
        """On the way to another place."""
        q, r = quaternion(self.axes), quaternion(other.axes)
        if q @ r < 0.0:
            r = -r
        way = Weapon((1 - share) * self.grip + share * other.grip, (1, 0, 0))
        way.axes = matrix((1 - share) * q + share * r)
        return way

    def moved(self, turn_, about, shift=0.0):
        """As it is where the trunk is turned by `turn_` about a place and carried by `shift`."""
        other = Weapon(turn_ @ (self.grip - about) + about + shift, (1, 0, 0))
        other.axes = turn_ @ self.axes
        return other


def right_hand(pose, weapon, elbow=(-0.6, -0.8, -0.3), curl=52.0):
    hand = weapon.axes @ _REST.T
    wrist = weapon.grip - hand @ _GRIP
    reach_arm(pose, -1, wrist, hand, np.asarray(elbow, dtype=float))
    fingers(pose, -1, curl, 26.0, 30.0)


def left_hand(pose, weapon, forward=crossbow.SUPPORT, elbow=(0.5, -0.8, 0.0), share=0.5):
    """Under the stock, palm up; `share` says how far its fingers point across it rather than along."""
    f, u, s = weapon.axes.T    # s: to the right of one who aims
    along = unit(share * s + (1.0 - share) * f + 0.10 * u)
    palm = unit(u - along * (u @ along))
    rest = np.stack([sk.HAND_ALONG, sk.HAND_PALM, np.cross(sk.HAND_ALONG, sk.HAND_PALM)], axis=1)
    hand = np.stack([along, palm, np.cross(along, palm)], axis=1) @ rest.T
    touch = hand @ (0.078 * sk.HAND_ALONG + 0.040 * sk.HAND_PALM)
    reach_arm(pose, 1, weapon.point(forward, -0.004) - touch, hand, np.asarray(elbow, dtype=float))
    fingers(pose, 1, 40.0, 12.0)


def both_hands(pose, weapon, **left):
    right_hand(pose, weapon)
    left_hand(pose, weapon, **left)
