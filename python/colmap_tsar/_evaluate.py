# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Scores against ground truth."""
import dataclasses
import os
from typing import List, Optional, Sequence, Union

from . import _core
from ._result import Result

_Path = Union[str, "os.PathLike[str]"]


@dataclasses.dataclass(frozen=True)
class DepthScore:
    """How right depths are, over the pixels of all images with ground truth."""

    area: str
    """The pixels: "all", or "textureless"."""
    tolerance: float
    """A depth is right if it is off by less than this, in units of the model."""
    precision: float
    """Share of right depths among the estimated ones; 0 without any."""
    recall: float
    """Share of right depths among all pixels with ground truth."""
    f1: float
    """The harmonic mean of both."""
    num_right: int
    num_estimated: int
    num_known: int


@dataclasses.dataclass(frozen=True)
class DepthEvaluation(Result):
    """What evaluate_depth() finds."""

    num_images: int
    num_images_without_map: int
    """Images with ground truth that are left out of the scores."""
    num_masks: Optional[int]
    """Of num_images, those with a mask; None where no masks were given."""
    scores: List[DepthScore]
    """For each area, one for each tolerance."""


@dataclasses.dataclass(frozen=True)
class CloudScore:
    """How right a cloud is; shares in [0, 1]."""

    tolerance: float
    """The distance up to which a point is right, in units of the scans."""
    completeness: float
    """Of the scanned surface, the part with a point within the tolerance."""
    accuracy: float
    """Of the points in space that the scanners saw, those within the tolerance of
    the surface. Where no scanner looked, nothing is counted."""
    f1: float
    """The harmonic mean of both."""


@dataclasses.dataclass(frozen=True)
class CloudEvaluation(Result):
    """What evaluate_cloud() finds."""

    num_points: int
    num_scan_points: int
    scores: List[CloudScore]
    """One for each tolerance."""


def evaluate_depth(
    workspace_path: _Path,
    *,
    input_type: str = "geometric",
    ground_truth_path: Optional[_Path] = None,
    mask_path: Optional[_Path] = None,
    tolerances: Sequence[float] = (0.02, 0.1),
) -> DepthEvaluation:
    """Compares the depth maps of a dense workspace with ground truth depth.

    For all pixels and for textureless areas, where gray values vary by less than 4
    of 255 levels (standard deviation in a window of 11 x 11 pixels).

    Args:
        workspace_path: The dense workspace; its images are needed to find the
            textureless areas.
        input_type: The maps to score: such as "geometric".
        ground_truth_path: Folder with IMAGE_NAME.bin, depth maps in COLMAP's format
            (0: unknown). None: ground_truth/depth in the workspace.
        mask_path: The folder with masks of the undistorted images, named as for
            COLMAP: a.jpg.png for a.jpg. Pixels where a mask is black (0) are not
            scored. None: no masks.
        tolerances: A depth is right if it is off by less than this; rising numbers,
            in units of the model (meters, if it has them).
    """
    result = _core.evaluate_depth(
        os.fspath(workspace_path),
        input_type,
        "" if ground_truth_path is None else os.fspath(ground_truth_path),
        "" if mask_path is None else os.fspath(mask_path),
        tolerances,
    )
    result["scores"] = [DepthScore(**score) for score in result["scores"]]
    return DepthEvaluation(**result)


def evaluate_cloud(
    cloud_path: _Path,
    scans_path: _Path,
    *,
    tolerances: Sequence[float] = (0.01, 0.02, 0.05, 0.1),
    voxel_size: float = 0.01,
    beam_radius: float = 0.001125,
    beam_angle: float = 0.011,
) -> CloudEvaluation:
    """Compares a point cloud with laser scans by the measure of the ETH3D multi-view
    benchmark.

    Args:
        cloud_path: The cloud: a PLY file, ASCII or binary little-endian.
        scans_path: MeshLab project that lists the scans (PLY, each in its scanner's
            frame) and their poses.
        tolerances: Distances up to which a point is right; rising numbers, in units
            of the scans (meters, if they have them).
        voxel_size: Edge length of the voxels over which scores are averaged, in
            units of the scans.
        beam_radius: Radius of a laser beam at the scanner, in units of the scans.
        beam_angle: Half the opening angle of a laser beam, in degrees.
    """
    result = _core.evaluate_cloud(
        os.fspath(cloud_path),
        os.fspath(scans_path),
        tolerances,
        voxel_size,
        beam_radius,
        beam_angle,
    )
    result["scores"] = [CloudScore(**score) for score in result["scores"]]
    return CloudEvaluation(**result)
