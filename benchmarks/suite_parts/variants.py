# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""The named sets of options that a suite runs."""

import shlex

from programs import CommandFailed

SWITCHES = ("denoise", "filter", "filter_confidence",
            "filter_discontinuity", "refine", "superpixel_planes",
            "weighted_median", "segment", "view_agreement", "region_cores",
            "region_rims", "bounded_regions", "confirmed_depths", "scene_planes",
            "foreground_fattening", "manhattan_frame", "bounded_planes",
            "adjust_planes", "bounding_creases",
            "pixel_borders", "photometric", "curved_surfaces", "cylinders",
            "off_plane_depths")
# Off by default: the ablation switches each of them on.
OPTIONAL_SWITCHES = ("distrust_unmatched",)
# The numbers of the method, with their defaults: each is halved and doubled.
PARAMETERS = {"min_aggregated_score": 0.8, "confidence_weight": 0.7,
              "num_iterations": 4, "superpixel_size": 400,
              "min_plane_support": 0.3, "window_radius": 5,
              "spatial_sigma": 2, "color_sigma": 3, "disparity_tolerance": 24,
              "edge_threshold": 4, "hough_min_votes": 5, "hough_max_gap": 15,
              "min_region_size": 8000, "max_boundary_error": 0.02,
              "plane_tolerance": 7, "min_scene_plane": 100,
              "unlabelled_cost": 0.02}
# Doubling these leads out of their range.
SHARES = {"confidence_weight"}
DEFAULT = "default"


def read_variant(text):
    name, equals, options = text.partition("=")
    if not name or not equals:
        raise CommandFailed(f"--variant {text}: it is not NAME='OPTIONS'")
    return name, shlex.split(options)


def make_variants(given, ablation, sensitivity, extra):
    """Name -> options, in the order of the tables.

    given: texts NAME=OPTIONS; extra: options for all runs.
    """
    variants = dict(read_variant(text) for text in given)
    if len(variants) < len(given):
        raise CommandFailed("--variant: two have the same name")
    if not variants or ablation or sensitivity:
        variants = {DEFAULT: [], **variants}
    if ablation:
        for switch in SWITCHES:
            variants[f"without {switch}"] = [f"--TsarRefine.{switch}", "0"]
        for switch in OPTIONAL_SWITCHES:
            variants[f"with {switch}"] = [f"--TsarRefine.{switch}", "1"]
        for preset in ("paper", "paper_strict"):
            variants[f"preset {preset}"] = ["--TsarRefine.preset", preset]
    if sensitivity:
        for name, value in PARAMETERS.items():
            half = value // 2 if isinstance(value, int) else value / 2
            double = min(2 * value, 1) if name in SHARES else 2 * value
            for changed in (half, double):
                variants[f"{name} {changed:g}"] = [f"--TsarRefine.{name}",
                                                   f"{changed:g}"]
    return {name: shlex.split(extra) + options
            for name, options in variants.items()}
