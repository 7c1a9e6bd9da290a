# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of the benchmarks share."""

import argparse
import shutil
import sys
from pathlib import Path


def check(condition, message):
    if not condition:
        sys.exit("FAILED: " + message)
    print("ok:", message)


def programs_and_fresh_folder(*names):
    """What a test is called with: the programs of these names, and last a folder
    that it empties."""
    parser = argparse.ArgumentParser()
    for name in (*names, "folder"):
        parser.add_argument("--" + name, required=True)
    arguments = vars(parser.parse_args())
    folder = Path(arguments["folder"])
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    return *(arguments[name] for name in names), folder
