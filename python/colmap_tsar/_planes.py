# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""The planes of a refined scene, as arrays of NumPy."""
import dataclasses
import os
import typing
from typing import Dict, List, Optional, Union

from . import _core
from ._numpy import import_numpy

if typing.TYPE_CHECKING:
    import numpy

    _Array = numpy.ndarray

_Path = Union[str, "os.PathLike[str]"]


@dataclasses.dataclass(frozen=True, eq=False)
class Polygon:
    """A part of a plane; points in the world frame. The last point of each ring is
    joined to the first."""

    outline: "_Array"
    """(K, 3); counterclockwise, seen from where the normal points."""
    holes: List["_Array"]
    """(K, 3) each; clockwise."""


@dataclasses.dataclass(frozen=True, eq=False)
class Planes:
    """What read_planes() finds: N planes, by their ids. World frame, units of the
    sparse model; docs/planes.md tells how each is found."""

    input_type: str
    """The maps that they are of: such as "geometric"."""
    num_images: int
    """How many images have plane maps."""
    vertical: Optional["_Array"]
    """(3,): unit vector that points up. None if nothing tells."""
    vertical_from: str
    """"manhattan_frame", "cameras" or "none"."""
    frames: "_Array"
    """(F, 3, 3): Manhattan frames; frames[f, a] is axis a of frame f, a unit
    vector."""
    ids: "_Array"
    """(N,): what plane maps hold. Ascending, with gaps if min_area left planes
    out."""
    classes: List[str]
    """N times "floor", "ceiling", "wall" or "other"."""
    normals: "_Array"
    """(N, 3): unit vectors that point to where most of the pixels are seen from."""
    offsets: "_Array"
    """(N,): normal . X + offset = 0."""
    centers: "_Array"
    """(N, 3): a point on each plane amid what was measured."""
    axes: "_Array"
    """(N, 2, 3): two unit vectors in each plane, right-handed with the normal."""
    covariances: "_Array"
    """(N, 3, 3): of the rotation about both axes through the center (radians), and
    of the shift along the normal. Infinite where a variance is not known."""
    areas: "_Array"
    """(N,): of all polygons without their holes."""
    resolutions: "_Array"
    """(N,): side of a cell of the grid that the polygons were found on; 0 if no
    image shows the plane."""
    shares_measured: "_Array"
    """(N,): share of its pixels whose depth was measured there, not filled."""
    supports: "_Array"
    """(N,): what was measured of it when it was found, in pixels of full
    confidence. 0: nothing, it is guessed at a crease where another plane ends."""
    num_pixels: "_Array"
    """(N,): pixels of all images that lie on it."""
    components: "_Array"
    """(N,): planes of different components are not connected by common views."""
    frame_ids: "_Array"
    """(N,): the frame along one of whose axes the normal lies exactly; -1: none."""
    frame_axes: "_Array"
    """(N,): that axis (0, 1, 2); -1: none."""
    meets: List[List[int]]
    """The ids of the planes with which each has a crease."""
    images: List[Dict[str, int]]
    """For each plane the images that show it, and in how many pixels."""
    polygons: List[List[Polygon]]
    """The outlines of each plane, the largest first."""

    def __len__(self) -> int:
        return len(self.classes)


# Attributes of Planes that are arrays: the type and the shape for one plane.
_ARRAYS = {
    "ids": ("int64", ()),
    "normals": ("float64", (3,)),
    "offsets": ("float64", ()),
    "centers": ("float64", (3,)),
    "axes": ("float64", (2, 3)),
    "covariances": ("float64", (3, 3)),
    "areas": ("float64", ()),
    "resolutions": ("float64", ()),
    "shares_measured": ("float64", ()),
    "supports": ("float64", ()),
    "num_pixels": ("int64", ()),
    "components": ("int64", ()),
    "frame_ids": ("int64", ()),
    "frame_axes": ("int64", ()),
}
_LISTS = ("classes", "meets", "images")


def _to_polygon(np, polygon):
    return Polygon(
        np.array(polygon["outline"]), [np.array(hole) for hole in polygon["holes"]]
    )


def read_planes(
    workspace_path: _Path,
    *,
    input_type: Optional[str] = None,
    min_area: float = 0.0,
) -> Planes:
    """The planes of a refined workspace: walls, floors, ceilings and other flat
    surfaces. What the command tsar_planes writes, as arrays.

    Reads the maps of all images, one at a time; Ctrl-C ends it. Needs NumPy.

    Args:
        workspace_path: The refined dense workspace.
        input_type: The maps that were refined, "geometric" or "photometric".
            None: geometric, or photometric where only those have planes.
        min_area: Planes of a smaller area, in square units of the sparse model, are
            left out.
    """
    np = import_numpy()
    result = _core.read_planes(os.fspath(workspace_path), input_type, min_area)
    planes = result.pop("planes")
    for name, (kind, shape) in _ARRAYS.items():
        values = [plane[name] for plane in planes]
        result[name] = np.array(values, kind).reshape(len(planes), *shape)
    for name in _LISTS:
        result[name] = [plane[name] for plane in planes]
    result["polygons"] = [
        [_to_polygon(np, polygon) for polygon in plane["polygons"]] for plane in planes
    ]
    result["frames"] = np.array(result["frames"], "float64").reshape(-1, 3, 3)
    if result["vertical"] is not None:
        result["vertical"] = np.array(result["vertical"])
    return Planes(**result)


def read_plane_map(path: _Path) -> "_Array":
    """Which plane each pixel of an image lies on: (height, width) of int32, the ids
    of read_planes(); -1: none. Needs NumPy.

    Args:
        path: A plane map, stereo/plane_maps/IMAGE_NAME.TYPE.png in the workspace.
    """
    np = import_numpy()
    width, height, pixels = _core.read_plane_map(os.fspath(path))
    numbers = np.frombuffer(pixels, "uint16").reshape(height, width)
    return numbers.astype("int32") - 1
