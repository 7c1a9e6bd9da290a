# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""A sparse model of undistorted images, as text or binary, and its scaling."""

import struct
from dataclasses import dataclass

import numpy as np

from copied_scene import (KEYPOINT, MODEL_IDS, NUM_PARAMS, SceneError,
                          rotation_matrix, text_lines)

MODEL_NAMES = {number: name for name, number in MODEL_IDS.items()}
TRACK_ELEMENT = np.dtype([("image", "<u4"), ("keypoint", "<u4")])


@dataclass
class Camera:
    id: int
    model: str
    width: int
    height: int
    params: list

    def intrinsics(self, shape):
        """fx, fy, cx, cy for a map of height x width."""
        params = self.params
        fx, fy, cx, cy = (params if self.model == "PINHOLE"
                          else [params[0], *params])
        sx, sy = shape[1] / self.width, shape[0] / self.height
        return fx * sx, fy * sy, cx * sx, cy * sy

    def scaled(self, width, height):
        fx, fy, cx, cy = self.intrinsics((height, width))
        return Camera(self.id, "PINHOLE", width, height, [fx, fy, cx, cy])


@dataclass
class PosedImage:
    id: int
    quaternion: np.ndarray
    translation: np.ndarray
    camera_id: int
    name: str
    keypoints: np.ndarray  # KEYPOINT; the point is -1 where there is none.

    def rotation(self):
        return rotation_matrix(self.quaternion)


@dataclass
class Point:
    id: int
    position: np.ndarray
    color: tuple
    error: float
    track: np.ndarray  # TRACK_ELEMENT


@dataclass
class SparseModel:
    cameras: dict  # By id.
    images: list
    points: list

    def scaled(self, long_side):
        """The model of the same images at this long side."""
        cameras, images = {}, []
        for camera in self.cameras.values():
            scale = long_side / max(camera.width, camera.height)
            cameras[camera.id] = camera.scaled(
                max(1, round(camera.width * scale)),
                max(1, round(camera.height * scale)))
        for image in self.images:
            old, new = self.cameras[image.camera_id], cameras[image.camera_id]
            keypoints = image.keypoints.copy()
            keypoints["xy"] *= [new.width / old.width, new.height / old.height]
            images.append(PosedImage(image.id, image.quaternion,
                                     image.translation, image.camera_id,
                                     image.name, keypoints))
        return SparseModel(cameras, images, self.points)


def read_model(folder):
    """The model below a folder, text before binary as there may be both."""
    if (folder / "cameras.txt").is_file():
        model = read_text(folder)
    elif (folder / "cameras.bin").is_file():
        model = read_binary(folder)
    else:
        raise SceneError(f"{folder}: no cameras.txt and no cameras.bin; give "
                         "a dense workspace, as image_undistorter makes it")
    for camera in model.cameras.values():
        if camera.model not in NUM_PARAMS:
            raise SceneError(f"{folder}: camera {camera.id} has lens "
                             "distortion; undistort it first")
    return model


def read_text(folder):
    cameras = {}
    for line in text_lines(folder / "cameras.txt"):
        words = line.split()
        if words:
            cameras[int(words[0])] = Camera(
                int(words[0]), words[1], int(words[2]), int(words[3]),
                [float(word) for word in words[4:]])
    images = []
    lines = text_lines(folder / "images.txt")
    for pose, observed in zip(lines[::2], lines[1::2]):
        words = pose.split(maxsplit=9)
        values = np.array(observed.split(), float).reshape(-1, 3)
        keypoints = np.empty(len(values), KEYPOINT)
        keypoints["xy"], keypoints["point"] = values[:, :2], values[:, 2]
        images.append(PosedImage(
            int(words[0]), np.array(words[1:5], float),
            np.array(words[5:8], float), int(words[8]), words[9], keypoints))
    points = []
    for line in text_lines(folder / "points3D.txt"):
        words = line.split()
        if words:
            track = np.array(words[8:], "<u4").view(TRACK_ELEMENT)
            points.append(Point(int(words[0]), np.array(words[1:4], float),
                                tuple(int(word) for word in words[4:7]),
                                float(words[7]), track))
    return SparseModel(cameras, images, points)


class ByteReader:
    """Takes values from the front of a file."""

    def __init__(self, path):
        self.path = path
        try:
            self.data = path.read_bytes()
        except OSError as error:
            raise SceneError(f"{path}: {error.strerror}") from error
        self.at = 0

    def take(self, form):
        try:
            values = struct.unpack_from("<" + form, self.data, self.at)
        except struct.error as error:
            raise SceneError(f"{self.path}: the file ends too early"
                             ) from error
        self.at += struct.calcsize("<" + form)
        return values

    def array(self, kind, count):
        if self.at + kind.itemsize * count > len(self.data):
            raise SceneError(f"{self.path}: the file ends too early")
        values = np.frombuffer(self.data, kind, count, self.at)
        self.at += kind.itemsize * count
        return values

    def text(self):
        end = self.data.index(b"\0", self.at)
        value = self.data[self.at:end].decode()
        self.at = end + 1
        return value


def read_binary(folder):
    reader, cameras = ByteReader(folder / "cameras.bin"), {}
    for _ in range(*reader.take("Q")):
        number, model, width, height = reader.take("IiQQ")
        if model not in MODEL_NAMES:
            raise SceneError(f"{reader.path}: camera {number} has lens "
                             "distortion; undistort it first")
        name = MODEL_NAMES[model]
        params = list(reader.take(f"{NUM_PARAMS[name]}d"))
        cameras[number] = Camera(number, name, width, height, params)
    reader, images = ByteReader(folder / "images.bin"), []
    for _ in range(*reader.take("Q")):
        number, *pose = reader.take("I7d")
        camera, = reader.take("I")
        name = reader.text()
        keypoints = reader.array(KEYPOINT, *reader.take("Q"))
        images.append(PosedImage(number, np.array(pose[:4]),
                                 np.array(pose[4:]), camera, name, keypoints))
    reader, points = ByteReader(folder / "points3D.bin"), []
    for _ in range(*reader.take("Q")):
        number, *values = reader.take("Q3d3Bd")
        track = reader.array(TRACK_ELEMENT, *reader.take("Q"))
        points.append(Point(number, np.array(values[:3]), tuple(values[3:6]),
                            values[6], track))
    return SparseModel(cameras, images, points)


def numbers(values):
    return " ".join(repr(float(value)) for value in values)


def write_text(model, folder):
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "cameras.txt").write_text("".join(
        f"{camera.id} {camera.model} {camera.width} {camera.height} "
        f"{numbers(camera.params)}\n" for camera in model.cameras.values()))
    with open(folder / "images.txt", "w", encoding="utf-8") as file:
        for image in model.images:
            file.write(f"{image.id} {numbers(image.quaternion)} "
                       f"{numbers(image.translation)} {image.camera_id} "
                       f"{image.name}\n")
            file.write(" ".join(f"{x:.3f} {y:.3f} {point}" for (x, y), point
                                in image.keypoints.tolist()) + "\n")
    with open(folder / "points3D.txt", "w", encoding="utf-8") as file:
        for point in model.points:
            file.write(f"{point.id} {numbers(point.position)} "
                       f"{' '.join(map(str, point.color))} {point.error!r} "
                       + " ".join(f"{image} {keypoint}" for image, keypoint
                                  in point.track.tolist()) + "\n")
