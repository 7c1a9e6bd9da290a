#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Starts every command with standard input, output or error closed. None of its
files gets the number of a closed stream, so that what is printed is not written
into it: at each call that changes a file those numbers stand for nothing. The
bytes are those of an undisturbed run; a result that cannot be printed is an
error."""
import os
import signal
import subprocess
import time

from robustness import (Program, check, check_same, copy, make_folder, parse_arguments, read_tree,
                        without_accounts)
from start_workspaces import STEREO, StartWorkspaces

CLOSED = ((0,), (1,), (2,), (1, 2), (0, 1, 2))
NUM_STOPS = 3  # Of each run, spread over it.

args = parse_arguments("shim")
program = Program(args.program, args.shim)
folder = make_folder(args.folder)
work, log = (os.path.join(folder.name, name) for name in ("work", "log"))
start = StartWorkspaces(folder.name)
start.make(program)
CASES = {
    "refine": (["tsar_refine", work, "--TsarRefine.num_threads", 2], start.mapped),
    "restore": (["tsar_refine", work, "--restore", 1], start.refined),
    "stereo": (["tsar_stereo", work, *STEREO, "--TsarStereo.num_threads", 2], start.bare),
    "report": (["tsar_report", work, "--num_threads", 2], start.refined),
}


def start_without(streams, words, **faults):
    def close():
        for stream in streams:
            os.close(stream)

    environment = dict(os.environ, LD_PRELOAD=args.shim)
    for name, value in faults.items():
        environment["TSAR_FAULT_" + name.upper()] = str(value)
    return subprocess.Popen(program.arguments(*words), env=environment, preexec_fn=close,
                            stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                            stderr=subprocess.DEVNULL)


def state_of(process):
    with open(f"/proc/{process.pid}/stat", encoding="utf-8") as file:
        return file.read().rpartition(")")[2].split()[0]


num_stops = 0
for case, (command, source) in CASES.items():
    copy(source, work)
    program.run(*command, log=log)
    last = without_accounts(read_tree(work))
    with open(log, encoding="utf-8") as file:
        num_calls = len(file.readlines())
    os.remove(log)
    for streams in CLOSED:
        for stop in range(NUM_STOPS):
            copy(source, work)
            process = start_without(streams, command, stop_at=1 + num_calls * stop // NUM_STOPS)
            while state_of(process) not in "TZ":
                time.sleep(0.002)
            for stream in streams if state_of(process) == "T" else ():
                link = f"/proc/{process.pid}/fd/{stream}"
                target = os.readlink(link) if os.path.lexists(link) else "closed"
                check(target == "/dev/null", f"{case}: stream {stream} of {streams} is {target}")
                num_stops += 1
            process.send_signal(signal.SIGCONT)
            check(process.wait() == 0, f"{case} without {streams} ended with {process.returncode}")
            check_same(without_accounts(read_tree(work)), last, f"{case} without {streams}")
check(num_stops > 90, f"only {num_stops} streams were looked at")

# What is printed onto a full disk is lost, and that is told.
copy(start.mapped, work)
for words in ([args.program, "--help"], [args.program, "tsar_evaluate", "--help"],
              program.arguments("tsar_refine", work)):
    with open("/dev/full", "w", encoding="utf-8") as full:
        result = subprocess.run(words, stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    lines = [line for line in result.stderr.splitlines() if line.startswith("ERROR: ")]
    # Where an earlier write has failed, its reason is not known any more.
    knows_reason = "tsar_refine" not in words
    check(result.returncode == 1 and len(lines) == 1 and "standard output" in lines[0]
          and ("No space left" in lines[0] or not knows_reason),
          f"{words} onto a full disk ended with {result.returncode}: {result.stderr}")
print(f"{num_stops} streams")
