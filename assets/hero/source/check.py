"""Measures the exported file: reads it back, plays each clip, prints a table.

    blender --background --factory-startup --python assets/hero/source/check.py -- \
        assets/hero/hero.fbx

Exits 1 when a bound is broken. Sole points count as on the ground below CONTACT;
while one is, its way over the ground is slide. Four samples a frame: between keys
a player interpolates, and so does this.
"""

import math
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import bpy  # noqa: E402
import numpy as np  # noqa: E402

import clips  # noqa: E402
import skeleton as sk  # noqa: E402

CONTACT = 0.0015     # m; a sole that rolls is within this of the ground near its pivot
SLIDE = 0.002        # m, the most that a sole may slide in one stance
SINK = 0.003         # m, below the ground while a foot is down: what linear keys cut off at a run
SEAM = 1e-4          # m, between the first and the last frame of a loop
LIES = 0.03          # m, that the lowest point of somebody lying may be over or under the ground: cloth and grass
SUBFRAMES = 4


def load(path):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.render.fps = int(clips.RATE)
    bpy.ops.import_scene.fbx(filepath=path)
    armature = next(o for o in bpy.data.objects if o.type == "ARMATURE")
    body = next(o for o in bpy.data.objects if o.type == "MESH")
    return armature, body, {a.name.split("|")[-1]: a for a in bpy.data.actions}


def deformed(body):
    """Vertices in glTF's axes, as Blender shows them."""
    scene = bpy.context.evaluated_depsgraph_get()
    obj = body.evaluated_get(scene)
    mesh = obj.to_mesh()
    p = np.empty(len(mesh.vertices) * 3)
    mesh.vertices.foreach_get("co", p)
    obj.to_mesh_clear()
    m = np.array(obj.matrix_world)
    p = p.reshape(-1, 3) @ m[:3, :3].T + m[:3, 3]
    return np.stack([p[:, 0], p[:, 2], -p[:, 1]], axis=1)


def joints(armature):
    m = np.array(armature.matrix_world)
    out = {}
    for b in armature.pose.bones:
        h = m[:3, :3] @ np.array(b.head) + m[:3, 3]
        out[b.name] = np.array([h[0], h[2], -h[1]])
    return out


def to_ground(p, clip, time):
    """Where on the ground a point of the person is, had the person walked from time 0."""
    a = math.radians(clip.turn_rate * time)
    x = p[..., 0] * math.cos(a) + p[..., 2] * math.sin(a)
    z = -p[..., 0] * math.sin(a) + p[..., 2] * math.cos(a) + clip.speed * time
    return np.stack([x, z], axis=-1)


def stance_slides(soles, clip, times, spans):
    """The way over the ground of each sole point while it touches, within each stance."""
    worst = []
    for landing, off in spans:
        # A stance may go on beyond the loop's end; samples are of two rounds.
        inside = (times >= landing * clip.length - 1e-9) & (times <= off * clip.length + 1e-9)
        frames = np.flatnonzero(inside)
        start = {}
        most = 0.0
        for f in frames:
            ground = to_ground(soles[f], clip, times[f])
            touching = np.flatnonzero(soles[f][:, 1] < CONTACT)
            start = {v: start.get(v, ground[v]) for v in touching}
            for v in touching:
                most = max(most, float(np.linalg.norm(ground[v] - start[v])))
        worst.append(most)
    return max(worst, default=0.0)


def check_mesh(body, rows, most, held):
    mesh = body.data
    counts = np.array([len(v.groups) for v in mesh.vertices])
    sums = np.array([sum(g.weight for g in v.groups) for v in mesh.vertices])
    triangles = sum(len(p.vertices) - 2 for p in mesh.polygons)
    rest = deformed(body)
    mirror = {tuple(np.round(p, 4)) for p in rest}
    lone = sum(tuple(np.round(p * [-1, 1, 1], 4) + 0.0) not in mirror for p in rest)
    rows.append(("triangles", triangles, triangles <= most))
    rows.append(("vertices", len(mesh.vertices), True))
    rows.append(("weights a vertex, most", int(counts.max()), counts.max() <= 4))
    rows.append(("weight sum, worst error", f"{np.abs(sums - 1).max():.1e}", np.abs(sums - 1).max() < 1e-5))
    rows.append(("vertices without a mirror image (0.1 mm)", lone, lone <= held + len(rest) // 100))
    rows.append(("height (m)", f"{rest[:, 1].max():.3f}", True))
    rows.append(("lowest point at rest (mm)", f"{rest[:, 1].min() * 1000:.2f}", abs(rest[:, 1].min()) < 0.001))


def check_clip(armature, body, clip, action, soles_of):
    armature.animation_data.action = action
    scene = bpy.context.scene
    start, end = action.frame_range
    assert abs((end - start) - clip.frames) < 1e-3, (clip.name, start, end)
    steps = np.arange(0, clip.frames * SUBFRAMES + 1) / SUBFRAMES
    lengths, every, bones = [], [], []
    for s in steps:
        at = start + s
        scene.frame_set(int(math.floor(at)), subframe=at - math.floor(at))
        every.append(deformed(body))
        j = joints(armature)
        bones.append(j)
        lengths.append([np.linalg.norm(j[n] - j[sk.PARENT[n]]) for n in sk.NAMES if sk.PARENT[n] not in (None, "root")])
    every, lengths = np.array(every), np.array(lengths)
    times = steps / clips.RATE
    slide = 0.0
    for side, spans in (("left", clip.left), ("right", clip.right)):
        soles = every[:, soles_of[side]]
        t = times
        if clip.looped:
            soles = np.concatenate([soles, soles[1:]])
            t = np.concatenate([times, times[1:] + clip.length])
        slide = max(slide, stance_slides(soles, clip, t, spans))
    # In the air the game lifts the person: only what touches can sink.
    down = np.zeros(len(times), dtype=bool)
    for a, b in clip.left + clip.right:
        for turn in (0.0, -1.0):
            down |= (times >= (a + turn) * clip.length - 1e-9) & (times <= (b + turn) * clip.length + 1e-9)
    sink = max(0.0, -float(every[down, :, 1].min())) if down.any() else 0.0
    # Who lies on the ground touches it, and is not in it.
    lies = -float(every[-1][:, 1].min()) if not (clip.left or clip.right or clip.looped) else 0.0
    seam = np.abs(every[0] - every[-1]).max() if clip.looped else 0.0
    # Velocity across the seam against that just beside it.
    jerk = 0.0
    if clip.looped:
        v = np.diff(np.concatenate([every[-1 - SUBFRAMES:-1:SUBFRAMES], every[0:SUBFRAMES * 2 + 1:SUBFRAMES]]), axis=0) * clips.RATE
        steady = np.diff(every[::SUBFRAMES], axis=0) * clips.RATE
        jerk = np.abs(np.diff(v, axis=0)).max() / max(np.abs(np.diff(steady, axis=0)).max(), 1e-9)
    knee = 0.0
    for s in ("_l", "_r"):
        for j in bones:
            a = j["lower_leg" + s] - j["upper_leg" + s]
            b = j["foot" + s] - j["lower_leg" + s]
            cos = a @ b / np.linalg.norm(a) / np.linalg.norm(b)
            knee = max(knee, 180.0 - math.degrees(math.acos(max(-1, min(1, cos)))))
    return {"clip": clip.name, "s": clip.length, "slide": slide, "sink": sink,
            "stretch": float(np.ptp(lengths, axis=0).max()), "seam": seam, "jerk": jerk, "knee": knee,
            "lies": lies}


def main(path, all_clips, most=15000, held=0):
    """`most` triangles; `held`: vertices of what is in one hand."""
    armature, body, actions = load(path)
    rows = []
    armature.data.pose_position = "REST"
    bpy.context.view_layer.update()
    check_mesh(body, rows, most, held)
    rest = deformed(body)
    armature.data.pose_position = "POSE"
    sole = rest[:, 1] < 0.02
    soles_of = {"left": np.flatnonzero(sole & (rest[:, 0] > 0)), "right": np.flatnonzero(sole & (rest[:, 0] < 0))}
    good = True
    for name, value, ok in rows:
        good &= bool(ok)
        print(f"{name:44} {value!s:>10} {'' if ok else 'BROKEN'}")
    print(f"{'clip':11} {'s':>6} {'slide mm':>9} {'sink mm':>8} {'stretch mm':>11} {'seam mm':>8} {'seam jerk':>10} {'knee deg':>9} {'lies mm':>8}")
    for clip in all_clips:
        r = check_clip(armature, body, clip, actions[clip.name], soles_of)
        ok = r["slide"] <= SLIDE and r["sink"] <= SINK and r["seam"] <= SEAM and r["knee"] < 179.0 \
            and r["jerk"] <= 1.05 and r["stretch"] < 1e-4 and abs(r["lies"]) <= LIES
        good &= ok
        print(f"{r['clip']:11} {r['s']:6.3f} {r['slide'] * 1000:9.2f} {r['sink'] * 1000:8.2f} {r['stretch'] * 1000:11.4f} "
              f"{r['seam'] * 1000:8.4f} {r['jerk']:10.3f} {r['knee']:9.1f} {r['lies'] * 1000:8.1f} {'' if ok else 'BROKEN'}")
    missing = set(c.name for c in all_clips) ^ set(actions)
    if missing:
        print("clips that differ from the list:", sorted(missing))
        good = False
    print("all bounds hold" if good else "bounds are broken")
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main(sys.argv[sys.argv.index("--") + 1], clips.all_clips())
