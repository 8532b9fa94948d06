"""Models, paints, rigs, animates and exports the person.

    blender --background --factory-startup --python assets/hero/source/main.py -- \
        assets/hero/hero.fbx

Writes the FBX file with its textures inside, and beside it hero.ron, which tells a
game of each clip's length, speed and steps.
"""

import os
import sys
import tempfile

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import bpy  # noqa: E402

import clips  # noqa: E402
import finish  # noqa: E402
import paint  # noqa: E402
import parts  # noqa: E402
import rig  # noqa: E402
import uv  # noqa: E402
import weights  # noqa: E402

TEXTURE = 1024


def write_ron(path):
    """The clips' table in RON, for code that matches speed to phase."""
    def spans(list_):
        return "[" + ", ".join(f"({a:.6f}, {b:.6f})" for a, b in list_) + "]"
    lines = ["// Written by source/main.py with hero.fbx. Lengths s, speeds m/s, turning degrees/s (left is",
             "// positive); left, right: (landing, take-off) of the foot in shares of the clip's length.",
             "(", "    clips: ["]
    for c in clips.all_clips():
        lines.append(f'        (name: "{c.name}", length: {c.length:.6f}, looped: {str(c.looped).lower()}, '
                     f"speed: {c.speed:.3f}, turn_rate: {c.turn_rate:.1f}, "
                     f"left: {spans(c.left)}, right: {spans(c.right)}),")
    lines += ["    ],", ")", ""]
    with open(path, "w", encoding="utf-8", newline="\n") as out:
        out.write("\n".join(lines))


def export(path, objects):
    for o in bpy.data.objects:
        o.select_set(o in objects)
    bpy.context.scene.render.fps = int(clips.RATE)
    bpy.ops.export_scene.fbx(
        filepath=path, use_selection=True, object_types={"ARMATURE", "MESH"},
        apply_scale_options="FBX_SCALE_ALL", axis_forward="-Z", axis_up="Y", bake_space_transform=False,
        mesh_smooth_type="OFF", use_mesh_modifiers=False, add_leaf_bones=False, use_tspace=False,
        bake_anim=True, bake_anim_use_all_bones=False, bake_anim_use_nla_strips=False,
        bake_anim_use_all_actions=True, bake_anim_force_startend_keying=True, bake_anim_step=0.5,
        bake_anim_simplify_factor=0.0, path_mode="COPY", embed_textures=True)


def main(path, size=TEXTURE):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    import addon_utils
    addon_utils.enable("io_scene_fbx")
    halves = uv.unwrap(parts.build_all())
    bones = weights.of_all(halves)
    tangents = {h.name: rig.tangents(h) for h in halves}
    colour, normal, rough = paint.textures(halves, tangents, size)
    with tempfile.TemporaryDirectory() as folder:
        images = {k: os.path.join(folder, f"hero_{k}.png") for k in ("colour", "normal", "roughness")}
        paint.save(colour, images["colour"])
        paint.save(normal, images["normal"], 128)
        half = rough.reshape(size // 2, 2, size // 2, 2, 3).mean(axis=(1, 3))
        paint.save(half, images["roughness"], 64)
        for k, image in images.items():
            print(f"hero_{k}.png {os.path.getsize(image)} bytes")
        armature, body = rig.make_person(halves, bones, images)
        rig.make_actions(armature)
        export(path, (armature, body))
    finish.finish(path, {c.name for c in clips.all_clips() if c.keys == 1})
    write_ron(os.path.splitext(path)[0] + ".ron")
    print(f"{path}: {os.path.getsize(path)} bytes, {len(body.data.polygons)} triangles, "
          f"{len(body.data.vertices)} vertices")


if __name__ == "__main__":
    main(*sys.argv[sys.argv.index("--") + 1:][:1])
