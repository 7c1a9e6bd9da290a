#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Runs chain on a small room whose scan is the cloud of the drawn maps, which a
stand-in for COLMAP's fusion makes, too: this way has an F1 of 1 and is measured
before the others, which have other clouds."""

import shutil
import subprocess
import sys
from pathlib import Path

from programs import run
from testing import check, programs_and_fresh_folder

CHAIN = Path(__file__).resolve().parent / "chain"


def main():
    program, maker, folder = programs_and_fresh_folder("program", "maker")
    scene, scans = folder / "room", folder / "room" / "scans"
    run([maker, "--workspace_path", scene, "--width", 160,
         "--height", 107, "--num_images", 4, "--num_sources", 3])
    scans.mkdir()
    (scans / "scan_alignment.mlp").write_text(
        '<!DOCTYPE MeshLabDocument><MeshLabProject><MeshGroup>'
        '<MLMesh label="s" filename="s.ply"><MLMatrix44>1 0 0 0 0 1 0 0 '
        '0 0 1 0 0 0 0 1</MLMatrix44></MLMesh></MeshGroup></MeshLabProject>')
    colmap = folder / "colmap"
    colmap.write_text(f"""#!/bin/sh
test "$1 $2 $4" = "stereo_fusion --workspace_path --output_path" || exit 3
exec '{program}' tsar_fuse --workspace_path "$3" --output_path "$5"
""")
    colmap.chmod(0o755)
    run([colmap, "stereo_fusion", "--workspace_path", scene,
         "--output_path", scans / "s.ply"])

    command = [sys.executable, CHAIN, scene, "--program", program,
               "--colmap", colmap, "--seeds", 2, "--device", "cpu"]
    output = run(command)
    print(output)
    table = output[output.index("### From photos to a cloud"):].splitlines()
    rows = {cells[0]: cells[1:] for cells in (
        [cell.strip() for cell in line.strip("|").split("|")]
        for line in table if line.startswith("| "))}
    ways = ["COLMAP", "COLMAP's maps, refined", "tsar_stereo, refined"]
    check(list(rows)[1:] == [*(f"room: {way}" for way in ways),
                             *(f"mean: {way}" for way in ways)],
          "each way has a row for the scene and one for the mean")
    check(rows["room: COLMAP"][:2] == ["1.000 ± 0.000"] * 2,
          "a cloud that is the scan has F1 1")
    for way, num_programs in zip(ways, (1, 2, 3)):
        first, second, seconds = rows[f"room: {way}"]
        check(0.1 < float(first.split()[0]) <= float(second.split()[0]) <= 1,
              "F1 rises with the tolerance")
        check(len(seconds.split(" + ")) == num_programs,
              f"{way}: seconds of {num_programs} programs")
        check(rows[f"mean: {way}"][0] == first.split()[0],
              "the mean of one scene is the scene's")

    shutil.rmtree(scene / "stereo" / "depth_maps")
    output = run(command)
    check("mean: tsar_stereo, refined" in output and
          "COLMAP's maps" not in output,
          "a scene without maps has the way from its photos alone")

    shutil.rmtree(scans)
    failed = subprocess.run([str(word) for word in command],
                            capture_output=True, text=True, check=False)
    check(failed.returncode == 1 and failed.stderr.startswith("ERROR: ") and
          "scan_alignment.mlp" in failed.stderr,
          "a scene without scans is one line of error")
    shutil.rmtree(folder)


if __name__ == "__main__":
    main()
