#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Equations of the paper have one number everywhere: that of the list in
docs/method.md, which says where each is computed. The paper itself is not part
of the project."""
import glob
import os
import re

from library_sources import library_sources
from sample_testing import check, parse_arguments

args = parse_arguments("repository")

with open(os.path.join(args.repository, "docs/method.md"), encoding="utf-8") as file:
    method = file.read()
rows = re.findall(r"^\| (\d+) \| (.*) \| (`.*`) \|$",
                  method.split("\n### Equations\n")[1], re.MULTILINE)
symbols = {int(number): text for number, text, _ in rows}
places = {int(number): re.findall(r"`([^`]+)`", paths) for number, _, paths in rows}
check(list(symbols) == list(range(1, 17)), "the list has the 16 equations, in order")
for number, stems in places.items():
    for stem in stems:
        check(glob.glob(os.path.join(args.repository, "colmap_tsar", stem + ".*")),
              f"Eq. {number} is in {stem}")

# A comment that names an equation is in a file that computes it.
num_named = 0
for name, text in library_sources(args.repository):
    for number in re.findall(r"\bEq\.(?:\s|//)*(\d+)", text):
        num_named += 1
        check(os.path.splitext(name)[0] in places[int(number)], f"{name} names Eq. {number}")
check(num_named > 15, f"{num_named} equations are named in the sources")

# The table of readings gives each symbol the number that it has in the list.
named = re.findall(r"^\| (\S+) ?(?:\w+ )?\(Eq\. (\d+)\) \|", method, re.MULTILINE)
check(len(named) > 12, f"{len(named)} rows of readings have a number")
for symbol, number in named:
    check(re.search(r"(?<!\w)" + re.escape(symbol) + r"(?!\w)", symbols[int(number)]),
          f"{symbol} is Eq. {number}")
