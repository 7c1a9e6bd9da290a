# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Builds the wheel from pyproject.toml, installs it into a new virtual environment
and uses it there, with nothing else on the path. Skipped where what it is built by
cannot be had from the package index. The scores of point clouds are left out of it,
which scripts/build_wheels.sh leaves in.

  wheel_test.py BUILD_FOLDER [NAME=VALUE of CMake]..."""
import os
import re
import shutil
import sys
import zipfile

from sample_testing import check, run, skip, unpack_small
from support import REPOSITORY, WORK_FOLDER, new_folder
from virtual_environment import VirtualEnvironment

USE = """
import json, pathlib, sys
import colmap_tsar
assert pathlib.Path(colmap_tsar.__file__).is_relative_to(sys.prefix)
summary = colmap_tsar.refine(
    sys.argv[1], scene_planes=False, num_iterations=1, progress=False)
assert summary.num_refined == 8, summary
try:
    colmap_tsar.evaluate_cloud(sys.argv[1] + "/a.ply", sys.argv[1] + "/scans.mlp")
except colmap_tsar.UnsupportedError as error:
    assert "TSAR_CLOUD_EVALUATION=ON" in str(error), error
else:
    raise AssertionError("a cloud was scored, or read")
scores = colmap_tsar.evaluate_depth(sys.argv[1]).scores
assert colmap_tsar.restore(sys.argv[1]).num_restored == 8
assert scores[0].f1 > colmap_tsar.evaluate_depth(sys.argv[1]).scores[0].f1
print(json.dumps([colmap_tsar.__version__, colmap_tsar.has_cuda]))
"""


def build_requirements():
    """As pyproject.toml has them; Python knows TOML from 3.11 on only."""
    text = (REPOSITORY / "pyproject.toml").read_text()
    return re.findall(r'"([^"]+)"', re.search(r"requires = \[(.*)\]", text)[1])


def main(build_folder, definitions):
    builder = VirtualEnvironment(WORK_FOLDER / "build_environment")
    if not builder.install(*build_requirements()):
        skip("the build's packages cannot be had from the package index")
    folder = new_folder()
    try:
        # In the environment that is there, so that nothing is fetched again.
        status, output = builder.pip(
            *("wheel", "--no-build-isolation", "--no-deps", "--verbose"),
            *("--wheel-dir", folder / "wheel"),
            f"--config-settings=build-dir={build_folder}",
            *(f"--config-settings=cmake.define.{text}" for text in definitions),
            REPOSITORY,
        )
        if status != 0:
            sys.exit(f"FAILED: pip wheel\n{output}")
        wheels = list((folder / "wheel").iterdir())
        check(len(wheels) == 1, f"one wheel: {wheels[0].name}")
        names = zipfile.ZipFile(wheels[0]).namelist()
        roots = {name.split("/")[0] for name in names}
        version = wheels[0].name.split("-")[1]
        check(roots == {"colmap_tsar", f"colmap_tsar-{version}.dist-info"},
              "holds the package and nothing else")
        for name in ("py.typed", "__init__.py", "_keywords.py"):
            check(f"colmap_tsar/{name}" in names, "holds " + name)

        user = VirtualEnvironment.with_wheel(folder / "user", wheels[0])
        unpack_small(REPOSITORY, folder / "dense")
        environment = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}
        printed = run(user.python, "-I", "-c", USE, folder / "dense", env=environment)
        check(f'["{version}", ' in printed, f"works when installed: {printed.strip()}")
        text = (REPOSITORY / "CMakeLists.txt").read_text()
        check(f"VERSION {version} " in text, "has the project's version")
    finally:
        shutil.rmtree(folder)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])
