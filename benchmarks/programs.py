# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""What the benchmarks written in Python share: other programs and tables."""

import shlex
import subprocess
from pathlib import Path


class CommandFailed(Exception):
    """A program ended with an error; the message says which and why."""


def describe_failure(command, exit_code, output):
    """One line: the command, its exit code and the last line it printed."""
    lines = output.strip().splitlines()
    return (f"{shlex.join(command)} gave exit code {exit_code}: "
            f"{' '.join(lines[-1:])}")


def run(command):
    """Runs a command and returns what it printed."""
    command = [str(word) for word in command]
    try:
        done = subprocess.run(command, capture_output=True, text=True,
                              check=False)
    except OSError as error:
        raise CommandFailed(f"{command[0]}: {error.strerror}") from error
    if done.returncode != 0:
        raise CommandFailed(describe_failure(
            command, done.returncode,
            done.stderr if done.stderr.strip() else done.stdout))
    return done.stdout


def commit():
    """The commit of the checkout that this file belongs to."""
    folder = Path(__file__).resolve().parent
    try:
        return run(["git", "-C", folder, "describe", "--always", "--dirty",
                    "--abbrev=40"]).strip()
    except CommandFailed:
        return "unknown"


def print_rows(title, head, rows):
    """A Markdown table; the first column is text, the others are numbers."""
    print(f"\n{title}\n\n| {' | '.join(head)} |")
    print("|---|" + "---:|" * (len(head) - 1))
    for row in rows:
        print(f"| {' | '.join(row)} |")
