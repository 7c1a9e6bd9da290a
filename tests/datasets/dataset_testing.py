# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""The sample scene in the layouts of the data sets, and how the tests run the
scripts on it. The environment names the program, COLMAP, the repository and a
folder to work in."""
import json
import os
import pathlib
import shutil
import subprocess
import sys
import unittest

REPOSITORY = pathlib.Path(os.environ["TSAR_SOURCE_DIR"])
# Scripts that begin with "env python3" get this interpreter directly, not
# through a version manager, which takes longer than the stand-ins themselves.
os.environ["PATH"] = os.pathsep.join((os.path.dirname(sys.executable), os.environ["PATH"]))

PROGRAM = os.environ["TSAR_PROGRAM"]
COLMAP = os.environ["TSAR_COLMAP"]
sys.path[:0] = [str(REPOSITORY / "scripts" / "datasets"), str(REPOSITORY / "scripts"),
                str(REPOSITORY / "tests" / "sample")]

import numpy as np  # pylint: disable=wrong-import-position
from files import DatasetError  # pylint: disable=wrong-import-position
from model import read_cameras, read_images  # pylint: disable=wrong-import-position
from ply import read_ply, write_points  # pylint: disable=wrong-import-position
from sample_testing import digests, gray_png, unpack  # pylint: disable=wrong-import-position

# Long side of the maps: stereo on two cores takes a few seconds.
MAP_SIZE = 80
NUM_IMAGES = 5


class Sample:
    """The sample scene: a COLMAP workspace with scans."""

    def __init__(self, folder):
        unpack(str(REPOSITORY), str(folder))
        self.folder = folder
        self.cameras = read_cameras(folder / "sparse" / "cameras.txt")
        self.images = read_images(folder / "sparse" / "images.txt")[:NUM_IMAGES]
        self.names = [image.name for image in self.images]

    def camera(self, image):
        return self.cameras[image.camera_id]

    def copy_images(self, folder):
        folder.mkdir(parents=True)
        for name in self.names:
            shutil.copyfile(self.folder / "images" / name, folder / name)

    def scan_points(self):
        """All scans in the frame of the world."""
        project = (self.folder / "scans" / "scan_alignment.mlp").read_text(encoding="utf-8")
        clouds = []
        for part in project.split('filename="')[1:]:
            name = part[:part.index('"')]
            numbers = part[part.index("<MLMatrix44>") + 12:part.index("</MLMatrix44>")]
            matrix = np.array(numbers.split(), float).reshape(4, 4)
            points = read_ply(self.folder / "scans" / name).points
            clouds.append(points @ matrix[:3, :3].T + matrix[:3, 3])
        return np.concatenate(clouds)


def make_eth3d(sample, scene, with_scans=True):
    """As the benchmark ships it: names with their folder, comments, and points
    with tracks of the existing images only."""
    sample.copy_images(scene / "images" / "dslr_images_undistorted")
    calibration = scene / "dslr_calibration_undistorted"
    calibration.mkdir()
    sparse = sample.folder / "sparse"
    comment = "# List with one line of data per item:\n"
    (calibration / "cameras.txt").write_text(comment + (sparse / "cameras.txt").read_text())
    lines = (sparse / "images.txt").read_text().split("\n")[:2 * NUM_IMAGES]
    for i in range(0, len(lines), 2):
        head, name = lines[i].rsplit(" ", 1)
        lines[i] = f"{head} dslr_images_undistorted/{name}"
    ids = {str(image.image_id) for image in sample.images}
    points = ""
    for line in (sparse / "points3D.txt").read_text().splitlines():
        words = line.split()
        track = [t for t in zip(words[8::2], words[9::2]) if t[0] in ids]
        if line.startswith("#") or len(track) < 2:
            continue
        points += " ".join(words[:8] + [word for t in track for word in t]) + "\n"
    kept = {line.split()[0] for line in points.splitlines()}
    for i in range(1, len(lines), 2):
        words = lines[i].split()
        for j in range(2, len(words), 3):
            words[j] = words[j] if words[j] in kept else "-1"
        lines[i] = " ".join(words)
    (calibration / "images.txt").write_text(comment + "\n".join(lines) + "\n")
    (calibration / "points3D.txt").write_text(comment + points)
    if with_scans:
        shutil.copytree(sample.folder / "scans", scene / "dslr_scan_eval")


def make_strecha(sample, scene):
    sample.copy_images(scene / "images")
    (scene / "gt_dense_cameras").mkdir()
    for image in sample.images:
        fx, fy, cx, cy = sample.camera(image).params
        rows = [[fx, 0, cx], [0, fy, cy], [0, 0, 1], [0, 0, 0],
                *image.pose.rotation.T.tolist(), image.pose.center().tolist()]
        text = "".join(" ".join(repr(float(v)) for v in row) + "\n" for row in rows)
        camera = sample.camera(image)
        (scene / "gt_dense_cameras" / f"{image.name}.camera").write_text(
            f"{text}{camera.width} {camera.height}\n")


def make_tanks_and_temples(sample, scene, with_poses=True, truth_from_world=None):
    """truth_from_world: the matrix from the poses' frame to the ground truth's."""
    sample.copy_images(scene / "images")
    if with_poses:
        text = ""
        for index, image in enumerate(sample.images):
            rows = image.pose.world_from_camera()
            text += f"{index} {index} 0\n"
            text += "".join(" ".join(repr(float(v)) for v in row) + "\n" for row in rows)
        (scene / f"{scene.name}_COLMAP_SfM.log").write_text(text)
    if truth_from_world is not None:
        points = sample.scan_points()
        points = points @ truth_from_world[:3, :3].T + truth_from_world[:3, 3]
        write_points(scene / f"{scene.name}.ply", points)
        np.savetxt(scene / f"{scene.name}_trans.txt", truth_from_world)
        low, high = points.min(0) - 1, points.max(0) + 1
        polygon = [[low[0], low[1], 0], [high[0], low[1], 0],
                   [high[0], high[1], 0], [low[0], high[1], 0]]
        (scene / f"{scene.name}.json").write_text(json.dumps(
            {"axis_max": high[2], "axis_min": low[2], "bounding_polygon": polygon,
             "class_name": "SelectionPolygonVolume", "orthogonal_axis": "Z"}))


def write_gray_png(path, pixels):
    """pixels: height x width, 8 bits."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(gray_png([row.tobytes() for row in np.asarray(pixels, np.uint8)]))


class FolderTest(unittest.TestCase):
    """Has a folder of its own, empty before each test."""

    def setUp(self):
        self.root = pathlib.Path(os.environ["TSAR_WORK_FOLDER"]) / type(self).__name__
        shutil.rmtree(self.root, ignore_errors=True)
        self.root.mkdir(parents=True)

    def write(self, name, text):
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        return path

    def rejects(self, text, function, *arguments):
        """Checks that a call is refused by one line that contains this text."""
        with self.assertRaises(DatasetError) as caught:
            function(*arguments)
        self.assertIn(text, str(caught.exception))
        self.assertNotIn("\n", str(caught.exception))

    def rejects_changes(self, good, read, cases):
        """Checks that a good text is refused once a part of it is replaced.
        cases: (text of the error, part, replacement)."""
        path = self.write("changed", good)
        read(path)
        for text, old, new in cases:
            with self.subTest(text=text, old=old):
                self.assertIn(old, good)
                path.write_text(good.replace(old, new))
                self.rejects(text, read, path)


def check_one_line(test, result, text):
    """Ended with exactly one line, which contains this text."""
    test.assertEqual(result.returncode, 1, result.stdout + result.stderr)
    test.assertEqual(result.stderr.count("\n"), 1, result.stderr)
    test.assertTrue(result.stderr.startswith("ERROR: "), result.stderr)
    test.assertIn(text, result.stderr)


class DatasetTest(unittest.TestCase):
    """Runs a script of scripts/ on folders below its own."""

    script = ""  # A class names its own.

    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(os.environ["TSAR_WORK_FOLDER"]) / cls.__name__
        shutil.rmtree(cls.folder, ignore_errors=True)
        cls.folder.mkdir(parents=True)
        cls.sample = Sample(cls.folder / "sample")

    def command(self, *arguments):
        return [str(part) for part in (
            REPOSITORY / "scripts" / f"{self.script}.sh", "--colmap", COLMAP,
            "--colmap_tsar", PROGRAM, "--max_image_size", MAP_SIZE, *arguments)]

    def call(self, *arguments):
        return subprocess.run(self.command(*arguments), stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True)

    def run_well(self, *arguments):
        result = self.call(*arguments)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        return result.stdout

    def fails(self, *arguments, text):
        check_one_line(self, self.call(*arguments), text)

    def fails_of_changes(self, scene, options, cases):
        """Checks that copies of a scene with one changed file are refused, and
        nothing is written. cases: (file, part of its text or None to remove the
        file, replacement, text of the error)."""
        output = self.folder / "nothing"
        for number, (file, old, new, text) in enumerate(cases):
            copy = self.folder / f"damaged{number}" / scene.name
            shutil.copytree(scene, copy)
            if old is None:
                (copy / file).unlink()
            else:
                content = (copy / file).read_text()
                self.assertIn(old, content)
                (copy / file).write_text(content.replace(old, new, 1))
            self.fails(copy, "--output_path", output, *options, text=text)
        self.assertFalse(output.exists())

    def files_of(self, folder):
        """Content of all files, and when they were written."""
        times = {str(p.relative_to(folder)): p.stat().st_mtime_ns
                 for p in folder.rglob("*") if p.is_file()}
        return digests(folder), times

    def check_workspace(self, workspace, prefix=""):
        names = [prefix + name for name in self.sample.names]
        stereo = workspace / "stereo"
        self.assertEqual(sorted((stereo / "fusion.cfg").read_text().split()), names)
        lines = (stereo / "patch-match.cfg").read_text().splitlines()
        self.assertEqual(sorted(lines[::2]), names)
        self.assertEqual(set(lines[1::2]), {"__auto__, 20"})
        for name in names:
            self.assertTrue((workspace / "images" / name).is_file())
            for kind in ("depth_maps", "normal_maps"):
                self.assertTrue((stereo / kind / f"{name}.geometric.bin").is_file(), name)

    def check_poses(self, images, tolerance, prefix=""):
        """Poses of images against the sample's."""
        images = sorted(images, key=lambda image: image.name)
        self.assertEqual([i.name for i in images], [prefix + n for n in self.sample.names])
        for image, given in zip(images, self.sample.images):
            np.testing.assert_allclose(image.pose.rotation, given.pose.rotation,
                                       rtol=0, atol=tolerance)
            np.testing.assert_allclose(image.pose.center(), given.pose.center(),
                                       rtol=0, atol=tolerance)


def vertex_count(path):
    return len(read_ply(path).points)
