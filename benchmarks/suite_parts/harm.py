# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""What a refinement did to the depths of a scene, compared with the truth."""

import numpy as np

from suite_parts.maps import at_pixels_of, read_gray_png, read_map

RIGHT = 0.01  # As a fraction of the depth; so are the rest.
HARMED = 0.025
HARMED_FAR = 0.05
NUM_BINS = 10
# The gap of a bin with a smaller share of the pixels says nothing.
MIN_BIN_SHARE = 0.01


def is_right(depth, truth, tolerance):
    """Where a depth is there and its relative error below the tolerance."""
    return ((truth > 0) & (depth > 0)
            & (np.abs(depth - truth) < tolerance * truth))


def truth_of(scene, name, shape):
    """The true depth at a map's pixels, None where the image has no truth."""
    path = scene / "ground_truth" / "depth" / f"{name}.bin"
    if not path.is_file():
        return None
    return at_pixels_of(shape, read_map(path)[0])


def share(part, whole):
    return float(part / whole) if whole else None


def count_harm(before, after, truth):
    """Pixels right to 1 % before; of these off by over 2.5 % or gone after;
    off by over 5 % or gone; gone."""
    sure = is_right(before, truth, RIGHT)
    return np.array([sure.sum(),
                     (sure & ~is_right(after, truth, HARMED)).sum(),
                     (sure & ~is_right(after, truth, HARMED_FAR)).sum(),
                     (sure & (after <= 0)).sum()])


class Calibration:
    """Confidence against the share of right depths, in tenths of its range."""

    def __init__(self):
        self.counts = np.zeros(NUM_BINS)
        self.confidences = np.zeros(NUM_BINS)
        self.rights = np.zeros(NUM_BINS)

    def add(self, confidence, depth, truth):
        used = (truth > 0) & (depth > 0)
        values = confidence[used].astype(float)
        right = is_right(depth, truth, RIGHT)[used]
        bins = np.clip((values * NUM_BINS).astype(int), 0, NUM_BINS - 1)
        self.counts += np.bincount(bins, minlength=NUM_BINS)
        self.confidences += np.bincount(bins, values, NUM_BINS)
        self.rights += np.bincount(bins, right, NUM_BINS)

    def scores(self):
        total = self.counts.sum()
        if not total:
            return {}
        filled = np.maximum(self.counts, 1)
        gaps = np.abs(self.confidences - self.rights) / filled
        shares = np.where(self.counts > 0, self.rights / filled, np.nan)
        return {
            "calibration_error": float((gaps * self.counts).sum() / total),
            "calibration_gap": float(
                gaps[self.counts >= MIN_BIN_SHARE * total].max()),
            "calibration_pixels": [int(count) for count in self.counts],
            "calibration_right": [None if np.isnan(value) else float(value)
                                  for value in shares]}


def measure_truth(scene, before, after):
    """HARM and calibration of a refinement; nothing without true depth.

    scene: the workspace with ground_truth/depth; before, after: Maps.
    """
    harm, calibration = np.zeros(4), Calibration()
    for name in before.names():
        old, new = before.depth(name), after.depth(name)
        truth = truth_of(scene, name, old.shape)
        if truth is None:
            continue
        harm += count_harm(old, new, truth)
        confidence = after.path("confidence", name, "png")
        if confidence.is_file():
            calibration.add(read_gray_png(confidence) / 255, new, truth)
    if not harm[0]:
        return calibration.scores()
    return {"harm": share(harm[1], harm[0]),
            "harm_far": share(harm[2], harm[0]),
            "lost": share(harm[3], harm[0]), **calibration.scores()}
