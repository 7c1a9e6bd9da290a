# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""What the servers of the benchmarks take: whole sets, within limits."""
import os
import shutil
import subprocess

import ply
from files import DatasetError

# ETH3D's limits, of a cloud and of all files together.
MAX_POINTS = 50_000_000
MAX_BYTES = 12 * 10**9


def check_set(option, scenes, given):
    """That the scenes of a set are all among the given ones, before any of them is
    worked on. option: how the set was named, for the error."""
    missing = sorted(set(scenes) - set(given))
    if missing:
        raise DatasetError(f"{option}: {len(missing)} of {len(scenes)} scenes are missing, "
                           f"{', '.join(missing)}; put them into the folder of SCENES")


def check_times(seconds):
    """That it is known how long each scene took. seconds: name -> time or None."""
    missing = sorted(name for name, time in seconds.items() if time is None)
    if missing:
        raise DatasetError("--submit: a submission tells how long a scene took, and it is not "
                           f"known how long the maps of {', '.join(missing)} did; write the line "
                           "runtime SECONDS into MAPS/SCENE/runtime.txt, or let the script make "
                           "the maps")


def put_into(folder, source, name, max_points=None):
    """Copies a file into a submission, whole or not at all; a cloud of more points than
    max_points is thinned. Returns what was done, in words."""
    folder.mkdir(parents=True, exist_ok=True)
    part = folder / f"{name}.part"
    count = ply.count(source, "vertex") if max_points else 0
    if max_points and count > max_points:
        ply.thin(source, part, max_points)
        done = f"{name}: thinned evenly from {count} to {max_points} points, the most that is taken"
    else:
        shutil.copyfile(source, part)
        done = ""
    os.replace(part, folder / name)
    return done


def points_within(clouds, max_bytes):
    """The largest number of points per cloud with which all fit. clouds: pairs of a
    number of points and the bytes of one."""
    low, high = 0, max(count for count, _ in clouds)
    while low < high:
        middle = (low + high + 1) // 2
        if sum(min(count, middle) * size for count, size in clouds) <= max_bytes:
            low = middle
        else:
            high = middle - 1
    return low


def pack(archive, folder, names):
    """Writes a 7z archive of files of a folder; it appears when it is complete."""
    cmake = shutil.which("cmake")
    if not cmake:
        raise DatasetError(f"{archive}: cannot be written without cmake, which packs it; install "
                           f"it, or pack {archive.stem} in {folder} yourself")
    part = archive.with_name(archive.name + ".part")
    # It is read back: cmake says nothing of a full disk.
    for words in (["cf", str(part), "--format=7zip", *names], ["tf", str(part)]):
        done = subprocess.run([cmake, "-E", "tar", *words], cwd=folder, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        lines = done.stdout.strip().splitlines()
        if done.returncode != 0 or (words[0] == "tf" and sorted(lines) != sorted(names)):
            part.unlink(missing_ok=True)
            raise DatasetError(f"{archive}: is not whole; see that its disk has room; cmake -E tar "
                               f"says '{(lines or ['nothing'])[-1][:200]}'")
    os.replace(part, archive)
