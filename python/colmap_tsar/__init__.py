# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Completes the depth maps of COLMAP's dense stage on surfaces without texture.

Between COLMAP's patch_match_stereo and stereo_fusion:

    import colmap_tsar

    colmap_tsar.refine("dense")

or, with the maps at hand as arrays of NumPy,

    ws = colmap_tsar.Workspace("dense")
    ws.refine()
    ws["a.jpg"].depth

refine() fills the depth and normal maps of a dense workspace where walls, floors
and facades have no texture, in COLMAP's own format and under the same names;
restore() puts COLMAP's maps back. evaluate_depth() and evaluate_cloud() score the
result against ground truth. help(refine) explains every option, and Error what can
go wrong. read_planes() and read_plane_map() give the planes of a refined
scene as arrays of NumPy. help() of each tells the rest.

has_cuda says whether this package was built for NVIDIA GPUs; without, everything
is computed on the CPU, with the same results.
"""
from ._core import __version__, has_cuda
from ._errors import (
    BadOptionError,
    CorruptError,
    DeviceError,
    Error,
    FileError,
    MismatchError,
    NotFoundError,
    OutOfMemoryError,
    UnsupportedError,
)
from ._evaluate import (
    CloudEvaluation,
    CloudScore,
    DepthEvaluation,
    DepthScore,
    evaluate_cloud,
    evaluate_depth,
)
from ._images import Camera, WorkspaceImage
from ._planes import Planes, Polygon, read_plane_map, read_planes
from ._refine import refine, restore
from ._summaries import (
    ExportSummary,
    FuseSummary,
    ImportSummary,
    RefineSummary,
    ReportSummary,
    RestoreSummary,
    StereoSummary,
)
from ._workspace import Workspace

__all__ = [
    "BadOptionError",
    "Camera",
    "CloudEvaluation",
    "CloudScore",
    "CorruptError",
    "DepthEvaluation",
    "DepthScore",
    "DeviceError",
    "Error",
    "ExportSummary",
    "FileError",
    "FuseSummary",
    "ImportSummary",
    "MismatchError",
    "NotFoundError",
    "OutOfMemoryError",
    "Planes",
    "Polygon",
    "RefineSummary",
    "ReportSummary",
    "RestoreSummary",
    "StereoSummary",
    "UnsupportedError",
    "Workspace",
    "WorkspaceImage",
    "__version__",
    "evaluate_cloud",
    "evaluate_depth",
    "has_cuda",
    "read_plane_map",
    "read_planes",
    "refine",
    "restore",
]

# Where users find them, whatever the file.
for _name in __all__:
    if callable(globals()[_name]):
        globals()[_name].__module__ = __name__
del _name
