#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Kills a command before each call by which it changes files, and in the middle
of each write, one run per call. Each map of a workspace is then, byte for byte,
the former one or the one that an undisturbed run writes, and all former bytes
can be found. A page, an import and a cloud are the former or the new one,
whole. The same command continues to the bytes of an undisturbed run."""
import json
import os
import shutil

import synthetic_workspace
from robustness import (KEY, Setting, check, check_kept, check_same, copy, maps_of, read, read_tree)

setting = Setting("command")
program, work = setting.program, setting.work
before, site = setting.path("before"), setting.path("site")
# One kill in so many, for commands that write like others or are slow.
STEPS = {"compose": 3, "stereo": 4}
SHARD = ["--TsarRefine.shard", "0/1", "--TsarRefine.pass"]
setting.commands["compose"] = (["tsar_refine", work, *SHARD, "compose"], before)


def check_order(log, is_final):
    """Checks that contents are on the disk before names: a file's before it is
    renamed, and all that belongs to a final name before that name is given.
    is_final: returns what belongs to a final name, and nothing for others."""
    dirty = set()
    for line in log:
        name, first, second = line.split("\t")
        if name in ("create", "write", "link"):
            dirty.add(second if name == "link" else first)
        elif name == "mkdir":
            dirty.add(os.path.dirname(first))
        elif name == "fsync":
            dirty.discard(first)
        elif name == "rename":
            check(first not in dirty, f"{first} is renamed before it is flushed")
            dirty.add(os.path.dirname(second))
            belongs = is_final(second)
            left = [path for path in dirty if belongs and path.startswith(belongs)]
            check(not left, f"{second} gets its name before {left} are on the disk")


def kill_everywhere(what, start, command, check_killed, check_done, step=1, **faults):
    """Returns the calls of an undisturbed run. step: a number, for one kill in
    so many calls; or a function that selects the kills from the calls."""
    start()
    log = program.log(*command, **faults)
    kills = step(log) if callable(step) else range(1, len(log) + 1, step)
    for kill_at in kills:
        start()
        try:
            code, errors = program.call(*command, kill_at=kill_at, **faults)
            check(code == -9, f"ended with {code}: {errors}")
            check_killed(kill_at)
            code, errors = program.call(*command, **faults)
            # A killed undoing may have been complete.
            at_end = code == 1 and "nothing to restore" in errors and "--restore" in command
            check(code == 0 or at_end, f"going on ended with {code}: {errors}")
            check_done()
        except SystemExit as error:
            raise SystemExit(f"{error}\n{what}, after kill {kill_at}, at {log[kill_at - 1]}") from None
    check(len(kills) >= 8, f"only {len(kills)} kills")
    print(f"{what}: {len(kills)} kills of {len(log)} calls")
    return log


def leave_normals_unchanged():
    """As if the refinement of this image had given the normals that it had."""
    normals = os.path.join(before, "stereo", "normal_maps", KEY + ".bin")
    synthetic_workspace.write(normals, read(os.path.join(
        before, "stereo", "tsar", "original", "normal_maps", KEY + ".bin")))
    path = os.path.join(before, "stereo", "tsar", "records", KEY + ".json")
    record = json.loads(read(path))
    state = os.stat(normals)
    record["files"]["normal"] = [f"{state.st_size}@{state.st_mtime_ns}"]
    synthetic_workspace.write(path, json.dumps(record).encode())


def kill_in_workspace(case):
    command, source = setting.commands[case]
    if case == "compose":
        copy(setting.mapped, work)
        program.run("tsar_refine", work, *SHARD, "observe")
        program.run("tsar_refine", work, "--TsarRefine.pass", "model")
        os.rename(work, before)
    else:
        copy(source, before)
    if case == "restore":
        leave_normals_unchanged()
    first = read_tree(before)
    untouched = read_tree(setting.bare if case == "stereo" else setting.mapped)
    copy(before, work)
    program.run(*command)
    last = setting.read_work()
    check(maps_of(last) != maps_of(first), "the command changes maps")

    def check_killed(kill_at):
        check_kept(read_tree(work), first, last, untouched)
        # Checks that undoing restores all, from some of these workspaces.
        if case in ("refine", "compose") and kill_at % 10 == 0:
            copy(work, site)
            code, errors = program.call("tsar_refine", site, "--restore", 1)
            nothing = code == 1 and "nothing to restore" in errors
            check(code == 0 or nothing, f"undoing failed: {errors}")
            # Where nothing was done, there may be a temporary file.
            left = {path: content for path, content in read_tree(site).items()
                    if not (nothing and path.endswith((".tsar_tmp", "tsar/lock")))}
            check_same(left, untouched, "after undoing")

    log = kill_everywhere(case, lambda: copy(before, work), command, check_killed,
                          lambda: check_same(setting.read_work(), last, "after going on"),
                          STEPS.get(case, 1))
    check_order(log, lambda name: os.path.join(work, "stereo", "tsar", "original") if
                "_maps/" in name and "/stereo/tsar/" not in name else "")


def kill_while_writing_a_folder(case):
    """There may be none only where a file system cannot exchange folders."""
    output = os.path.join(site, case)
    if case == "report":
        options = ["--num_threads", 1, "--overwrite", 1, "--report_path", output]
        copy(setting.mapped, before)
        program.run("tsar_refine", before, "--TsarRefine.scene_planes", 0)
        command = ["tsar_report", before, *options]
        other = ["tsar_report", setting.refined, *options]  # Shows planes, too.
        data, listed, marker = "index.html", "tsar_report.txt", "unfinished_page"
    else:
        command = setting.import_to(output, "--overwrite", 1)
        other = [*command, "--check_scale", 0, "--depth_scale", 2, "--output_type", "photometric"]
        data = listed = "stereo/tsar_import_files.txt"
        marker = "unfinished_import"

    def read_output():
        return {path: content for path, content in read_tree(output).items()
                if path not in (marker, marker + ".tsar_tmp")}

    def start(former):
        shutil.rmtree(site, ignore_errors=True)
        os.mkdir(site)
        if former:
            copy(setting.path("former"), output)

    def check_done():
        check_same(read_tree(output), new, "after going on")
        check(os.listdir(site) == [case], f"left {os.listdir(site)}")

    def kills(log):
        # While the files are written, nothing is replaced: one kill in ten.
        begin = next(i for i, line in enumerate(log, 1) if "/" + listed in line)
        return [*range(1, begin, 10), *range(begin, len(log) + 1)]

    start(False)
    program.run(*other)
    old = read_output()
    copy(output, setting.path("former"))
    start(False)
    program.run(*command)
    new = read_output()
    check(old.keys() - new.keys() and old[data] != new[data], "they differ")
    for former, faults in ((False, {}), (True, {}), (True, {"no_exchange": 1})):
        def check_killed(_):
            tree = read_output()
            may_miss = not former or faults
            check(tree in (old, new) or (may_miss and not tree), "there is no whole folder")

        log = kill_everywhere(f"{case}, former {former} {faults}", lambda: start(former), command,
                              check_killed, check_done, kills, **faults)
        check_order(log, lambda name: output if name == output else "")


def kill_while_writing_a_cloud():
    """Beside a cloud is the list of images that belongs to it, or none."""
    cloud = os.path.join(site, "fused.ply")
    command = ["tsar_fuse", setting.refined, "--output_path", cloud, "--overwrite", 1,
               "--TsarFuse.num_threads", 1]
    os.mkdir(site)
    program.run(*command, "--TsarFuse.point_spacing", 1)
    former = read_tree(site)
    check(sorted(former) == ["fused.ply", "fused.ply.vis"], f"{sorted(former)} were written")
    copy(site, before)
    program.run(*command)
    new = read_tree(site)
    check(new != former, "another spacing gives another cloud")

    def check_killed(_):
        left = read_tree(site)
        whole = [tree for tree in (former, new) if left["fused.ply"] == tree["fused.ply"]]
        check(whole, "the cloud is none of the two")
        check(left.get("fused.ply.vis") in (None, whole[0]["fused.ply.vis"]),
              "the list is of another cloud")

    kill_everywhere("fuse", lambda: copy(before, site), command, check_killed,
                    lambda: check_same(read_tree(site), new, "after going on"))


case = setting.args.command
if case in ("report", "import"):
    kill_while_writing_a_folder(case)
elif case == "fuse":
    kill_while_writing_a_cloud()
else:
    kill_in_workspace(case)
