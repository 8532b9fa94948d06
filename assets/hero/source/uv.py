"""Texture coordinates: charts unwrapped by Blender, scaled and packed.

Both halves of the person share their texels. What is painted is a function of the
place on the body, so the seams between charts do not show.
"""

import bpy
import numpy as np

import sdf


def _islands(faces, key):
    """Number of the island of each face: joined by an edge, of one key."""
    parent = list(range(len(faces)))

    def find(i):
        while parent[i] != i:
            parent[i] = parent[parent[i]]
            i = parent[i]
        return i
    seen = {}
    for f, (a, b, c) in enumerate(faces):
        for e in ((a, b), (b, c), (c, a)):
            k = (min(e), max(e), key[f])
            if k in seen:
                parent[find(f)] = find(seen[k])
            else:
                seen[k] = f
    roots = {}
    return np.array([roots.setdefault(find(f), len(roots)) for f in range(len(faces))])


def _scale(uv, verts, faces, island, detail):
    """Each island as large as its surface times detail squared."""
    t = verts[faces]
    area = 0.5 * sdf.length(np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0]))
    e1, e2 = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
    flat = 0.5 * np.abs(e1[:, 0] * e2[:, 1] - e1[:, 1] * e2[:, 0])
    for i in range(island.max() + 1):
        on = island == i
        scale = np.sqrt(area[on].sum() / max(flat[on].sum(), 1e-12)) * detail[on][0]
        centre = uv[on].mean(axis=(0, 1))
        uv[on] = (uv[on] - centre) * scale
    return uv


def unwrap(halves, margin=0.004):
    """Gives each half its `uv` (faces, 3, 2) in 0..1."""
    offset, verts, faces, chart, detail, fixed = 0, [], [], [], [], []
    for k, h in enumerate(halves):
        verts.append(h.verts)
        faces.append(h.faces + offset)
        chart.append(k * 100 + h.chart)
        detail.append(np.full(len(h.faces), h.detail))
        fixed.append(np.full(len(h.faces), h.ribbon))
        offset += len(h.verts)
    verts, faces, chart, detail, fixed = map(np.concatenate, (verts, faces, chart, detail, fixed))

    mesh = bpy.data.meshes.new("unwrap")
    mesh.from_pydata(verts.tolist(), [], faces.tolist())
    mesh.uv_layers.new(name="uv")
    obj = bpy.data.objects.new("unwrap", mesh)
    bpy.context.scene.collection.objects.link(obj)
    bpy.context.view_layer.objects.active = obj
    sides = {}
    for f, (a, b, c) in enumerate(faces):
        for e in ((a, b), (b, c), (c, a)):
            sides.setdefault((min(e), max(e)), set()).add(chart[f])
    for edge in mesh.edges:
        edge.use_seam = len(sides[tuple(sorted(edge.vertices))]) > 1
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.uv.unwrap(method="ANGLE_BASED", margin=0.01)
    bpy.ops.object.mode_set(mode="OBJECT")

    layer = mesh.uv_layers["uv"].data
    uv = np.array([d.uv[:] for d in layer]).reshape(-1, 3, 2)
    brought = np.concatenate([h.uv for h in halves if h.ribbon])
    uv[fixed] = brought
    island = _islands(faces, chart)
    uv = _scale(uv, verts, faces, island, detail)
    uv = _pack(uv, island, margin)
    bpy.data.objects.remove(obj)
    bpy.data.meshes.remove(mesh)
    start = 0
    for h in halves:
        h.uv = uv[start:start + len(h.faces)]
        start += len(h.faces)
    return halves


def _upright(points):
    """The turn that makes the points' box smallest, lying."""
    best = None
    for degrees in range(0, 180, 3):
        a = np.radians(degrees)
        turn = np.array([[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]])
        q = points @ turn.T
        size = q.max(axis=0) - q.min(axis=0)
        if size[1] <= size[0] and (best is None or size[0] * size[1] < best[0] - 1e-12):
            best = (size[0] * size[1], turn)
    return best[1]


GRID = 256


def _cover(uv, scale, margin):
    """The cells of the grid that an island's triangles touch, margin included."""
    low = uv.min(axis=(0, 1))
    q = (uv - low) * scale * GRID + margin * GRID
    size = np.ceil(q.max(axis=(0, 1)) + margin * GRID).astype(int) + 1
    mask = np.zeros((size[1], size[0]), dtype=bool)
    for t in q:
        x0, y0 = np.floor(t.min(axis=0) - margin * GRID).astype(int)
        x1, y1 = np.ceil(t.max(axis=0) + margin * GRID).astype(int)
        mask[max(y0, 0):y1 + 1, max(x0, 0):x1 + 1] = True
    return mask


def _place(masks, order):
    """Lowest free place for each mask, or nothing if one does not fit."""
    field = np.zeros((GRID, GRID), dtype=bool)
    places = {}
    for i in order:
        found = None
        for mask, turned in masks[i]:
            h, w = mask.shape
            if h > GRID or w > GRID:
                continue
            cells = np.argwhere(mask)
            busy = np.zeros((GRID - h + 1, GRID - w + 1), dtype=bool)
            for y, x in cells:
                busy |= field[y:y + GRID - h + 1, x:x + GRID - w + 1]
            free = np.argwhere(~busy)
            if len(free):
                y, x = free[np.argmin(free[:, 0] + free[:, 1] * 0.5 + np.maximum(free[:, 0] + h, free[:, 1] + w))]
                cost = max(y + h, x + w)
                if found is None or cost < found[0]:
                    found = (cost, y, x, mask, turned)
        if found is None:
            return None
        _, y, x, mask, turned = found
        field[y:y + mask.shape[0], x:x + mask.shape[1]] |= mask
        places[i] = (y, x, turned)
    return places


def _pack(uv, island, margin):
    """Islands laid into the unit square by their true outlines, as large as fits."""
    count = island.max() + 1
    quarter = np.array([[0.0, -1.0], [1.0, 0.0]])
    for i in range(count):
        on = island == i
        uv[on] = uv[on] @ _upright(uv[on].reshape(-1, 2)).T
    boxes = [uv[island == i].max(axis=(0, 1)) - uv[island == i].min(axis=(0, 1)) for i in range(count)]
    order = np.argsort([-b[0] * b[1] for b in boxes], kind="stable")
    total = sum(b[0] * b[1] for b in boxes)
    scale = 1.05 / np.sqrt(total)
    while True:
        masks = [[(_cover(uv[island == i] @ np.linalg.matrix_power(quarter, k).T, scale, margin), k)
                  for k in (0, 1)] for i in range(count)]
        places = _place(masks, order)
        if places is not None:
            break
        scale *= 0.965
    for i in range(count):
        on = island == i
        y, x, k = places[i]
        q = uv[on] @ np.linalg.matrix_power(quarter, k).T
        uv[on] = (q - q.min(axis=(0, 1))) * scale + margin + np.array([x, y]) / GRID
    return uv
