"""The clips: functions from time to a pose, keyed at 30 or 60 a second.

Figures of walking and running: see assets/hero/README.md.
"""

import math
from dataclasses import dataclass
from typing import Callable

import numpy as np

import gait
import skeleton as sk
from pose import Pose, arm, blend, fingers, reach_leg, turn, turn_x, turn_y, turn_z
from sdf import unit

RATE = 30.0
TAU = 2.0 * math.pi


@dataclass
class Clip:
    name: str
    frames: int              # the last frame; of a loop it is the first one again
    looped: bool
    pose: Callable           # time (s) -> Pose
    speed: float = 0.0       # m/s that the ground goes by
    turn_rate: float = 0.0   # degrees/s, to the left
    left: tuple = ()         # phases (landing, take-off) of the left foot
    right: tuple = ()
    keys: int = 1            # keys a frame: two where a foot on the ground turns fast

    @property
    def length(self):
        return self.frames / RATE


def ease(t):
    """0 to 1 with no speed or acceleration at the ends."""
    t = max(0.0, min(1.0, t))
    return t * t * t * (t * (6 * t - 15) + 10)


def legs(pose, stride, phase):
    """Both legs of a stride; the right one half a period later."""
    for side, offset in ((1, 0.0), (-1, 0.5)):
        ankle, foot, toes = gait.foot(stride, side, phase - offset)
        reach_leg(pose, side, ankle, foot, toes, knee_out=2.0)


STAND_WIDTH = 0.112
STAND_TOES = 9.0


def stand(pose, shift=(0.0, 0.0)):
    """Both feet flat on their places beside the origin, shifted by (x, z)."""
    for side in (1, -1):
        ankle = np.array([side * STAND_WIDTH + shift[0], sk.ANKLE[1], 0.012 * side + shift[1]])
        reach_leg(pose, side, ankle, turn_y(side * STAND_TOES), 0.0, knee_out=4.0)


def relaxed_arms(pose, swing=0.0, breath=0.0):
    for side in (1, -1):
        arm(pose, side, 2.0 + swing + 0.6 * breath, 11.5 + 0.8 * breath, 13.0 + 0.4 * swing, twist=14.0, wrist=6.0)
        fingers(pose, side, 10.0, 7.0, 7.0)


IDLE_DROP = -0.0070


def idle(t, length=4.0):
    """Two breaths; the weight drifts from foot to foot once."""
    phase = t / length
    breath = math.sin(TAU * 2.0 * phase) + 0.18 * math.sin(TAU * 4.0 * phase + 0.6)
    sway = math.sin(TAU * phase)
    slow = math.sin(TAU * phase + 1.1)
    p = Pose()
    p.shift = np.array([0.011 * sway, IDLE_DROP + 0.0016 * breath - 0.002 * sway * sway, 0.004 * slow])
    p.turned("hips", turn_z(-1.1 * sway), turn_y(0.9 * slow), turn_x(1.0))
    p.turned("spine_1", turn_z(0.8 * sway), turn_x(1.2 - 0.3 * breath))
    p.turned("spine_2", turn_z(0.6 * sway), turn_x(0.4 - 0.6 * breath))
    p.turned("chest", turn_x(1.2 - 0.9 * breath), turn_y(-0.6 * slow))
    p.turned("neck", turn_x(1.0 + 0.9 * breath), turn_y(1.4 * math.sin(TAU * phase + 2.3)))
    p.turned("head", turn_x(-4.0 + 0.9 * breath), turn_y(2.4 * math.sin(TAU * phase + 2.0)),
             turn_z(-0.5 * sway))
    for side, s in ((1, "_l"), (-1, "_r")):
        p.turned("shoulder" + s, turn_z(side * (-1.5 + 1.3 * breath)))
    relaxed_arms(p, 0.5 * slow, breath)
    stand(p)
    return p


WALK = gait.Stride(
    period=31 / RATE, speed=1.5, duty=0.62, landing_z=0.385, width=0.056, toe_out=7.0,
    strike=21.0, flat_from=0.17, flat_to=0.56, push=62.0,
    swing=[(0.28, -0.320, 0.245, -52.0), (0.60, 0.110, 0.165, -4.0), (0.84, 0.405, 0.150, 21.0)])


def walk(t):
    f = (t / WALK.period) % 1.0
    once, twice = TAU * f, 2.0 * TAU * f
    p = Pose()
    # Lowest while both feet are down, highest over the standing leg; to and fro over it.
    p.shift = np.array([0.019 * math.sin(once - 0.35), -0.0530 - 0.0170 * math.cos(twice - 0.75), 0.006 * math.sin(twice)])
    yaw = -6.0 * math.cos(once)
    list_ = 3.6 * math.sin(once + 0.15)
    p.turned("hips", turn_y(yaw), turn_z(list_), turn_x(4.0 + 0.8 * math.cos(twice)))
    chest_yaw = 6.5 * math.cos(once - 0.15)
    chest_list = -1.3 * math.sin(once + 0.2)
    for bone, part in (("spine_1", 0.30), ("spine_2", 0.35), ("chest", 0.35)):
        p.turned(bone, turn_y(part * (chest_yaw - yaw)), turn_z(part * (chest_list - list_)),
                 turn_x(0.9 - 0.4 * math.cos(twice - 0.6) * part))
    for bone, part in (("neck", 0.45), ("head", 0.55)):
        p.turned(bone, turn_y(-part * chest_yaw), turn_z(-part * chest_list),
                 turn_x(part * (-7.0 + 0.6 * math.cos(twice - 0.4))))
    for side, s in ((1, "_l"), (-1, "_r")):
        # The arm goes with the other leg, its hand a little behind its elbow.
        swing = -side * math.cos(once - 0.12)
        late = -side * math.cos(once - 0.55)
        p.turned("shoulder" + s, turn_y(side * -2.5 * swing), turn_z(side * -1.5))
        arm(p, side, 2.0 + 23.0 * swing, 10.5 + 1.2 * abs(swing), 21.0 + 13.0 * late, twist=16.0, wrist=8.0 - 3.0 * late)
        fingers(p, side, 17.0, 10.0, 13.0)
    legs(p, WALK, f)
    return p


RUN = gait.Stride(
    period=22 / RATE, speed=4.0, duty=0.335, landing_z=0.335, width=0.045, toe_out=5.0,
    strike=9.0, flat_from=0.14, flat_to=0.30, push=80.0,
    swing=[(0.12, -0.525, 0.290, -98.0), (0.30, -0.440, 0.455, -92.0), (0.50, -0.130, 0.440, -58.0),
           (0.70, 0.220, 0.310, -20.0), (0.88, 0.420, 0.200, 4.0)])


def run(t):
    f = (t / RUN.period) % 1.0
    once, twice = TAU * f, 2.0 * TAU * f
    p = Pose()
    low = 2.0 * TAU * 0.17
    p.shift = np.array([0.012 * math.sin(once - 0.2), -0.103 - 0.028 * math.cos(twice - low), 0.0])
    yaw = -8.0 * math.cos(once + 0.1)
    list_ = 3.5 * math.sin(once + 0.3)
    p.turned("hips", turn_y(yaw), turn_z(list_), turn_x(9.0 + 1.5 * math.cos(twice - 0.5)))
    chest_yaw = 11.0 * math.cos(once - 0.05)
    for bone, part in (("spine_1", 0.30), ("spine_2", 0.35), ("chest", 0.35)):
        p.turned(bone, turn_y(part * (chest_yaw - yaw)), turn_z(-part * 1.2 * list_), turn_x(1.6))
    for bone, part in (("neck", 0.45), ("head", 0.55)):
        p.turned(bone, turn_y(-part * chest_yaw), turn_z(0.2 * part * list_), turn_x(part * -13.0))
    for side, s in ((1, "_l"), (-1, "_r")):
        swing = -side * math.cos(once - 0.05)
        late = -side * math.cos(once - 0.35)
        p.turned("shoulder" + s, turn_y(side * -5.0 * swing), turn_z(side * -1.0))
        arm(p, side, -5.0 + 34.0 * swing, 17.0 - 3.0 * swing, 86.0 + 16.0 * late, twist=17.0 + 7.0 * swing, wrist=4.0)
        fingers(p, side, 34.0, 16.0, 30.0)
    legs(p, RUN, f)
    return p



def _turning(direction):
    stride = gait.Stride(
        period=1.0, speed=0.0, duty=0.64, landing_z=0.0, width=STAND_WIDTH, toe_out=STAND_TOES,
        strike=0.0, flat_from=0.05, flat_to=0.72, push=16.0,
        swing=[(0.45, None, 0.160, -12.0)], turn_rate=direction * 90.0)

    def pose(t):
        f = t / stride.period
        once, twice = TAU * f, 2 * TAU * f
        p = Pose()
        p.shift = np.array([0.022 * math.sin(once - 0.55), -0.020 - 0.005 * math.cos(twice - 0.9), 0.0])
        p.turned("hips", turn_z(1.8 * math.sin(once)), turn_y(direction * 2.0 * math.cos(twice)), turn_x(2.0))
        for bone in ("spine_1", "spine_2", "chest"):
            p.turned(bone, turn_y(direction * 2.0), turn_z(-0.5 * math.sin(once)), turn_x(0.8))
        p.turned("neck", turn_y(direction * 5.0), turn_x(-1.0))
        p.turned("head", turn_y(direction * 7.0), turn_x(-3.0))
        for side in (1, -1):
            swing = -side * direction * 4.0 - side * 3.0 * math.cos(once)
            arm(p, side, 3.0 + swing, 14.0, 20.0, twist=15.0, wrist=6.0)
            fingers(p, side, 14.0, 8.0, 10.0)
        legs(p, stride, f)
        return p
    return pose, stride


def _crouch(depth, lean, arms_back):
    """Standing, the hips `depth` (m) lower."""
    p = Pose()
    p.shift = np.array([0.0, IDLE_DROP - depth, -0.30 * depth])
    p.turned("hips", turn_x(0.55 * lean + 1.0))
    for bone in ("spine_1", "spine_2", "chest"):
        p.turned(bone, turn_x(0.15 * lean + 0.9))
    p.turned("neck", turn_x(-0.35 * lean + 1.0))
    p.turned("head", turn_x(-0.45 * lean - 4.0))
    for side in (1, -1):
        arm(p, side, 2.0 - arms_back, 11.5 + 0.10 * arms_back, 13.0 + 0.35 * arms_back, twist=14.0, wrist=6.0)
        fingers(p, side, 16.0, 8.0, 12.0)
    stand(p)
    return p


def _airborne(t, length=1.0):
    """Falling: knees soft, arms out for balance; a slow loop."""
    a = TAU * t / length
    p = Pose()
    p.shift = np.array([0.0, IDLE_DROP, 0.0])
    p.turned("hips", turn_x(5.0), turn_z(1.2 * math.sin(a)))
    for bone in ("spine_1", "spine_2", "chest"):
        p.turned(bone, turn_x(1.5), turn_z(-0.5 * math.sin(a)))
    p.turned("neck", turn_x(3.0))
    p.turned("head", turn_x(4.0))
    for side, s in ((1, "_l"), (-1, "_r")):
        wave = math.sin(a + 0.8 * side)
        p.turned("shoulder" + s, turn_z(side * 6.0))
        arm(p, side, 18.0 + 6.0 * math.cos(a + side), 46.0 + 6.0 * wave, 42.0 - 5.0 * wave, twist=8.0)
        fingers(p, side, 4.0, 0.0, 2.0)
        ankle = np.array([side * 0.125, sk.ANKLE[1] + (0.20 if side > 0 else 0.15) + 0.018 * wave,
                          (0.07 if side > 0 else -0.10) + 0.022 * math.cos(a + 1.4 * side)])
        reach_leg(p, side, ankle, turn_y(side * 8.0) @ turn_x(22.0 if side > 0 else 34.0), 0.0, knee_out=5.0)
    return p


def _launch():
    """The last touch of the ground: legs long, heels up, arms thrown forward."""
    p = Pose()
    p.shift = np.array([0.0, 0.036, 0.020])
    p.turned("hips", turn_x(2.0))
    for bone in ("spine_1", "spine_2", "chest"):
        p.turned(bone, turn_x(-1.0))
    p.turned("head", turn_x(-5.0))
    for side, s in ((1, "_l"), (-1, "_r")):
        p.turned("shoulder" + s, turn_z(side * 7.0))
        arm(p, side, 78.0, 16.0, 48.0, twist=10.0)
        fingers(p, side, 10.0, 4.0, 8.0)
        flip = np.array([side, 1.0, 1.0])
        base = np.array([side * STAND_WIDTH, sk.ANKLE[1], 0.012 * side])
        yaw, tilt = turn_y(side * STAND_TOES), turn_x(40.0)
        pivot = (sk.BALL - sk.ANKLE) * flip
        reach_leg(p, side, base + yaw @ (pivot - tilt @ pivot), yaw @ tilt, 40.0, knee_out=4.0)
    return p


def _keyed(keys):
    """Poses at times, each reached softly: ease from key to key."""
    def pose(t):
        for (t0, a), (t1, b) in zip(keys, keys[1:]):
            if t <= t1:
                return blend(a, b, ease((t - t0) / (t1 - t0)))
        return keys[-1][1]
    return pose


def _planted(pose_of, until, heel=None):
    """The same motion with the feet held on their standing places before `until`."""
    def pose(t):
        p = pose_of(t)
        if t <= until:
            lift = heel(t) if heel else 0.0
            for side in (1, -1):
                flip = np.array([side, 1.0, 1.0])
                base = np.array([side * STAND_WIDTH, sk.ANKLE[1], 0.012 * side])
                yaw, tilt = turn_y(side * STAND_TOES), turn_x(lift)
                pivot = (sk.BALL - sk.ANKLE) * flip
                reach_leg(p, side, base + yaw @ (pivot - tilt @ pivot), yaw @ tilt, lift, knee_out=4.0)
        return p
    return pose


JUMP_LEAVES = 12 / RATE


def _jump():
    keys = [(0.0, idle(0.0)), (8 / RATE, _crouch(0.21, 42.0, 44.0)), (JUMP_LEAVES, _launch()), (21 / RATE, _airborne(0.0))]
    return _planted(_keyed(keys), JUMP_LEAVES, lambda t: 40.0 * ease((t - 8 / RATE) / (JUMP_LEAVES - 8 / RATE)))


LAND_PLANTED = 3 / RATE


def _land():
    touch = _crouch(0.075, 14.0, -30.0)
    keys = [(0.0, _airborne(0.0)), (LAND_PLANTED, touch), (8 / RATE, _crouch(0.23, 40.0, 6.0)), (22 / RATE, idle(0.0))]
    base = _keyed(keys)

    def pose(t):
        p = base(t)
        if t >= LAND_PLANTED:
            stand(p)
        return p
    return pose


def _wave():
    length = 75 / RATE

    def pose(t):
        p = idle(t, 75 / RATE)
        rise = ease(t / 0.55) * ease((length - t) / 0.60)
        swing = math.sin(TAU * 1.9 * (t - 0.45)) * ease((t - 0.35) / 0.3) * ease((length - 0.5 - t) / 0.3)
        up = Pose()
        up.local = dict(p.local)
        up.shift = p.shift
        arm(up, -1, 22.0, 92.0, 96.0, twist=-68.0, wrist=-4.0)
        fingers(up, -1, -9.0, -6.0, -9.0)
        up.turned("shoulder_r", turn_z(-13.0))
        up.turned("chest", turn_z(1.8))
        up.turned("head", turn_z(-2.5), turn_y(-3.0))
        q = blend(p, up, rise)
        # The forearm beats from side to side about the upper arm's own axis.
        axis = unit(sk.ARM_DIR * np.array([-1.0, 1.0, 1.0]))
        q.local["upper_arm_r"] = q.local["upper_arm_r"] @ turn(axis, math.radians(20.0 * swing * rise))
        stand(q)
        return q
    return pose


def all_clips():
    left, left_stride = _turning(1.0)
    right, _ = _turning(-1.0)
    duty = left_stride.duty
    always = ((0.0, 1.0),)
    return [
        Clip("idle", 120, True, idle, left=always, right=always),
        Clip("walk", 31, True, walk, WALK.speed, 0.0, ((0.0, WALK.duty),), ((0.5, 0.5 + WALK.duty),), keys=2),
        Clip("run", 22, True, run, RUN.speed, 0.0, ((0.0, RUN.duty),), ((0.5, 0.5 + RUN.duty),), keys=2),
        Clip("turn_left", 30, True, left, 0.0, 90.0, ((0.0, duty),), ((0.5, 0.5 + duty),)),
        Clip("turn_right", 30, True, right, 0.0, -90.0, ((0.0, duty),), ((0.5, 0.5 + duty),)),
        Clip("jump", 21, False, _jump(), left=((0.0, 12 / 21),), right=((0.0, 12 / 21),), keys=2),
        Clip("fall", 30, True, _airborne),
        Clip("land", 22, False, _land(), left=((3 / 22, 1.0),), right=((3 / 22, 1.0),), keys=2),
        Clip("wave", 75, False, _wave(), left=always, right=always),
    ]
