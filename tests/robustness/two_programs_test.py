#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Starts every command on a workspace on which another one works: it stops with
one clear line and changes nothing, and the first one ends as if alone."""
import os
import shutil
import signal

from robustness import (Program, check, check_same, copy, make_folder, parse_arguments, read_tree,
                        wait_until_stopped, without_accounts)
from start_workspaces import STEREO, StartWorkspaces

args = parse_arguments("shim")
program = Program(args.program, args.shim)
folder = make_folder(args.folder)
work, other = (os.path.join(folder.name, name) for name in ("work", "other"))
start = StartWorkspaces(folder.name)
COMMANDS = {
    "refine": ["tsar_refine", work],
    "restore": ["tsar_refine", work, "--restore", 1],
    "stereo": ["tsar_stereo", work, *STEREO, "--overwrite", 1],
    "refine to a second workspace": ["tsar_refine", work, "--output_path", other],
}
SOURCES = {"refine": start.mapped, "restore": start.refined, "stereo": start.bare,
           "refine to a second workspace": start.mapped}

start.make(program)

num_pairs = 0
for first, command in COMMANDS.items():
    copy(SOURCES[first], work)
    log = os.path.join(folder.name, "log")
    program.run(*command, log=log)
    alone = without_accounts(read_tree(work))
    with open(log, encoding="utf-8") as file:
        num_calls = len(file.readlines())
    os.remove(log)
    shutil.rmtree(other, ignore_errors=True)

    copy(SOURCES[first], work)
    process = program.start(*command, stop_at=num_calls // 2)
    try:
        wait_until_stopped(process)
        before, other_before = read_tree(work), read_tree(other)
        for second, words in COMMANDS.items():
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
