# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""How much of the depths of a scene is plainly wrong."""

import numpy as np

from suite_parts.harm import share, truth_of
from suite_parts.maps import read_gray_png

OUTLIER = 0.05  # As a fraction of the true depth.
# The surface around a pixel is smooth where the true depths within this many
# pixels differ by less than this factor.
SPECK_RADIUS = 7
SPECK_FACTOR = 1.1
# Values of the provenance maps.
ORIGINS = {"measured": (1, 2), "filled": (3, 4, 5), "guessed": (6,),
           "prior": (7,)}


def spread(values, combine, outside):
    """The largest (np.maximum) or smallest value around each pixel; outside:
    what there is beyond the border."""
    for axis in (0, 1):
        padding = [(0, 0), (0, 0)]
        padding[axis] = (SPECK_RADIUS, SPECK_RADIUS)
        padded = np.pad(values, padding, constant_values=outside)
        size = values.shape[axis]
        values = combine.reduce([
            np.take(padded, range(shift, shift + size), axis)
            for shift in range(2 * SPECK_RADIUS + 1)])
    return values


def is_smooth(truth):
    """Where the true depths around a pixel are of one surface."""
    known = truth > 0
    farthest = spread(np.where(known, truth, 0), np.maximum, 0)
    nearest = spread(np.where(known, truth, np.inf), np.minimum, np.inf)
    return known & (farthest < SPECK_FACTOR * nearest)


def measure_outliers(scene, maps):
    """OUTLIERS, of all pixels with a depth and by origin, and SPECKS, measured
    outliers amid a smooth surface as a share of all pixels with a true depth;
    nothing without true depth. All depths of maps without an origin count as
    measured.

    scene: the workspace with ground_truth/depth; maps: Maps.
    """
    depths = dict.fromkeys(["all", *ORIGINS], 0)
    wrong = dict.fromkeys(["all", *ORIGINS], 0)
    num_pixels = num_specks = 0
    for name in maps.names():
        depth = maps.depth(name)
        truth = truth_of(scene, name, depth.shape)
        if truth is None:
            continue
        used = (truth > 0) & (depth > 0)
        outlier = used & (np.abs(depth - truth) > OUTLIER * truth)
        path = maps.path("provenance", name, "png")
        origin = read_gray_png(path) if path.is_file() else np.ones(depth.shape)
        masks = {kind: used & np.isin(origin, values)
                 for kind, values in ORIGINS.items()}
        for kind, mask in {"all": used, **masks}.items():
            depths[kind] += int(mask.sum())
            wrong[kind] += int((outlier & mask).sum())
        num_pixels += int((truth > 0).sum())
        num_specks += int((outlier & masks["measured"] & is_smooth(truth)).sum())
    if not num_pixels:
        return {}
    return {"outliers": share(wrong["all"], depths["all"]),
            **{f"outliers_{kind}": share(wrong[kind], depths[kind])
               for kind in ORIGINS},
            "specks": share(num_specks, num_pixels)}
