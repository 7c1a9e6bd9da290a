# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Scans of a mesh from where the cameras stand.

The measure of ETH3D wants scans with their scanner: a point counts as wrong only
where a beam passed through it. A mesh does not tell where it was seen from. So
each camera scans it: a beam goes through each pixel and ends at the nearest
triangle. Beams are as wide as their pixels, so that together they fill the view;
what the mesh hides, or leaves open, is not counted, as with real scans.
"""
import math

import numpy as np

from files import DatasetError, write_text
from ply import write_points, write_project

SCAN_WIDTH = 1024       # Longer side of a scan, in beams.
SAMPLES_PER_BEAM = 1.5  # Along the edges of a triangle.
MAX_SAMPLES = 1 << 22   # Points at work at a time.


def project(points, focal, middle):
    return points[:, :2] / points[:, 2:] * focal + middle


def triangle_samples(triangles, divisions):
    """Points that cover triangles (n x 3 x 3) evenly, in each direction of an edge
    divisions + 1 of them: n x (d + 1)(d + 2)/2 x 3."""
    i, j = np.meshgrid(np.arange(divisions + 1), np.arange(divisions + 1), indexing="ij")
    inside = i + j <= divisions
    weights = np.stack([i[inside], j[inside], divisions - i[inside] - j[inside]], 1) / divisions
    return np.einsum("sk,nkx->nsx", weights, triangles)


def scan_from(points, faces, camera, pose, size):
    """The points of a mesh that a camera sees, one per pixel of an image of this
    size, in the camera's frame."""
    width, height = size
    focal = np.array(camera.params[:2]) * width / camera.width
    middle = np.array(camera.params[2:]) * width / camera.width
    local = points @ pose.rotation.T + pose.translation
    # Triangles that reach behind the camera are left out; scenes lie before it.
    faces = faces[(local[faces][:, :, 2] > 0).all(1)]
    pixels = project(local[faces].reshape(-1, 3), focal, middle).reshape(-1, 3, 2)
    low, high = pixels.min(1), pixels.max(1)
    seen = (high >= 0).all(1) & (low < (width, height)).all(1)
    faces, low, high = faces[seen], low[seen], high[seen]
    longest = np.minimum((high - low).max(1), 4 * max(size))
    divisions = np.maximum(1, np.ceil(longest * SAMPLES_PER_BEAM)).astype(int)
    # Powers of two, so that there are few different ones.
    divisions = 2**np.ceil(np.log2(divisions)).astype(int)

    depth = np.full(width * height, np.inf)
    nearest = np.zeros((width * height, 3))
    for count in np.unique(divisions):
        chosen = faces[divisions == count]
        block = max(1, MAX_SAMPLES // ((count + 1) * (count + 2) // 2))
        for begin in range(0, len(chosen), block):
            samples = triangle_samples(local[chosen[begin:begin + block]], count).reshape(-1, 3)
            cell = np.floor(project(samples, focal, middle)).astype(int)
            inside = ((cell >= 0) & (cell < (width, height))).all(1)
            samples, cell = samples[inside], cell[inside] @ (1, width)
            # The nearest sample of each cell: far ones are overwritten.
            order = np.argsort(-samples[:, 2], kind="stable")
            samples, cell = samples[order], cell[order]
            nearer = samples[:, 2] < depth[cell]
            depth[cell[nearer]] = samples[nearer, 2]
            nearest[cell[nearer]] = samples[nearer]
    return nearest[np.isfinite(depth)]


def scan_mesh(mesh, cameras, poses, folder):
    """Writes one scan per camera, scan_alignment.mlp with their poses, and
    beam_angle.txt, half the opening angle of a beam in degrees."""
    folder.mkdir(parents=True)
    scans, angle = [], 0.0
    for name, pose in sorted(poses.items()):
        camera = cameras[name]
        scale = min(1.0, SCAN_WIDTH / max(camera.width, camera.height))
        size = round(camera.width * scale), round(camera.height * scale)
        points = scan_from(mesh.points, mesh.faces, camera, pose, size)
        angle = max(angle, math.degrees(math.atan(0.5 / (scale * camera.params[0]))))
        if len(points):
            write_points(folder / f"{name}.ply", points)
            scans.append((f"{name}.ply", pose.world_from_camera()))
    if not scans:
        raise DatasetError("--ground_truth: no camera sees the mesh; is it in the frame "
                           "of the cameras?")
    write_project(folder / "scan_alignment.mlp", scans)
    write_text(folder / "beam_angle.txt", f"{angle:.6g}\n")
