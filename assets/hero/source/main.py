"""Makes the hiker.

    blender --background --factory-startup --python assets/hero/source/main.py -- \
        assets/hero/hero.fbx

Writes the FBX file with its textures inside, and beside it hero.ron, which tells a
game of each clip's length, speed and steps.
"""

import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import clips  # noqa: E402
import figure  # noqa: E402
import looks  # noqa: E402
import parts  # noqa: E402
import ribbons  # noqa: E402


def hiker():
    return figure.Figure("hero", parts.bodies(), ribbons.build_all, looks.LOOKS, clips.all_clips(),
                         {"eye": "head", "hat": "head"})


if __name__ == "__main__":
    figure.make(*sys.argv[sys.argv.index("--") + 1:][:1], hiker())
