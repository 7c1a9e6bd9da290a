#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Kills a command before each call by which it changes files, and in the middle
of each write, one run per call. After every kill each map is, byte for byte, the
one that was there or the one that an undisturbed run writes, the former bytes
are all to be found, and the same command goes on to the same bytes."""
import itertools
import json
import os

import synthetic_workspace
from robustness import (Program, check, check_same, copy, make_folder, maps_of, parse_arguments,
                        read_tree, without_accounts)
from start_workspaces import NUM_IMAGES, STEREO

# Undoing is checked after every so manieth kill.
UNDO_EVERY = 10
# The calls at which to kill: every one, or every so manieth of a slow command.
STEPS = {"stereo": 4}

args = parse_arguments("shim", "command")
program = Program(args.program, args.shim)
folder = make_folder(args.folder)
before, work, spare = (os.path.join(folder.name, name) for name in ("before", "work", "spare"))
# The folder in which a command keeps the maps that it replaces.
KEPT = {"refine": "stereo/tsar/original/", "restore": "stereo/tsar/original/",
        "compose": "stereo/tsar/original/"}
SHARD = ["--TsarRefine.shard", "0/1", "--TsarRefine.pass"]
COMMANDS = {
    "refine": ["tsar_refine", work],
    "compose": ["tsar_refine", work, *SHARD, "compose"],
    "restore": ["tsar_refine", work, "--restore", 1],
    "stereo": ["tsar_stereo", work, *STEREO, "--overwrite", 1],
}
UNDO = {"refine": COMMANDS["restore"], "compose": COMMANDS["restore"]}


def leave_normals_unchanged(name):
    """As if the refinement of this image had come to the normals that it had."""
    with open(os.path.join(work, KEPT["restore"], "normal_maps", name + ".bin"), "rb") as file:
        original = file.read()
    synthetic_workspace.write(os.path.join(work, "stereo", "normal_maps", name + ".bin"), original)
    path = os.path.join(work, "stereo", "tsar", "records", name + ".json")
    with open(path, encoding="utf-8") as file:
        record = json.load(file)
    state = os.stat(os.path.join(work, "stereo", "normal_maps", name + ".bin"))
    record["files"]["normal"] = [f"{state.st_size}@{state.st_mtime_ns}"]
    synthetic_workspace.write(path, json.dumps(record).encode())


def prepare():
    """Makes `before`; returns its files, and those of the untouched workspace."""
    synthetic_workspace.draw(work, NUM_IMAGES)
    untouched = read_tree(work)
    if args.command == "restore":
        program.run("tsar_refine", work)
        leave_normals_unchanged("v0.png.geometric")
    elif args.command == "compose":
        program.run("tsar_refine", work, *SHARD, "observe")
        program.run("tsar_refine", work, "--TsarRefine.pass", "model")
    os.rename(work, before)
    return read_tree(before), untouched


def check_order(log):
    """That what a name stands for is on the disk before the name: a file is
    flushed after its last write and before it is renamed, a new folder is
    flushed into the one above it, before a map is replaced."""
    dirty = set()
    unflushed = set()
    for line in log:
        name, first, second = line.rstrip("\n").split("\t")
        if name in ("create", "write"):
            dirty.add(first)
        elif name == "fsync":
            dirty.discard(first)
            unflushed = {path for path in unflushed if os.path.dirname(path) != first}
        elif name == "mkdir":
            unflushed.add(first)
        elif name == "link":
            dirty.add(second)  # Whoever wrote it may not have flushed it.
        elif name == "rename":
            check(first not in dirty, f"{first} is renamed before it is flushed")
            if "_maps/" in second and KEPT.get(args.command, "") not in second:
                kept = [path for path in unflushed if "/stereo/tsar/" in path]
                check(not kept, f"{second} is replaced before {kept} are on the disk")


def check_whole(tree, first, last):
    """Every map is of before or of after, and what was before is not lost."""
    for path in maps_of(first).keys() | maps_of(last).keys():
        known = [first[path]] if path in first else []
        known += [last[path]] if path in last else []
        may_miss = args.command == "stereo" or len(known) == 1
        found = tree.get(path)
        check(found in known or (found is None and may_miss), f"{path} is neither")
        if args.command in KEPT and path in untouched:
            kept = KEPT[args.command] + path[len("stereo/"):]
            check(untouched[path] in (found, tree.get(kept)), f"{path} is lost")
    for path in tree.keys() & untouched.keys() - maps_of(tree).keys():
        check(tree[path] == untouched[path], f"{path} changed")
    check(untouched.keys() - maps_of(untouched).keys() <= tree.keys(), "files are missing")


def check_undone(words):
    """That the command that undoes gives all back, from a workspace like this."""
    copy(work, spare)
    code, errors = program.call(*words)
    nothing = code == 1 and "nothing to restore" in errors
    check(code == 0 or nothing, f"undoing failed: {errors}")
    tree = read_tree(work)
    if nothing:  # Some temporaries.
        tree = {path: content for path, content in tree.items() if not path.endswith(".tsar_tmp")}
    check_same(tree, untouched, "after undoing")
    copy(spare, work)


first, untouched = prepare()
command = COMMANDS[args.command]
copy(before, work)
log_path = os.path.join(folder.name, "log")
program.run(*command, log=log_path)
last = without_accounts(read_tree(work))
with open(log_path, encoding="utf-8") as file:
    log = file.readlines()
check_order(log)
check(maps_of(last) != maps_of(first), "the command changes maps")

num_kills = 0
num_undone = 0
for kill_at in itertools.count(1, STEPS.get(args.command, 1)):
    copy(before, work)
    code, errors = program.call(*command, kill_at=kill_at)
    if code == 0:
        break
    check(code == -9, f"kill {kill_at} ended with {code}: {errors}")
    num_kills += 1
    try:
        check_whole(read_tree(work), first, last)
        if args.command in UNDO and num_kills % UNDO_EVERY == 0:
            num_undone += 1
            check_undone(UNDO[args.command])
        code, errors = program.call(*command)
        # A killed undoing may have been at its end.
        at_end = code == 1 and args.command == "restore" and "nothing" in errors
        check(code == 0 or at_end, f"going on ended with {code}: {errors}")
        check_same(without_accounts(read_tree(work)), last, "after going on")
    except SystemExit as error:
        at = log[kill_at - 1].strip() if kill_at <= len(log) else "?"
        raise SystemExit(f"{error}\nafter kill {kill_at}, at {at}") from None
check(num_kills >= 20, f"only {num_kills} kills")
print(f"{args.command}: {num_kills} kills, {num_undone} of them undone; "
      f"{len(log)} calls in an undisturbed run")
