# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Cameras and poses, and COLMAP's sparse model in its text form.

A pose takes world to camera, x_camera = rotation @ x_world + translation, with
the camera's axes right, down and forward. Numbers are written with all digits, so
that what is read again is the same.
"""
import dataclasses
import pathlib

import numpy as np

from files import DatasetError, parse_numbers, read_lines, write_text

# How many parameters COLMAP's models have that can occur here.
CAMERA_MODELS = {"SIMPLE_PINHOLE": 3, "PINHOLE": 4, "SIMPLE_RADIAL": 4, "THIN_PRISM_FISHEYE": 12}
MAX_ROTATION_ERROR = 1e-3  # Of a rotation in a data set's file, in any entry.


@dataclasses.dataclass
class Camera:
    model: str  # A name of CAMERA_MODELS.
    width: int
    height: int
    params: list  # As COLMAP orders them: fx[, fy], cx, cy[, k].


@dataclasses.dataclass
class Pose:
    rotation: np.ndarray     # 3 x 3, world to camera.
    translation: np.ndarray  # 3, units of the world.

    def center(self):
        """Where the camera is in the world."""
        return -self.rotation.T @ self.translation

    def world_from_camera(self):
        """The 4 x 4 matrix that takes camera to world."""
        matrix = np.eye(4)
        matrix[:3, :3] = self.rotation.T
        matrix[:3, 3] = self.center()
        return matrix


@dataclasses.dataclass
class Image:
    image_id: int
    camera_id: int
    name: str
    pose: Pose


def pose_from_camera_to_world(rotation, center, place):
    """The pose whose inverse has this rotation and translation. place names the
    file in the error for a matrix that is no rotation."""
    rotation = np.asarray(rotation, float)
    error = np.abs(rotation @ rotation.T - np.eye(3)).max()
    if error > MAX_ROTATION_ERROR or np.linalg.det(rotation) < 0:
        raise DatasetError(f"{place}: the matrix is not a rotation")
    # The files hold six digits; COLMAP wants a rotation to the last one.
    u, _, v = np.linalg.svd(rotation)
    rotation = (u @ v).T
    return Pose(rotation, -rotation @ np.asarray(center, float))


def quaternion(rotation):
    """w, x, y, z of a rotation matrix, w not negative."""
    # The eigenvector of the largest eigenvalue is the quaternion; unlike formulas
    # with square roots this has no case that loses digits.
    xx, yx, zx, xy, yy, zy, xz, yz, zz = np.asarray(rotation).T.flat
    matrix = np.array([
        [xx - yy - zz, yx + xy, zx + xz, zy - yz],
        [yx + xy, yy - xx - zz, zy + yz, xz - zx],
        [zx + xz, zy + yz, zz - xx - yy, yx - xy],
        [zy - yz, xz - zx, yx - xy, xx + yy + zz]])
    x, y, z, w = np.linalg.eigh(matrix)[1][:, 3]
    sign = -1 if w < 0 else 1
    return sign * np.array([w, x, y, z])


def rotation_matrix(q):
    w, x, y, z = np.asarray(q, float) / np.linalg.norm(q)
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def numbered_lines(path, what):
    """(number, line) of a file's lines that are no comments, empty ones too."""
    return [(number, line) for number, line in enumerate(read_lines(path, what), 1)
            if not line.startswith("#")]


def read_cameras(path):
    cameras = {}
    for number, line in numbered_lines(path, "COLMAP's cameras as text"):
        words = line.split()
        if not words:
            continue
        place = f"{path}: line {number}"
        if len(words) < 4 or words[1] not in CAMERA_MODELS:
            raise DatasetError(f"{place}: no camera of the models {', '.join(CAMERA_MODELS)}")
        camera_id, width, height = parse_numbers(
            " ".join([words[0], *words[2:4]]), 3, place, int)
        params = parse_numbers(" ".join(words[4:]), CAMERA_MODELS[words[1]], place)
        cameras[camera_id] = Camera(words[1], width, height, params)
    return cameras


def read_images(path):
    """The images in the file's order; their observations are left out."""
    images = []
    lines = numbered_lines(path, "COLMAP's images as text")
    while lines and not lines[-1][1].strip():
        lines.pop()
    # Two lines per image, the second one may be empty: an image without points.
    for number, line in lines[::2]:
        place = f"{path}: line {number}"
        words = line.split(maxsplit=9)
        if len(words) != 10:
            raise DatasetError(f"{place}: not 'id, rotation, translation, camera, name'")
        values = parse_numbers(" ".join(words[1:8]), 7, place)
        image_id, camera_id = parse_numbers(f"{words[0]} {words[8]}", 2, place, int)
        if not any(values[:4]):
            raise DatasetError(f"{place}: the quaternion is zero")
        pose = Pose(rotation_matrix(values[:4]), np.array(values[4:]))
        images.append(Image(image_id, camera_id, words[9].strip(), pose))
    return images


def write_model(folder, cameras, images):
    """A model without points: cameras by id, and images."""
    folder = pathlib.Path(folder)
    text = lambda values: " ".join(repr(float(value)) for value in values)
    write_text(folder / "cameras.txt", "".join(
        f"{i} {c.model} {c.width} {c.height} {text(c.params)}\n"
        for i, c in sorted(cameras.items())))
    write_text(folder / "images.txt", "".join(
        f"{i.image_id} {text(quaternion(i.pose.rotation))} "
        f"{text(i.pose.translation)} {i.camera_id} {i.name}\n\n" for i in images))
    write_text(folder / "points3D.txt", "")


def largest_pose_change(before, after):
    """How far the rotation (entries of the matrix) and position (relative to the
    extent of the cameras) of an image differ between two lists."""
    by_name = {image.name: image.pose for image in before}
    centers = np.array([pose.center() for pose in by_name.values()])
    extent = max(np.ptp(centers, axis=0).max(), 1e-12)
    return max(max(np.abs(image.pose.rotation - by_name[image.name].rotation).max(),
                   np.abs(image.pose.center() - by_name[image.name].center()).max() / extent)
               for image in after)
