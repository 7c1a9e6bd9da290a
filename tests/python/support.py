# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of the Python module share. CMake says where things are."""
import hashlib
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

PROGRAM = os.environ["TSAR_PROGRAM"]
REPOSITORY = pathlib.Path(os.environ["TSAR_SOURCE_DIR"])
WORK_FOLDER = pathlib.Path(os.environ["TSAR_WORK_FOLDER"])
SKIPPED = 77  # CTest's SKIP_RETURN_CODE.


def run(*command, **options):
    """The standard output of a command that must succeed."""
    result = subprocess.run(
        [str(part) for part in command],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        **options,
    )
    if result.returncode != 0:
        raise AssertionError(
            f"failed: {' '.join(map(str, command))}\n{result.stdout}{result.stderr}"
        )
    return result.stdout


def run_program(*arguments):
    return run(PROGRAM, *arguments)


def python_with_numpy():
    for python in (sys.executable, "/usr/bin/python3"):
        if subprocess.run(
            [python, "-c", "import numpy"], stderr=subprocess.DEVNULL
        ).returncode == 0:
            return python
    raise AssertionError("no python3 with numpy: install python3-numpy")


def unpack_sample(folder):
    run(
        python_with_numpy(),
        REPOSITORY / "scripts" / "sample_scene.py",
        "unpack",
        REPOSITORY / "data" / "sample",
        folder,
    )


def keep_images(workspace, count):
    """Has only the first images of the sample refined; the rest are sources."""
    text = "".join(f"v{i:03d}.jpg\n__auto__, 20\n" for i in range(count))
    (workspace / "stereo" / "patch-match.cfg").write_text(text)


def digests(folder):
    """The content of every file below a folder, by relative path."""
    return {
        path.relative_to(folder).as_posix(): hashlib.sha256(
            path.read_bytes()
        ).hexdigest()
        for path in sorted(pathlib.Path(folder).rglob("*"))
        if path.is_file()
    }


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
        unpack_sample(cls.sample)
        keep_images(cls.sample, cls.num_images)

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(dir=self.class_folder))
        self.workspace = self.new_workspace("dense")

    def new_workspace(self, name):
        return pathlib.Path(shutil.copytree(self.sample, self.folder / name))
