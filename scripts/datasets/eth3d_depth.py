# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""ETH3D's ground truth depth, which is of the distorted photos, in the undistorted
views and in the size of their depth maps, as tsar_evaluate reads it.

The archives SCENE_dslr_jpg.7z and SCENE_dslr_depth.7z have
dslr_calibration_jpg/{cameras,images}.txt and ground_truth_depth/dslr_images/NAME:
32-bit floats, row by row, without a head; infinite where there is none.
"""
import pathlib

import numpy as np

from files import DatasetError
from model import read_cameras, read_images

CALIBRATION = "dslr_calibration_jpg"
DEPTH = "ground_truth_depth"


def project(camera, x, y):
    """Pixels of the THIN_PRISM_FISHEYE camera for points (x, y, 1) of its frame."""
    fx, fy, cx, cy, k1, k2, p1, p2, k3, k4, sx, sy = camera.params
    radius = np.hypot(x, y)
    shrink = np.where(radius > 1e-9, np.arctan(radius) / np.maximum(radius, 1e-9), 1.0)
    x, y = x * shrink, y * shrink
    r2 = x * x + y * y
    radial = 1 + r2 * (k1 + r2 * (k2 + r2 * (k3 + r2 * k4)))
    return (fx * (x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x) + sx * r2) + cx,
            fy * (y * radial + 2 * p2 * x * y + p1 * (r2 + 2 * y * y) + sy * r2) + cy)


def undistort_depth(depth, distorted, undistorted, width, height):
    """The depth, 0 where it is unknown, of each pixel of a map of the undistorted view,
    from the nearest pixel of the distorted one."""
    fx, fy, cx, cy = undistorted.params
    column, row = np.meshgrid((np.arange(width) + 0.5) * undistorted.width / width,
                              (np.arange(height) + 0.5) * undistorted.height / height)
    x, y = project(distorted, (column - cx) / fx, (row - cy) / fy)
    x, y = np.floor(x).astype(int), np.floor(y).astype(int)
    inside = (x >= 0) & (x < distorted.width) & (y >= 0) & (y < distorted.height)
    result = np.zeros((height, width), np.float32)
    result[inside] = depth[y[inside], x[inside]]
    result[~np.isfinite(result) | (result < 0)] = 0
    return result


def has_depth(path):
    return (path / DEPTH).is_dir() and (path / CALIBRATION).is_dir()


def write_depth(path, calibration, map_sizes, output):
    """Writes OUTPUT/NAME.bin for the images of a scene. calibration: folder of the
    undistorted cameras; map_sizes: image name -> (width, height)."""
    cameras, images = (read(path / CALIBRATION / name) for read, name in (
        (read_cameras, "cameras.txt"), (read_images, "images.txt")))
    distorted = {pathlib.PurePosixPath(image.name).name: image for image in images}
    plain = read_cameras(calibration / "cameras.txt")
    for image in read_images(calibration / "images.txt"):
        name = pathlib.PurePosixPath(image.name).name
        if name not in distorted:
            raise DatasetError(f"{path / CALIBRATION / 'images.txt'}: has no image {name}")
        camera = cameras[distorted[name].camera_id]
        if camera.model != "THIN_PRISM_FISHEYE":
            raise DatasetError(f"{path / CALIBRATION / 'cameras.txt'}: {camera.model}; unpack the "
                               "archive of the JPEG images again")
        file = path / DEPTH / distorted[name].name
        if not file.is_file():
            raise DatasetError(f"{file}: not found; unpack the archive of the depth maps again")
        depth = np.fromfile(file, "<f4")
        if depth.size != camera.width * camera.height:
            raise DatasetError(f"{file}: {depth.size} depths, not the {camera.width} x "
                               f"{camera.height} of its camera")
        width, height = map_sizes[image.name]
        values = undistort_depth(depth.reshape(camera.height, camera.width), camera,
                                 plain[image.camera_id], width, height)
        target = output / f"{image.name}.bin"
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(f"{width}&{height}&1&".encode() + values.astype("<f4").tobytes())
