#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Kills tsar_refine on two threads at random moments, several times in a row on
one workspace, in place and with an output workspace. Each time every map is the
original or the refined one, the originals are there, and an input that is not to
be changed is as it was; in the end the bytes are those of an undisturbed run."""
import random
import shutil
import time

import synthetic_workspace
from robustness import (Setting, check, check_kept, check_same, copy, maps_of, read_tree,
                        without_accounts)

SEED = 20240607
NUM_KILLS = 40

setting = Setting()
program, work = setting.program, setting.work
before, output = setting.path("before"), setting.path("output")
synthetic_workspace.draw(before, 4)
original = read_tree(before)
print(f"seed {SEED}")
moments = random.Random(SEED)


def check_kills(target, *options):
    """Kills the command, which refines the maps of `target`."""
    command = ("tsar_refine", work, "--TsarRefine.num_threads", 2, *options)
    copy(before, work)
    start = time.monotonic()
    program.run(*command)
    duration = time.monotonic() - start
    last = without_accounts(read_tree(target))
    first = original if target == work else maps_of(original)
    num_kills = num_runs = 0
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
                check_same(setting.read_work(), original, "the input")
                if "stereo/confidence_maps/v0.png.geometric.png" not in tree:
                    continue  # Perhaps not all of it is made.
            # The rest of an output workspace is links to folders.
            check_kept(tree, first, last, original)
        num_runs += 1
        check_same(without_accounts(read_tree(target)), last, "in the end")
        program.run("tsar_refine", target, "--restore", 1)
        tree = read_tree(target)
        check_same(tree if target == work else maps_of(tree), first, "after restoring")
    print(f"{num_kills} kills, {num_runs} times to the end")


check_kills(work)
check_kills(output, "--output_path", output)
