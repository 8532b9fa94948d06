"""Writes values.txt: what the reference implementation of FLIP says of small images.

    pip install flip-evaluator==1.7 numpy
    python reference.py > values.txt

The images are made of integers, so that the Rust test makes the same ones. A line is
kind, seed, width, height, tone map, start and stop exposure and their number (0 0 0 for LDR),
mean error, then the errors of all pixels.
"""

import numpy
from flip_evaluator import evaluate


def noise(seed, n):
    """Integers of 0 to 255: the high bits of a linear congruential generator (Knuth, MMIX)."""
    state, values = seed, []
    for _ in range(n):
        state = (state * 6364136223846793005 + 1442695040888963407) % 2**64
        values.append(state >> 56)
    return values


def image(seed, width, height):
    """A ramp, stripes and noise, as integers of 0 to 255; the second image is off in a part of it."""
    values = noise(seed, 6 * width * height)
    first, second = [], []
    for y in range(height):
        for x in range(width):
            for c in range(3):
                k = 3 * (y * width + x) + c
                base = (x * 200 // width + (40 if (x // 4 + y // 3 + c) % 2 else 0) + values[k] // 16) % 256
                off = values[3 * width * height + k] // 8 if (x + 2 * y) % 3 == seed % 3 else 0
                first.append(base)
                second.append(min(base + off, 255))
    shape = (height, width, 3)
    return numpy.array(first).reshape(shape), numpy.array(second).reshape(shape)


def line(kind, seed, width, height, curve, reference, test, parameters):
    errors, mean, used = evaluate(reference, test, kind, applyMagma=False, parameters=parameters)
    hdr = kind == "HDR"
    exposures = [used[k] if hdr else 0 for k in ("startExposure", "stopExposure", "numExposures")]
    head = [kind, seed, width, height, curve] + [repr(float(e)) for e in exposures]
    print(*head, repr(float(mean)), *(f"{e:.6f}" for e in numpy.asarray(errors).reshape(height * width, -1)[:, 0]))


for seed, width, height in [(1, 24, 16), (2, 31, 7), (3, 12, 25)]:
    reference, test = image(seed, width, height)
    scale = numpy.float32(1 / 255)
    line("LDR", seed, width, height, "-", (reference * scale).astype(numpy.float32), (test * scale).astype(numpy.float32), {})
    # Radiance from 2^-12 to 2^4: a power of two, and an eighth of it at most in steps.
    radiance = lambda v: (2.0 ** (v // 16 - 12) * (1 + (v % 16) / 16)).astype(numpy.float32)
    for curve in ("ACES", "Reinhard"):
        line("HDR", seed, width, height, curve, radiance(reference), radiance(test), {"tonemapper": curve.lower()})
