# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Draws a very small dense workspace, on which a run takes a fraction of a
second: a wall with texture and a bare rectangle, seen head-on by up to four
cameras side by side. Needs nothing but Python."""
import math
import os
import random
import struct
import zlib

NAMES = ("v0.png", "left/v1.png", "v2.png", "v3.png")
WIDTH, HEIGHT = 40, 30
FOCAL, DEPTH, BASELINE = 34.0, 5.0, 0.4


def png_chunk(kind, body):
    return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))


def png(rows, bits=8):
    """A PNG of rows of gray levels: a photo in colors, or gray with 16 bits, as
    other programs write depth."""
    num_channels = 3 if bits == 8 else 1
    header = struct.pack(">IIBBBBB", len(rows[0]), len(rows), bits, num_channels - 1, 0, 0, 0)
    body = b"".join(b"\0" + b"".join(level.to_bytes(bits // 8, "big") * num_channels for level in row)
                    for row in rows)
    return (b"\x89PNG\r\n\x1a\n" + png_chunk(b"IHDR", header)
            + png_chunk(b"IDAT", zlib.compress(body)) + png_chunk(b"IEND", b""))


def write(path, content):
    """A new file, so that other links to an old one keep what they have."""
    os.makedirs(os.path.dirname(path), exist_ok=True)
    if os.path.lexists(path):
        os.remove(path)
    with open(path, "wb") as file:
        file.write(content)


def map_file(channels, width=None, height=None):
    """COLMAP's raster file of these channels, each a list of width * height; of the
    images' size unless told otherwise."""
    width, height = width or WIDTH, height or HEIGHT
    header = f"{width}&{height}&{len(channels)}&".encode()
    return header + b"".join(struct.pack(f"<{len(c)}f", *c) for c in channels)


def wall(view, x, y):
    return (DEPTH * (x - WIDTH / 2) / FOCAL + BASELINE * view,
            DEPTH * (y - HEIGHT / 2) / FOCAL)


def is_bare(view, x, y):
    u, v = wall(view, x, y)
    return abs(u - 0.6) < 1.1 and abs(v) < 1.1


def level(view, x, y):
    if is_bare(view, x, y):
        return 200
    u, v = wall(view, x, y)
    wave = math.sin(9 * u + 3 * v) + math.sin(7 * v - 4 * u * u) + math.sin(31 * u * v)
    return int(110 + 25 * wave)


def photo_rows(view):
    return [[level(view, x, y) for x in range(WIDTH)] for y in range(HEIGHT)]


def depth_map(view, kind):
    noise = random.Random(10 * view + len(kind))
    depths = []
    for y in range(HEIGHT):
        for x in range(WIDTH):
            error = noise.uniform(-1, 1)
            if not is_bare(view, x, y):
                depths.append(DEPTH * (1 + 0.001 * error))
            elif kind == "photometric" or noise.random() < 0.1:
                depths.append(DEPTH * (1 + 0.2 * error))
            else:
                depths.append(0.0)
    return depths


def sparse_model(names):
    """The files of the sparse model as text, with points of the wall that all
    images see."""
    points = []
    for y in range(2, HEIGHT - 2, 4):
        for x in range(12, WIDTH - 2, 4):
            if not is_bare(0, x, y):
                points.append((*wall(0, x, y), DEPTH))
    tracks = " ".join(f"{view + 1} 0" for view in range(len(names)))
    return {
        "cameras.txt": f"1 PINHOLE {WIDTH} {HEIGHT} {FOCAL} {FOCAL} {WIDTH / 2} {HEIGHT / 2}\n",
        "images.txt": "".join(f"{view + 1} 1 0 0 0 {-BASELINE * view} 0 0 1 {name}\n\n"
                              for view, name in enumerate(names)),
        "points3D.txt": "".join(f"{i + 1} {x} {y} {z} 0 0 0 0.5 {tracks}\n"
                                for i, (x, y, z) in enumerate(points)),
    }


def draw(root, num_images, with_maps=True):
    """Makes the workspace, with maps of both types if wanted."""
    names = NAMES[:num_images]
    for name, text in sparse_model(names).items():
        write(os.path.join(root, "sparse", name), text.encode())
    stereo = os.path.join(root, "stereo")
    write(os.path.join(stereo, "patch-match.cfg"),
          "".join(f"{name}\n__all__\n" for name in names).encode())
    write(os.path.join(stereo, "fusion.cfg"), "".join(f"{name}\n" for name in names).encode())
    for folder in ("depth_maps", "normal_maps"):
        os.makedirs(os.path.join(stereo, folder), exist_ok=True)
    for view, name in enumerate(names):
        write(os.path.join(root, "images", name), png(photo_rows(view)))
        for kind in ("photometric", "geometric") if with_maps else ():
            depths = depth_map(view, kind)
            facing = [-1.0 if depth > 0 else 0.0 for depth in depths]
            nothing = [0.0] * len(depths)
            tail = f"{name}.{kind}.bin"
            write(os.path.join(stereo, "depth_maps", tail), map_file([depths]))
            write(os.path.join(stereo, "normal_maps", tail),
                  map_file([nothing, nothing, facing]))


def draw_external_maps(folder, num_images):
    """Depth as another program would give it: arrays of NumPy, by image name."""
    for view, name in enumerate(NAMES[:num_images]):
        header = f"{{'descr': '<f4', 'fortran_order': False, 'shape': ({HEIGHT}, {WIDTH}), }}"
        header += " " * (-(len(header) + 11) % 64) + "\n"
        body = struct.pack(f"<{WIDTH * HEIGHT}f", *depth_map(view, "geometric"))
        write(os.path.join(folder, os.path.splitext(name)[0] + ".npy"),
              b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header.encode() + body)
