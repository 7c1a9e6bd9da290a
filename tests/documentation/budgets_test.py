#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""No folder of the library, nor the tests or the documents, exceeds its budget
of lines: whatever lengthens one of them must shorten it elsewhere. A line of a
page has at most 130 columns, except in table rows, pictures and indented
blocks."""
import argparse
from pathlib import Path

from sample_testing import check

SOURCES = (".cc", ".cu", ".cuh", ".h", ".js", ".html", ".css")
SCRIPTS = (".py", ".sh")
BUDGETS = (
    ("colmap_tsar/base", SOURCES, 2897),
    ("colmap_tsar/cli", SOURCES, 3210),
    ("colmap_tsar/compose", SOURCES, 2310),
    ("colmap_tsar/device", SOURCES, 1680),
    ("colmap_tsar/fusion", SOURCES, 1464),
    ("colmap_tsar/io", SOURCES, 4208),
    ("colmap_tsar/matching", SOURCES, 2040),
    ("colmap_tsar/priors", SOURCES, 1820),
    ("colmap_tsar/run", SOURCES, 7815),
    ("colmap_tsar/scene", SOURCES, 10825),
    ("colmap_tsar/tools/evaluation", SOURCES, 1111),
    ("colmap_tsar/tools/import", SOURCES, 1572),
    ("colmap_tsar/tools/plane_export", SOURCES, 2120),
    ("colmap_tsar/tools/report", SOURCES, 900),
    ("colmap_tsar/tools/stereo", SOURCES, 1330),
    ("colmap_tsar/view", SOURCES, 6155),
    ("tests", SOURCES + SCRIPTS, 43520),
    ("docs", (".md",), 3500),
)
PAGES = {
    "README.md": 100,
    "docs/ablation.md": 450,
    "docs/method.md": 700,
    "docs/robustness.md": 60,
    "docs/troubleshooting.md": 250,
}

parser = argparse.ArgumentParser()
parser.add_argument("--repository", required=True)
repository = Path(parser.parse_args().repository)


def count_lines(folder, endings):
    """In the files below the folder whose names end in one of these."""
    return sum(len(path.read_text(encoding="utf-8").splitlines())
               for path in folder.rglob("*")
               if path.is_file() and path.suffix in endings)


for name, endings, budget in BUDGETS:
    lines = count_lines(repository / name, endings)
    check(0 < lines <= budget, f"{name} has {lines} of {budget} lines")
for name, budget in PAGES.items():
    lines = len((repository / name).read_text(encoding="utf-8").splitlines())
    check(0 < lines <= budget, f"{name} has {lines} of {budget} lines")
for path in [repository / "README.md", *sorted((repository / "docs").glob("*.md"))]:
    wide = [line for line in path.read_text(encoding="utf-8").splitlines()
            if len(line) > 130 and not line.startswith(("|", "![", "    "))]
    check(not wide, f"{path.name} wraps its lines: {wide}")
folders = {path.parent.relative_to(repository).as_posix()
           for path in (repository / "colmap_tsar").rglob("*.cc")}
homeless = [folder for folder in folders
            if not any(f"{folder}/".startswith(f"{name}/") for name, _, _ in BUDGETS)]
check(not homeless, f"every folder of the library has a budget: {homeless}")
