# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""A workspace of many images: copies of a small scene, side by side.

The copies share the scene's files by links and lie so far apart that none sees
another; the images of a copy give what the scene's would. Or they are the rooms
of one large building, linked by some views. Needs numpy.
"""

import math
import os
from pathlib import Path

import numpy as np

MAP_FOLDERS = ("depth_maps", "normal_maps")
NUM_PARAMS = {"SIMPLE_PINHOLE": 3, "PINHOLE": 4}
MODEL_IDS = {"SIMPLE_PINHOLE": 0, "PINHOLE": 1}
KEYPOINT = np.dtype([("xy", "<f8", 2), ("point", "<i8")])


class SceneError(Exception):
    """The scene is not what it must be; the message says why."""


def text_lines(path):
    """The lines of a file of COLMAP's, without its comments."""
    if not path.is_file():
        raise SceneError(f"{path}: no such file; give a workspace with a sparse "
                         "model as text (colmap model_converter)")
    return [line for line in path.read_text().splitlines()
            if not line.startswith("#")]


def rotation_matrix(quaternion):
    w, x, y, z = quaternion / np.linalg.norm(quaternion)
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


class ModelImage:
    def __init__(self, pose, keypoints):
        words = pose.split(maxsplit=9)
        self.id = int(words[0])
        self.quaternion = np.array(words[1:5], float)
        self.translation = np.array(words[5:8], float)
        self.camera_id = int(words[8])
        self.name = words[9]
        values = np.array(keypoints.split(), float).reshape(-1, 3)
        self.keypoints = np.empty(len(values), KEYPOINT)
        self.keypoints["xy"] = values[:, :2]
        self.keypoints["point"] = values[:, 2]

    def translation_at(self, offset):
        """For the same camera, moved by an offset in the world."""
        return self.translation - rotation_matrix(self.quaternion) @ offset


class ModelPoints:
    """points3D.bin's records of the scene, to be moved as a whole."""

    def __init__(self, lines):
        records = [line.split() for line in lines]
        self.ids = np.array([words[0] for words in records], "<u8")
        self.positions = np.array([words[1:4] for words in records], "<f8")
        tracks = [np.array(words[8:], "<u4") for words in records]
        self.track_images = np.concatenate(tracks)[::2]
        head = np.dtype([("id", "<u8"), ("position", "<f8", 3),
                         ("color", "u1", 3), ("error", "<f8"),
                         ("length", "<u8")])
        heads = np.zeros(len(records), head)
        heads["color"] = [words[4:7] for words in records]
        heads["error"] = [words[7] for words in records]
        lengths = np.array([len(track) // 2 for track in tracks])
        heads["length"] = lengths
        self.bytes = np.frombuffer(b"".join(
            part.tobytes() for pair in zip(heads, tracks) for part in pair),
            np.uint8).copy()
        sizes = head.itemsize + 8 * lengths
        self.starts = np.cumsum(sizes) - sizes
        # Where each element of a track has its image.
        first = np.cumsum(lengths) - lengths
        within = np.arange(lengths.sum()) - np.repeat(first, lengths)
        self.track_starts = (np.repeat(self.starts + head.itemsize, lengths)
                             + 8 * within)

    def moved(self, point_shift, image_shift, offset):
        """The records with other ids and places."""
        self._put(self.starts, self.ids + np.uint64(point_shift))
        self._put(self.starts + 8, self.positions + offset)
        self._put(self.track_starts,
                  self.track_images + np.uint32(image_shift))
        return self.bytes.tobytes()

    def _put(self, starts, values):
        raw = np.ascontiguousarray(values).view(np.uint8)
        raw = raw.reshape(len(starts), -1)
        at = starts[:, None] + np.arange(raw.shape[1])
        self.bytes[at] = raw


class Scene:
    """A workspace's sparse model, and its maps reduced to every step-th pixel.

    COLMAP's maps have a pixel's ray at its integer coordinates, so that the
    pixels kept are exactly where the reduced camera has them.
    """

    def __init__(self, root, reduced, step):
        self.root = root
        self.reduced = reduced
        self.cameras = [line.split() for line
                        in text_lines(root / "sparse" / "cameras.txt")]
        for camera in self.cameras:
            if camera[1] not in MODEL_IDS:
                raise SceneError(f"{root}: camera {camera[0]} has lens "
                                 "distortion; undistort it first")
        lines = text_lines(root / "sparse" / "images.txt")
        self.images = [ModelImage(*pair)
                       for pair in zip(lines[::2], lines[1::2])]
        self.points = ModelPoints(
            text_lines(root / "sparse" / "points3D.txt"))
        self.maps = [path.relative_to(root / "stereo")
                     for folder in MAP_FOLDERS
                     for path in sorted((root / "stereo" / folder).glob("*.bin"))]
        if not self.images or not self.maps:
            raise SceneError(f"{root}: no images or no maps")
        self.map_size = None
        for path in self.maps:
            self.map_size = reduce_map(root / "stereo" / path, reduced / path,
                                       step)

    def offset_of(self, copy, grid):
        spacing = grid.spacing * np.linalg.norm(
            np.ptp(self.points.positions, axis=0))
        row, column = grid.place_of(copy)
        return spacing * np.array([column, row, 0.0])

    def shifts_of(self, copy):
        """What is added to the ids of images and of points."""
        return (copy * (max(image.id for image in self.images) + 1),
                copy * (int(self.points.ids.max()) + 1))


class Grid:
    """How copies stand: on a square, so many times the scene's size apart."""

    def __init__(self, num_copies, sources):
        self.num_copies = num_copies
        self.side = math.ceil(math.sqrt(num_copies))
        self.spacing = 1 if sources == "linked" else 10

    def place_of(self, copy):
        """Row and column."""
        return divmod(copy, self.side)

    def next_to(self, copy):
        """The copies to the right and below."""
        row, column = self.place_of(copy)
        beside = [copy + 1] if column + 1 < self.side else []
        return [other for other in beside + [copy + self.side]
                if other < self.num_copies]


def reduce_map(source, target, step):
    """Keeps every step-th column and row; returns width and height."""
    width, height, channels, body = source.read_bytes().split(b"&", 3)
    values = np.frombuffer(body, "<f4").reshape(
        int(channels), int(height), int(width))[:, ::step, ::step]
    target.parent.mkdir(parents=True, exist_ok=True)
    size = values.shape[2], values.shape[1]
    target.write_bytes(b"%d&%d&%d&" % (*size, int(channels))
                       + np.ascontiguousarray(values).tobytes())
    return size


def link(source, target):
    """A hard link, or a symbolic one to another disk."""
    try:
        os.link(source, target)
    except OSError:
        target.symlink_to(source)


def copied_name(copy, name):
    return f"{copy:04d}_{name}"


def make_copies(scene, workspace, num_copies, sources):
    """Writes the workspace.

    sources: "listed" names each image's sources in patch-match.cfg, all others
    of its copy; "linked" sets the copies side by side and names one image of
    the copies to the right and below as well, so that the views are all
    connected and walls and floors continue from copy to copy; "auto" leaves the
    sources to be chosen by the points that they share.
    """
    grid = Grid(num_copies, sources)
    images = workspace / "images"
    stereo = workspace / "stereo"
    sparse = workspace / "sparse"
    for folder in (images, sparse, *(stereo / name for name in MAP_FOLDERS)):
        folder.mkdir(parents=True)
    for copy in range(num_copies):
        for image in scene.images:
            link((scene.root / "images" / image.name).resolve(),
                 images / copied_name(copy, image.name))
        for path in scene.maps:
            link((scene.reduced / path).resolve(),
                 stereo / path.parent / copied_name(copy, path.name))
    write_lists(scene, stereo, grid, sources)
    write_cameras(scene, sparse / "cameras.bin")
    write_images(scene, sparse / "images.bin", grid)
    write_points(scene, sparse / "points3D.bin", grid)


def write_lists(scene, stereo, grid, sources):
    names = [image.name for image in scene.images]
    lines = []
    for copy in range(grid.num_copies):
        for name in names:
            others = [copied_name(copy, other)
                      for other in names if other != name]
            if sources == "linked":
                others += [copied_name(other, name)
                           for other in grid.next_to(copy)]
            lines += [copied_name(copy, name),
                      "__auto__, 20" if sources == "auto"
                      else ", ".join(others)]
    (stereo / "patch-match.cfg").write_text("\n".join(lines) + "\n")
    (stereo / "fusion.cfg").write_text("\n".join(lines[::2]) + "\n")


def write_cameras(scene, path):
    with open(path, "wb") as file:
        file.write(np.uint64(len(scene.cameras)).tobytes())
        for camera in scene.cameras:
            model = camera[1]
            file.write(np.uint32(camera[0]).tobytes()
                       + np.int32(MODEL_IDS[model]).tobytes()
                       + np.array(camera[2:4], "<u8").tobytes()
                       + np.array(camera[4:4 + NUM_PARAMS[model]],
                                  "<f8").tobytes())


def write_images(scene, path, grid):
    with open(path, "wb") as file:
        file.write(np.uint64(len(scene.images) * grid.num_copies).tobytes())
        for copy in range(grid.num_copies):
            offset = scene.offset_of(copy, grid)
            image_shift, point_shift = scene.shifts_of(copy)
            for image in scene.images:
                keypoints = image.keypoints.copy()
                keypoints["point"][keypoints["point"] >= 0] += point_shift
                file.write(np.uint32(image.id + image_shift).tobytes()
                           + image.quaternion.tobytes()
                           + image.translation_at(offset).tobytes()
                           + np.uint32(image.camera_id).tobytes()
                           + copied_name(copy, image.name).encode() + b"\0"
                           + np.uint64(len(keypoints)).tobytes()
                           + keypoints.tobytes())


def write_points(scene, path, grid):
    with open(path, "wb") as file:
        file.write(np.uint64(len(scene.points.ids) * grid.num_copies).tobytes())
        for copy in range(grid.num_copies):
            image_shift, point_shift = scene.shifts_of(copy)
            file.write(scene.points.moved(
                point_shift, image_shift, scene.offset_of(copy, grid)))
