"""Measures the soldier as the hiker's check does.

    blender --background --factory-startup --python assets/soldier/source/check.py -- \
        assets/soldier/soldier.fbx
"""

import importlib.util
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
HERO = os.path.join(HERE, "..", "..", "hero", "source")
sys.path[:0] = [HERE, HERO]

import crossbow  # noqa: E402
import drill  # noqa: E402

# Both files are called check.
_spec = importlib.util.spec_from_file_location("hero_check", os.path.join(HERO, "check.py"))
hero_check = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(hero_check)

TRIANGLES = 16500    # iron and a crossbow more than the hiker


if __name__ == "__main__":
    held = sum(len(half.verts) for half in crossbow.halves())
    hero_check.main(sys.argv[sys.argv.index("--") + 1], drill.all_clips(), TRIANGLES, held)
