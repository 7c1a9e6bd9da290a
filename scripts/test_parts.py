#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Says which of the large and rarely affected parts of the tests to run.

tests/parts.json lists these parts: what each is, its tests by the names that
ctest knows, and the files and folders on which its result depends. A part is
run if a commit of the day before the last one changed any of these, or if a
file that is not committed is among them; with --all, and where git cannot say,
every part is.

Prints two lines: the names of the parts to run, and a regular expression of
the tests of all other parts, for `ctest --exclude-regex`.
"""

import argparse
import json
import os
import re
import subprocess
import sys
from pathlib import Path

DAY = 24 * 60 * 60


def git(repository, *arguments):
    """What git prints; an error where it fails."""
    return subprocess.run(
        ["git", "-C", str(repository), *arguments], check=True, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.DEVNULL).stdout


def changed_files(repository, since=""):
    """Files changed since a commit, by default that of a day before HEAD; None
    where the history does not reach back so far, or there is none."""
    try:
        if not since:
            head = int(git(repository, "log", "-1", "--format=%ct"))
            since = git(repository, "rev-list", "-1",
                        f"--before={head - DAY}", "HEAD").strip()
        if not since:
            return None
        committed = git(repository, "diff", "--name-only", "-z", since, "HEAD")
        edited = git(repository, "status", "--porcelain", "-z", "--no-renames")
    except (OSError, subprocess.CalledProcessError):
        return None
    return ([name for name in committed.split("\0") if name] +
            [line[3:] for line in edited.split("\0") if line])


def depends(part, changed):
    """Whether one of the changed files is a part's path or lies below one."""
    return any(name == path or name.startswith(path + "/")
               for path in part["paths"] for name in changed)


def choose(parts, changed):
    """The names of the parts to run; all where changed is None."""
    return [name for name, part in parts.items()
            if changed is None or depends(part, changed)]


def exclusion(parts, chosen):
    """A regular expression of the tests of the parts that are not chosen; one
    that no test matches where all are."""
    tests = [re.escape(test) for name, part in parts.items()
             if name not in chosen for test in part["tests"]]
    return f"^({'|'.join(tests)})$" if tests else "^$"


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--all", action="store_true", help="every part")
    arguments = parser.parse_args()
    repository = Path(__file__).resolve().parent.parent
    parts = json.loads((repository / "tests" / "parts.json").read_text())
    changed = None
    if not arguments.all:
        changed = changed_files(repository,
                                os.environ.get("TSAR_CHANGED_SINCE", ""))
    chosen = choose(parts, changed)
    for name, part in parts.items():
        if name not in chosen:
            print(f"test: left out, since nothing that it depends on changed: "
                  f"{part['is']} (--all runs it)", file=sys.stderr)
    print(*chosen)
    print(exclusion(parts, chosen))


if __name__ == "__main__":
    main()
