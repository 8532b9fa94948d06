"""Makes the soldier, with the scripts of the hiker.

    blender --background --factory-startup --python assets/soldier/source/main.py -- \
        assets/soldier/soldier.fbx

Writes the FBX file with its textures inside, and beside it soldier.ron, which tells a
game of each clip's length, speed and steps.
"""

import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [HERE, os.path.join(HERE, "..", "..", "hero", "source")]

import crossbow  # noqa: E402
import dress  # noqa: E402
import drill  # noqa: E402
import figure  # noqa: E402
import pack  # noqa: E402
import ribbons  # noqa: E402
import shapes  # noqa: E402
from sdf import vec  # noqa: E402


def _ribbons(jacket):
    around = [vec(0.0, 1.034, -0.150), vec(0.058, 1.032, -0.150)] + pack.hip_belt_points()
    belt = ribbons.ribbon("belt", jacket, around, 20, 0.022, 0.006, 1.0, free=(0, 0))
    return [belt, ribbons.collar(), shapes.helmet()] + crossbow.halves()


def soldier():
    return figure.Figure("soldier", shapes.bodies(), _ribbons, dress.all_looks(), drill.all_clips(),
                         {"eye": "head", "helmet": "head", "crossbow": "hand_l"}, ("plate",))


if __name__ == "__main__":
    figure.make(*sys.argv[sys.argv.index("--") + 1:][:1], soldier())
