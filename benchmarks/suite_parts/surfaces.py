# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Which of the large surfaces of a scene a cloud holds: a mean over the scene
hides a ceiling that is missing."""

import functools
import itertools
import threading
import xml.etree.ElementTree

import numpy as np

from programs import CommandFailed

# In units of the scene.
CELL = 0.02
INLIER = 0.01
TOLERANCES = (0.02, 0.05)
# Least share of the scan, of a large plane and of the worst surface.
MIN_SHARE = 0.02
MIN_WORST_SHARE = 0.1
MAX_PLANES = 10
NUM_TRIALS = 400
# Trials are judged by this many points, or up to twice as many.
NUM_JUDGES = 25000
CELL_SPAN = 1 << 20
LOCK = threading.Lock()
PLY_TYPES = {"char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1",
             "short": "<i2", "int16": "<i2", "ushort": "<u2", "uint16": "<u2",
             "int": "<i4", "int32": "<i4", "uint": "<u4", "uint32": "<u4",
             "float": "<f4", "float32": "<f4", "double": "<f8",
             "float64": "<f8"}


def read_points(path):
    """The vertices of a binary PLY file that begins with them, n x 3."""
    try:
        head, body = path.read_bytes().split(b"end_header\n", 1)
        head, first, *_ = head.decode("latin-1").split("\nelement ")
        name, count, *properties = (line.split() for line in
                                    first.replace(" ", "\n", 1).splitlines())
        if name != ["vertex"] or "format binary_little_endian 1.0" not in head:
            raise ValueError("save it as binary_little_endian, vertices first")
        rows = np.frombuffer(body, [(words[2], PLY_TYPES[words[1]])
                                    for words in properties
                                    if words[:1] == ["property"]],
                             int(*count))
        return np.stack([rows[axis] for axis in "xyz"], 1).astype(float)
    except (OSError, ValueError, KeyError) as error:
        raise CommandFailed(f"{path}: not a PLY file of points ({error})"
                            ) from error


def read_scans(project):
    """The points of all scans of a MeshLab project, in its frame."""
    points = [np.empty((0, 3))]
    for mesh in xml.etree.ElementTree.parse(project).iter("MLMesh"):
        matrix = np.array(mesh.find("MLMatrix44").text.split(), float)
        matrix = matrix.reshape(4, 4)[:3]
        points.append(read_points(project.parent / mesh.get("filename"))
                      @ matrix[:, :3].T + matrix[:, 3])
    return np.concatenate(points)


def cell_numbers(points, size):
    """The cell of a grid that each point is in; cells that are adjacent along
    the last axis have consecutive numbers."""
    x, y, z = np.floor(points / size).astype(np.int64).T
    return (x * CELL_SPAN + y) * CELL_SPAN + z


def one_per_cell(points, size=CELL):
    """Indices of one point in each cell. Cell borders avoid round numbers, at
    which surfaces lie: their noise would fill two layers."""
    return np.unique(cell_numbers(points + size / 4, size),
                     return_index=True)[1]


def within(points, cloud, distance):
    """Which of the points have one of the cloud within a distance."""
    found = np.zeros(len(points), bool)
    if not len(points):
        return found
    cloud = cloud[((cloud >= points.min(0) - distance)
                   & (cloud <= points.max(0) + distance)).all(1)]
    numbers, own = (cell_numbers(some, distance) for some in (cloud, points))
    order = np.argsort(numbers)
    cloud, numbers = cloud[order], numbers[order]
    for x, y in itertools.product((0, -1, 1), repeat=2):
        left = np.flatnonzero(~found)
        middle = own[left] + (x * CELL_SPAN + y) * CELL_SPAN
        at = np.searchsorted(numbers, middle - 1)
        end = np.searchsorted(numbers, middle + 1, "right")
        while len(left):
            left, at, end = (some[at < end] for some in (left, at, end))
            near = ((cloud[at] - points[left]) ** 2).sum(1) <= distance ** 2
            found[left[near]] = True
            left, at, end = left[~near], at[~near] + 1, end[~near]
    return found


def fit_plane(points):
    """The unit normal, whose largest component is positive, and the offset
    along it of the least-squares plane."""
    center = points.mean(0)
    normal = np.linalg.eigh(np.cov((points - center).T))[1][:, 0]
    normal *= np.sign(normal[np.abs(normal).argmax()])
    return normal, normal @ center


def find_plane(points, random):
    """Which points lie on the largest plane, by RANSAC; with its normal and
    offset."""
    judges = points[::max(1, len(points) // NUM_JUDGES)]
    best = np.zeros(len(judges), bool)
    for _ in range(NUM_TRIALS):
        corner, *others = points[random.choice(len(points), 3)]
        normal = np.cross(*(others - corner))
        length = np.linalg.norm(normal)
        if length > 0:
            on = np.abs((judges - corner) @ normal) < INLIER * length
            best = max(best, on, key=np.count_nonzero)
    normal, offset = fit_plane(judges[best])
    on = np.abs(points @ normal - offset) < INLIER
    return on, normal, offset


@functools.lru_cache(maxsize=1)
def find_surfaces(project):
    """Points of the scans, one per cell, and the large planes among them as
    (normal, offset, indices of points), about the largest first."""
    points = read_scans(project)
    points = points[one_per_cell(points)]
    random, left, found = np.random.default_rng(0), np.arange(len(points)), []
    while len(found) < MAX_PLANES and len(left) >= max(
            3, MIN_SHARE * len(points)):
        on, normal, offset = find_plane(points[left], random)
        if on.sum() < MIN_SHARE * len(points):
            break
        found.append((normal, offset, left[on]))
        left = left[~on]
    return points, found


def check_surfaces(project, cloud_path):
    """For each large plane of the scans its normal, offset and share of their
    points, and of these points the shares with one of the cloud within each
    tolerance; beside it the smallest share at the last tolerance, None where
    no plane has enough of the scan.

    project: scan_alignment.mlp.
    """
    with LOCK:  # The runs of a scene share what is found once.
        points, planes = find_surfaces(project)
    cloud, held = read_points(cloud_path), np.zeros(len(points), bool)
    shares = []
    for tolerance in TOLERANCES:
        held[~held] = within(points[~held], cloud, tolerance)
        shares.append([float(held[on].mean()) for _, _, on in planes])
    surfaces = [[*normal.tolist(), float(offset), len(on) / len(points), *of_it]
                for (normal, offset, on), *of_it in zip(planes, *shares)]
    return {"surfaces": surfaces,
            "worst_surface": min((surface[-1] for surface in surfaces
                                  if surface[4] >= MIN_WORST_SHARE),
                                 default=None)}
