"""From a field to a mesh of even triangles.

`surface_nets` finds a first surface on a grid; `remesh` then splits, joins and
turns edges and moves vertices along the surface until each edge has about the
length that the part wishes for at its place (Botsch and Kobbelt, "A Remeshing
Approach to Multiresolution Modeling", 2004). Even triangles bend without
creases wherever a joint is, with more of them where the part asks.

Only the half with x >= 0 is made; vertices on the mirror plane stay on it.
"""

import bmesh
import bpy
import numpy as np

import sdf

ON_PLANE = 1e-7


def surface_nets(field, low, high, cell):
    """Quads about the zero set of `field` in the box, on the side x >= 0."""
    low, high = np.array(low, dtype=float), np.array(high, dtype=float)
    centred = low[0] <= 0.0
    if centred:
        low[0] = -0.5 * cell  # the first cells straddle the mirror plane
    count = np.ceil((high - low) / cell).astype(int) + 2
    axes = [low[a] + cell * np.arange(count[a]) for a in range(3)]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    d = np.concatenate([field(part) for part in np.array_split(grid, max(1, len(grid) // 200000))])
    d = d.reshape(count)
    inside = d < 0.0

    cells = count - 1
    total = np.zeros((*cells, 3))
    hits = np.zeros(cells)
    corner = lambda a, o: (slice(o[0], cells[0] + o[0]), slice(o[1], cells[1] + o[1]),
                           slice(o[2], cells[2] + o[2]))
    for axis in range(3):
        others = [a for a in range(3) if a != axis]
        for i in (0, 1):
            for j in (0, 1):
                a = [0, 0, 0]
                a[others[0]], a[others[1]] = i, j
                b = list(a)
                b[axis] = 1
                da, db = d[corner(d, a)], d[corner(d, b)]
                crosses = (da < 0.0) != (db < 0.0)
                t = np.where(crosses, da / np.where(crosses, da - db, 1.0), 0.0)
                for k in range(3):
                    place = t if k == axis else float(a[k])
                    total[..., k] += np.where(crosses, place, 0.0)
                hits += crosses
    active = hits > 0
    index = np.full(cells, -1)
    index[active] = np.arange(active.sum())
    where = np.argwhere(active)
    verts = low + cell * (where + total[active] / hits[active][:, None])

    quads = []
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        a = [slice(None)] * 3
        b = [slice(None)] * 3
        a[axis], b[axis] = slice(0, -1), slice(1, None)
        cross = inside[tuple(a)] != inside[tuple(b)]
        out = inside[tuple(a)]
        edges = np.argwhere(cross)
        keep = (edges[:, u] > 0) & (edges[:, v] > 0) & (edges[:, u] < cells[u]) & (edges[:, v] < cells[v])
        edges = edges[keep]
        facing = out[tuple(edges.T)]

        def at(du, dv):
            e = edges.copy()
            e[:, u] -= du
            e[:, v] -= dv
            return index[tuple(e.T)]
        quad = np.stack([at(1, 1), at(0, 1), at(0, 0), at(1, 0)], axis=1)
        quad[~facing] = quad[~facing][:, ::-1]
        quads.append(quad)
    quads = np.concatenate(quads)
    if centred:
        verts[np.abs(verts[:, 0]) < 1e-4 * cell, 0] = 0.0
    return verts, quads


def _arrays(bm):
    bm.verts.index_update()
    bm.edges.index_update()
    bm.verts.ensure_lookup_table()
    bm.edges.ensure_lookup_table()
    p = np.array([v.co[:] for v in bm.verts])
    e = np.array([(a.verts[0].index, a.verts[1].index) for a in bm.edges])
    return p, e


def _split_long(bm, sizing):
    for _ in range(3):
        p, e = _arrays(bm)
        size = sizing(0.5 * (p[e[:, 0]] + p[e[:, 1]]))
        ratio = sdf.length(p[e[:, 0]] - p[e[:, 1]]) / size
        todo = [bm.edges[i] for i in np.argsort(-ratio, kind="stable") if ratio[i] > 4.0 / 3.0]
        if not todo:
            return
        for edge in todo:
            faces = list(edge.link_faces)
            a, b = edge.verts
            _, new = bmesh.utils.edge_split(edge, a, 0.5)
            for face in faces:
                across = [v for v in face.verts if v not in (a, b, new)]
                if across:
                    bmesh.utils.face_split(face, new, across[0])


def _collapse_short(bm, sizing):
    for _ in range(6):
        p, e = _arrays(bm)
        size = sizing(p)
        goal = 0.5 * (size[e[:, 0]] + size[e[:, 1]])
        ratio = sdf.length(p[e[:, 0]] - p[e[:, 1]]) / goal
        order = [i for i in np.argsort(ratio, kind="stable") if ratio[i] < 0.8]
        touched = set()
        targets = {}
        for i in order:
            edge = bm.edges[i]
            a, b = edge.verts
            if b.is_boundary and not a.is_boundary:
                a, b = b, a
            if a.is_boundary and b.is_boundary and not edge.is_boundary:
                continue
            near_a = {x.other_vert(a) for x in a.link_edges}
            near_b = {x.other_vert(b) for x in b.link_edges}
            ring = near_a | near_b
            if touched & {v.index for v in ring}:
                continue
            if len(near_a & near_b) != (1 if edge.is_boundary else 2):
                continue
            place = a.co if a.is_boundary and not b.is_boundary else 0.5 * (a.co + b.co)
            too_long = any((v.co - place).length > 1.45 * size[v.index] for v in ring if v not in (a, b))
            if too_long or _flips(a, b, place) or _flips(b, a, place):
                continue
            targets[b] = a
            a.co = place
            touched |= {v.index for v in ring}
        if not targets:
            return
        bmesh.ops.weld_verts(bm, targetmap=targets)


def _flips(v, other, place):
    """Whether moving v to `place` turns a face of v, other than the two that go."""
    for face in v.link_faces:
        if other in face.verts:
            continue
        a, b = [x.co for x in face.verts if x is not v]
        before = (a - v.co).cross(b - v.co)
        after = (a - place).cross(b - place)
        if before.dot(after) < 0.2 * before.length * after.length:
            return True
    return False


def _turn_edges(bm):
    for edge in list(bm.edges):
        if not edge.is_valid or len(edge.link_faces) != 2:
            continue
        a, b = edge.verts
        f, g = edge.link_faces
        c = next(v for v in f.verts if v not in (a, b))
        d = next(v for v in g.verts if v not in (a, b))
        if any(x.other_vert(c) is d for x in c.link_edges):
            continue

        def off(v, change):
            want = 4 if v.is_boundary else 6
            return (len(v.link_edges) + change - want) ** 2
        now = off(a, 0) + off(b, 0) + off(c, 0) + off(d, 0)
        then = off(a, -1) + off(b, -1) + off(c, 1) + off(d, 1)
        if then >= now:
            continue
        n1 = (c.co - d.co).cross(a.co - d.co)
        n2 = (d.co - c.co).cross(b.co - c.co)
        n0 = f.normal + g.normal
        if n1.dot(n2) < 0.5 * n1.length * n2.length or n1.length * n2.length < 1e-16:
            continue
        if abs(n1.dot(n0)) < 0.5 * n1.length * n0.length or abs(n2.dot(n0)) < 0.5 * n2.length * n0.length:
            continue
        if (c.co - d.co).length > 1.3 * (a.co - b.co).length:
            continue
        bmesh.utils.edge_rotate(edge, True)


def _relax(bm, field, rounds=2):
    bm.normal_update()
    p, e = _arrays(bm)
    border = np.array([v.is_boundary for v in bm.verts])
    rim = np.array([x.is_boundary for x in bm.edges])
    # A border vertex listens to its neighbours on the border alone.
    src = np.concatenate([e[:, 0], e[:, 1]])
    dst = np.concatenate([e[:, 1], e[:, 0]])
    listens = np.concatenate([rim | ~border[e[:, 1]], rim | ~border[e[:, 0]]])
    src, dst = src[listens], dst[listens]
    for _ in range(rounds):
        total = np.zeros_like(p)
        count = np.zeros(len(p))
        np.add.at(total, dst, p[src])
        np.add.at(count, dst, 1.0)
        move = total / np.maximum(count, 1.0)[:, None] - p
        n = sdf.unit(sdf.gradient(field, p))
        move -= n * np.einsum("ij,ij->i", move, n)[:, None]
        p = sdf.project(field, p + 0.7 * move, 2)
        p[border, 0] = 0.0
    for v, co in zip(bm.verts, p):
        v.co = co


def remesh(verts, quads, field, sizing, rounds=16):
    """Triangles whose edges have about the length sizing(points). The only
    border may be that on the mirror plane. Ends when a round changes little."""
    mesh = bpy.data.meshes.new("remesh")
    mesh.from_pydata(verts.tolist(), [], quads.tolist())
    bm = bmesh.new()
    bm.from_mesh(mesh)
    bpy.data.meshes.remove(mesh)
    bmesh.ops.triangulate(bm, faces=bm.faces[:])
    count = len(bm.faces)
    for done in range(rounds):
        _split_long(bm, sizing)
        _collapse_short(bm, sizing)
        bm.normal_update()
        _turn_edges(bm)
        _relax(bm, field)
        if done >= 4 and abs(len(bm.faces) - count) < 0.01 * count:
            break
        count = len(bm.faces)
    p, _ = _arrays(bm)
    faces = np.array([[v.index for v in f.verts] for f in bm.faces])
    bm.free()
    return sdf.project(field, p, 3) * np.where(np.abs(p[:, :1]) < ON_PLANE, [[0.0, 1.0, 1.0]], 1.0), faces
