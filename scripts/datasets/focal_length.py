# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""The focal length of a camera whose poses are known, from matches alone.

With the poses known, the focal length is the only unknown of the epipolar
geometry: that one is taken for which matches lie nearest to their epipolar lines.
No starting value is needed, and none of what the matches' points are in space.
"""
import numpy as np

from files import DatasetError

SMALLEST, LARGEST = 0.3, 4.0  # Focal lengths, in widths of the image.
NUM_STEPS = 200
MAX_MATCHES = 20000
MAX_ERROR = 4.0  # Pixels; further off is a wrong match.
# With right poses most matches are near their lines, up to the distortion.
MAX_MEAN_ERROR = 2.0


def cross_matrix(t):
    return np.array([[0, -t[2], t[1]], [t[2], 0, -t[0]], [-t[1], t[0], 0]])


def epipolar_errors(essentials, first, second, focal):
    """First-order distances of matches to their epipolar geometry, in pixels.
    essentials is n x 3 x 3; points n x 2, pixels from the principal point."""
    extend = lambda p: np.concatenate([p / focal, np.ones((len(p), 1))], axis=1)
    a, b = extend(first), extend(second)
    line_b = np.einsum("nij,nj->ni", essentials, a)
    line_a = np.einsum("nji,nj->ni", essentials, b)
    residual = np.einsum("ni,ni->n", b, line_b)
    length = np.sqrt((line_b[:, :2]**2).sum(1) + (line_a[:, :2]**2).sum(1))
    return focal * np.abs(residual) / np.maximum(length, 1e-12)


def estimate_focal_length(matches, poses, width, height, place):
    """The focal length in pixels of all images, which are width x height with the
    principal point in the middle. matches are as read_matches gives them, poses by
    name; place names the poses' file in errors."""
    middle = np.array([width / 2, height / 2])
    essentials, first, second = [], [], []
    for name_a, name_b, points_a, points_b in matches:
        a, b = poses[name_a], poses[name_b]
        rotation = b.rotation @ a.rotation.T
        translation = b.translation - rotation @ a.translation
        essential = cross_matrix(translation) @ rotation
        essentials.append(np.broadcast_to(essential, (len(points_a), 3, 3)))
        first.append(points_a - middle)
        second.append(points_b - middle)
    if not first:
        raise DatasetError(f"{place}: no two images match; are these images of one scene?")
    essentials, first, second = map(np.concatenate, (essentials, first, second))
    step = -(-len(first) // MAX_MATCHES)
    essentials, first, second = essentials[::step], first[::step], second[::step]

    def cost(focal):
        errors = epipolar_errors(essentials, first, second, focal)
        return np.minimum(errors, MAX_ERROR).mean()

    candidates = width * np.geomspace(SMALLEST, LARGEST, NUM_STEPS)
    costs = [cost(focal) for focal in candidates]
    best = int(np.argmin(costs))
    if not 0 < best < NUM_STEPS - 1 or costs[best] > MAX_MEAN_ERROR:
        raise DatasetError(
            f"{place}: the poses do not fit the images (matches are {costs[best]:.1f} pixels "
            "off their epipolar lines); are they of these images, in this order?")
    low, high = candidates[best - 1], candidates[best + 1]
    while high - low > 1e-4 * width:
        a, b = low + (high - low) / 3, high - (high - low) / 3
        low, high = (low, b) if cost(a) < cost(b) else (a, high)
    return (low + high) / 2
