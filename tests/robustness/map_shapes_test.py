#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Gives the commands maps that are not of their images' shape, such as
transposed ones: they end with one line that names the map, and change nothing."""
import os

import synthetic_workspace
from synthetic_workspace import HEIGHT, NAMES, WIDTH
from robustness import (Program, check, check_same, copy, make_folder, parse_arguments, read_tree)
from start_workspaces import STEREO, StartWorkspaces

args = parse_arguments()
program = Program(args.program)
folder = make_folder(args.folder)
work = os.path.join(folder.name, "work")
start = StartWorkspaces(folder.name)
REFINE = ["tsar_refine", work]
REPORT = ["tsar_report", work, "--report_path", os.path.join(folder.name, "page")]
IMAGE = NAMES[1]


def put(path, width, height, num_channels):
    """A wall, as a map of this size."""
    channels = [[0.0] * (width * height) for _ in range(num_channels)]
    channels[-1] = [5.0 if num_channels == 1 else -1.0] * (width * height)
    synthetic_workspace.write(os.path.join(work, path),
                          synthetic_workspace.map_file(channels, width, height))


def put_maps(kind, width, height, root="stereo"):
    put(f"{root}/depth_maps/{IMAGE}.{kind}.bin", width, height, 1)
    put(f"{root}/normal_maps/{IMAGE}.{kind}.bin", width, height, 3)


def fails(case, command, *texts):
    before = read_tree(work)
    program.fails_with_one_line(*command, texts=texts)
    check_same(read_tree(work), before, case)


start.make(program)
SHAPES = ((HEIGHT, WIDTH), (4000, 2), (WIDTH, HEIGHT - 4), (WIDTH // 2, HEIGHT))
num_cases = 0
for width, height in SHAPES:
    told = (IMAGE, f"has {width} x {height} pixels", f"of {WIDTH} x {HEIGHT};")
    copy(start.mapped, work)
    put_maps("photometric", width, height)
    fails(f"photometric maps of {width} x {height}", REFINE, "depth_maps", "photometric", *told)
    put_maps("geometric", width, height)
    fails(f"maps of {width} x {height}", REFINE, "depth_maps", "geometric", *told)
    # Of an image that is only a source.
    synthetic_workspace.write(os.path.join(work, "stereo", "patch-match.cfg"),
                          f"{NAMES[0]}\n__all__\n".encode())
    fails("maps of a source", REFINE, *told)
    # What is kept of a map before its refinement.
    copy(start.refined, work)
    put_maps("geometric", width, height, os.path.join("stereo", "tsar", "original"))
    for command in (REFINE, REPORT):
        fails(f"stored originals in {command[0]}", command, "this is not the original of",
              f"{IMAGE}.geometric.bin")
    copy(start.mapped, work)
    put(f"stereo/cost_maps/{IMAGE}.geometric.bin", width, height, 2)
    fails("costs", REFINE, "cost_maps", *told)
    num_cases += 6

# Half of an image's size is its shape, rounded or not.
for width, height in ((WIDTH // 2, HEIGHT // 2), (37, 28), (2 * WIDTH, 2 * HEIGHT)):
    copy(start.mapped, work)
    for kind in ("geometric", "photometric"):
        put_maps(kind, width, height)
    program.run(*REFINE)
    num_cases += 1

# A report of maps that were replaced after their refinement.
copy(start.refined, work)
put(f"stereo/normal_maps/{IMAGE}.geometric.bin", WIDTH // 2, HEIGHT // 2, 3)
program.fails_with_one_line(*REPORT, texts=[f"{IMAGE}.geometric.bin"])

# Ground truth of another shape scores nothing.
copy(start.mapped, work)
put(f"ground_truth/depth/{IMAGE}.bin", HEIGHT, WIDTH, 1)
code, errors = program.evaluate(work)
check(code == 1 and errors.count("\n") == 1 and f"{IMAGE}.geometric.bin: has {WIDTH} x {HEIGHT}"
      in errors and f"ground truth of {HEIGHT} x {WIDTH}" in errors, errors)

# tsar_stereo does not take maps for its own that it made of larger images.
copy(start.bare, work)
STEREO_COMMAND = ["tsar_stereo", work, *STEREO]
program.run(*STEREO_COMMAND)
put_maps("photometric", WIDTH // 2, HEIGHT // 2)
fails("maps of another size", STEREO_COMMAND, "--overwrite 1")
program.run(*STEREO_COMMAND, "--overwrite", 1)
for view in range(2):
    with open(os.path.join(work, f"stereo/depth_maps/{NAMES[view]}.photometric.bin"), "rb") as file:
        check(file.read().startswith(f"{WIDTH}&{HEIGHT}&1&".encode()), "maps are made anew")
print(f"{num_cases + 3} cases")
