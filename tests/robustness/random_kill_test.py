#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Kills tsar_refine on two threads at random moments, several times in a row on
one workspace, in place and with an output workspace. Each time every map is the
original or the refined one, the originals are there, and an input that is not to
be changed is as it was; in the end the bytes are those of an undisturbed run."""
import os
import random
import shutil
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
before, work, output = (os.path.join(folder.name, name) for name in ("before", "work", "output"))
IN_PLACE = ("tsar_refine", work, "--TsarRefine.num_threads", 2)

synthetic_workspace.draw(before, NUM_IMAGES)
original = maps_of(read_tree(before))
print(f"seed {SEED}")
moments = random.Random(SEED)


def without_notes(tree):
    """Beside the lock that a killed program leaves."""
    return {path: content for path, content in tree.items() if path != "stereo/tsar/lock"}


def check_kills(target, command):
    """Kills the command, which refines the maps of `target`."""
    copy(before, work)
    start = time.monotonic()
    program.run(*command)
    duration = time.monotonic() - start
    last = without_accounts(read_tree(target))
    refined = maps_of(last)
    num_kills = 0
    num_runs = 0
    while num_kills < NUM_KILLS:
        copy(before, work)
        shutil.rmtree(output, ignore_errors=True)
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
            tree = read_tree(target)
            if target != work:
                check_same(without_notes(read_tree(work)), read_tree(before), "the input")
                if "stereo/confidence_maps/v0.png.geometric.png" not in tree:
                    continue  # Perhaps not all of it is made.
            for path, content in original.items():
                kept = "stereo/tsar/original/" + path[len("stereo/"):]
                check(tree.get(path) in (content, refined[path]), f"{path} is neither")
                check(content in (tree[path], tree.get(kept)), f"{path} is lost")
        num_runs += 1
        check_same(without_accounts(read_tree(target)), last, "in the end")
        program.run("tsar_refine", target, "--restore", 1)
        tree = read_tree(target)
        # Of an output workspace, the rest are links to folders.
        check_same(tree if target == work else maps_of(tree),
                   read_tree(before) if target == work else original, "after restoring")
    print(f"{num_kills} kills, {num_runs} times to the end")


check_kills(work, IN_PLACE)
check_kills(output, (*IN_PLACE, "--output_path", output))
