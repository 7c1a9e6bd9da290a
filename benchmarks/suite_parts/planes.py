# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""How far the planes of a scene lie off the true surfaces."""

import numpy as np

from suite_parts.harm import truth_of
from suite_parts.maps import read_gray_png, read_map

# Smaller planes are left out: of the pixels of planes with a true depth.
MIN_SHARE = 0.02


def distances_to_truth(model, image, maps, truth):
    """The plane of each pixel that lies on one and has a true depth, counted
    from 1, and how far it lies behind the true surface along its normal."""
    depth = maps.depth(image.name)
    plane = read_gray_png(maps.path("plane", image.name, "png"))
    normal = read_map(maps.path("normal", image.name))
    y, x = np.nonzero((plane > 0) & (depth > 0) & (truth > 0))
    fx, fy, cx, cy = model.cameras[image.camera_id].intrinsics(depth.shape)
    slope = (normal[0, y, x] * (x + 0.5 - cx) / fx
             + normal[1, y, x] * (y + 0.5 - cy) / fy + normal[2, y, x])
    return plane[y, x], (depth - truth)[y, x] * np.abs(slope)


def check_planes(scene, model, maps):
    """The large planes by falling share of the pixels: the share, and the
    quartiles of the distance behind the true surface, in units of the scene.
    Beside it the mean of the absolute medians, weighed by the shares. Nothing
    without true depth or without planes.

    scene: the workspace with ground_truth/depth; maps: refined Maps.
    """
    planes, distances = [np.empty(0, int)], [np.empty(0)]
    for image in model.images:
        if maps.path("plane", image.name, "png").is_file():
            truth = truth_of(scene, image.name, maps.depth(image.name).shape)
            if truth is not None:
                plane, distance = distances_to_truth(model, image, maps, truth)
                planes.append(plane)
                distances.append(distance)
    planes, distances = np.concatenate(planes), np.concatenate(distances)
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
