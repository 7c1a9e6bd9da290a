# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""How right depths are where the image has texture."""

import numpy as np

# Gray levels: the standard deviation of the pixels around a textured one, and
# how far these reach.
MIN_DEVIATION = 6
RADIUS = 3
TOLERANCES = (0.01, 0.02)


def window_mean(values, radius=RADIUS):
    """The mean of the square window around each pixel; the border is repeated."""
    side = 2 * radius + 1
    padded = np.pad(values.astype(float), radius, mode="edge")
    sums = np.pad(padded, ((1, 0), (1, 0))).cumsum(0).cumsum(1)
    return (sums[side:, side:] - sums[:-side, side:] - sums[side:, :-side]
            + sums[:-side, :-side]) / side ** 2


def is_textured(gray):
    """Where the gray levels around a pixel vary."""
    gray = gray.astype(float)
    variance = window_mean(gray * gray) - window_mean(gray) ** 2
    return variance > MIN_DEVIATION ** 2


def count_right(depth, truth, textured):
    """Of the textured pixels with truth: how many there are, how many have a
    depth, and how many are right within each of TOLERANCES."""
    seen = textured & (truth > 0)
    found = seen & (depth > 0)
    error = np.abs(depth - truth)
    return np.array([seen.sum(), found.sum(),
                     *((found & (error < tolerance)).sum()
                       for tolerance in TOLERANCES)])


def f1_scores(counts):
    """At each of TOLERANCES, from sums of count_right."""
    seen, found, *right = counts
    return [float(2 * number / (seen + found)) if seen + found else None
            for number in right]
