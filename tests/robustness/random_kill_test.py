#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Kills tsar_refine on two threads at random moments, several times in a row on
one workspace. Each time every map is the original or the refined one and the
originals are there; in the end the bytes are those of an undisturbed run."""
import os
import random
import time

import synthetic_workspace
from robustness import (Program, check, check_same, copy, make_folder, maps_of, parse_arguments,
                        read_tree, without_accounts)

SEED = 20240607
NUM_IMAGES = 4
NUM_KILLS = 60

args = parse_arguments()
program = Program(args.program)
folder = make_folder(args.folder)
before, work = (os.path.join(folder.name, name) for name in ("before", "work"))
command = ("tsar_refine", work, "--TsarRefine.num_threads", 2)

synthetic_workspace.draw(before, NUM_IMAGES)
original = maps_of(read_tree(before))
copy(before, work)
start = time.monotonic()
program.run(*command)
duration = time.monotonic() - start
last = without_accounts(read_tree(work))
refined = maps_of(last)

print(f"seed {SEED}")
moments = random.Random(SEED)
num_kills = 0
num_runs = 0
while num_kills < NUM_KILLS:
    copy(before, work)
    code = None
    while code != 0:
        process = program.start(*command)
        # Half of them early: what was done is not done again.
        time.sleep(moments.uniform(0, duration) * moments.choice((0.5, 1.0)))
        process.kill()
        _, errors = process.communicate()
        code = process.returncode
        check(code in (0, -9), f"ended with {code}: {errors}")
        num_kills += code != 0
        tree = read_tree(work)
        for path, content in original.items():
            kept = "stereo/tsar/original/" + path[len("stereo/"):]
            check(tree.get(path) in (content, refined[path]), f"{path} is neither")
            check(content in (tree[path], tree.get(kept)), f"{path} is lost")
    num_runs += 1
    check_same(without_accounts(tree), last, "in the end")
    program.run("tsar_refine", work, "--restore", 1)
    check_same(read_tree(work), read_tree(before), "after restoring")
print(f"{num_kills} kills, {num_runs} times to the end")
