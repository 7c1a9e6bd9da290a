# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Looks at a wheel that scripts/build_wheels.sh has built, and uses it in a new
virtual environment: it needs nothing from the system but the C and C++ run
time, and writes the maps that the program writes. What holds for any wheel is a
function for wheel_test.py.

  portable_wheel.py WHEEL"""
import json
import os
import pathlib
import re
import shutil
import sys
import zipfile

from sample_testing import check, results, run, unpack_small
from support import REPOSITORY, new_folder, run_program
from virtual_environment import VirtualEnvironment

MOST_LIBRARIES = 12
UNWANTED = re.compile(r"gdal|hdf5|mpi|gtk|Qt|tbb|protobuf|blas|lapack|gfortran|cuda")
# What every Linux that can run Python has.
RUN_TIME = re.compile(
    r"(ld-linux-[^/]*|libc|libm|libdl|librt|libpthread|libgcc_s|libstdc\+\+|libz)\.so[.\d]*"
)

USE = """
import json, pathlib, sys, time

def libraries():
    lines = pathlib.Path("/proc/self/maps").read_text().splitlines()
    return {line.split(maxsplit=5)[5] for line in lines if ".so" in line}

# What the standard library loads is none of ours.
import ctypes, dataclasses, typing, zipfile
before = libraries()
start = time.perf_counter()
import colmap_tsar
seconds = time.perf_counter() - start
sample = pathlib.Path(sys.argv[1])
before_score = colmap_tsar.evaluate_depth(sample).scores[0].f1
summary = colmap_tsar.refine(sample, device="cpu", progress=False)
after_score = colmap_tsar.evaluate_depth(sample).scores[0].f1
scans = sample / "scans" / "scan_alignment.mlp"
try:
    points = colmap_tsar.evaluate_cloud(next(scans.parent.glob("*.ply")), scans).num_points
except colmap_tsar.UnsupportedError as error:
    points = str(error)
print(json.dumps({
    "file": colmap_tsar.__file__,
    "has_cuda": colmap_tsar.has_cuda,
    "libraries": sorted(libraries() - before),
    "num_refined": summary.num_refined,
    "points": points,
    "scores": [before_score, after_score],
    "seconds": seconds,
}))
"""


def check_content(wheel):
    archive = zipfile.ZipFile(wheel)
    names = archive.namelist()
    bundled = [os.path.basename(name) for name in names if re.search(r"\.libs/.*\.so", name)]
    check("-manylinux_" in wheel.name, f"{wheel.name} has a tag of manylinux")
    check(
        len(bundled) <= MOST_LIBRARIES and not any(map(UNWANTED.search, bundled)),
        f"{len(bundled)} libraries are inside beside the module: {bundled}",
    )
    licenses = [name for name in names if "/licenses/" in name]
    check(any(name.endswith("/opencv") for name in licenses),
          f"{len(licenses)} licenses are inside")
    print(f"{wheel.stat().st_size / 1e6:.1f} MB")


def check_use(wheel, folder):
    """Returns what a process reports that uses the installed wheel."""
    user = VirtualEnvironment.with_wheel(folder / "user", wheel)
    unpack_small(REPOSITORY, folder / "dense")
    shutil.copytree(folder / "dense", folder / "expected")
    # Nothing from this shell, such as a library path.
    environment = {"PATH": os.environ["PATH"], "HOME": str(folder)}
    printed = run(user.python, "-I", "-c", USE, folder / "dense", env=environment)
    found = json.loads(printed)
    inside = str(user.folder.resolve())
    check(found["file"].startswith(inside), f"imported in {found['seconds']:.3f} s")
    check(found["num_refined"] == 8, "refines the sample scene")
    check(found["scores"][1] > found["scores"][0] + 0.1, f"F1: {found['scores']}")
    run_program("tsar_refine", "--workspace_path", folder / "expected", "--TsarRefine.device", "cpu")
    maps = results(folder / "dense")
    check(len(maps) > 16, f"{len(maps)} files of maps")
    different = sorted(path for path, digest in results(folder / "expected").items()
                       if maps.get(path) != digest)
    check(not different, f"the program's maps are the same, but for {different}")
    found["outside"] = [path for path in found["libraries"] if not path.startswith(inside)]
    return found


def main(wheel):
    folder = new_folder()
    try:
        check_content(wheel)
        found = check_use(wheel, folder)
        check(found["points"] > 0, f"scores a cloud of {found['points']} points")
        check(found["has_cuda"] == ("_cuda" in wheel.name), f"has_cuda: {found['has_cuda']}")
        outside = found["outside"]
        foreign = [path for path in outside if not RUN_TIME.fullmatch(os.path.basename(path))]
        check(not foreign, f"of the system's libraries only {outside} and not {foreign}")
    finally:
        shutil.rmtree(folder)


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]))
