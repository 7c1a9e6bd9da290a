#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""What the library does in a single place, because it is easily done wrong, is
found nowhere else in the sources."""
import fnmatch
import re

from library_sources import library_sources
from sample_testing import check, parse_arguments

args = parse_arguments("repository")

# What must not occur, in which files it may, and what to use instead.
RULES = (
    (r"<glog/|\bV?LOG\(", ("base/warning.cc",), "Warn() of base/warning.h"),
    (r"std::(cout|cerr|clog)\b|<iostream>|\bprintf\(", ("cli/*",),
     "an error, Warn(), or a stream that the caller gives"),
    (r"std::(j?thread|async)\(|<pthread", ("base/start_thread.h", "tools/evaluation/parallel_blocks.h"),
     "StartThread() of base/start_thread.h"),
    (r"std::ostringstream", ("base/text_stream.h",),
     "TextStream of base/text_stream.h"),
)

num_files = 0
broken = []
for name, text in library_sources(args.repository):
    num_files += 1
    source = re.sub(r"//.*", "", text)
    for pattern, allowed, instead in RULES:
        found = re.search(pattern, source)
        if found and not any(fnmatch.fnmatch(name, other) for other in allowed):
            broken.append(f"{name} holds {found.group(0)}; use {instead}")
check(num_files > 100, f"{num_files} sources were read")
check(not broken, "sources keep to the rules" + "".join("\n  " + line for line in broken))
