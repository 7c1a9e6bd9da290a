# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""The images of a workspace, and their maps as arrays of NumPy."""
import dataclasses
import functools
import os
import pathlib
import typing

from . import _core
from ._numpy import import_numpy

if typing.TYPE_CHECKING:
    import numpy

    _Array = numpy.ndarray


@dataclasses.dataclass(frozen=True)
class Camera:
    """A pinhole camera without distortion, for rasters of width x height pixels.

    Pixel (column, row) has the ray ((column - cx) / fx, (row - cy) / fy, 1), without
    half a pixel, as in COLMAP's dense stage."""

    width: int
    height: int
    fx: float
    fy: float
    cx: float
    cy: float

    @property
    def K(self) -> "_Array":
        """(3, 3) of float64: the calibration matrix."""
        rows = [[self.fx, 0.0, self.cx], [0.0, self.fy, self.cy], [0.0, 0.0, 1.0]]
        return import_numpy().array(rows)

    def resized(self, width: int, height: int) -> "Camera":
        """The same camera for rasters of another size."""
        x, y = width / self.width, height / self.height
        return Camera(width, height, self.fx * x, self.fy * y, self.cx * x, self.cy * y)


class WorkspaceImage:
    """An image of a Workspace. Its maps are read when they are asked for, and stay
    with this object as they were then; the workspace makes a new one each time.

    Maps are arrays of height x width pixels, in the size of the depth map. Where the
    workspace has none, they raise NotFoundError."""

    def __init__(self, workspace_path, name, input_type, facts):
        self._workspace_path = os.fspath(workspace_path)
        self._name = name
        self._input_type = input_type
        self._facts = facts

    def __repr__(self) -> str:
        return f"<WorkspaceImage {self._name!r}, {self._input_type} maps>"

    @property
    def name(self) -> str:
        """As in the sparse model: the path below images/."""
        return self._name

    @property
    def path(self) -> pathlib.Path:
        """The undistorted photo."""
        return pathlib.Path(self._workspace_path, "images", self._name)

    @property
    def input_type(self) -> str:
        """Which maps these are: such as "geometric"."""
        return self._input_type

    @functools.cached_property
    def depth(self) -> "_Array":
        """(height, width) of float32: z in the camera's frame, in units of the sparse
        model; 0: none. As pycolmap's DepthMap.to_array()."""
        return self._read("depth", "float32")

    @functools.cached_property
    def normals(self) -> "_Array":
        """(height, width, 3) of float32: unit vectors in the camera's frame (x right,
        y down, z forward) that point to the camera; 0: none. As pycolmap's
        NormalMap.to_array()."""
        return self._read("normals", "float32", 3)

    @functools.cached_property
    def confidence(self) -> "_Array":
        """(height, width) of float32: the probability that the depth is right to 1 %;
        0: no depth. In steps of 1/255."""
        confidence = self._read("confidence", "uint8")
        return confidence.astype("float32") / 255

    @functools.cached_property
    def sigma(self) -> "_Array":
        """(height, width) of float32: the standard deviation of the depth, in its units;
        0: no depth."""
        return self._read("sigma", "float32")

    @functools.cached_property
    def provenance(self) -> "_Array":
        """(height, width) of uint8: where the depth comes from. 0: none, 1: measured,
        2: plane of a superpixel, 3: interpolated, 4: plane of a region, 5: other views,
        6: guessed, 7: a depth prior."""
        return self._read("provenance", "uint8")

    @functools.cached_property
    def planes(self) -> "_Array":
        """(height, width) of int32: the plane that the depth lies on, one of the ids of
        Workspace.planes; -1: none."""
        return self._read("planes", "uint16").astype("int32") - 1

    @functools.cached_property
    def photo_camera(self) -> Camera:
        """The camera for the pixels of the photo."""
        return Camera(*(self._facts[key] for key in ("width", "height", "fx", "fy", "cx", "cy")))

    @functools.cached_property
    def camera(self) -> Camera:
        """The camera for the pixels of the depth map, or of the image where there is
        none."""
        camera = self.photo_camera
        where = (self._workspace_path, self._name, self._input_type)
        if not _core.has_depth_map(*where):
            return camera
        return camera.resized(*_core.read_depth_map_size(*where))

    @functools.cached_property
    def cam_from_world(self) -> "_Array":
        """(3, 4) of float64: [R | t] with x_camera = R x_world + t, as pycolmap's
        Rigid3d.matrix()."""
        return import_numpy().array(self._facts["cam_from_world"])

    def _read(self, kind, dtype, *channels):
        np = import_numpy()
        width, height, pixels = _core.read_map(
            self._workspace_path, self._name, self._input_type, kind
        )
        return np.frombuffer(pixels, dtype).reshape(height, width, *channels)
