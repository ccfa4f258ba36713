#!/usr/bin/env python3
"""Writes resources/scenes/gallery/studio.hdr: a dark room with lamps behind cloth, as photographers have it, for pictures by Cycles."""
import math
import pathlib

WIDTH, HEIGHT = 128, 64
EDGE = 4  # degrees in which a lamp's light falls off
# Degrees to the right of -z, degrees above the horizon, light.
LAMPS = [((-118, -62), (2, 52), (6.5, 6.3, 6.0)),
         ((56, 76), (-4, 62), (9.0, 9.2, 9.6)),
         ((-40, 40), (58, 84), (5.0, 5.0, 5.0)),
         ((150, 210), (25, 60), (1.6, 1.5, 1.4))]


def share(value, ends):
    low, high = ends
    return max(0.0, min(1.0, (value - low) / EDGE + 0.5)) * max(0.0, min(1.0, (high - value) / EDGE + 0.5))


def light(right, up):
    color = [0.05 + 0.04 * max(0.0, math.sin(math.radians(up)))] * 3
    for sideways, upwards, lamp in LAMPS:
        part = max(share(right, sideways), share(right + 360, sideways)) * share(up, upwards)
        color = [c + part * x for c, x in zip(color, lamp)]
    return color


def rgbe(color):
    mantissa, exponent = math.frexp(max(color))
    scale = mantissa * 256 / max(color)
    return bytes([int(c * scale) for c in color] + [exponent + 128])


pixels = bytearray()
for row in range(HEIGHT):
    for column in range(WIDTH):
        pixels += rgbe(light((column + 0.5) / WIDTH * 360 - 180, 90 - (row + 0.5) / HEIGHT * 180))
head = f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {HEIGHT} +X {WIDTH}\n".encode()
root = pathlib.Path(__file__).resolve().parents[2]
(root / "resources/scenes/gallery/studio.hdr").write_bytes(head + pixels)
