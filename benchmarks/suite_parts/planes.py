# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""The planes of a refined scene: how far they lie off the true surfaces, and
how many there are."""

import numpy as np

from suite_parts.agreement import lift
from suite_parts.harm import truth_of
from suite_parts.maps import read_gray_png, read_map
from suite_parts.plane_copies import (CELL, MIN_AREA, count_surfaces,
                                      surface_of_labels, thin)

# Planes with a smaller share of plane pixels with truth are left out.
MIN_SHARE = 0.02


def distances_to_truth(model, image, maps, plane, truth):
    """The plane of each pixel that lies on one and has a true depth, counted
    from 1, and how far it lies behind the true surface along its normal."""
    depth = maps.depth(image.name)
    normal = read_map(maps.path("normal", image.name))
    y, x = np.nonzero((plane > 0) & (depth > 0) & (truth > 0))
    fx, fy, cx, cy = model.cameras[image.camera_id].intrinsics(depth.shape)
    slope = (normal[0, y, x] * (x + 0.5 - cx) / fx
             + normal[1, y, x] * (y + 0.5 - cy) / fy + normal[2, y, x])
    return plane[y, x], (depth - truth)[y, x] * np.abs(slope)


def points_of_planes(model, image, maps, plane):
    """Each plane of an image with world points of its pixels."""
    depth = maps.depth(image.name)
    y, x = np.nonzero((plane > 0) & (depth > 0))
    points = lift(x, y, depth[y, x].astype(float), image,
                  model.cameras[image.camera_id], depth.shape)
    for label in np.unique(plane[y, x]).tolist():
        own = points[plane[y, x] == label]
        yield label, own[thin(own)]


def score_offsets(planes, distances):
    """The scores of the planes and distances of pixels; see check_planes."""
    large = []
    for plane in np.unique(planes):
        of_plane = distances[planes == plane]
        share = len(of_plane) / len(planes)
        if share >= MIN_SHARE:
            large.append([share, *np.percentile(of_plane, (25, 50, 75))])
    if not large:
        return {}
    large = np.array(sorted(large, reverse=True))
    return {"planes": large.tolist(),
            "plane_offset": float(np.average(np.abs(large[:, 2]),
                                             weights=large[:, 0]))}


def check_planes(scene, model, maps):
    """The large planes by falling share of the pixels: the share, and the
    quartiles of the distance behind the true surface, in units of the scene.
    Beside it the mean of the absolute medians, weighted by the shares; both
    need true depth. Also the scores of count_surfaces. Nothing without planes.

    scene: the workspace with ground_truth/depth; maps: refined Maps.
    """
    planes, distances, points = [np.empty(0, int)], [np.empty(0)], {}
    for image in model.images:
        path = maps.path("plane", image.name, "png")
        if not path.is_file():
            continue
        plane = read_gray_png(path)
        for label, own in points_of_planes(model, image, maps, plane):
            points.setdefault(label, []).append(own)
        truth = truth_of(scene, image.name, plane.shape)
        if truth is not None:
            for all_of_it, part in zip((planes, distances), distances_to_truth(
                    model, image, maps, plane, truth)):
                all_of_it.append(part)
    if not points:
        return {}
    surfaces = [surface_of_labels(own) for own
                in map(np.concatenate, points.values())
                if len(own) * CELL ** 2 >= MIN_AREA]
    return {**score_offsets(np.concatenate(planes), np.concatenate(distances)),
            **count_surfaces(surfaces)}
