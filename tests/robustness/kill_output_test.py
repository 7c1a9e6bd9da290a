#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Kills tsar_refine --output_path before each call by which it changes files: the
input stays as it is, and the same command goes on to the same output."""
import os
import shutil

from robustness import (Program, check, check_same, copy, difference, make_folder, parse_arguments,
                        read_tree, without_accounts)
from start_workspaces import StartWorkspaces

# Once maps are refined, as in place: one kill of so many.
STEP = 5

args = parse_arguments("shim")
program = Program(args.program, args.shim)
folder = make_folder(args.folder)
work, output = (os.path.join(folder.name, name) for name in ("work", "output"))
start = StartWorkspaces(folder.name)
start.make(program)
REFINE = ["tsar_refine", work, "--output_path", output]


def read_input():
    """Beside the notes that a run makes there."""
    return {path: content for path, content in read_tree(work).items()
            if not path.startswith("stereo/tsar/")}


copy(start.mapped, work)
first = read_input()
program.run(*REFINE)
last = without_accounts(read_tree(output))
check(any(path.startswith("stereo/depth_maps/") for path in difference(last, first)),
      "the output has other maps")

num_kills = 0
step = 1
kill_at = 1
while True:
    copy(start.mapped, work)
    shutil.rmtree(output, ignore_errors=True)
    code, errors = program.call(*REFINE, kill_at=kill_at)
    if code == 0:
        break
    at = f"kill {kill_at}"
    check(code == -9, f"{at} ended with {code}: {errors}")
    num_kills += 1
    check_same(read_input(), first, at)
    if os.path.exists(os.path.join(output, "stereo", "confidence_maps")):
        step = STEP
    program.run(*REFINE)
    check_same(without_accounts(read_tree(output)), last, f"{at}: after going on")
    check_same(read_input(), first, f"{at}: after going on")
    kill_at += step
check(num_kills >= 30, f"only {num_kills} kills")
print(f"{num_kills} kills")
