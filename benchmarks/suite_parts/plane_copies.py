# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Whether each surface of a scene is one plane: how many planes of some area
there are, and how many of them are copies of another. Lengths are in units of
the scene."""

import itertools

import numpy as np

from suite_parts.agreement import lift
from suite_parts.harm import truth_of
from suite_parts.surfaces import (CELL, CELL_SPAN, INLIER, cell_numbers,
                                  fit_plane, one_per_cell, within)

# A plane counts if a connected piece of it has this area; pieces consist of
# blocks with at least a fifth of their cells covered by the plane.
MIN_AREA = 0.1
BLOCK = 5 * CELL
MIN_CELLS = 5
# Two planes are copies where they are closer than a block to each other in
# the plane, closer than this across it, and nearly parallel.
COPY_OFFSET = 0.06
COPY_COSINE = np.cos(np.radians(5))
# True normals are computed over this many pixels to each side. Those of a
# plane's points differ by less than an angle from its own.
NORMAL_STEP = 2
NORMAL_COSINE = np.cos(np.radians(10))
NUM_TRIALS = 500
NUM_JUDGES = 10000
# A surface is curved if it bends more and that explains most deviations.
MAX_CURVATURE = 0.5
STEPS = [x * CELL_SPAN ** 2 + y * CELL_SPAN
         for x, y in itertools.product((-1, 0, 1), repeat=2)]


def thin(points):
    """One point in each cell of half the size, whose grid may be turned
    against that of a plane."""
    return one_per_cell(points, CELL / 2)


class Surface:
    """A plane, and of the points on it one in each cell of its own grid."""

    def __init__(self, normal, offset, points):
        self.normal, self.offset = normal, offset
        flat = self.flatten(points)
        chosen = one_per_cell(flat)
        self.points, self.flat = points[chosen], flat[chosen]
        self.area = len(chosen) * CELL ** 2
        self.piece = self.largest_piece()

    def flatten(self, points):
        """Coordinates in the plane, and 0."""
        axes = np.linalg.svd(self.normal[None])[2][1:]
        return np.column_stack([points @ axes.T, np.zeros(len(points))])

    def heights(self, points):
        return points @ self.normal - self.offset

    def largest_piece(self):
        """Which of the points are on the largest connected piece."""
        numbers = cell_numbers(self.flat, BLOCK)
        left = {number: count for number, count in zip(
            *(some.tolist() for some in np.unique(numbers, return_counts=True)))
            if count >= MIN_CELLS}
        largest = {}
        while left:
            piece, border = {}, [next(iter(left))]
            while border:
                number = border.pop()
                if number in left:
                    piece[number] = left.pop(number)
                    border += [number + step for step in STEPS]
            largest = max(largest, piece, key=lambda one: sum(one.values()))
        return np.isin(numbers, list(largest))

    def is_large(self):
        return self.piece.sum() * CELL ** 2 >= MIN_AREA

    def is_curved(self):
        """Whether the largest piece bends, as a strip of a column does."""
        u, v = (self.flat[self.piece] - self.flat[self.piece].mean(0)).T[:2]
        terms = np.stack([np.ones_like(u), u, v, u * u, u * v, v * v], 1)
        heights = self.heights(self.points[self.piece])
        bend = np.linalg.lstsq(terms, heights, rcond=None)[0]
        curvature = np.linalg.norm([[2 * bend[3], bend[4]],
                                    [bend[4], 2 * bend[5]]], 2)
        return (curvature > MAX_CURVATURE
                and (heights - terms @ bend).std() < heights.std() / 2)


def surface_of_labels(points):
    """The plane of the pixels that have its label, few of which lie off it."""
    normal, offset = fit_plane(points)
    for _ in range(3):
        gaps = np.abs(points @ normal - offset)
        normal, offset = fit_plane(points[gaps <= np.median(gaps)])
    return Surface(normal, offset,
                   points[np.abs(points @ normal - offset) < INLIER])


def find_copies(surfaces):
    """Distances of the pairs of copies, where they are close."""
    found = []
    for large, small in itertools.combinations(
            sorted(surfaces, key=lambda surface: -surface.area), 2):
        heights = np.abs(large.heights(small.points))
        if (abs(large.normal @ small.normal) > COPY_COSINE
                and heights.min() < COPY_OFFSET):
            close = within(large.flatten(small.points), large.flat, BLOCK)
            if close.any() and np.median(heights[close]) < COPY_OFFSET:
                found.append(float(np.median(heights[close])))
    return found


def count_surfaces(surfaces, prefix=""):
    """How many planes there are, and pairs of copies among them with their
    median distance in hundredths of the unit, None without any."""
    surfaces = [surface for surface in surfaces if surface.is_large()]
    copies = find_copies(surfaces)
    return {f"{prefix}num_planes": len(surfaces),
            f"{prefix}plane_copies": len(copies),
            f"{prefix}copy_offset_cm":
            100 * float(np.median(copies)) if copies else None}


def points_of_truth(truth, image, camera):
    """World points of true depths, and the surface's normals there."""
    y, x = np.indices(truth.shape)
    grid = lift(x, y, np.where(truth > 0, truth, np.nan).astype(float), image,
                camera, truth.shape)
    step, middle = NORMAL_STEP, slice(NORMAL_STEP, -NORMAL_STEP)
    normals = np.cross(grid[middle, 2 * step:] - grid[middle, :-2 * step],
                       grid[2 * step:, middle] - grid[:-2 * step, middle])
    length = np.linalg.norm(normals, axis=2)
    grid = grid[middle, middle]
    known = (length > 0) & np.isfinite(grid[:, :, 0])
    chosen = thin(grid[known])
    return (grid[known][chosen],
            (normals[known] / length[known][:, None])[chosen])


def find_true_surfaces(points, normals):
    """The planes among points with normals, greedily. What lies in one plane
    is one, however far apart; what is curved is left out."""
    def support(points, normals, normal, offset):
        """1 for a point in the plane, 0 for one that is not on it."""
        return ((normals @ normal > NORMAL_COSINE) * np.maximum(
            0, 1 - ((points @ normal - offset) / INLIER) ** 2))

    random, found = np.random.default_rng(0), []
    while len(points) > 3:
        step = len(points) // NUM_JUDGES + 1
        trials = ((normals[trial], normals[trial] @ points[trial]) for trial
                  in random.integers(len(points), size=NUM_TRIALS))
        normal, offset = max(trials, key=lambda trial: support(
            points[::step], normals[::step], *trial).sum())
        for _ in range(3):
            on = support(points, normals, normal, offset) > 0
            if on.sum() * CELL ** 2 < MIN_AREA:
                return found
            fitted, offset = fit_plane(points[on])
            sign = np.sign(fitted @ normal)
            normal, offset = sign * fitted, sign * offset
        on = support(points, normals, normal, offset) > 0
        surface = Surface(normal, offset, points[on])
        if surface.area < MIN_AREA:
            break
        if surface.is_large() and not surface.is_curved():
            found.append(surface)
        points, normals = points[~on], normals[~on]
    return found


def check_true_planes(scene, model, maps):
    """The scores of count_surfaces for the true surfaces, at the pixels of the
    maps; nothing without true depth."""
    parts = []
    for image in model.images:
        if maps.path("depth", image.name).is_file():
            truth = truth_of(scene, image.name, maps.depth(image.name).shape)
            if truth is not None:
                parts.append(points_of_truth(
                    truth, image, model.cameras[image.camera_id]))
    if not parts:
        return {}
    points, normals = map(np.concatenate, zip(*parts))
    chosen = thin(points)
    return count_surfaces(find_true_surfaces(points[chosen], normals[chosen]),
                          "true_")
