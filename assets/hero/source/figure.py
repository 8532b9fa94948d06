"""Models, paints, rigs, animates and exports a person.

What differs from one to another is a `Figure`; all stand on one skeleton and share the scripts of this folder.
"""

import os
import tempfile
from dataclasses import dataclass, field
from typing import Callable

import bpy

import clips
import finish
import paint
import parts
import rig
import uv
import weights

TEXTURE = 1024


@dataclass
class Figure:
    name: str
    bodies: list             # of parts.Part
    ribbons: Callable        # the jacket's field -> list of parts.Half that bring their own uv
    looks: dict              # name of a part -> Look
    clips: list              # of clips.Clip
    rigid: dict              # name of a part -> the one bone that moves it
    worn: tuple = field(default_factory=tuple)  # parts that lie on the jacket and move with it


def write_ron(path, figure):
    """The clips' table in RON, for code that matches speed to phase."""
    def spans(list_):
        return "[" + ", ".join(f"({a:.6f}, {b:.6f})" for a, b in list_) + "]"
    lines = [f"// Written by source/main.py with {figure.name}.fbx. Lengths s, speeds m/s, turning degrees/s (left is",
             "// positive); left, right: (landing, take-off) of the foot in shares of the clip's length.",
             "(", "    clips: ["]
    for c in figure.clips:
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


def make(path, figure, size=TEXTURE):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    import addon_utils
    addon_utils.enable("io_scene_fbx")
    halves = uv.unwrap(parts.build_all(figure.bodies, figure.ribbons))
    bones = weights.of_all(halves, figure.rigid, figure.worn)
    tangents = {h.name: rig.tangents(h) for h in halves}
    colour, normal, rough = paint.textures(halves, tangents, size, figure.looks)
    with tempfile.TemporaryDirectory() as folder:
        images = {k: os.path.join(folder, f"{figure.name}_{k}.png") for k in ("colour", "normal", "roughness")}
        paint.save(colour, images["colour"])
        paint.save(normal, images["normal"], 128)
        half = rough.reshape(size // 2, 2, size // 2, 2, 3).mean(axis=(1, 3))
        paint.save(half, images["roughness"], 64)
        for image in images.values():
            print(f"{os.path.basename(image)} {os.path.getsize(image)} bytes")
        armature, body = rig.make_person(figure.name, halves, bones, images)
        rig.make_actions(armature, figure.clips)
        export(path, (armature, body))
    finish.finish(path, {c.name for c in figure.clips if c.keys == 1})
    write_ron(os.path.splitext(path)[0] + ".ron", figure)
    print(f"{path}: {os.path.getsize(path)} bytes, {len(body.data.polygons)} triangles, "
          f"{len(body.data.vertices)} vertices")
