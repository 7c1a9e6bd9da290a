#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Fills a small disk to many levels, and makes it read-only: each command stops
with one clear line, loses nothing, and does its work once that is over. Needs
the right to mount, in a name space of its own; is skipped without."""
import os
import subprocess
import sys
import tempfile

from robustness import (SKIPPED, Program, check, check_kept, check_same, copy, parse_arguments,
                        read_tree, without_accounts)
from start_workspaces import STEREO, StartWorkspaces

NUM_LEVELS = 24
DISK_BYTES = 4 << 20
IN_NAME_SPACE = "TSAR_IN_NAME_SPACE"

args = parse_arguments()
if IN_NAME_SPACE not in os.environ:
    # Its mounts go when the program ends.
    probe = subprocess.run(
        ["unshare", "--mount", "sh", "-c", "mount -t tmpfs tmpfs /mnt"],
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    if probe.returncode != 0:
        print("SKIPPED: mounting is not permitted here")
        sys.exit(SKIPPED)
    os.environ[IN_NAME_SPACE] = "1"
    os.execvp("unshare", ["unshare", "--mount", sys.executable, *sys.argv])

os.makedirs(args.folder, exist_ok=True)
folder = tempfile.TemporaryDirectory(dir=args.folder)
disk = os.path.join(folder.name, "disk")
os.makedirs(disk)
program = Program(args.program)
work, filler = os.path.join(disk, "work"), os.path.join(disk, "filler")
origins = StartWorkspaces(folder.name)
# The command, and from what workspace.
CASES = {
    "refine": (["tsar_refine", work], origins.mapped),
    "restore": (["tsar_refine", work, "--restore", 1], origins.refined),
    "stereo": (["tsar_stereo", work, *STEREO], origins.bare),
}


def mount(options):
    subprocess.run(["mount", "-t", "tmpfs", "-o", options, "tmpfs", disk], check=True)


def free_bytes():
    state = os.statvfs(disk)
    return state.f_bavail * state.f_bsize


def fill(num_left):
    with open(filler, "wb", buffering=0) as file:
        file.write(b"\0" * max(0, free_bytes() - num_left))


origins.make(program)

mount(f"size={DISK_BYTES}")
num_full = {}
for case, (command, source) in CASES.items():
    copy(source, work)
    start = free_bytes()
    first = read_tree(work)
    program.run(*command)
    last = without_accounts(read_tree(work))
    # What is needed on the way may be more than what stays.
    most = max(start - free_bytes(), 0) + (256 << 10)
    num_full[case] = 0
    for level in range(NUM_LEVELS if case == "refine" else NUM_LEVELS // 3):
        copy(source, work)
        fill(most * level // NUM_LEVELS)
        code, errors = program.call(*command)
        if code == 0:
            os.remove(filler)
            check_same(without_accounts(read_tree(work)), last, f"{case} on a nearly full disk")
            continue
        num_full[case] += 1
        lines = [line for line in errors.splitlines() if line.startswith("ERROR: ")]
        check(code == 1 and len(lines) == 1 and "No space left" in lines[0],
              f"{case} on a full disk ended with {code}: {errors}")
        check(disk in lines[0], f"{case}: no file is named: {lines[0]}")
        check_kept(read_tree(work), first, last, case)
        os.remove(filler)
        program.run(*command)
        check_same(without_accounts(read_tree(work)), last, f"{case}, with space again")
check(min(num_full["refine"], num_full["stereo"]) > 2,
      f"the disk was hardly ever full: {num_full}")
print("stopped by a full disk:", num_full)

for case, (command, source) in CASES.items():
    copy(source, work)
    first = read_tree(work)
    subprocess.run(["mount", "-o", "remount,ro", disk], check=True)
    line = program.fails_with_one_line(*command, texts=["Read-only file system", work])
    check_same(read_tree(work), first, f"{case} in a read-only folder")
    subprocess.run(["mount", "-o", "remount,rw", disk], check=True)
    program.run(*command)
    print(f"read-only, {case}: {line}")
subprocess.run(["umount", disk], check=True)
