# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of the Python module share. CMake says where things are."""
import os
import pathlib
import shutil
import struct
import tempfile
import unittest
import zlib

from sample_testing import digests, run, unpack

PROGRAM = os.environ["TSAR_PROGRAM"]
REPOSITORY = pathlib.Path(os.environ["TSAR_SOURCE_DIR"])
WORK_FOLDER = pathlib.Path(os.environ["TSAR_WORK_FOLDER"])
SKIPPED = 77  # CTest's SKIP_RETURN_CODE.
# Options of refine() that leave out what takes most of the time.
QUICK = {"scene_planes": False, "segment": False, "num_iterations": 1}
# The same with the planes of the scene.
PLANES = {"segment": False, "num_iterations": 1}


def run_program(*arguments):
    return run(PROGRAM, *arguments)


def keep_images(workspace, count):
    """Has only the first images of the sample refined; the rest are sources."""
    text = "".join(f"v{i:03d}.jpg\n__auto__, 20\n" for i in range(count))
    (workspace / "stereo" / "patch-match.cfg").write_text(text)


def write_black_mask(path, width, height):
    """A gray PNG file of zeros, in a new folder."""

    def chunk(kind, data):
        body = kind + data
        return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))

    path.parent.mkdir()
    path.write_bytes(
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0))
        + chunk(b"IDAT", zlib.compress(bytes((width + 1) * height)))
        + chunk(b"IEND", b"")
    )


def results(workspace):
    """The digests of all that depends on the input and the options alone."""
    return {
        path: digest
        for path, digest in digests(workspace).items()
        if path.startswith("stereo/") and not path.startswith("stereo/tsar/")
    }


class SampleTest(unittest.TestCase):
    """Gives every test workspaces of its own: copies of the sample scene."""

    num_images = 3

    @classmethod
    def setUpClass(cls):
        WORK_FOLDER.mkdir(parents=True, exist_ok=True)
        cls.class_folder = pathlib.Path(tempfile.mkdtemp(dir=WORK_FOLDER))
        cls.addClassCleanup(shutil.rmtree, cls.class_folder)
        cls.sample = cls.class_folder / "sample"
        unpack(REPOSITORY, cls.sample)
        keep_images(cls.sample, cls.num_images)

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(dir=self.class_folder))
        self.workspace = self.new_workspace("dense")

    def new_workspace(self, name):
        return pathlib.Path(shutil.copytree(self.sample, self.folder / name))
