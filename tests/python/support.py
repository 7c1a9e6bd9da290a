# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of the Python module share. CMake says where things are."""
import os
import pathlib
import shutil
import tempfile
import unittest

import colmap_tsar
from sample_testing import gray_png, keep_images, run, unpack_small

PROGRAM = os.environ["TSAR_PROGRAM"]
REPOSITORY = pathlib.Path(os.environ["TSAR_SOURCE_DIR"])
WORK_FOLDER = pathlib.Path(os.environ["TSAR_WORK_FOLDER"])
WORK_FOLDER.mkdir(parents=True, exist_ok=True)
WIDTH, HEIGHT = 240, 180  # Of the maps; photos are 640 x 480.
# Options of refine() that leave out what takes most of the time.
QUICK = {"scene_planes": False, "segment": False, "num_iterations": 1}
# The same with the planes of the scene.
PLANES = {"segment": False, "num_iterations": 1}


def run_program(*arguments):
    return run(PROGRAM, *arguments)


def words_of(options, group=""):
    """The options of a command that these keywords stand for."""
    words = []
    for name, value in options.items():
        value = ",".join(map(str, value)) if isinstance(value, (list, tuple)) else value
        words += [f"--{group}{name}", int(value) if isinstance(value, bool) else value]
    return words


def new_folder():
    return pathlib.Path(tempfile.mkdtemp(dir=WORK_FOLDER))


def write_black_mask(path, width, height):
    path.parent.mkdir()
    path.write_bytes(gray_png([bytes(width)] * height))


def read_map(path):
    """A file of COLMAP's, as height x width x channels."""
    import numpy as np

    width, height, channels, body = path.read_bytes().split(b"&", 3)
    shape = int(channels), int(height), int(width)
    return np.frombuffer(body, "<f4").reshape(shape).transpose(1, 2, 0)


class SampleTest(unittest.TestCase):
    """Gives every test workspaces of its own: copies of the sample scene, with small
    maps."""

    num_images = 3

    @classmethod
    def setUpClass(cls):
        cls.class_folder = new_folder()
        cls.addClassCleanup(shutil.rmtree, cls.class_folder)
        cls.sample = cls.class_folder / "sample"
        unpack_small(REPOSITORY, cls.sample)
        keep_images(cls.sample, cls.num_images)

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(dir=self.class_folder))
        self.workspace = self.new_workspace("dense")

    def new_workspace(self, name, source=None):
        return pathlib.Path(shutil.copytree(source or self.sample, self.folder / name))


class RefinedTest(SampleTest):
    """Has a refined copy, too, which is not to be changed."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.refined = cls.class_folder / "refined"
        shutil.copytree(cls.sample, cls.refined)
        colmap_tsar.refine(cls.refined, device="cpu", progress=False)
