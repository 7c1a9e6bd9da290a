#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Runs every command with less than it needs of what the system limits: sizes of
files, memory, threads, open files. Each time it ends well, or with one clear line
and exit code 1; nothing is lost, and without the limit it goes on to the bytes of
an undisturbed run."""
import itertools
import os
import random
import resource
import subprocess

from robustness import (Program, check, check_kept, check_same, copy, make_folder, parse_arguments,
                        read_tree, without_accounts)
from start_workspaces import STEREO, StartWorkspaces

SEED = 20240607
NUM_MOMENTS = 3  # Of each command at which memory runs out.
PATIENCE = 5  # Seconds for a help that takes a tenth of one; too few are a larger limit.
OUT_OF_MEMORY = "out of memory; close other programs"
NO_THREADS = "no more threads can be started"

args = parse_arguments("shim", "limit")
program = Program(args.program, args.shim)
folder = make_folder(args.folder)
work = os.path.join(folder.name, "work")
start = StartWorkspaces(folder.name)
start.make(program)
# The command, and from what workspace.
CASES = {
    "refine": (["tsar_refine", work], start.mapped),
    "restore": (["tsar_refine", work, "--restore", 1], start.refined),
    "stereo": (["tsar_stereo", work, *STEREO], start.bare),
    "report": (["tsar_report", work], start.refined),
}


def read_work():
    """Without a lock's file: one that is left behind means nothing."""
    return {path: content for path, content in without_accounts(read_tree(work)).items()
            if path != "stereo/tsar/lock"}


LAST = {}
for case, (command, source) in CASES.items():
    copy(source, work)
    program.run(*command)
    LAST[case] = read_work()


def set_limit(limit, value):
    """For the new process."""
    return lambda: resource.setrlimit(limit, (value, resource.getrlimit(limit)[1]))


def two_threads(command):
    if "--restore" in command:
        return ()
    return {"tsar_refine": ("--TsarRefine.num_threads", 2),
            "tsar_stereo": ("--TsarStereo.num_threads", 2),
            "tsar_report": ("--num_threads", 2)}.get(command[0], ())


def try_case(case, texts, what, more=(), **how):
    """Whether the command had enough. Otherwise: that it says so in a line with
    one of these texts, and goes on once there is enough."""
    command, source = CASES[case]
    copy(source, work)
    first = read_tree(work)
    code, errors = program.call(*command, *more, **how)
    what = f"{case} with {what} ended with {code}: {errors}"
    if code == 0:
        check_same(read_work(), LAST[case], what)
        return True
    lines = [line for line in errors.splitlines() if line.startswith("ERROR")]
    check(code == 1 and len(lines) == 1 and errors.endswith(lines[0] + "\n"), what)
    check(lines[0].startswith("ERROR: ") and "unexpected failure" not in lines[0], what)
    check(any(text in lines[0] for text in texts), what)
    check_kept(read_tree(work), first, LAST[case], case)
    code, errors = program.call(*command)
    # It may have been at its end: all is there, as the last check tells.
    at_end = code == 1 and (case == "restore" and "nothing" in errors or
                            case == "report" and "holds a report already" in errors)
    check(code == 0 or at_end, f"{what}; going on ended with {code}: {errors}")
    check_same(read_work(), LAST[case], what)
    return False


def limit_file_size():
    """From nothing up to the largest file; more than one must fail."""
    for case in CASES:
        largest = max(map(len, LAST[case].values()))
        sizes = sorted({0, 1, 100, 1000, 4096, largest // 2, largest - 1})
        enough = [try_case(case, ["File too large"], f"files of {size} bytes",
                           prepare=set_limit(resource.RLIMIT_FSIZE, size)) for size in sizes]
        # Putting maps back writes no file.
        check(not enough[0] or case == "restore", f"{case} writes no file")
        print(f"{case}: {enough.count(False)} of {len(sizes)} sizes were too small")


def count_moments(command, source, few, many):
    """The calls of operator new of a run, to two hundred."""
    while many - few > 200:
        middle = (few + many) // 2
        copy(source, work)
        code, _ = program.call(*command, no_memory_from=middle)
        few, many = (few, middle) if code == 0 else (middle, many)
    return many


def smallest_start(limit, too_few, enough, step=1):
    """The limit with which the program is loaded at all, to a step: its libraries
    take much of it."""
    while enough - too_few > step:
        middle = (too_few + enough) // 2
        starts = program.starts("tsar_refine", start.mapped, "--help", patience=PATIENCE,
                                prepare=set_limit(limit, middle))
        too_few, enough = (too_few, middle) if starts else (middle, enough)
    return enough


def limit_memory():
    """The address space from what starting takes on; then, at some moment, one
    allocation that fails, all from then on, or no more addresses."""
    print(f"seed {SEED}")
    moments = random.Random(SEED)
    texts = [OUT_OF_MEMORY, NO_THREADS, "Cannot allocate memory"]
    smallest = smallest_start(resource.RLIMIT_AS, 0, 1 << 40, 1 << 20)
    at_start = count_moments(["tsar_refine", start.bare, "--help"], start.bare, 0, 1 << 22)
    for case, (command, source) in CASES.items():
        for size in itertools.count(smallest, 8 << 20):
            if try_case(case, texts, f"{size} bytes of addresses",
                        two_threads(command), prepare=set_limit(resource.RLIMIT_AS, size)):
                break
        in_all = count_moments(command, source, at_start, at_start + (1 << 16))
        for _ in range(NUM_MOMENTS):
            moment = moments.randint(at_start, in_all)
            try_case(case, texts, f"no memory from {moment} on", no_memory_from=moment)
            try_case(case, texts, f"no memory at {moment}", no_memory_at=moment)
            try_case(case, texts, f"no addresses from {moment} on", no_addresses_from=moment)
        print(f"{case}: up to {size >> 20} MiB, {in_all - at_start} allocations")


def limit_threads():
    """No thread from the first, second, ... one on, until there are enough."""
    for case, (command, _) in CASES.items():
        for num_threads in itertools.count(1):
            if try_case(case, [NO_THREADS], f"{num_threads - 1} threads",
                        two_threads(command), no_threads_from=num_threads):
                break
        check((num_threads > 1) == (case in ("refine", "stereo", "report")),
              f"{case} starts {num_threads - 1} threads")
        print(f"{case}: starts {num_threads - 1} threads")


def limit_descriptors():
    """From what starting takes on; three are the standard streams."""
    smallest = smallest_start(resource.RLIMIT_NOFILE, 2, 64)
    for case in CASES:
        for number in itertools.count(smallest):
            if try_case(case, ["Too many open files"], f"{number} descriptors",
                        prepare=set_limit(resource.RLIMIT_NOFILE, number)):
                break
        print(f"{case}: needs {number} descriptors")


{"file_size": limit_file_size, "memory": limit_memory, "threads": limit_threads,
 "descriptors": limit_descriptors}[args.limit]()
