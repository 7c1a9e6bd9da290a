#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Starts every command on a workspace on which another one works: it stops with
one clear line and changes nothing, and the first one ends as if alone."""
import shutil
import signal

from robustness import (Setting, check, check_same, read_tree, wait_until_stopped, without_accounts)

setting = Setting()
program, work, other = setting.program, setting.work, setting.path("other")
del setting.commands["report"]
setting.commands["refine to a second workspace"] = (
    ["tsar_refine", work, "--output_path", other], setting.mapped)

num_pairs = 0
for first in setting.commands:
    command = setting.prepare(first)
    num_calls = len(program.log(*command))
    alone = without_accounts(read_tree(work))
    shutil.rmtree(other, ignore_errors=True)

    setting.prepare(first)
    process = program.start(*command, stop_at=num_calls // 2)
    try:
        check(wait_until_stopped(process), "the program ended")
        before, other_before = read_tree(work), read_tree(other)
        for second, (words, _) in setting.commands.items():
            # Of two that read one workspace, the second must not write to theirs.
            changed = other if other in command and other in words else work
            program.fails_with_one_line(*words, texts=["another program is working", changed])
            check_same(read_tree(work), before, f"{second} while {first} works")
            check_same(read_tree(other), other_before, f"{second} while {first} works")
            num_pairs += 1
    finally:
        process.send_signal(signal.SIGCONT)
        _, errors = process.communicate()
    check(process.returncode == 0, f"{first} ended with {process.returncode}: {errors}")
    check_same(without_accounts(read_tree(work)), alone, f"{first}, with others beside it")
print(f"{num_pairs} pairs of commands")
