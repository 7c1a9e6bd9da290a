#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Every commit that the documents name is in the history. Without a history, or
with only part of it, this cannot be checked."""
import os
import re

from sample_testing import call, check, parse_arguments, run, skip


# Commits of other projects, which are named beside them.
OTHERS = {
    "54c035f": "the trainer of 3D Gaussian splatting",
    "9c5c202": "its rasterizer",
    "5d968cf": "COLMAP",
    "a69263d": "PoseLib",
}

args = parse_arguments("repository")


def git(*command):
    return ("git", "-C", args.repository) + command


try:
    root = call(*git("rev-parse", "--show-toplevel", "--is-shallow-repository")).stdout
except OSError:
    root = ""
if root.split("\n")[:2] != [os.path.realpath(args.repository), "false"]:
    skip("no repository with its whole history")

history = run(*git("rev-list", "HEAD")).split()
num_named = 0
for name in run(*git("ls-files", "*.md")).split("\n")[:-1]:
    with open(os.path.join(args.repository, name), encoding="utf-8") as file:
        text = file.read()
    # Letters and digits in one word, except for scenes with their seed.
    hashes = set(re.findall(
        r"\b(?!facade)(?=[a-f]*[0-9])(?=[0-9]*[a-f])[0-9a-f]{7,40}\b", text))
    hashes |= set(re.findall(r"\b[Cc]ommits?\s+([0-9a-f]{7,40})\b", text))
    for commit in sorted(hashes - set(OTHERS)):
        num_named += 1
        check(any(full.startswith(commit) for full in history), f"{name} names {commit}")
check(num_named > 30, f"{num_named} commits are named in the documents")
