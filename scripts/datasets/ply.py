# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Points and triangles of PLY files."""
import dataclasses

import numpy as np

from files import DatasetError, write_bytes, write_text

TYPES = {"char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "<i2",
         "int16": "<i2", "ushort": "<u2", "uint16": "<u2", "int": "<i4", "int32": "<i4",
         "uint": "<u4", "uint32": "<u4", "float": "<f4", "float32": "<f4",
         "double": "<f8", "float64": "<f8"}


@dataclasses.dataclass
class Ply:
    points: np.ndarray  # n x 3
    faces: np.ndarray   # m x 3, indices of points; empty for a cloud.


def read_header(file, path):
    """The format, and (name, count, properties) of each element; a list has the
    type (count type, item type)."""
    if file.readline().strip() != b"ply":
        raise DatasetError(f"{path}: is not a PLY file")
    form, elements = "", []
    while True:
        words = file.readline().decode("latin-1").split()
        if words[:1] == ["format"] and len(words) == 3:
            form = words[1]
        elif words[:1] == ["element"] and len(words) == 3:
            elements.append((words[1], int(words[2]), []))
        elif words[:2] == ["property", "list"] and len(words) == 5 and elements:
            elements[-1][2].append((words[4], (TYPES[words[2]], TYPES[words[3]])))
        elif words[:1] == ["property"] and len(words) == 3 and elements:
            elements[-1][2].append((words[2], TYPES[words[1]]))
        elif words == ["end_header"]:
            break
        elif words[:1] not in (["comment"], ["obj_info"]):
            raise DatasetError(f"{path}: its header is damaged")
    if form not in ("ascii", "binary_little_endian"):
        raise DatasetError(f"{path}: format '{form}'; write it as ascii or "
                           "binary_little_endian")
    return form, elements


def row_type(properties):
    """The numpy type of one row, whose lists all have three items."""
    fields = []
    for name, kind in properties:
        if isinstance(kind, tuple):
            fields += [(name + " count", kind[0]), (name, kind[1], 3)]
        else:
            fields.append((name, kind))
    return np.dtype(fields)


def read_rows(file, form, count, kind):
    if form == "ascii":
        width = sum(int(np.prod(kind[name].shape, initial=1)) for name in kind.names)
        lines = [file.readline().split() for _ in range(count)]
        values = np.array(lines, float).reshape(count, width)
        rows, column = np.zeros(count, kind), 0
        for name in kind.names:
            size = int(np.prod(kind[name].shape, initial=1))
            part = values[:, column:column + size]
            rows[name] = part.reshape(rows[name].shape)
            column += size
        return rows
    data = file.read(count * kind.itemsize)
    return np.frombuffer(data, kind, count)


def read_ply(path):
    """Throws DatasetError for files that are damaged or whose faces are not
    triangles."""
    points, faces = None, np.zeros((0, 3), np.int64)
    try:
        with open(path, "rb") as file:
            form, elements = read_header(file, path)
            for name, count, properties in elements:
                rows = read_rows(file, form, count, row_type(properties))
                if name == "vertex":
                    points = np.stack([rows[a] for a in "xyz"], 1).astype(float)
                elif name == "face":
                    lists = [p for p, kind in properties if isinstance(kind, tuple)]
                    if len(lists) != 1 or (rows[lists[0] + " count"] != 3).any():
                        raise DatasetError(f"{path}: has faces that are not triangles")
                    faces = rows[lists[0]].astype(np.int64)
                if points is not None and name == "face":
                    break
    except FileNotFoundError:
        raise DatasetError(f"{path}: not found") from None
    except (ValueError, KeyError):
        raise DatasetError(f"{path}: is damaged, or not a PLY file of points or "
                           "triangles") from None
    if points is None or len(points) == 0:
        raise DatasetError(f"{path}: has no vertices")
    if not np.isfinite(points).all():
        raise DatasetError(f"{path}: has positions that are not finite")
    if faces.size and not (0 <= faces.min() and faces.max() < len(points)):
        raise DatasetError(f"{path}: has faces of vertices that are not there")
    return Ply(points, faces)


def count(path, element):
    """How many vertices or faces a file's header promises."""
    with open(path, "rb") as file:
        _, elements = read_header(file, path)
    return sum(number for name, number, _ in elements if name == element)


def is_whole(path):
    """Whether a binary cloud has as many bytes as its header promises: a program
    may not notice that the disk is full."""
    with open(path, "rb") as file:
        _, elements = read_header(file, path)
        expected = file.tell() + sum(number * row_type(properties).itemsize
                                     for _, number, properties in elements)
        return path.stat().st_size == expected


def row_size(path):
    """The bytes of a vertex of a binary cloud."""
    with open(path, "rb") as file:
        _, elements = read_header(file, path)
    return next(row_type(properties).itemsize for name, _, properties in elements
                if name == "vertex")


def thin(path, output, keep):
    """Writes that many vertices of a binary cloud, one after each equal stretch of them,
    with all their properties."""
    with open(path, "rb") as file:
        form, elements = read_header(file, path)
        start = file.tell()
        file.seek(0)
        header = file.read(start)
    if form == "ascii" or [name for name, _, _ in elements] != ["vertex"]:
        raise DatasetError(f"{path}: is not a binary cloud, which alone can be thinned")
    (_, number, properties), = elements
    rows = np.memmap(path, row_type(properties), "r", start, number)
    with open(output, "wb") as file:
        file.write(header.replace(b"element vertex %d" % number, b"element vertex %d" % keep))
        for begin in range(0, keep, 1 << 20):
            index = np.arange(begin, min(keep, begin + (1 << 20)), dtype=np.int64)
            file.write(rows[index * number // keep].tobytes())


def write_points(path, points):
    """A cloud of float x, y, z; the file appears when it is complete."""
    header = (f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n"
              "property float x\nproperty float y\nproperty float z\nend_header\n")
    write_bytes(path, header.encode() + np.asarray(points, "<f4").tobytes())


def write_project(path, scans):
    """A MeshLab project of (PLY file name, 4 x 4 matrix from scan to world)."""
    text = "<!DOCTYPE MeshLabDocument>\n<MeshLabProject>\n <MeshGroup>\n"
    for name, matrix in scans:
        rows = "".join(" ".join(repr(float(v)) for v in row) + "\n" for row in matrix)
        text += (f'  <MLMesh label="{name}" filename="{name}">\n'
                 f"   <MLMatrix44>\n{rows}</MLMatrix44>\n  </MLMesh>\n")
    text += " </MeshGroup>\n <RasterGroup/>\n</MeshLabProject>\n"
    write_text(path, text)
