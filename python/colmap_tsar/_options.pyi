# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
# Written by scripts/write_python_stubs.py.
import collections.abc
import os
import pathlib
import typing

import colmap_tsar

class RefineOptions:
    denoise: bool
    distrust_unmatched: bool
    filter: bool
    filter_confidence: bool
    filter_discontinuity: bool
    cost_ratio: bool
    view_agreement: bool
    min_aggregated_score: float
    confidence_weight: float
    refine: bool
    superpixel_planes: bool
    weighted_median: bool
    readmit_filtered: bool
    spread_medians: bool
    small_windows: bool
    pixel_distances: bool
    fill_wide_holes: bool
    fill_before_regions: bool
    num_iterations: int
    superpixel_size: int
    min_plane_support: float
    loose_plane_tolerance: float
    window_radius: int
    spatial_sigma: float
    color_sigma: float
    disparity_tolerance: float
    segment: bool
    edge_threshold: float
    edges_of_roots: bool
    short_lines: bool
    hough_min_votes: int
    hough_max_gap: int
    region_cores: bool
    region_rims: bool
    bounded_regions: bool
    max_region_planes: int
    min_region_size: int
    max_boundary_error: float
    max_boundary_gap: float
    confirmed_depths: bool
    scene_planes: bool
    foreground_fattening: bool
    manhattan_frame: bool
    adjust_planes: bool
    bounded_planes: bool
    bounding_creases: bool
    curved_surfaces: bool
    cylinders: bool
    off_plane_depths: bool
    pixel_borders: bool
    photometric: bool
    plane_tolerance: float
    min_scene_plane: float
    unlabelled_cost: float
    min_confidence: float
    sigma_maps: bool
    seed: int
    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    def __init__(
        self,
        *,
        denoise: bool = True,
        distrust_unmatched: bool = False,
        filter: bool = True,
        filter_confidence: bool = True,
        filter_discontinuity: bool = True,
        cost_ratio: bool = False,
        view_agreement: bool = True,
        min_aggregated_score: float = 0.8,
        confidence_weight: float = 0.7,
        refine: bool = True,
        superpixel_planes: bool = True,
        weighted_median: bool = True,
        readmit_filtered: bool = False,
        spread_medians: bool = False,
        small_windows: bool = False,
        pixel_distances: bool = False,
        fill_wide_holes: bool = False,
        fill_before_regions: bool = False,
        num_iterations: int = 4,
        superpixel_size: int = 400,
        min_plane_support: float = 0.3,
        loose_plane_tolerance: float = 0.0,
        window_radius: int = 5,
        spatial_sigma: float = 2.0,
        color_sigma: float = 3.0,
        disparity_tolerance: float = 24.0,
        segment: bool = True,
        edge_threshold: float = 4.0,
        edges_of_roots: bool = False,
        short_lines: bool = False,
        hough_min_votes: int = 5,
        hough_max_gap: int = 15,
        region_cores: bool = True,
        region_rims: bool = True,
        bounded_regions: bool = True,
        max_region_planes: int = 4,
        min_region_size: int = 8000,
        max_boundary_error: float = 0.02,
        max_boundary_gap: float = 0.0,
        confirmed_depths: bool = True,
        scene_planes: bool = True,
        foreground_fattening: bool = True,
        manhattan_frame: bool = True,
        adjust_planes: bool = True,
        bounded_planes: bool = True,
        bounding_creases: bool = True,
        curved_surfaces: bool = True,
        cylinders: bool = True,
        off_plane_depths: bool = True,
        pixel_borders: bool = True,
        photometric: bool = True,
        plane_tolerance: float = 7.0,
        min_scene_plane: float = 100.0,
        unlabelled_cost: float = 0.02,
        min_confidence: float = 0.0,
        sigma_maps: bool = True,
        seed: int = 0,
    ) -> None: ...
    @classmethod
    def paper(
        cls,
        *,
        denoise: bool = True,
        distrust_unmatched: bool = False,
        filter: bool = True,
        filter_confidence: bool = True,
        filter_discontinuity: bool = True,
        cost_ratio: bool = False,
        view_agreement: bool = True,
        min_aggregated_score: float = 0.8,
        confidence_weight: float = 0.7,
        refine: bool = True,
        superpixel_planes: bool = True,
        weighted_median: bool = True,
        readmit_filtered: bool = False,
        spread_medians: bool = False,
        small_windows: bool = False,
        pixel_distances: bool = False,
        fill_wide_holes: bool = False,
        fill_before_regions: bool = False,
        num_iterations: int = 4,
        superpixel_size: int = 400,
        min_plane_support: float = 0.3,
        loose_plane_tolerance: float = 0.0,
        window_radius: int = 5,
        spatial_sigma: float = 2.0,
        color_sigma: float = 3.0,
        disparity_tolerance: float = 24.0,
        segment: bool = True,
        edge_threshold: float = 4.0,
        edges_of_roots: bool = False,
        short_lines: bool = False,
        hough_min_votes: int = 5,
        hough_max_gap: int = 15,
        region_cores: bool = True,
        region_rims: bool = True,
        bounded_regions: bool = True,
        max_region_planes: int = 4,
        min_region_size: int = 8000,
        max_boundary_error: float = 0.02,
        max_boundary_gap: float = 0.0,
        confirmed_depths: bool = True,
        scene_planes: bool = True,
        foreground_fattening: bool = True,
        manhattan_frame: bool = True,
        adjust_planes: bool = True,
        bounded_planes: bool = True,
        bounding_creases: bool = True,
        curved_surfaces: bool = True,
        cylinders: bool = True,
        off_plane_depths: bool = True,
        pixel_borders: bool = True,
        photometric: bool = True,
        plane_tolerance: float = 7.0,
        min_scene_plane: float = 100.0,
        unlabelled_cost: float = 0.02,
        min_confidence: float = 0.0,
        sigma_maps: bool = True,
        seed: int = 0,
    ) -> RefineOptions: ...
    @classmethod
    def paper_strict(
        cls,
        *,
        denoise: bool = True,
        distrust_unmatched: bool = False,
        filter: bool = True,
        filter_confidence: bool = True,
        filter_discontinuity: bool = True,
        cost_ratio: bool = False,
        view_agreement: bool = True,
        min_aggregated_score: float = 0.8,
        confidence_weight: float = 0.7,
        refine: bool = True,
        superpixel_planes: bool = True,
        weighted_median: bool = True,
        readmit_filtered: bool = False,
        spread_medians: bool = False,
        small_windows: bool = False,
        pixel_distances: bool = False,
        fill_wide_holes: bool = False,
        fill_before_regions: bool = False,
        num_iterations: int = 4,
        superpixel_size: int = 400,
        min_plane_support: float = 0.3,
        loose_plane_tolerance: float = 0.0,
        window_radius: int = 5,
        spatial_sigma: float = 2.0,
        color_sigma: float = 3.0,
        disparity_tolerance: float = 24.0,
        segment: bool = True,
        edge_threshold: float = 4.0,
        edges_of_roots: bool = False,
        short_lines: bool = False,
        hough_min_votes: int = 5,
        hough_max_gap: int = 15,
        region_cores: bool = True,
        region_rims: bool = True,
        bounded_regions: bool = True,
        max_region_planes: int = 4,
        min_region_size: int = 8000,
        max_boundary_error: float = 0.02,
        max_boundary_gap: float = 0.0,
        confirmed_depths: bool = True,
        scene_planes: bool = True,
        foreground_fattening: bool = True,
        manhattan_frame: bool = True,
        adjust_planes: bool = True,
        bounded_planes: bool = True,
        bounding_creases: bool = True,
        curved_surfaces: bool = True,
        cylinders: bool = True,
        off_plane_depths: bool = True,
        pixel_borders: bool = True,
        photometric: bool = True,
        plane_tolerance: float = 7.0,
        min_scene_plane: float = 100.0,
        unlabelled_cost: float = 0.02,
        min_confidence: float = 0.0,
        sigma_maps: bool = True,
        seed: int = 0,
    ) -> RefineOptions: ...
    def update(
        self,
        *,
        denoise: bool = True,
        distrust_unmatched: bool = False,
        filter: bool = True,
        filter_confidence: bool = True,
        filter_discontinuity: bool = True,
        cost_ratio: bool = False,
        view_agreement: bool = True,
        min_aggregated_score: float = 0.8,
        confidence_weight: float = 0.7,
        refine: bool = True,
        superpixel_planes: bool = True,
        weighted_median: bool = True,
        readmit_filtered: bool = False,
        spread_medians: bool = False,
        small_windows: bool = False,
        pixel_distances: bool = False,
        fill_wide_holes: bool = False,
        fill_before_regions: bool = False,
        num_iterations: int = 4,
        superpixel_size: int = 400,
        min_plane_support: float = 0.3,
        loose_plane_tolerance: float = 0.0,
        window_radius: int = 5,
        spatial_sigma: float = 2.0,
        color_sigma: float = 3.0,
        disparity_tolerance: float = 24.0,
        segment: bool = True,
        edge_threshold: float = 4.0,
        edges_of_roots: bool = False,
        short_lines: bool = False,
        hough_min_votes: int = 5,
        hough_max_gap: int = 15,
        region_cores: bool = True,
        region_rims: bool = True,
        bounded_regions: bool = True,
        max_region_planes: int = 4,
        min_region_size: int = 8000,
        max_boundary_error: float = 0.02,
        max_boundary_gap: float = 0.0,
        confirmed_depths: bool = True,
        scene_planes: bool = True,
        foreground_fattening: bool = True,
        manhattan_frame: bool = True,
        adjust_planes: bool = True,
        bounded_planes: bool = True,
        bounding_creases: bool = True,
        curved_surfaces: bool = True,
        cylinders: bool = True,
        off_plane_depths: bool = True,
        pixel_borders: bool = True,
        photometric: bool = True,
        plane_tolerance: float = 7.0,
        min_scene_plane: float = 100.0,
        unlabelled_cost: float = 0.02,
        min_confidence: float = 0.0,
        sigma_maps: bool = True,
        seed: int = 0,
    ) -> RefineOptions: ...
    def check(self) -> None: ...
    def todict(self) -> typing.Dict[str, typing.Any]: ...
    def copy(self) -> RefineOptions: ...
    def __copy__(self) -> RefineOptions: ...
    def __deepcopy__(self, memo: typing.Any) -> RefineOptions: ...
