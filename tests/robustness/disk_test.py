#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Fills a small disk to many levels, and makes it read-only: each command stops
with one clear line, loses nothing, and does its work once that is over. Needs
the right to mount, in a name space of its own; is skipped without."""
import os
import subprocess

from robustness import (Setting, check, check_kept, check_one_line, check_same, in_own_name_space,
                        read_tree)

NUM_LEVELS = 24
DISK_BYTES = 4 << 20

in_own_name_space()
setting = Setting(on_disk=True)
program, disk = setting.program, setting.path("disk")
work, filler = os.path.join(disk, "work"), os.path.join(disk, "filler")
setting.use(work)
del setting.commands["report"]


def free_bytes():
    state = os.statvfs(disk)
    return state.f_bavail * state.f_bsize


def mount(options):
    subprocess.run(["mount", "-t", "tmpfs", "-o", options, "tmpfs", disk], check=True)


os.makedirs(disk)
mount(f"size={DISK_BYTES}")
num_full = {}
for case, (_, source) in setting.commands.items():
    command = setting.prepare(case)
    start = free_bytes()
    first = read_tree(work)
    program.run(*command)
    last = setting.read_work()
    # Intermediate files may need more space than what stays.
    most = max(start - free_bytes(), 0) + (256 << 10)
    num_full[case] = 0
    for level in range(NUM_LEVELS if case == "refine" else NUM_LEVELS // 3):
        setting.prepare(case)
        with open(filler, "wb", buffering=0) as file:
            file.write(bytes(max(0, free_bytes() - most * level // NUM_LEVELS)))
        code, errors = program.call(*command)
        if code != 0:
            num_full[case] += 1
            what = f"{case} on a full disk ended with {code}: {errors}"
            check_one_line(code, errors, what)
            check("No space left" in errors and disk in errors, what)
            check_kept(read_tree(work), first, last, read_tree(
                setting.mapped if case in ("refine", "restore") else setting.bare))
        os.remove(filler)
        if code != 0:
            program.run(*command)
        check_same(setting.read_work(), last, f"{case} on a nearly full disk, or with space again")
check(min(num_full["refine"], num_full["stereo"]) > 2,
      f"the disk was hardly ever full: {num_full}")
print("stopped by a full disk:", num_full)

for case in setting.commands:
    command = setting.prepare(case)
    first = read_tree(work)
    subprocess.run(["mount", "-o", "remount,ro", disk], check=True)
    program.fails_with_one_line(*command, texts=["Read-only file system", work])
    check_same(read_tree(work), first, f"{case} in a read-only folder")
    subprocess.run(["mount", "-o", "remount,rw", disk], check=True)
    program.run(*command)
subprocess.run(["umount", disk], check=True)
