# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Completes the depth maps of COLMAP's dense stage on surfaces without texture.

Between COLMAP's patch_match_stereo and stereo_fusion:

    import colmap_tsar

    colmap_tsar.refine("dense")

refine() fills the depth and normal maps of a dense workspace where walls, floors
and facades have no texture, in COLMAP's own format and under the same names;
restore() puts COLMAP's maps back. evaluate_depth() and evaluate_cloud() score the
result against ground truth. RefineOptions explains every option, and Error what
can go wrong. read_planes() and read_plane_map() give the planes of a refined
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
from ._options import RefineOptions
from ._planes import Planes, Polygon, read_plane_map, read_planes
from ._refine import RefineSummary, RestoreSummary, refine, restore

__all__ = [
    "BadOptionError",
    "CloudEvaluation",
    "CloudScore",
    "CorruptError",
    "DepthEvaluation",
    "DepthScore",
    "DeviceError",
    "Error",
    "FileError",
    "MismatchError",
    "NotFoundError",
    "OutOfMemoryError",
    "Planes",
    "Polygon",
    "RefineOptions",
    "RefineSummary",
    "RestoreSummary",
    "UnsupportedError",
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
