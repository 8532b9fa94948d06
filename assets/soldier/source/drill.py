"""A soldier's clips: the hiker's steps with a crossbow in both hands, and what only a soldier does.

`alarm`, `aim`, `shoot` and `hit` are laid over standing and walking from the spine up; `fall_back` is of the whole
body, and its last pose is how somebody lies who fell.
"""

import math

import numpy as np

import clips
import skeleton as sk
from clips import Clip, RATE, TAU, ease, idle, run, stand, walk
from hold import Weapon, both_hands, left_hand, right_hand
from pose import Pose, arm, blend, fingers, matrix, quaternion, reach_leg, turn_x, turn_y, turn_z

CHEST = sk.HEAD["chest"]

# As it is carried: low, pointing ahead and to the ground, across the body.
CARRIED = Weapon((-0.165, 1.085, 0.205), (0.42, -0.40, 0.80), (0.05, 1.0, 0.35))
# At a run it is held closer and steeper.
RUNNING = Weapon((-0.150, 1.100, 0.205), (0.62, 0.30, 0.62), (-0.35, 0.75, 0.55))


def _with_trunk(pose, weapon, share=1.0):
    """The weapon where the trunk carries it."""
    turns, places = pose.world()
    way = turns["chest"]
    if share < 1.0:
        q = (1.0 - share) * np.array([1.0, 0.0, 0.0, 0.0]) + share * quaternion(way)
        way = matrix(q)
    return weapon.moved(way, CHEST, places["chest"] - CHEST)


def _carrying(steps, weapon, share):
    def pose(t):
        p = steps(t)
        both_hands(p, _with_trunk(p, weapon, share))
        return p
    return pose


guard = _carrying(idle, CARRIED, 0.7)
patrol = _carrying(walk, CARRIED, 0.45)
charge = _carrying(run, RUNNING, 0.55)


def _turning(direction):
    steps, _ = clips._turning(direction)
    return _carrying(steps, CARRIED, 0.6)


def _still():
    """Standing without breath, for clips that are laid over others."""
    p = Pose()
    p.shift = np.array([0.0, clips.IDLE_DROP, 0.0])
    p.turned("hips", turn_x(1.0))
    p.turned("spine_1", turn_x(1.2))
    stand(p)
    return p


def _aiming(back=0.0, up=0.0, lean=4.0):
    """At the shoulder: the left side turned ahead, the cheek over the stock. `back`: metres of recoil, `up`: degrees."""
    p = _still()
    p.turned("spine_2", turn_y(-17.0), turn_x(lean - 0.6 * up))
    p.turned("chest", turn_y(-20.0), turn_x(lean - 0.6 * up))
    p.turned("shoulder_l", turn_y(-10.0))
    p.turned("shoulder_r", turn_z(-5.0), turn_y(-4.0))
    p.turned("neck", turn_y(16.0), turn_x(3.0))
    p.turned("head", turn_y(20.0), turn_x(4.0), turn_z(9.0))
    _, places = p.world()
    butt = places["upper_arm_r"] + np.array([0.062, 0.020, 0.065])
    tilt = turn_x(-up)
    ahead = tilt @ np.array([0.045, 0.0, 1.0])
    weapon = Weapon(butt + 0.285 * ahead / np.linalg.norm(ahead) - np.array([0.0, 0.0, back]), ahead, tilt @ np.array([0, 1.0, 0]))
    right_hand(p, weapon, elbow=(-0.75, -0.65, -0.1))
    left_hand(p, weapon, forward=0.170, elbow=(0.35, -0.93, 0.1), share=0.35)
    return p


def _lowered():
    p = _still()
    both_hands(p, _with_trunk(p, CARRIED, 0.7))
    return p


def _spanning(pull):
    """The bow points at the ground ahead and the left hand draws the string: at the bow (0) or at the nut (1)."""
    p = _still()
    lean = 9.0 + 4.0 * pull
    for bone in ("spine_2", "chest"):
        p.turned(bone, turn_x(lean), turn_y(-5.0))
    p.turned("neck", turn_x(6.0))
    p.turned("head", turn_x(14.0))
    weapon = Weapon((-0.130, 1.115, 0.230), (0.30, -0.86, 0.42), (0.10, 0.40, 0.90))
    right_hand(p, weapon, elbow=(-0.8, -0.3, -0.5))
    at = 0.255 - 0.135 * pull
    left_hand(p, weapon, forward=at, elbow=(0.8, -0.3, -0.3), share=0.9)
    return p


def _keyed(keys):
    return clips._keyed(keys)


AIM = 14       # frames until the weapon is up
SHOOT = 48
HIT = 18
ALARM = 45
FALL = 45


def _aim():
    return _keyed([(0.0, _lowered()), (AIM / RATE, _aiming())])


def _shoot():
    rest = _aiming()
    keys = [(0.0, rest), (1 / RATE, _aiming(0.035, 5.0, 1.5)), (7 / RATE, rest), (14 / RATE, _spanning(0.0)),
            (24 / RATE, _spanning(1.0)), (29 / RATE, _spanning(0.85)), (39 / RATE, rest), (SHOOT / RATE, rest)]
    return _keyed(keys)


def _alarm():
    """Calls the others: the free arm up and waving, the weapon in one hand."""
    def up(beat):
        p = _still()
        p.turned("chest", turn_y(14.0), turn_x(-5.0))
        p.turned("neck", turn_y(8.0), turn_x(-4.0))
        p.turned("head", turn_y(14.0), turn_x(-9.0))
        p.turned("shoulder_l", turn_z(13.0))
        arm(p, 1, 30.0, 122.0 + 8.0 * beat, 52.0 + 34.0 * beat, twist=-40.0)
        fingers(p, 1, -6.0, -4.0, -6.0)
        right_hand(p, _with_trunk(p, Weapon((-0.235, 1.060, 0.190), (0.10, -0.35, 0.93)), 0.6))
        return p
    keys = [(0.0, _lowered()), (9 / RATE, up(0.0)), (15 / RATE, up(1.0)), (21 / RATE, up(0.0)), (27 / RATE, up(1.0)),
            (33 / RATE, up(0.0)), (ALARM / RATE, _lowered())]
    return _keyed(keys)


def _hit():
    """A bolt in the right shoulder: thrown round, bent over it, up again."""
    def struck(share):
        p = _still()
        p.turned("spine_2", turn_y(-13.0 * share), turn_x(9.0 * share))
        p.turned("chest", turn_y(-19.0 * share), turn_x(10.0 * share), turn_z(7.0 * share))
        p.turned("neck", turn_x(12.0 * share))
        p.turned("head", turn_x(15.0 * share), turn_z(-9.0 * share), turn_y(10.0 * share))
        p.turned("shoulder_r", turn_z(-9.0 * share))
        low = Weapon(CARRIED.grip + np.array([0.02, -0.05, -0.02]) * share, (0.42, -0.40 - 0.45 * share, 0.80), (0.05, 1.0, 0.35))
        both_hands(p, _with_trunk(p, low, 0.7))
        return p
    return _keyed([(0.0, _lowered()), (3 / RATE, struck(1.0)), (8 / RATE, struck(0.75)), (HIT / RATE, _lowered())])


# Falling: the knees give, the trunk goes back over them, the back meets the ground, the limbs follow.

def _feet(p, places, pitches):
    p.feet, p.pitches = np.array(places, dtype=float), np.array(pitches, dtype=float)
    for side, (x, y, z), pitch in zip((1, -1), places, pitches):
        reach_leg(p, side, np.array([x, y, z]), turn_y(side * 14.0) @ turn_x(-pitch), 0.0, knee_out=14.0)


PLANTED = [(clips.STAND_WIDTH, sk.ANKLE[1], 0.012), (-clips.STAND_WIDTH, sk.ANKLE[1], -0.012)]


def _down(tilt, shift, bends, feet, pitches, weapon, left, head=0.0, roll=0.0, elbow=(-0.8, -0.2, 0.1)):
    """The hips tilted back by `tilt` degrees and carried by `shift`, the spine bent by `bends` at each bone."""
    p = Pose()
    p.shift = np.array(shift, dtype=float)
    p.turned("hips", turn_z(roll), turn_x(-tilt))
    for bone, bend in zip(("spine_1", "spine_2", "chest"), bends):
        p.turned(bone, turn_x(bend))
    p.turned("neck", turn_x(head))
    p.turned("head", turn_x(head), turn_y(0.5 * head))
    _feet(p, feet, pitches)
    forward, out, bent, twist = left
    arm(p, 1, forward, out, bent, twist=twist)
    fingers(p, 1, 10.0, 6.0)
    right_hand(p, weapon, elbow=elbow, curl=52.0)
    p.weapon, p.elbow = weapon, np.array(elbow)
    return p


# Lying on a back 0.13 m thick, a helmet's brim below the head.
LYING = 0.1500
# Where the right elbow of somebody lying goes: over the ground, not into it.
FLAT = (-0.55, 0.55, 0.60)


def _fall():
    hips = sk.HEAD["hips"]
    lie = lambda y, z: (0.0, y - hips[1], z - hips[2])
    standing = _lowered()
    standing.feet, standing.pitches = np.array(PLANTED), np.zeros(2)
    standing.weapon, standing.elbow = _with_trunk(standing, CARRIED, 0.7), np.array((-0.6, -0.8, -0.3))
    struck = _down(4.0, (0.0, -0.055, -0.03), (6, 9, 9), PLANTED, (0, 0),
                   Weapon((-0.20, 1.02, 0.23), (0.35, -0.60, 0.70)), (30.0, 24.0, 40.0, 10.0), 13.0, 3.0)
    giving = _down(16.0, (0.0, -0.300, -0.16), (5, 6, 6), PLANTED, (0, 0),
                   Weapon((-0.34, 0.80, 0.14), (-0.25, 0.10, 0.96)), (44.0, 52.0, 40.0, 0.0), 10.0, 4.0)
    sitting = _down(42.0, lie(0.36, -0.34), (10, 12, 10), [(0.125, 0.093, 0.06), (-0.14, 0.093, 0.02)], (0, 4),
                    Weapon((-0.50, 0.48, -0.26), (-0.45, 0.30, 0.84)), (20.0, 74.0, 30.0, 0.0), 20.0, 5.0)
    landing = _down(78.0, lie(0.185, -0.40), (2, 2, 2), [(0.150, 0.120, 0.36), (-0.165, 0.115, 0.28)], (22, 18),
                    Weapon((-0.62, 0.14, -0.62), (-0.62, 0.12, 0.78)), (0.0, 86.0, 22.0, 0.0), 14.0, 3.0, FLAT)
    bounced = _down(86.0, lie(LYING + 0.012, -0.42), (0, -1, 0), [(0.165, 0.110, 0.425), (-0.180, 0.112, 0.36)], (46, 34),
                    Weapon((-0.64, 0.075, -0.66), (-0.66, 0.03, 0.75)), (-6.0, 92.0, 18.0, 0.0), 17.0, 2.0, FLAT)
    lying = _down(88.0, lie(LYING, -0.42), (-1, -1, 0), [(0.185, 0.098, 0.452), (-0.205, 0.100, 0.385)], (60, 46),
                  Weapon((-0.645, 0.060, -0.67), (-0.67, 0.0, 0.74)), (-8.0, 94.0, 20.0, 0.0), 12.0, 2.0, FLAT)
    keys = [(0.0, standing), (4 / RATE, struck), (13 / RATE, giving), (22 / RATE, sitting), (30 / RATE, landing),
            (35 / RATE, bounced), (FALL / RATE, lying)]
    return _through(keys)


def _through(keys):
    """Poses at times, gone through without a stop: eased in and out alone."""
    def pose(t):
        for i, ((t0, a), (t1, b)) in enumerate(zip(keys, keys[1:])):
            if t <= t1 or i == len(keys) - 2:
                share = min(1.0, (t - t0) / (t1 - t0))
                if i == 0:
                    share = share * share * (2.0 - share)
                elif i == len(keys) - 2:
                    share = 1.0 - (1.0 - share) ** 2
                p = blend(a, b, share)
                # Turns that are blended keep neither feet nor hands over the ground: they are put there again.
                feet = (1 - share) * a.feet + share * b.feet
                _feet(p, feet, (1 - share) * a.pitches + share * b.pitches)
                right_hand(p, a.weapon.between(b.weapon, share), elbow=(1 - share) * a.elbow + share * b.elbow, curl=52.0)
                return p
        return keys[-1][1]
    return pose


def all_clips():
    always = ((0.0, 1.0),)
    W, R = clips.WALK, clips.RUN
    _, left_stride = clips._turning(1.0)
    duty = left_stride.duty
    return [
        Clip("idle", 120, True, guard, left=always, right=always),
        Clip("patrol", 31, True, patrol, W.speed, 0.0, ((0.0, W.duty),), ((0.5, 0.5 + W.duty),), keys=2),
        Clip("run", 22, True, charge, R.speed, 0.0, ((0.0, R.duty),), ((0.5, 0.5 + R.duty),), keys=2),
        Clip("turn_left", 30, True, _turning(1.0), 0.0, 90.0, ((0.0, duty),), ((0.5, 0.5 + duty),)),
        Clip("turn_right", 30, True, _turning(-1.0), 0.0, -90.0, ((0.0, duty),), ((0.5, 0.5 + duty),)),
        Clip("alarm", ALARM, False, _alarm(), left=always, right=always),
        Clip("aim", AIM, False, _aim(), left=always, right=always),
        Clip("shoot", SHOOT, False, _shoot(), left=always, right=always),
        Clip("hit", HIT, False, _hit(), left=always, right=always),
        Clip("fall_back", FALL, False, _fall()),
    ]
