#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Works on workspaces parts of which are on other file systems, between which
nothing can be linked or renamed. Needs the right to mount, in a name space of its
own; is skipped without."""
import os
import shutil
import subprocess

from robustness import (KEY, Setting, check, check_same, in_own_name_space, read_tree, set_time,
                        without_accounts)

in_own_name_space()
setting = Setting(on_disk=True)
program, work = setting.program, setting.work
# Sets of folders that somebody might move to another disk.
MOUNTS = (("depth_maps",), ("normal_maps",), ("depth_maps", "normal_maps"),
          ("tsar",), ("confidence_maps", "sigma_maps", "provenance_maps"), ("depth_maps/left",))
expected = {}
for case in ("refine", "stereo"):
    program.run(*setting.prepare(case))
    expected[case] = without_accounts(read_tree(work))
num_cases = 0


def mount(path):
    """Gives a folder a file system of its own, with the same content."""
    aside = setting.path("aside")
    shutil.rmtree(aside, ignore_errors=True)
    os.makedirs(path, exist_ok=True)
    shutil.copytree(path, aside, symlinks=True)
    subprocess.run(["mount", "-t", "tmpfs", "-o", "size=16M", "tmpfs", path], check=True)
    shutil.copytree(aside, path, symlinks=True, dirs_exist_ok=True)


def check_work_and_undo(case, what):
    """Checks a command on what it starts from, twice, and undoing it."""
    global num_cases
    command, source = setting.commands[case]
    for again in ("", ", again"):
        program.run(*command)
        check_same(without_accounts(read_tree(work)), expected[case], f"{case} {what}{again}")
    if case == "refine":
        program.run(*setting.commands["restore"][0])
        check_same(read_tree(work), read_tree(source), f"{case} {what}, undone")
    num_cases += 1


for case in expected:
    for mounts in MOUNTS:
        setting.prepare(case)
        paths = [os.path.join(work, "stereo", name) for name in mounts]
        for path in paths:
            mount(path)
        check_work_and_undo(case, f"with {mounts} on other file systems")
        subprocess.run(["umount", *paths], check=True)

# What stands in the way is superseded between file systems, too.
refine = setting.prepare("refine")
depth_maps = os.path.join(work, "stereo", "depth_maps")
mount(depth_maps)
program.run(*refine)
os.truncate(os.path.join(depth_maps, KEY + ".bin"), 100)
set_time(os.path.join(depth_maps, KEY + ".bin"), 1)
program.run(*setting.commands["restore"][0])
tree = read_tree(work)
check(len(tree.pop(f"stereo/tsar/superseded/depth_maps/{KEY}.bin")) == 100,
      "a damaged map is superseded")
check_same(tree, read_tree(setting.mapped), "restoring a damaged map between file systems")
subprocess.run(["umount", depth_maps], check=True)
print(f"{num_cases} cases")
