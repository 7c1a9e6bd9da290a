# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
# Written by scripts/write_python_stubs.py.
import os
import typing

class RefineKeywords(typing.TypedDict, total=False):
    image_list_path: typing.Union[str, os.PathLike[str], None]
    mask_path: typing.Union[str, os.PathLike[str], None]
    prior_path: typing.Union[str, os.PathLike[str], None]
    prior_type: typing.Literal['auto', 'metric', 'relative', 'inverse']
    region_path: typing.Union[str, os.PathLike[str], None]
    output_path: typing.Union[str, os.PathLike[str], None]
    preset: typing.Literal['default', 'paper', 'paper_strict']
    device: typing.Literal['auto', 'cuda', 'cpu']
    gpu_index: typing.Union[str, float, typing.Sequence[float]]
    cache_size: float
    num_threads: int
    debug_path: typing.Union[str, os.PathLike[str], None]
    shard: typing.Union[str, float, typing.Sequence[float], None]
    pass_: typing.Literal['all', 'observe', 'model', 'compose', 'merge']
    scene_planes: bool
    min_confidence: float
    sigma_maps: bool
    seed: int
    experiment: typing.Union[str, typing.Mapping[str, float], None]

class StereoKeywords(typing.TypedDict, total=False):
    image_list_path: typing.Union[str, os.PathLike[str], None]
    mask_path: typing.Union[str, os.PathLike[str], None]
    prior_path: typing.Union[str, os.PathLike[str], None]
    prior_type: typing.Literal['auto', 'metric', 'relative', 'inverse']
    overwrite: bool
    device: typing.Literal['auto', 'cuda', 'cpu']
    gpu_index: typing.Union[str, float, typing.Sequence[float]]
    cache_size: float
    num_threads: int
    max_image_size: int
    depth_min: float
    depth_max: float
    num_sources: int
    window_radius: int
    num_iterations: int
    num_levels: int
    geom_consistency: bool
    num_geometric_passes: int
    planar_prior: bool
    smooth_normals: bool
    filter_min_ncc: float
    filter_min_triangulation_angle: float
    filter_min_num_consistent: int
    filter_geom_consistency_max_cost: float

class FuseKeywords(typing.TypedDict, total=False):
    image_list_path: typing.Union[str, os.PathLike[str], None]
    mask_path: typing.Union[str, os.PathLike[str], None]
    bounding_box_path: typing.Union[str, os.PathLike[str], None]
    overwrite: bool
    preset: typing.Literal['default', 'paper', 'colmap']
    min_num_views: int
    max_reproj_error: float
    max_depth_error: float
    max_normal_error: float
    check_num_images: int
    point_spacing: int
    device: typing.Literal['auto', 'cuda', 'cpu']
    gpu_index: typing.Union[str, float, typing.Sequence[float]]
    cache_size: float
    num_threads: int

class ImportKeywords(typing.TypedDict, total=False):
    normal_path: typing.Union[str, os.PathLike[str], None]
    output_type: typing.Literal['geometric', 'photometric']
    image_list: typing.Union[str, os.PathLike[str], None]
    depth_scale: float
    scale_to_sparse: bool
    check_scale: bool
    overwrite: bool
    device: typing.Literal['auto', 'cuda', 'cpu']
    gpu_index: typing.Union[str, float, typing.Sequence[float]]
    cache_size: float
    num_threads: int

class ReportKeywords(typing.TypedDict, total=False):
    report_path: typing.Union[str, os.PathLike[str], None]
    overwrite: bool
    debug_path: typing.Union[str, os.PathLike[str], None]
    prior_path: typing.Union[str, os.PathLike[str], None]
    prior_type: typing.Literal['auto', 'metric', 'relative', 'inverse']
    before_path: typing.Union[str, os.PathLike[str], None]
    after_path: typing.Union[str, os.PathLike[str], None]
    fuse: typing.Optional[typing.Literal['default', 'paper', 'colmap']]
    ground_truth_path: typing.Union[str, os.PathLike[str], None]
    scans_path: typing.Union[str, os.PathLike[str], None]
    tolerances: typing.Union[str, float, typing.Sequence[float]]
    max_image_size: int
    max_points: int
    num_threads: int
    output_path: typing.Union[str, os.PathLike[str], None]
    num_images: int
