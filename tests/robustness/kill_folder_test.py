#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Kills tsar_report or tsar_import before each call by which it changes files.
After every kill a whole folder stands under its name, the former or the new one,
and the next call ends with the new one and nothing else beside it. Only where
the file system cannot exchange two folders there may be none until that call."""
import os
import shutil

from robustness import (Program, check, check_same, copy, make_folder, parse_arguments, read_tree)
from start_workspaces import StartWorkspaces

# While the files are written, nothing is replaced: one kill of so many.
STEP = 10

args = parse_arguments("shim", "command")
program = Program(args.program, args.shim)
folder = make_folder(args.folder)
site, kept = (os.path.join(folder.name, name) for name in ("site", "kept"))
output = os.path.join(site, args.command)
start = StartWorkspaces(folder.name)
start.make(program)
OPTIONS = ["--num_threads", 1, "--overwrite", 1]
if args.command == "report":
    OPTIONS += ["--report_path", output]
    plain = os.path.join(folder.name, "plain")
    copy(start.mapped, plain)
    program.run("tsar_refine", plain, "--TsarRefine.scene_planes", 0)
    COMMAND = ["tsar_report", plain, *OPTIONS]
    OTHER = ["tsar_report", start.refined, *OPTIONS]  # Shows planes, too.
    DATA, LIST, MARKER = "index.html", "tsar_report.txt", "unfinished_page"
else:
    COMMAND = ["tsar_import", start.mapped, "--input_path", start.external, "--format", "depth",
               "--output_path", output, "--overwrite", 1]
    OTHER = [*COMMAND, "--check_scale", 0, "--depth_scale", 2, "--output_type", "photometric"]
    DATA = LIST = "stereo/tsar_import_files.txt"
    MARKER = "unfinished_import"


def read_output():
    tree = read_tree(output)
    return {path: content for path, content in tree.items()
            if path not in (MARKER, MARKER + ".tsar_tmp")}


def start_anew(former):
    shutil.rmtree(site, ignore_errors=True)
    if former:
        copy(kept, site)
    else:
        os.mkdir(site)


def read_log(command, **faults):
    """The calls of an undisturbed run."""
    path = os.path.join(folder.name, "log")
    program.run(*command, log=path, **faults)
    with open(path, encoding="utf-8") as file:
        lines = file.read().splitlines()
    os.remove(path)
    return lines


def check_flushed(log):
    """That all of a folder is on the disk before it gets its name."""
    dirty = set()
    for line in log:
        name, first, second = line.split("\t")
        if name in ("create", "write", "mkdir"):
            dirty.add(os.path.dirname(first) if name == "mkdir" else first)
        elif name == "fsync":
            dirty.discard(first)
        elif name == "rename":
            check(first not in dirty, f"{first} is renamed before it is flushed")
            dirty.discard(first)
            dirty.add(os.path.dirname(second))
            if second == output:
                unflushed = [path for path in dirty if path.startswith(output)]
                check(not unflushed, f"{unflushed} are not on the disk")


start_anew(False)
# Of other files, and of other content.
program.run(*OTHER)
old = read_output()
copy(site, kept)
start_anew(False)
program.run(*COMMAND)
new = read_output()
check(old.keys() - new.keys() and old[DATA] != new[DATA], "they differ")

num_kills = 0
for former, faults in ((False, {}), (True, {}), (True, {"no_exchange": 1})):
    case = f"{'replacing' if former else 'writing'} the {args.command} {faults or ''}"
    start_anew(former)
    log = read_log(COMMAND, **faults)
    check_flushed(log)
    check_same(read_output(), new, case)
    begin = next(i for i, line in enumerate(log, 1) if "/" + LIST in line)
    check(len(log) - begin >= (20 if former else 5), f"{case}: {len(log)} calls")
    for kill_at in [*range(1, begin, STEP), *range(begin, len(log) + 1)]:
        at = f"{case}: kill {kill_at}, at {log[kill_at - 1]}"
        start_anew(former)
        code, errors = program.call(*COMMAND, kill_at=kill_at, **faults)
        check(code == -9, f"{at}: ended with {code}: {errors}")
        num_kills += 1
        tree = read_output()
        may_miss = not former or "no_exchange" in faults
        check(tree in (old, new) or (may_miss and not tree), f"{at}: no whole folder")
        code, errors = program.call(*COMMAND, **faults)
        check(code == 0, f"{at}: going on ended with {code}: {errors}")
        check_same(read_tree(output), new, f"{at}: after going on")
        check(os.listdir(site) == [args.command], f"{at}: left {os.listdir(site)}")
print(f"{num_kills} kills")
