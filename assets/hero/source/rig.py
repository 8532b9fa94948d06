"""The person in Blender: one mesh, one armature, one material, the clips as actions.

All data are in glTF's axes (y up, z forward). The armature object is turned so that
Blender, whose z is up, shows the person upright; the exporter turns it back, and the
nodes of the file carry no turn of their own.
"""

import math

import bpy
import mathutils
import numpy as np

import clips
import pose as posing
import skeleton as sk


def whole(halves, weights):
    """Both sides of all parts as one mesh: vertices, faces, normals, uv, weights."""
    verts, faces, normals, uv, w = [], [], [], [], []
    count = 0
    turn = [sk.INDEX[sk.mirrored(n)] for n in sk.NAMES]
    flip = np.array([-1.0, 1.0, 1.0])
    for h in halves:
        centre = np.abs(h.verts[:, 0]) < 1e-6
        left = np.arange(len(h.verts)) + count
        right = left.copy()
        side = ~centre
        right[side] = count + len(h.verts) + np.arange(side.sum())
        n = h.normals.copy()
        n[centre, 0] = 0.0
        n = n / np.linalg.norm(n, axis=1, keepdims=True)
        verts += [h.verts, h.verts[side] * flip]
        normals += [n, n[side] * flip]
        w += [weights[h.name], weights[h.name][side][:, turn]]
        faces += [left[h.faces], right[h.faces][:, ::-1]]
        uv += [h.uv, h.uv[:, ::-1]]
        count += len(h.verts) + side.sum()
        if h.right:
            # What was made for the left hand is left out, and its mirror image counts from there.
            for made in (verts, normals, w, faces, uv):
                del made[-2]
            faces[-1] = faces[-1] - len(h.verts)
            count -= len(h.verts)
    return tuple(np.concatenate(a) for a in (verts, faces, normals, uv, w))


def make_mesh(name, verts, faces, normals, uv):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(verts.tolist(), [], faces.tolist())
    mesh.uv_layers.new(name="uv").data.foreach_set("uv", uv.reshape(-1).tolist())
    mesh.polygons.foreach_set("use_smooth", [True] * len(faces))
    mesh.use_auto_smooth = True
    mesh.normals_split_custom_set_from_vertices(normals.tolist())
    return mesh


def tangents(half):
    """Tangent and sign of each face's corners, as glTF's readers make them."""
    mesh = make_mesh("tangents", half.verts, half.faces, half.normals, half.uv)
    mesh.calc_tangents()
    t = np.array([[*l.tangent, l.bitangent_sign] for l in mesh.loops]).reshape(-1, 3, 4)
    bpy.data.meshes.remove(mesh)
    return t


def make_material(name, images):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    shader = tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    shader.inputs["Metallic"].default_value = 0.0
    shader.inputs["Roughness"].default_value = 1.0
    shader.inputs["Specular"].default_value = 0.5

    def image(kind, colour):
        node = tree.nodes.new("ShaderNodeTexImage")
        node.image = bpy.data.images.load(images[kind])
        node.image.colorspace_settings.name = "sRGB" if colour else "Non-Color"
        return node.outputs["Color"]
    tree.links.new(image("colour", True), shader.inputs["Base Color"])
    tree.links.new(image("roughness", False), shader.inputs["Roughness"])
    bumps = tree.nodes.new("ShaderNodeNormalMap")
    tree.links.new(image("normal", False), bumps.inputs["Color"])
    tree.links.new(bumps.outputs["Normal"], shader.inputs["Normal"])
    return material


def make_armature(name):
    data = bpy.data.armatures.new(name)
    obj = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(obj)
    bpy.context.view_layer.objects.active = obj
    obj.select_set(True)
    bpy.ops.object.mode_set(mode="EDIT")
    for name, parent, head, tail in sk.BONES:
        bone = data.edit_bones.new(name)
        bone.head, bone.tail = head.tolist(), tail.tolist()
        # A bone's own x axis lies along the person's, as far as it can.
        along = (bone.tail - bone.head).normalized()
        bone.align_roll(mathutils.Vector((0, 0, 1)) if abs(along.z) < 0.9 else mathutils.Vector((0, 1, 0)))
        if parent:
            bone.parent = data.edit_bones[parent]
    bpy.ops.object.mode_set(mode="OBJECT")
    obj.rotation_euler = (math.radians(90.0), 0.0, 0.0)
    for bone in obj.pose.bones:
        bone.rotation_mode = "QUATERNION"
    return obj


def make_actions(armature, all_clips):
    """Linear keys for the turn of each bone, and for the hips' place."""
    rest = {b.name: np.array(b.matrix_local.to_3x3()) for b in armature.data.bones}
    armature.animation_data_create()
    actions = []
    for clip in all_clips:
        action = bpy.data.actions.new(clip.name)
        action.use_fake_user = True
        frames = np.arange(clip.frames * clip.keys + 1) / clip.keys
        poses = [clip.pose(f / clips.RATE) for f in frames]
        if clip.looped:
            poses[-1] = poses[0]

        def curve(path, index, values, group):
            c = action.fcurves.new(path, index=index, action_group=group)
            c.keyframe_points.add(len(values))
            c.keyframe_points.foreach_set("co", np.stack([frames, values], axis=1).ravel())
            c.keyframe_points.foreach_set("interpolation", [1] * len(values))  # linear
        for name in sk.NAMES:
            turns = []
            for p in poses:
                q = posing.quaternion(rest[name].T @ p.local[name] @ rest[name])
                if turns and q @ turns[-1] < 0.0:
                    q = -q
                turns.append(q)
            turns = np.array(turns)
            for i in range(4):
                curve(f'pose.bones["{name}"].rotation_quaternion', i, turns[:, i], name)
        shift = np.array([rest["hips"].T @ p.shift for p in poses])
        for i in range(3):
            curve('pose.bones["hips"].location', i, shift[:, i], "hips")
        actions.append((clip, action))
    armature.animation_data.action = actions[0][1]
    return actions


def make_person(name, halves, weights, images):
    verts, faces, normals, uv, w = whole(halves, weights)
    armature = make_armature(name)
    mesh = make_mesh(f"{name}_body", verts, faces, normals, uv)
    mesh.materials.append(make_material(name, images))
    body = bpy.data.objects.new("body", mesh)
    bpy.context.scene.collection.objects.link(body)
    body.parent = armature
    for i, name in enumerate(sk.NAMES):
        group = body.vertex_groups.new(name=name)
        for v in np.flatnonzero(w[:, i]):
            group.add([int(v)], float(w[v, i]), "REPLACE")
    body.modifiers.new("armature", "ARMATURE").object = armature
    return armature, body
