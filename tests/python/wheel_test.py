# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Builds the wheel from pyproject.toml, installs it into a new virtual
environment and uses it there, with nothing else on the path. Skipped if its
build requirements are not available from the package index. It omits the scores
of point clouds, which scripts/build_wheels.sh includes.

  wheel_test.py BUILD_FOLDER [NAME=VALUE of CMake]..."""
import re
import shutil
import sys
import zipfile

from portable_wheel import check_use
from sample_testing import check, skip
from support import REPOSITORY, WORK_FOLDER, new_folder
from virtual_environment import VirtualEnvironment


def build_requirements():
    """As pyproject.toml has them; Python reads TOML only from 3.11 on."""
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

        found = check_use(wheels[0], folder)
        check("TSAR_CLOUD_EVALUATION=ON" in str(found["points"]), "clouds are left out of it")
        text = (REPOSITORY / "CMakeLists.txt").read_text()
        check(f"VERSION {version} " in text, "has the project's version")
    finally:
        shutil.rmtree(folder)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])
