#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Starts every command with standard input, output or error closed. None of its
files gets the number of a closed stream, so that what is printed is not written
into it: at each call that changes a file those numbers stand for nothing. The
bytes are those of an undisturbed run."""
import os
import signal

from robustness import Setting, check, check_same, wait_until_stopped

CLOSED = ((0,), (1,), (2,), (0, 1, 2))
NUM_STOPS = 3  # Per run, spread over it.

setting = Setting()
program = setting.program


def close_streams():
    for stream in streams:
        os.close(stream)


num_stops = 0
for case in setting.commands:
    num_calls = len(program.log(*setting.prepare(case)))
    last = setting.read_work()
    for streams in CLOSED:
        for stop in range(NUM_STOPS):
            process = program.start(*setting.prepare(case), prepare=close_streams,
                                    stop_at=1 + num_calls * stop // NUM_STOPS)
            for stream in streams if wait_until_stopped(process) else ():
                link = f"/proc/{process.pid}/fd/{stream}"
                target = os.readlink(link) if os.path.lexists(link) else "closed"
                check(target == "/dev/null", f"{case}: stream {stream} of {streams} is {target}")
                num_stops += 1
            process.send_signal(signal.SIGCONT)
            process.communicate()
            check(process.returncode == 0, f"{case} without {streams} ended with {process.returncode}")
            check_same(setting.read_work(), last, f"{case} without {streams}")
check(num_stops > 60, f"only {num_stops} streams were looked at")
print(f"{num_stops} streams")
