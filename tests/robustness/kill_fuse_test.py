#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Kills tsar_fuse before each call by which it changes files. After every kill
the cloud is the former or the new one, whole, and beside it is the list of
images that belongs to it, or none; and the same command ends with the new
ones."""
import os
import shutil

from robustness import Program, check, make_folder, parse_arguments, read_tree
from start_workspaces import StartWorkspaces

args = parse_arguments("shim")
program = Program(args.program, args.shim)
folder = make_folder(args.folder)
site = os.path.join(folder.name, "site")
start = StartWorkspaces(folder.name)
start.make(program)
CLOUD, LIST = "fused.ply", "fused.ply.vis"
FUSE = ["tsar_fuse", start.refined, "--output_path", os.path.join(site, CLOUD),
        "--overwrite", 1, "--TsarFuse.num_threads", 1]


def start_with(files):
    shutil.rmtree(site, ignore_errors=True)
    os.mkdir(site)
    for name, content in files.items():
        with open(os.path.join(site, name), "wb") as file:
            file.write(content)


start_with({})
program.run(*FUSE, "--TsarFuse.point_spacing", 1)
former = read_tree(site)
check(sorted(former) == [CLOUD, LIST], f"{sorted(former)} were written")
start_with({})
program.run(*FUSE)
new = read_tree(site)
check(new != former, "another spacing gives another cloud")

num_kills = 0
while True:
    start_with(former)
    code, errors = program.call(*FUSE, kill_at=num_kills + 1)
    if code == 0:
        break
    num_kills += 1
    at = f"kill {num_kills}"
    check(code == -9, f"{at} ended with {code}: {errors}")
    left = read_tree(site)
    whole = former if left[CLOUD] == former[CLOUD] else new
    check(left[CLOUD] == whole[CLOUD], f"{at}: the cloud is none of the two")
    check(left.get(LIST, whole[LIST]) == whole[LIST], f"{at}: the list is of another cloud")
    program.run(*FUSE)
    check(read_tree(site) == new, f"{at}: the next run does not end with the new cloud")
check(num_kills >= 8, f"only {num_kills} kills")
print(f"{num_kills} kills")
