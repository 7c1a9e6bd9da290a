#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Starts every command on a workspace on which another one works: it stops with
one clear line and changes nothing, and the first one ends as if alone. If two
write one cloud or page, it is that of one of them, whole."""
import os
import shutil
import signal

from robustness import (Setting, check, check_one_line, check_same, copy, read_tree,
                        wait_until_stopped, without_accounts)

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
            # If both write to one output workspace, it is the one refused.
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

site = setting.path("site")
copy(setting.refined, other)  # Its name is on its page.
for command, options in (
        ("tsar_fuse", ["--output_path", os.path.join(site, "fused.ply"), "--TsarFuse.num_threads", 1,
                       "--TsarFuse.point_spacing"]),
        ("tsar_report", ["--report_path", os.path.join(site, "page"), "--num_threads", 1,
                         "--max_image_size"])):
    pair, whole = [], []
    for workspace, value in ((setting.refined, 1), (other, 2)):
        value = value if command == "tsar_fuse" else 100
        pair.append([command, workspace, "--overwrite", 1, *options, value])
        shutil.rmtree(site, ignore_errors=True)
        os.mkdir(site)
        log = program.log(*pair[-1])
        whole.append(read_tree(site))
    check(whole[0] != whole[1], f"both {command} write the same")
    num_refused = 0
    for stop_at in range(1, len(log) + 1):
        process = program.start(*pair[0], stop_at=stop_at)
        is_stopped = wait_until_stopped(process)
        code, errors = program.call(*pair[1])
        what = f"{command}, beside one stopped at {log[stop_at - 1]}"
        if code != 0:
            check_one_line(code, errors, what)
            check("another" in errors, f"{what}: {errors}")
            num_refused += 1
        if is_stopped:
            process.send_signal(signal.SIGCONT)
        _, errors = process.communicate()
        if process.returncode != 0:  # Overtaken before it had the lock.
            check_one_line(process.returncode, errors, what)
            check(code == 0 and "another" in errors, f"{what}: the first says {errors}")
        check(read_tree(site) in whole, f"{what}: left {sorted(read_tree(site))}")
        num_pairs += 1
    check(num_refused > len(log) // 2, f"the second {command} was hardly ever refused")
print(f"{num_pairs} pairs of commands")
