#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Runs end_to_end on a small room and checks that its tables hold numbers, that
refining gained, and that what COLMAP's stereo would get is complete. Stand-ins
take the places of COLMAP and of nvidia-smi."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

from programs import CommandFailed, own_folder, run
from testing import check, programs_and_fresh_folder

NUM_IMAGES = 4


def score(program, workspace, truth):
    """F1 and recall of the geometric maps over all pixels."""
    text = run([program, "tsar_evaluate", "depth", "--workspace_path",
                workspace, "--ground_truth_path", truth, "--tolerances", "0.1",
                "--json", "1"])
    row = next(row for row in json.loads(text)["scores"]
               if row["area"] == "all")
    return row["f1"], row["recall"]


def write_stereo(path):
    """A stand-in for COLMAP: checks what it is given and writes no maps."""
    path.write_text("""#!/bin/sh
test "$2" = --workspace_path || exit 3
if test "$1" = stereo_fusion; then
  test -f "$3/stereo/depth_maps/00002.jpg.geometric.bin" || exit 6
  exit
fi
test "$1" = patch_match_stereo || exit 3
test -f "$3/images/00002.jpg" && test -f "$3/sparse/points3D.txt" || exit 4
test "$(wc -l < "$3/stereo/patch-match.cfg")" = 2 || exit 5
""")
    path.chmod(0o755)


def write_nvidia_smi(path):
    """A stand-in for nvidia-smi: the second GPU fills by 500 MiB."""
    path.write_text("""#!/bin/sh
case $1 in
  *memory*) ;;
  *) echo "Stand-in, 1.2"; exit ;;
esac
if test -e "$0.was_run"; then used=800; else used=300; fi
touch "$0.was_run"
printf '0, 40\\n1, %s\\n' $used
""")
    path.chmod(0o755)


def table(lines, title):
    """The rows of the table under this title: first cell -> other cells."""
    start = lines.index(title) + 4
    rows = {}
    for line in lines[start:]:
        if not line.startswith("|"):
            break
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        rows[cells[0]] = cells[1:]
    return rows


def run_end_to_end(program, maker, folder, *options):
    output = run([sys.executable,
                  Path(__file__).resolve().parent / "end_to_end",
                  "--program", program, "--maker", maker,
                  "--width", 160, "--height", 107, "--num_images", NUM_IMAGES,
                  "--num_sources", 3, "--repeat", 1, "--device", "cpu",
                  "--folder", folder, *options])
    print(output)
    return output.splitlines()


def check_own_folder(folder):
    """Checks that a folder with the user's files is not taken for results."""
    mine = folder / "mine"
    mine.mkdir()
    (mine / "stereo").write_text("years of work")
    try:
        own_folder(mine)
    except CommandFailed as failure:
        check("mine" in str(failure), f"own_folder tells: {failure}")
    else:
        check(False, "own_folder takes a folder of the user's")
    check(os.listdir(mine) == ["stereo"], "a folder of the user's stays")
    for _ in range(2):
        own_folder(folder / "results" / "room")
    check(True, "results are taken up again")


def main():
    program, maker, folder = programs_and_fresh_folder("program", "maker")
    check_own_folder(folder)
    stereo = folder / "colmap"
    write_stereo(stereo)
    write_nvidia_smi(folder / "nvidia-smi")
    os.environ["PATH"] = f"{folder}{os.pathsep}{os.environ['PATH']}"

    lines = run_end_to_end(program, maker, folder, "--keep", "--colmap", stereo)
    runs = table(lines, "### Whole runs")
    check(list(runs) == ["tsar_refine", "tsar_stereo", "tsar_fuse",
                         "patch_match_stereo, photometric pass",
                         "stereo_fusion"],
          "a row for each program of ours and of COLMAP's")
    images, seconds, _, speed, house, ratio, _, gpu, memory = runs["tsar_refine"]
    check(int(images) == NUM_IMAGES, "all images count")
    check(float(seconds) > 0 and float(speed) > 0 and float(ratio) == 1,
          "time and speed are positive, the ratio of the first run is 1")
    check(abs(float(house) - 500 / 60 * float(seconds)) < 0.06,
          "500 images take as long as 500 times one")
    check(float(memory) > 1, "the memory is that of a program")
    check(int(gpu) == 500, "the GPU memory is what came on top")
    check("GPUs: Stand-in, driver 1.2" in lines, "the GPU has a name")
    stages = table(lines, "### Seconds per image by stage")
    check(float(stages["matching"][0]) > 0, "stages have times")

    workspaces = Path(lines[-1].removeprefix("workspaces: "))
    truth = workspaces / "room" / "ground_truth" / "depth"
    before = score(program, workspaces / "room", truth)
    after = score(program, workspaces / "refined", truth)
    print("F1 and recall:", before, after)
    check(before[0] > 0.1, "the drawn maps are right in places")
    check(after[0] > before[0] + 0.05 and after[1] > before[1] + 0.05,
          "F1 and recall rise by over 0.05")

    lines = run_end_to_end(program, maker, folder / "in_place", "--in_place",
                           "--repeat", 2)
    check("tsar_refine" in table(lines, "### Whole runs"),
          "two runs in place give a table")
    check(not list((folder / "in_place").iterdir()),
          "without --keep nothing is left")

    failed = subprocess.run(
        [sys.executable, Path(__file__).resolve().parent / "end_to_end",
         "--program", folder / "missing"], capture_output=True, text=True,
        check=False)
    check(failed.returncode == 1 and failed.stderr.startswith("ERROR: ") and
          len(failed.stderr.splitlines()) == 1,
          "a missing program is one line of error")
    shutil.rmtree(folder)


if __name__ == "__main__":
    main()
