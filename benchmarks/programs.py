# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""What the benchmarks written in Python share: other programs and tables."""

import os
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


def colmap_environment(library_folder):
    """Variables for COLMAP without a display, and for where its libraries are
    if they are not the system's."""
    environment = {"QT_QPA_PLATFORM": "offscreen"}
    if library_folder:
        environment["LD_LIBRARY_PATH"] = os.pathsep.join(filter(None, (
            str(library_folder), os.environ.get("LD_LIBRARY_PATH"))))
    return environment


def run(command, environment=None):
    """Runs a command with these additional variables, and returns what it
    printed."""
    command = [str(word) for word in command]
    try:
        done = subprocess.run(command, capture_output=True, text=True,
                              check=False,
                              env={**os.environ, **(environment or {})})
    except OSError as error:
        raise CommandFailed(f"{command[0]}: {error.strerror}") from error
    if done.returncode != 0:
        raise CommandFailed(describe_failure(
            command, done.returncode,
            done.stderr if done.stderr.strip() else done.stdout))
    return done.stdout


def own_folder(path):
    """Makes a folder for results, which is emptied where results are made anew:
    nothing that a benchmark did not make may be in it."""
    marker = path / "made_by_a_benchmark"
    if path.exists() and not marker.is_file() and any(path.iterdir()):
        raise CommandFailed(f"{path} is there already and was not made by a "
                            "benchmark; name another folder")
    path.mkdir(parents=True, exist_ok=True)
    marker.touch()
    return path


def commit():
    """The commit of the checkout that this file belongs to."""
    folder = Path(__file__).resolve().parent
    try:
        return run(["git", "-C", folder, "describe", "--always", "--dirty",
                    "--abbrev=40"]).strip()
    except CommandFailed:
        return "unknown"


def table_lines(title, head, rows):
    """A Markdown table; the first column is text, the others are numbers."""
    return ["", title, "", f"| {' | '.join(head)} |",
            "|---|" + "---:|" * (len(head) - 1),
            *(f"| {' | '.join(row)} |" for row in rows)]


def print_rows(title, head, rows):
    print("\n".join(table_lines(title, head, rows)))
