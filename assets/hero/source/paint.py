"""The three textures: base colour, normal map, roughness.

For each texel the place on the body in the rest pose is found; what is painted
there is a function of that place (`looks.py`), so charts meet without a seam. The
normal map holds what the field's fine version has and the mesh has not: folds,
seams, weave, knitting, lids and hair.
"""

import numpy as np

import sdf


def rasterise(halves, tangents, size):
    """For each covered texel: part, place, smooth normal, tangent and its sign."""
    part = np.full((size, size), -1)
    place = np.zeros((size, size, 3))
    normal = np.zeros((size, size, 3))
    tangent = np.zeros((size, size, 4))
    for k, half in enumerate(halves):
        tan = tangents[half.name]
        for f, corners in enumerate(half.uv * size - 0.5):
            # A texel's width beyond the edges, so that filtering finds paint there.
            x0, y0 = np.maximum(np.floor(corners.min(axis=0) - 2).astype(int), 0)
            x1, y1 = np.minimum(np.ceil(corners.max(axis=0) + 2).astype(int), size - 1)
            if x1 < x0 or y1 < y0:
                continue
            gx, gy = np.meshgrid(np.arange(x0, x1 + 1), np.arange(y0, y1 + 1))
            a, b, c = corners
            area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
            if abs(area) < 1e-9:
                continue
            w1 = ((gx - a[0]) * (c[1] - a[1]) - (gy - a[1]) * (c[0] - a[0])) / area
            w2 = ((b[0] - a[0]) * (gy - a[1]) - (b[1] - a[1]) * (gx - a[0])) / area
            w0 = 1.0 - w1 - w2
            least = np.minimum(np.minimum(w0, w1), w2)
            here = part[y0:y1 + 1, x0:x1 + 1]
            reach = 1.6 / np.sqrt(abs(area))
            hit = (least >= 0.0) | ((least > -reach) & (here < 0))
            if not hit.any():
                continue
            w = np.clip(np.stack([w0, w1, w2], axis=-1)[hit], 0.0, None)
            w /= w.sum(axis=1, keepdims=True)
            ys, xs = gy[hit], gx[hit]
            v = half.faces[f]
            part[ys, xs] = k
            place[ys, xs] = w @ half.verts[v]
            normal[ys, xs] = w @ half.normals[v]
            tangent[ys, xs] = np.concatenate([w @ tan[f, :, :3], np.full((len(w), 1), tan[f, 0, 3])], axis=1)
    return part, place, sdf.unit(normal), tangent


def _spread(image, known, rounds=6):
    """Paint carried outwards over the empty texels."""
    image, known = image.copy(), known.copy()
    for _ in range(rounds):
        total = np.zeros_like(image)
        count = np.zeros(known.shape)
        for dy, dx in ((0, 1), (0, -1), (1, 0), (-1, 0)):
            k = np.roll(known, (dy, dx), axis=(0, 1))
            total += np.roll(image, (dy, dx), axis=(0, 1)) * k[..., None]
            count += k
        new = ~known & (count > 0)
        image[new] = total[new] / count[new][:, None]
        known |= new
    mean = image[known].mean(axis=0)
    image[~known] = mean
    return image


def _fine_normal(field, p, n, height):
    """The normal of the fine field raised by `height`; never far from the mesh's own."""
    g = sdf.gradient(lambda q: field(q) - height(q), p, 0.0006)
    fine = sdf.unit(g)
    # On edges where the coarse mesh cuts a corner, the field may look another way.
    agree = np.einsum("ij,ij->i", fine, n)
    share = sdf.smoothstep(0.35, 0.75, agree)[:, None]
    return sdf.unit(fine * share + n * (1 - share))


def textures(halves, tangents, size, looks):
    """(colour sRGB, normal, roughness) as arrays (size, size, 3) in 0..1, row 0 lowest."""
    part, place, normal, tangent = rasterise(halves, tangents, size)
    colour = np.zeros((size, size, 3))
    rough = np.full((size, size, 3), 0.8)
    bumps = np.zeros((size, size, 3))
    bumps[...] = (0.5, 0.5, 1.0)
    for k, half in enumerate(halves):
        on = part == k
        if not on.any():
            continue
        p, n, t = place[on], normal[on], tangent[on]
        look = looks[half.name]
        base, roughness = look.surface(p, n)
        if look.field is not None:
            p_on = sdf.project(look.field, p, 2)
            p_on = np.where(sdf.length(p_on - p)[:, None] < 0.006, p_on, p)
            fine = _fine_normal(look.field, p_on, n, look.height)
        else:
            slope = sdf.gradient(look.height, p, 0.0006)
            slope -= n * np.einsum("ij,ij->i", slope, n)[:, None]
            fine = sdf.unit(n - slope)
        tx = sdf.unit(t[:, :3] - n * np.einsum("ij,ij->i", t[:, :3], n)[:, None])
        ty = np.cross(n, tx) * t[:, 3:]
        local = np.stack([np.einsum("ij,ij->i", fine, a) for a in (tx, ty, n)], axis=1)
        local[:, 2] = np.maximum(local[:, 2], 0.15)
        colour[on] = base
        rough[on] = roughness[:, None]
        bumps[on] = sdf.unit(local) * 0.5 + 0.5
    known = part >= 0
    srgb = np.where(colour <= 0.0031308, 12.92 * colour, 1.055 * np.maximum(colour, 1e-9) ** (1 / 2.4) - 0.055)
    return _spread(srgb, known), _spread(bumps, known), _spread(rough, known)


def save(array, path, levels=256):
    """An 8-bit PNG; `levels` coarser steps make it smaller. The grey of the roughness
    is written as RGB, so that it may serve as a glTF metallic-roughness texture."""
    import struct
    import zlib
    steps = levels - 1
    data = np.round(np.clip(array, 0, 1) * steps) * (255.0 / steps)
    data = np.round(data).astype(np.uint8)[::-1]
    h, w, _ = data.shape
    raw = data.reshape(h, w * 3).astype(np.int16)
    up = np.vstack([np.zeros((1, w * 3), np.int16), raw[:-1]])
    left = np.hstack([np.zeros((h, 3), np.int16), raw[:, :-3]])
    corner = np.hstack([np.zeros((h, 3), np.int16), up[:, :-3]])
    guess = left + up - corner
    da, db, dc = np.abs(guess - left), np.abs(guess - up), np.abs(guess - corner)
    paeth = np.where((da <= db) & (da <= dc), left, np.where(db <= dc, up, corner))
    options = [raw, raw - left, raw - up, raw - ((left + up) >> 1), raw - paeth]
    costs = np.stack([np.abs(((o + 128) & 255) - 128).sum(axis=1) for o in options])
    best = costs.argmin(axis=0)
    rows = bytearray()
    for y in range(h):
        rows.append(int(best[y]))
        rows += (options[best[y]][y] & 255).astype(np.uint8).tobytes()

    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
    with open(path, "wb") as out:
        out.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", w, h, 8, 2, 0, 0, 0))
                  + chunk(b"IDAT", zlib.compress(bytes(rows), 9)) + chunk(b"IEND", b""))
