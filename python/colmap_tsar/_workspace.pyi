# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
# Written by scripts/write_python_stubs.py.
import collections.abc
import os
import pathlib
import typing

import colmap_tsar

class Workspace(collections.abc.Mapping[str, colmap_tsar.WorkspaceImage]):
    def __init__(
        self,
        workspace_path: typing.Union[str, os.PathLike[str]],
        *,
        input_type: typing.Optional[str] = None,
    ) -> None: ...
    def __len__(
        self,
    ) -> int: ...
    def __iter__(
        self,
    ) -> typing.Iterator[str]: ...
    def __contains__(
        self,
        name: object,
    ) -> bool: ...
    def __getitem__(
        self,
        name: str,
    ) -> colmap_tsar.WorkspaceImage: ...
    @property
    def path(self) -> pathlib.Path: ...
    @property
    def input_type(self) -> str: ...
    @property
    def images(self) -> typing.Tuple[colmap_tsar.WorkspaceImage, ...]: ...
    @property
    def planes(self) -> colmap_tsar.Planes: ...
    def refine(
        self,
        options: typing.Union[colmap_tsar.RefineOptions, typing.Mapping[str, typing.Any], None] = None,
        *,
        preset: str = 'default',
        output_path: typing.Union[str, os.PathLike[str], None] = None,
        image_list_path: typing.Union[str, os.PathLike[str], None] = None,
        mask_path: typing.Union[str, os.PathLike[str], None] = None,
        device: str = 'auto',
        gpu_index: typing.Union[str, int] = '-1',
        num_threads: int = -1,
        cache_size: float = 32.0,
        shard: str = '',
        pass_: str = 'all',
        progress: typing.Union[bool, typing.Callable[[str, int, int], typing.Any]] = True,
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
    ) -> colmap_tsar.RefineSummary: ...
    def stereo(
        self,
        *,
        progress: typing.Union[bool, typing.Callable[[str, int, int], typing.Any]] = True,
        image_list_path: typing.Union[str, os.PathLike[str], None] = None,
        mask_path: typing.Union[str, os.PathLike[str], None] = None,
        overwrite: bool = False,
        device: typing.Literal['auto', 'cuda', 'cpu'] = 'auto',
        gpu_index: typing.Union[str, float, typing.Sequence[float]] = '-1',
        cache_size: float = 32.0,
        num_threads: int = -1,
        max_image_size: int = -1,
        depth_min: float = -1.0,
        depth_max: float = -1.0,
        num_sources: int = 20,
        window_radius: int = 5,
        num_iterations: int = 4,
        num_levels: int = 2,
        geom_consistency: bool = True,
        num_geometric_passes: int = 2,
        planar_prior: bool = True,
        smooth_normals: bool = True,
        filter_min_ncc: float = 0.1,
        filter_min_triangulation_angle: float = 3.0,
        filter_min_num_consistent: int = 2,
        filter_geom_consistency_max_cost: float = 1.0,
    ) -> colmap_tsar.StereoSummary: ...
    def import_maps(
        self,
        input_path: typing.Union[str, os.PathLike[str]],
        format: str,
        *,
        progress: typing.Union[bool, typing.Callable[[str, int, int], typing.Any]] = True,
        normal_path: typing.Union[str, os.PathLike[str], None] = None,
        output_type: typing.Literal['geometric', 'photometric'] = 'geometric',
        index_order: typing.Literal['image_id', 'name'] = 'image_id',
        image_list: typing.Union[str, os.PathLike[str], None] = None,
        depth_scale: float = 0.0,
        scale_to_sparse: bool = False,
        check_scale: bool = True,
        normal_frame: typing.Literal['auto', 'world', 'camera'] = 'auto',
        import_costs: bool = False,
        overwrite: bool = False,
    ) -> colmap_tsar.ImportSummary: ...
    def report(
        self,
        *,
        progress: typing.Union[bool, typing.Callable[[str, int, int], typing.Any]] = True,
        report_path: typing.Union[str, os.PathLike[str], None] = None,
        overwrite: bool = False,
        debug_path: typing.Union[str, os.PathLike[str], None] = None,
        before_path: typing.Union[str, os.PathLike[str], None] = None,
        after_path: typing.Union[str, os.PathLike[str], None] = None,
        ground_truth_path: typing.Union[str, os.PathLike[str], None] = None,
        scans_path: typing.Union[str, os.PathLike[str], None] = None,
        tolerances: typing.Union[str, float, typing.Sequence[float]] = '0.02,0.1',
        max_image_size: int = 1000,
        max_points: int = 300000,
        num_threads: int = -1,
        output_path: typing.Union[str, os.PathLike[str], None] = None,
        num_images: int = 3,
    ) -> colmap_tsar.ReportSummary: ...
    def export(
        self,
        output_path: typing.Union[str, os.PathLike[str]],
        format: str,
        *,
        progress: typing.Union[bool, typing.Callable[[str, int, int], typing.Any]] = True,
        mask_path: typing.Union[str, os.PathLike[str], None] = None,
        depth_scale: float = 0.001,
        overwrite: bool = False,
        num_threads: int = -1,
    ) -> colmap_tsar.ExportSummary: ...
    def restore(
        self,
        conflicts: str = 'report',
    ) -> colmap_tsar.RestoreSummary: ...
    def undo_imports(
        self,
        conflicts: str = 'report',
    ) -> colmap_tsar.RestoreSummary: ...
