#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Runs every command with less than it needs of what the system limits: sizes
of files, memory, threads, open files. Each time it succeeds, or ends with one
clear line and exit code 1; nothing is lost, and without the limit it continues
to the bytes of an undisturbed run."""
import itertools
import random
import resource

from robustness import Setting, check, check_kept, check_one_line, check_same, read_tree

SEED = 20240607
NUM_MOMENTS = 6  # At which memory runs out, for each command.
NO_THREADS = "no more threads can be started"

setting = Setting("limit")
program = setting.program
HELP = ["tsar_refine", setting.mapped, "--help"]
LAST = {}
for case in setting.commands:
    program.run(*setting.prepare(case))
    LAST[case] = setting.read_work()


def set_limit(limit, value):
    """For the new process."""
    return lambda: resource.setrlimit(limit, (value, resource.getrlimit(limit)[1]))


def with_two_threads(case):
    return {"refine": ("--TsarRefine.num_threads", 2), "stereo": ("--TsarStereo.num_threads", 2),
            "report": ("--num_threads", 2)}.get(case, ())


def try_case(case, texts, what, more=(), **how):
    """Whether the command had enough. Otherwise checks that it says so in a
    line with one of these texts, and continues once there is enough."""
    command = setting.prepare(case)
    first = read_tree(setting.work)
    code, errors = program.call(*command, *more, **how)
    what = f"{case} with {what} ended with {code}: {errors}"
    if code != 0:
        check_one_line(code, errors, what)
        check(any(text in errors for text in texts), what)
        check_kept(read_tree(setting.work), first, LAST[case],
                   read_tree(setting.bare if case == "stereo" else setting.mapped))
        again, errors = program.call(*command)
        # It may have been complete: all is there, as the last check shows.
        check(again == 0 or case == "restore" and "nothing" in errors,
              f"{what}; going on ended with {again}: {errors}")
    check_same(setting.read_work(), LAST[case], what)
    return code == 0


def limit_file_size():
    """From nothing up to the largest file; more than one must fail."""
    for case in setting.commands:
        largest = max(map(len, LAST[case].values()))
        sizes = sorted({0, 1, 100, 1000, 4096, largest // 2, largest - 1})
        enough = [try_case(case, ["File too large"], f"files of {size} bytes",
                           prepare=set_limit(resource.RLIMIT_FSIZE, size)) for size in sizes]
        # Putting maps back writes no file.
        check(not enough[0] or case == "restore", f"{case} writes no file")
        print(f"{case}: {enough.count(False)} of {len(sizes)} sizes were too small")


def count_moments(case, few, many):
    """The number of calls of operator new in a run, to within two hundred."""
    while many - few > 200:
        middle = (few + many) // 2
        command = setting.prepare(case) if case else HELP
        code, _ = program.call(*command, no_memory_from=middle)
        few, many = (few, middle) if code == 0 else (middle, many)
    return many


def limit_memory():
    """At random moments, one allocation fails, or all from then on, or there
    are no more addresses, so that no thread gets its stack."""
    print(f"seed {SEED}")
    moments = random.Random(SEED)
    texts = ["out of memory; close other programs", NO_THREADS, "Cannot allocate memory"]
    at_start = count_moments(None, 0, 1 << 22)
    for case in setting.commands:
        in_all = count_moments(case, at_start, at_start + (1 << 16))
        enough = [try_case(case, texts, f"{fault} {moment}", with_two_threads(case), **{fault: moment})
                  for moment in (moments.randint(at_start, in_all) for _ in range(NUM_MOMENTS))
                  for fault in ("no_memory_from", "no_memory_at", "no_addresses_from")]
        check(not all(enough), f"{case} never runs out of memory")
        print(f"{case}: {in_all - at_start} allocations, {enough.count(False)} times too few")


def limit_threads():
    """No thread from the first, second, ... one on, until there are enough."""
    for case in setting.commands:
        for num_threads in itertools.count(1):
            if try_case(case, [NO_THREADS], f"{num_threads - 1} threads",
                        with_two_threads(case), no_threads_from=num_threads):
                break
        check((num_threads > 1) == (case != "restore"), f"{case} starts {num_threads - 1} threads")
        print(f"{case}: starts {num_threads - 1} threads")


def limit_descriptors():
    """From what starting takes on: with fewer the loader exits with 127."""
    smallest = next(number for number in itertools.count(3) if program.call(
        *HELP, prepare=set_limit(resource.RLIMIT_NOFILE, number))[0] != 127)
    for case in setting.commands:
        for number in itertools.count(smallest):
            if try_case(case, ["Too many open files"], f"{number} descriptors",
                        prepare=set_limit(resource.RLIMIT_NOFILE, number)):
                break
        check(number > smallest, f"{case} needs none but those of starting")
        print(f"{case}: needs {number} descriptors")


{"file_size": limit_file_size, "memory": limit_memory, "threads": limit_threads,
 "descriptors": limit_descriptors}[setting.args.limit]()
