"""Where a foot is in a stride.

In stance the foot is fixed to the ground, which goes by at the clip's speed and
turning rate: it lands on the heel, rolls flat, lifts its heel over the bent toes.
In swing the ankle follows a smooth path from take-off to the next landing that
starts and ends with the stance's own velocity. Everything is a function of the
phase alone, so a loop closes with its velocities.
"""

from dataclasses import dataclass, field

import numpy as np

import skeleton as sk
from pose import turn_x, turn_y


@dataclass
class Stride:
    period: float            # s
    speed: float             # m/s along +z
    duty: float              # share of the period that a foot is on the ground
    landing_z: float         # where the flat foot's ankle would be when it lands, m
    width: float             # of the ankle from the middle line, m
    toe_out: float           # degrees
    strike: float            # degrees, toes up at landing
    flat_from: float         # share of the stance
    flat_to: float
    push: float              # degrees, heel up at take-off
    swing: list = field(default_factory=list)  # (share of swing, ankle z, ankle y, pitch)
    turn_rate: float = 0.0   # degrees/s, of the person to the left


def _foot_at(stride, side, base, pitch):
    """Ankle, foot's turn and toes' bend of a foot whose flat ankle is at `base` on the
    ground. Positive pitch: toes up, about the heel; negative: heel up, about the ball."""
    yaw = turn_y(side * stride.toe_out)
    flip = np.array([side, 1.0, 1.0])
    pivot = (sk.HEEL if pitch > 0.0 else sk.BALL) - sk.ANKLE
    pivot = pivot * flip
    tilt = turn_x(-pitch)
    offset = pivot - tilt @ pivot
    ankle = base + yaw @ offset
    return ankle, yaw @ tilt, max(0.0, -pitch)


def _stance_pitch(stride, s):
    if s < stride.flat_from:
        t = s / stride.flat_from
        return stride.strike * (1 - t) ** 2 * (1 + 0.5 * t)
    if s > stride.flat_to:
        t = (s - stride.flat_to) / (1 - stride.flat_to)
        return -stride.push * t * t * (1.5 - 0.5 * t)
    return 0.0


def stance(stride, side, s):
    """The foot at share s of its stance, in the person's frame."""
    time = s * stride.duty * stride.period
    base = np.array([side * stride.width, sk.ANKLE[1], stride.landing_z - stride.speed * time])
    heading = 0.0
    if stride.turn_rate:
        # Seen by one who turns, the ground turns back about the origin.
        whole = stride.turn_rate * stride.duty * stride.period
        heading = 0.5 * whole - stride.turn_rate * time
        base = turn_y(heading) @ base
    ankle, foot, toes = _foot_at(stride, side, np.zeros(3), _stance_pitch(stride, s))
    spin = turn_y(heading)
    return base + spin @ ankle, spin @ foot, toes, heading, _stance_pitch(stride, s)


def _hermite(knots, values, slopes, t):
    i = max(0, min(len(knots) - 2, int(np.searchsorted(knots, t, side="right")) - 1))
    w = knots[i + 1] - knots[i]
    u = (t - knots[i]) / w
    return ((1 + 2 * u) * (1 - u) ** 2 * values[i] + u * (1 - u) ** 2 * w * slopes[i]
            + u * u * (3 - 2 * u) * values[i + 1] - u * u * (1 - u) * w * slopes[i + 1])


def swing(stride, side, s):
    """The foot at share s of its swing."""
    air = (1 - stride.duty) * stride.period
    per_share = air / (stride.duty * stride.period)
    eps = 1e-4
    a0, _, toes0, h0, p0 = stance(stride, side, 1.0)
    a0b, _, toes0b, h0b, p0b = stance(stride, side, 1.0 - eps)
    a1, _, toes1, h1, p1 = stance(stride, side, 0.0)
    a1b, _, toes1b, h1b, p1b = stance(stride, side, eps)

    def channel(v0, v0b, v1, v1b, middle):
        knots = [0.0] + [m[0] for m in middle] + [1.0]
        values = [v0] + [m[1] for m in middle] + [v1]
        slopes = list(np.gradient(values, knots)) if len(knots) > 2 else [0.0, 0.0]
        slopes[0] = (v0 - v0b) / eps * per_share
        slopes[-1] = (v1b - v1) / eps * per_share
        return _hermite(knots, values, slopes, s)
    z = channel(a0[2], a0b[2], a1[2], a1b[2], [(m[0], m[1]) for m in stride.swing if m[1] is not None])
    y = channel(a0[1], a0b[1], a1[1], a1b[1], [(m[0], m[2]) for m in stride.swing])
    x = channel(a0[0], a0b[0], a1[0], a1b[0], [])
    pitch = channel(p0, p0b, p1, p1b, [(m[0], m[3]) for m in stride.swing])
    toes = channel(toes0, toes0b, toes1, toes1b, [(m[0], max(0.0, toes0 * (1 - 3 * m[0]))) for m in stride.swing])
    heading = channel(h0, h0b, h1, h1b, [])
    foot = turn_y(heading) @ turn_y(side * stride.toe_out) @ turn_x(-pitch)
    return np.array([x, y, z]), foot, max(0.0, toes)


def foot(stride, side, phase):
    """Ankle (m), foot's turn and toes' bend (degrees) at a phase counted from this
    foot's landing."""
    phase = phase % 1.0
    if phase < stride.duty:
        return stance(stride, side, phase / stride.duty)[:3]
    return swing(stride, side, (phase - stride.duty) / (1 - stride.duty))
