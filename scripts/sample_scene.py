#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Packs a COLMAP dense workspace with its ground truth into a small folder, and
unpacks it again.

  sample_scene.py unpack ARCHIVE_DIR WORKSPACE
  sample_scene.py pack   WORKSPACE ARCHIVE_DIR

A workspace here is images/, sparse/ (text), stereo/ (cfg files, depth and normal
maps), ground_truth/depth/NAME.bin and scans/ (PLY files and a MeshLab project
with their poses). Images and cfg files are kept as they are, the sparse model is
kept without loss. Maps and scans are rounded, far below the noise of a real
measurement:

  depth    a 16-bit logarithm, in steps of 1e-4 of the depth or, where a map
           spans more than that allows, in 65534 equal steps of the logarithm
  normals  octahedral, 2 x 8 bit, less than a degree off
  scans    0.2 mm; the order of the points changes

Invalid pixels (depth 0, normal 0) stay exactly 0. Needs numpy alone.
"""
import json
import lzma
import pathlib
import shutil
import sys

import numpy as np

DEPTH_STEP = 1e-4
MAX_CODE = 65535
NORMAL_SCALE = 127
SCAN_STEP = 2e-4
SCAN_BLOCK = 256  # Points of one block of this many steps stand together.


def read_map(path):
    """A map file's content as an array (channels, height, width)."""
    width, height, channels, body = path.read_bytes().split(b"&", 3)
    shape = int(channels), int(height), int(width)
    return np.frombuffer(body, "<f4").reshape(shape)


def write_map(path, values):
    path.parent.mkdir(parents=True, exist_ok=True)
    channels, height, width = values.shape
    header = f"{width}&{height}&{channels}&".encode()
    path.write_bytes(header + np.ascontiguousarray(values, "<f4").tobytes())


def compress_codes(codes):
    """16-bit codes as differences along the last axis, high bytes first: noise
    then sits in the low bytes and does not spoil the rest."""
    differences = np.diff(codes.astype(np.int64), axis=-1, prepend=0)
    differences = (differences & 0xFFFF).astype(np.uint16)
    planes = (differences >> 8).astype(np.uint8), differences.astype(np.uint8)
    filters = [{"id": lzma.FILTER_LZMA2, "preset": 9, "lc": 4, "lp": 0, "pb": 0}]
    return lzma.compress(b"".join(p.tobytes() for p in planes), filters=filters)


def decompress_codes(body, shape):
    planes = np.frombuffer(lzma.decompress(body), np.uint8).astype(np.uint64)
    high, low = planes.reshape(2, *shape)
    return np.cumsum((high << 8) | low, axis=-1) & 0xFFFF


def encode_depth(depth):
    """Codes 1..65535 for valid pixels, and what decode_depth needs."""
    valid = depth > 0
    logs = np.log(depth, where=valid, out=np.zeros(depth.shape))
    low = float(logs[valid].min()) if valid.any() else 0.0
    high = float(logs[valid].max()) if valid.any() else 0.0
    step = max(DEPTH_STEP, (high - low) / (MAX_CODE - 1))
    codes = np.where(valid, np.round((logs - low) / step) + 1, 0)
    return codes, {"log_min": low, "log_step": step}


def decode_depth(codes, head):
    logs = head["log_min"] + (codes.astype(np.float64) - 1) * head["log_step"]
    return np.where(codes > 0, np.exp(logs), 0)


def fold(u, v):
    """Maps the half octahedron below z = 0 onto the rim of the unit square, and
    back."""
    sign_u, sign_v = np.where(u >= 0, 1, -1), np.where(v >= 0, 1, -1)
    return (1 - np.abs(v)) * sign_u, (1 - np.abs(u)) * sign_v


def encode_normals(normals):
    length = np.abs(normals).sum(0)
    valid = length > 0
    u, v, z = normals / np.where(valid, length, 1)
    u, v = np.where(z < 0, fold(u, v), (u, v))
    quantize = lambda a: np.where(valid, np.round((a + 1) * NORMAL_SCALE) + 1, 0)
    return np.stack([quantize(u), quantize(v)])


def decode_normals(codes):
    u, v = (codes.astype(np.float64) - 1) / NORMAL_SCALE - 1
    z = 1 - np.abs(u) - np.abs(v)
    u, v = np.where(z < 0, fold(u, v), (u, v))
    normals = np.stack([u, v, z])
    return np.where(codes[0] > 0, normals / np.linalg.norm(normals, axis=0), 0)


def write_record(file, head, body):
    file.write(json.dumps({**head, "bytes": len(body)}).encode() + b"\n" + body)


def read_records(path):
    with open(path, "rb") as file:
        while line := file.readline():
            head = json.loads(line)
            yield head, file.read(head["bytes"])


def pack_maps(depth_dir, normal_dir, suffix, archive):
    """One record per depth map, with its normals where normal_dir is given."""
    with open(archive, "wb") as file:
        for path in sorted(depth_dir.rglob("*" + suffix)):
            name = path.relative_to(depth_dir).as_posix()[: -len(suffix)]
            codes, head = encode_depth(read_map(path)[0])
            codes = codes[None]
            if normal_dir:
                normals = encode_normals(read_map(normal_dir / (name + suffix)))
                codes = np.concatenate([codes, normals])
            head.update(name=name, shape=codes.shape)
            write_record(file, head, compress_codes(codes))


def unpack_maps(archive, depth_dir, normal_dir, suffix):
    for head, body in read_records(archive):
        codes = decompress_codes(body, tuple(head["shape"]))
        tail = head["name"] + suffix
        write_map(depth_dir / tail, decode_depth(codes[:1], head))
        if normal_dir:
            write_map(normal_dir / tail, decode_normals(codes[1:]))


def pack_scans(scans, archive):
    """Points in the order of the blocks they lie in, so that neighbors in the
    file are neighbors in space."""
    with open(archive, "wb") as file:
        for path in sorted(scans.glob("*.ply")):
            header, body = path.read_bytes().split(b"end_header\n", 1)
            properties = [l for l in header.split(b"\n") if l[:8] == b"property"]
            if properties != [b"property float " + axis for axis in (b"x", b"y", b"z")]:
                sys.exit(f"{path}: only float x, y, z can be packed")
            points = np.frombuffer(body, "<f4").reshape(-1, 3).astype(np.float64)
            origin = points.min(0)
            codes = np.round((points - origin) / SCAN_STEP).astype(np.int64)
            if codes.max() > MAX_CODE:
                sys.exit(f"{path}: spans more than {MAX_CODE * SCAN_STEP:.1f} units")
            blocks = codes // SCAN_BLOCK
            codes = codes[np.lexsort((codes[:, 1], codes[:, 0], *blocks.T))].T
            head = {"name": path.name, "shape": codes.shape, "origin": origin.tolist()}
            write_record(file, head, compress_codes(codes))


def unpack_scans(archive, scans):
    for head, body in read_records(archive):
        codes = decompress_codes(body, tuple(head["shape"]))
        points = codes.T * SCAN_STEP + np.array(head["origin"])
        header = ("ply\nformat binary_little_endian 1.0\n"
                  f"element vertex {len(points)}\nproperty float x\n"
                  "property float y\nproperty float z\nend_header\n")
        path = scans / head["name"]
        path.write_bytes(header.encode() + points.astype("<f4").tobytes())


def map_folders(workspace):
    """(archive name, folder of depth maps, folder of normal maps, file ending)."""
    stereo = workspace / "stereo"
    for kind in ("photometric", "geometric"):
        yield (f"{kind}.maps", stereo / "depth_maps", stereo / "normal_maps",
               f".{kind}.bin")
    yield "ground_truth.maps", workspace / "ground_truth" / "depth", None, ".bin"


def copy_files(source, target, pattern):
    target.mkdir(parents=True, exist_ok=True)
    for path in source.glob(pattern):
        shutil.copyfile(path, target / path.name)


def pack(workspace, archive):
    copy_files(workspace / "images", archive / "images", "*")
    copy_files(workspace / "stereo", archive / "stereo", "*.cfg")
    copy_files(workspace / "scans", archive / "scans", "*.mlp")
    (archive / "sparse").mkdir(exist_ok=True)
    for path in (workspace / "sparse").glob("*.txt"):
        packed = lzma.compress(path.read_bytes(), preset=9)
        (archive / "sparse" / (path.name + ".xz")).write_bytes(packed)
    for name, depth_dir, normal_dir, suffix in map_folders(workspace):
        pack_maps(depth_dir, normal_dir, suffix, archive / name)
    pack_scans(workspace / "scans", archive / "scans" / "scans.points")


def unpack(archive, workspace):
    copy_files(archive / "images", workspace / "images", "*")
    copy_files(archive / "stereo", workspace / "stereo", "*.cfg")
    copy_files(archive / "scans", workspace / "scans", "*.mlp")
    (workspace / "sparse").mkdir(exist_ok=True)
    for path in (archive / "sparse").glob("*.xz"):
        text = lzma.decompress(path.read_bytes())
        (workspace / "sparse" / path.stem).write_bytes(text)
    for name, depth_dir, normal_dir, suffix in map_folders(workspace):
        unpack_maps(archive / name, depth_dir, normal_dir, suffix)
    # COLMAP expects the folder, even where there is nothing in it.
    (workspace / "stereo" / "consistency_graphs").mkdir(exist_ok=True)
    unpack_scans(archive / "scans" / "scans.points", workspace / "scans")


def main():
    commands = {"pack": pack, "unpack": unpack}
    if len(sys.argv) != 4 or sys.argv[1] not in commands:
        sys.exit(__doc__)
    source, target = map(pathlib.Path, sys.argv[2:])
    if not (source / "images").is_dir():
        sys.exit(f"{source}: has no folder images; is it the right folder?")
    if target.exists() and any(target.iterdir()):
        sys.exit(f"{target}: is not empty; remove it or name another folder")
    target.mkdir(parents=True, exist_ok=True)
    commands[sys.argv[1]](source, target)


if __name__ == "__main__":
    main()
