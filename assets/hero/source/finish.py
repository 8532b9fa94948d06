"""Makes an exported FBX file the same whenever and wherever it was written.

The exporter puts the time, absolute paths and numbers of its own run into the file,
and names a stack "hero|walk". Here the file is read as a tree and written anew with
a fixed time, file names without folders, numbers counted from the start, objects in
a fixed order, and stacks named as the clips are.
"""

import struct
import zlib

from io_scene_fbx import encode_bin, parse_fbx

EPOCH = {b"Year": 2026, b"Month": 1, b"Day": 1, b"Hour": 0, b"Minute": 0, b"Second": 0, b"Millisecond": 0}

_ADD = {ord("Y"): "add_int16", ord("C"): "add_bool", ord("I"): "add_int32", ord("F"): "add_float32",
        ord("D"): "add_float64", ord("L"): "add_int64", ord("R"): "add_bytes", ord("S"): "add_string"}


def _add_array(out, values, kind):
    """An array packed as small as zlib can."""
    data = values.tobytes()
    packed = zlib.compress(data, 9)
    encoding, body = (1, packed) if len(packed) < len(data) else (0, data)
    out.props_type.append(kind)
    out.props.append(struct.pack("<3I", len(values), encoding, len(body)) + body)


def _write(elem):
    out = encode_bin.FBXElem(elem.id)
    for value, kind in zip(elem.props, elem.props_type):
        if chr(kind) in "fidlbc":
            _add_array(out, value, kind)
        else:
            getattr(out, _ADD[kind])(value)
    out.elems = [_write(e) for e in elem.elems]
    return out


def _walk(elem):
    yield elem
    for e in elem.elems:
        yield from _walk(e)


def _child(root, name):
    return next(e for e in root.elems if e.id == name)


def _clip_name(name):
    """b"hero|walk\\0\\1AnimStack" without the object that it was recorded from."""
    label, zero, kind = name.partition(b"\x00\x01")
    return label.split(b"|")[-1] + zero + kind


def _fix_times(root):
    for elem in _walk(root):
        if elem.id == b"CreationTimeStamp":
            for e in elem.elems:
                if e.id in EPOCH:
                    e.props[0] = EPOCH[e.id]
        elif elem.id == b"P" and elem.props and b"DateTime" in elem.props[0]:
            elem.props[4] = b"01/01/2026 00:00:00.000"


def _fix_paths(root):
    def base(path):
        return path.replace(b"\\", b"/").split(b"/")[-1]
    for elem in _walk(root):
        if elem.id in (b"Filename", b"RelativeFilename", b"FileName"):
            elem.props[0] = base(elem.props[0])
        elif elem.id == b"P" and elem.props[0] in (b"Path", b"RelPath", b"DocumentUrl", b"SrcDocumentUrl",
                                                   b"Original|FileName"):
            elem.props[4] = base(elem.props[4])


def _names(objects):
    """A name for each object that does not depend on its number."""
    return {e.props[0]: (e.id, e.props[1], e.props[2]) for e in objects.elems}


def _order(root):
    """Objects sorted by what they are and by what they belong to; connections by their ends."""
    objects, links = _child(root, b"Objects"), _child(root, b"Connections")
    names = _names(objects)
    parents = {}
    for c in links.elems:
        parents.setdefault(c.props[1], []).append((c.props[2], c.props[3] if len(c.props) > 3 else b""))
    known = {}

    def key(uid):
        if uid not in known:
            known[uid] = ()
            own = names.get(uid, (b"", b"", b""))
            known[uid] = (own[0], own[1], own[2],
                          tuple(sorted((key_text(up), prop) for up, prop in parents.get(uid, []))))
        return known[uid]

    def key_text(uid):
        return repr(key(uid)).encode()
    kind_rank = {}
    for e in objects.elems:
        kind_rank.setdefault(e.id, len(kind_rank))
    ranks = {k: i for i, k in enumerate(sorted(kind_rank))}
    # Bones keep the exporter's order (parents first), which is fixed by the armature.
    movable = {b"AnimationStack", b"AnimationLayer", b"AnimationCurveNode", b"AnimationCurve"}
    fixed = [e for e in objects.elems if e.id not in movable]
    moved = sorted((e for e in objects.elems if e.id in movable), key=lambda e: (ranks[e.id], key_text(e.props[0])))
    objects.elems[:] = fixed + moved
    place = {e.props[0]: i for i, e in enumerate(objects.elems)}
    links.elems.sort(key=lambda c: (place.get(c.props[1], -1), place.get(c.props[2], -1),
                                    c.props[3] if len(c.props) > 3 else b""))


def _renumber(root):
    objects, links = _child(root, b"Objects"), _child(root, b"Connections")
    new = {e.props[0]: 1000 + i for i, e in enumerate(objects.elems)}
    for e in objects.elems:
        e.props[0] = new[e.props[0]]
        for n in _walk(e):
            if n.id == b"Node" and n.props and n.props[0] in new:  # of a bind pose
                n.props[0] = new[n.props[0]]
    for c in links.elems:
        for i in (1, 2):
            c.props[i] = new.get(c.props[i], c.props[i])
    for doc in _child(root, b"Documents").elems:
        if doc.id == b"Document":
            doc.props[0] = 999


def _thin_constant_curves(root):
    """A curve that never moves keeps its first and last key."""
    for e in _child(root, b"Objects").elems:
        if e.id != b"AnimationCurve":
            continue
        parts = {c.id: c for c in e.elems}
        values, times = parts[b"KeyValueFloat"].props[0], parts[b"KeyTime"].props[0]
        if len(values) > 2 and max(values) - min(values) < 1e-7:
            parts[b"KeyValueFloat"].props[0] = values[:1] + values[-1:]
            parts[b"KeyTime"].props[0] = times[:1] + times[-1:]
            parts[b"KeyAttrRefCount"].props[0][0] = 2


def _drop_idle_nodes(root):
    """Curves of places and scales that stay at their rest value are left out, and all
    of those of the two objects above the bones, which never move."""
    objects, links = _child(root, b"Objects"), _child(root, b"Connections")
    by_id = {e.props[0]: e for e in objects.elems}
    rest = {}
    for e in objects.elems:
        if e.id == b"Model":
            for p in _child(e, b"Properties70").elems:
                if p.props[0].startswith(b"Lcl "):
                    if e.props[2] != b"LimbNode":
                        # The turn that undoes Blender's own leaves some 1e-6 degrees.
                        p.props[4:7] = [0.0 if abs(v) < 1e-4 else v for v in p.props[4:7]]
                    rest[e.props[0], p.props[0]] = p.props[4:7]
    curves, target = {}, {}
    for c in links.elems:
        source = by_id.get(c.props[1])
        if source is None:
            continue
        if source.id == b"AnimationCurve":
            curves.setdefault(c.props[2], []).append((c.props[3], source))
        elif source.id == b"AnimationCurveNode" and c.props[0] == b"OP":
            target[c.props[1]] = (c.props[2], c.props[3])
    gone = set()
    for node, (model, prop) in target.items():
        default = rest.get((model, prop), [1.0, 1.0, 1.0] if prop == b"Lcl Scaling" else [0.0, 0.0, 0.0])
        bone = by_id[model].props[2] == b"LimbNode"
        if bone and (prop == b"Lcl Rotation" or by_id[model].props[1].startswith(b"hips")):
            continue
        still = True
        for axis, curve in curves.get(node, []):
            values = _child(curve, b"KeyValueFloat").props[0]
            want = default[b"XYZ".index(axis[-1:])]
            still &= all(abs(v - want) < (1e-5 if bone else 1e-4) for v in (min(values), max(values)))
        if still:
            gone.add(node)
            gone.update(curve.props[0] for _, curve in curves.get(node, []))
    objects.elems[:] = [e for e in objects.elems if e.props[0] not in gone]
    links.elems[:] = [c for c in links.elems if c.props[1] not in gone and c.props[2] not in gone]
    counts = {}
    for e in objects.elems:
        counts[e.id] = counts.get(e.id, 0) + 1
    for kind in _child(root, b"Definitions").elems:
        if kind.id == b"ObjectType" and kind.props[0] in counts:
            _child(kind, b"Count").props[0] = counts[kind.props[0]]


def _drop_half_frames(root, stacks):
    """Of the stacks named, every other key: they are exported at half frames as all are."""
    objects, links = _child(root, b"Objects"), _child(root, b"Connections")
    up = {}
    for c in links.elems:
        up.setdefault(c.props[1], []).append(c.props[2])
    by_id = {e.props[0]: e for e in objects.elems}

    def stack_of(uid):
        while uid in by_id and by_id[uid].id != b"AnimationStack":
            above = [u for u in up.get(uid, []) if u in by_id and by_id[u].id.startswith(b"Animation")]
            if not above:
                return None
            uid = above[0]
        return by_id[uid].props[1].partition(b"\x00")[0].decode() if uid in by_id else None
    for e in objects.elems:
        if e.id == b"AnimationCurve" and stack_of(e.props[0]) in stacks:
            parts = {c.id: c for c in e.elems}
            count = len(parts[b"KeyTime"].props[0])
            assert count % 2 == 1, "a clip ends on a whole frame"
            for name in (b"KeyTime", b"KeyValueFloat"):
                parts[name].props[0] = parts[name].props[0][::2]
            parts[b"KeyAttrRefCount"].props[0][0] = (count + 1) // 2


def finish(path, whole_frames=()):
    """`whole_frames`: names of the clips that need no keys between frames."""
    root, version = parse_fbx.parse(path)
    _fix_times(root)
    _fix_paths(root)
    for e in _walk(root):
        if e.id in (b"AnimationStack", b"AnimationLayer"):
            e.props[1] = _clip_name(e.props[1])
        elif e.id == b"Take":
            e.props[0] = _clip_name(e.props[0])
            for f in e.elems:
                if f.id == b"FileName":
                    f.props[0] = _clip_name(f.props[0])
    takes = _child(root, b"Takes")
    takes.elems.sort(key=lambda t: (t.id, t.props[0]))
    _drop_idle_nodes(root)
    _drop_half_frames(root, whole_frames)
    _thin_constant_curves(root)
    _order(root)
    _renumber(root)
    encode_bin.write(path, _write(root), version)
