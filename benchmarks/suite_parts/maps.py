# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Maps of a dense workspace as arrays: COLMAP's format and gray PNG."""

import struct
import zlib
from pathlib import Path

import numpy as np

from programs import CommandFailed

PNG_SIGNATURE = b"\x89PNG\r\n\x1a\n"


def read_map(path):
    """A map in COLMAP's format, channels x height x width."""
    try:
        width, height, channels, body = path.read_bytes().split(b"&", 3)
        return np.frombuffer(body, "<f4").reshape(
            int(channels), int(height), int(width))
    except (OSError, ValueError) as error:
        raise CommandFailed(f"{path}: not a map in COLMAP's format ({error})"
                            ) from error


def write_map(path, values):
    """Writes channels x height x width, or height x width."""
    values = np.asarray(values, "<f4")
    channels, height, width = values.reshape(-1, *values.shape[-2:]).shape
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(b"%d&%d&%d&" % (width, height, channels)
                     + np.ascontiguousarray(values).tobytes())


def map_size(path):
    """Width and height, from a map's first bytes."""
    with open(path, "rb") as file:
        head = file.read(64).split(b"&", 3)
    if len(head) < 4:
        raise CommandFailed(f"{path}: not a map in COLMAP's format")
    return int(head[0]), int(head[1])


def read_gray_png(path):
    """A gray PNG of 8 or 16 bits without interlacing, as confidence, provenance
    and plane maps are."""
    data = path.read_bytes()
    if data[:8] != PNG_SIGNATURE:
        raise CommandFailed(f"{path}: not a PNG")
    at, packed, head = 8, b"", None
    while at + 8 <= len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        if kind == b"IHDR":
            head = struct.unpack(">IIBBBBB", body)
        elif kind == b"IDAT":
            packed += body
        at += length + 12
    if head is None or head[2] not in (8, 16) or any(head[3:]):
        raise CommandFailed(f"{path}: not a gray PNG of 8 or 16 bits without "
                            "interlacing")
    width, height = head[:2]
    step = head[2] // 8
    rows = np.frombuffer(zlib.decompress(packed), np.uint8).reshape(
        height, step * width + 1)
    # Filters are applied to the high and the low bytes separately.
    bytes_of_pixels = [undo_filters(rows[:, 0], rows[:, 1 + place::step])
                       for place in range(step)]
    if step == 1:
        return bytes_of_pixels[0]
    high, low = bytes_of_pixels
    return high.astype(np.uint16) << 8 | low


def undo_filters(kinds, rows):
    """The pixels of PNG's filtered rows. kinds: the filter of each row."""
    pixels = np.zeros((len(rows) + 1, rows.shape[1]), np.uint8)
    for y, (kind, values) in enumerate(zip(kinds, rows)):
        above = pixels[y]
        if kind == 0:
            pixels[y + 1] = values
        elif kind == 1:
            pixels[y + 1] = np.cumsum(values, dtype=np.uint64) % 256
        elif kind == 2:
            pixels[y + 1] = values + above
        else:
            pixels[y + 1] = undo_sequential(kind, values.tolist(),
                                            above.tolist())
    return pixels[1:]


def undo_sequential(kind, values, above):
    """The filters in which a pixel depends on the one before it."""
    row, left, corner = [], 0, 0
    for value, up in zip(values, above):
        if kind == 3:
            guess = (left + up) // 2
        else:
            estimate = left + up - corner
            guess = min((left, up, corner),
                        key=lambda near: abs(estimate - near))
        left, corner = (value + guess) % 256, up
        row.append(left)
    return row


class Maps:
    """Where the maps of one type of a workspace are."""

    def __init__(self, workspace, map_type=None):
        self.stereo = Path(workspace) / "stereo"
        self.type = map_type or self._type()

    def _type(self):
        """The type that tsar_refine chooses by default."""
        depth = self.stereo / "depth_maps"
        for name in ("geometric", "photometric"):
            if next(depth.rglob(f"*.{name}.bin"), None):
                return name
        raise CommandFailed(f"{depth}: no depth maps; run patch_match_stereo, "
                            "or give the scene the maps 'tsar_stereo'")

    def names(self):
        """The images that have depth maps."""
        root, suffix = self.stereo / "depth_maps", f".{self.type}.bin"
        return sorted(path.relative_to(root).as_posix()[:-len(suffix)]
                      for path in root.rglob("*" + suffix))

    def path(self, kind, name, suffix="bin"):
        return self.stereo / f"{kind}_maps" / f"{name}.{self.type}.{suffix}"

    def depth(self, name):
        return read_map(self.path("depth", name))[0]

    def long_side(self):
        return max(max(map_size(self.path("depth", name)))
                   for name in self.names())


def at_pixels_of(shape, values):
    """A map sampled at the nearest pixels of a map of another size."""
    height, width = shape
    rows = ((np.arange(height) + 0.5) * values.shape[0] / height).astype(int)
    columns = ((np.arange(width) + 0.5) * values.shape[1] / width).astype(int)
    return values[rows[:, None], columns]
