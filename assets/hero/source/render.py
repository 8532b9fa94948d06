"""Pictures of the person: sun and sky over a grey ground, by Cycles.

    blender --background --factory-startup --python assets/hero/source/render.py -- \
        assets/hero/hero.fbx OUT_DIR [VIEW ...]

A view is a name of VIEWS, or VIEW@CLIP@PHASE, or CLIP for a sheet of eight phases of
a clip, or CLIP:AZIMUTH.
"""

import math
import os
import sys

import bpy
import mathutils

# name: (azimuth in degrees, 0 from the front, 90 from the person's left; height of the
# camera's eye and of what it looks at, m; distance, m; lens, mm)
VIEWS = {
    "front": (0, 1.0, 0.92, 5.2, 85),
    "side": (90, 1.0, 0.92, 5.2, 85),
    "back": (180, 1.0, 0.92, 5.2, 85),
    "quarter": (35, 1.3, 0.95, 5.0, 85),
    "game": (160, 2.6, 1.05, 4.2, 60),
    "face": (0, 1.67, 1.66, 1.3, 110),
    "face_side": (90, 1.67, 1.66, 1.3, 110),
    "face_quarter": (35, 1.70, 1.65, 1.3, 110),
    "bust": (25, 1.60, 1.45, 2.2, 85),
    "legs": (40, 0.80, 0.55, 2.6, 85),
    "hand": (70, 0.95, 0.83, 1.3, 110),
    "shoulder": (150, 1.75, 1.35, 2.4, 85),
}


def stage(samples=48, size=(480, 720)):
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.samples = samples
    scene.cycles.use_denoising = False
    scene.cycles.max_bounces = 3
    scene.render.threads_mode = "FIXED"
    scene.render.threads = 2
    scene.render.resolution_x, scene.render.resolution_y = size
    scene.render.image_settings.file_format = "PNG"
    scene.view_settings.view_transform = "Filmic"
    scene.view_settings.look = "Medium High Contrast"
    world = bpy.data.worlds.new("sky")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs[0].default_value = (0.42, 0.60, 0.90, 1)
    world.node_tree.nodes["Background"].inputs[1].default_value = 0.75
    scene.world = world
    sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    sun.data.energy = 4.0
    sun.data.angle = math.radians(1.0)
    sun.data.color = (1.0, 0.94, 0.85)
    scene.collection.objects.link(sun)
    bpy.ops.mesh.primitive_plane_add(size=60.0)
    ground = bpy.context.object
    mat = bpy.data.materials.new("ground")
    mat.use_nodes = True
    mat.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (0.22, 0.23, 0.17, 1)
    mat.node_tree.nodes["Principled BSDF"].inputs["Roughness"].default_value = 0.95
    ground.data.materials.append(mat)
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    scene.collection.objects.link(camera)
    scene.camera = camera
    return camera, sun


def look(camera, sun, azimuth, eye, target, distance, lens, aside=0.0):
    """Blender's world: z up, the person looks along -y, the person's left is +x."""
    a = math.radians(azimuth)
    place = mathutils.Vector((math.sin(a) * distance, -math.cos(a) * distance, eye))
    aim = mathutils.Vector((0, 0, target))
    camera.location = place
    camera.rotation_euler = (aim - place).to_track_quat("-Z", "Y").to_euler()
    camera.data.lens = lens
    # The sun stands behind the camera's left shoulder, 40 degrees high.
    s = a - math.radians(45)
    up = mathutils.Vector((math.sin(s), -math.cos(s), 0.85))
    sun.rotation_euler = up.to_track_quat("Z", "Y").to_euler()


def shoot(path):
    bpy.context.scene.render.filepath = path
    bpy.ops.render.render(write_still=True)


def sheet(camera, sun, armature, action, out, azimuth=90, phases=8, size=(240, 360)):
    """Eight phases of a clip side by side in one PNG."""
    import numpy as np
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = size
    armature.animation_data.action = action
    start, end = action.frame_range
    tiles = []
    for i in range(phases):
        at = start + (end - start) * i / phases
        scene.frame_set(int(at), subframe=at - int(at))
        look(camera, sun, azimuth, 1.05, 0.90, 5.2, 72)
        tile = out + ".tile.png"
        shoot(tile)
        image = bpy.data.images.load(tile)
        tiles.append(np.array(image.pixels[:]).reshape(size[1], size[0], 4))
        bpy.data.images.remove(image)
        os.remove(tile)
    rows = [np.concatenate(tiles[i:i + 4], axis=1) for i in range(0, phases, 4)]
    whole = np.concatenate(rows[::-1], axis=0)
    image = bpy.data.images.new("sheet", whole.shape[1], whole.shape[0])
    image.pixels = whole.ravel().tolist()
    image.filepath_raw = out
    image.file_format = "PNG"
    image.save()


def main(args):
    source, out = args[0], args[1]
    wanted = args[2:] or ["front", "back", "face"]
    os.makedirs(out, exist_ok=True)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.fbx(filepath=source)
    armature = next(o for o in bpy.data.objects if o.type == "ARMATURE")
    bpy.context.scene.render.fps = 30
    camera, sun = stage()
    actions = {a.name.split("|")[-1]: a for a in bpy.data.actions}
    for name in wanted:
        view, clip, phase = (name.split("@") + ["", ""])[:3]
        if view in VIEWS:
            armature.animation_data.action = actions[clip or "idle"]
            start, end = armature.animation_data.action.frame_range
            bpy.context.scene.frame_set(int(round(start + (end - start) * float(phase or 0.0))))
            close = view.startswith("face") or view in ("bust", "legs", "hand", "shoulder")
            scene = bpy.context.scene
            scene.render.resolution_x, scene.render.resolution_y = (560, 640) if close else (480, 800)
            look(camera, sun, *VIEWS[view])
            shoot(os.path.join(out, name.replace("@", "_") + ".png"))
        else:
            clip, _, azimuth = name.partition(":")
            sheet(camera, sun, armature, actions[clip], os.path.join(out, name.replace(":", "_") + ".png"),
                  float(azimuth or 90))


if __name__ == "__main__":
    main(sys.argv[sys.argv.index("--") + 1:])
