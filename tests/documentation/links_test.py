#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""The documents name only options and commands that exist, and link to files
and headings that are there."""
import glob
import os
import re

from sample_testing import check, parse_arguments, run

args = parse_arguments("program", "repository")


def read(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def anchor(heading):
    """The name that a heading has in links."""
    return re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")


def documents():
    for pattern in ("*.md", "docs/*.md", "benchmarks/*.md", "patches/*.md"):
        yield from sorted(glob.glob(os.path.join(args.repository, pattern)))


def known_options():
    """Names such as TsarRefine.filter, of all commands; and these."""
    text = run(args.program, "--help")
    commands = re.findall(r"^  (tsar_\w+) ", text, re.MULTILINE)
    options = set()
    for command in commands:
        for form in ([], ["depth"], ["cloud"]) if command == "tsar_evaluate" else ([],):
            help_text = run(args.program, command, *form, "--help_all")
            options |= set(re.findall(r"^  --(\S+)", help_text, re.MULTILINE))
    return commands, options


# They record past changes or measurements, with the options of that time.
OF_THEIR_TIME = ("CHANGELOG.md", "benchmarks/RESULTS.md", "docs/ablation.md")

commands, options = known_options()
for path in documents():
    text = read(path)
    name = os.path.relpath(path, args.repository)
    for target, fragment in re.findall(r"\]\(([^)#\s]*)(#[^)\s]*)?\)", text):
        if "://" in target:
            continue
        linked = os.path.normpath(os.path.join(os.path.dirname(path), target)) if target else path
        check(os.path.exists(linked), f"{name} links to {target or fragment}")
        if fragment:
            headings = re.findall(r"^#+ (.*)$", read(linked), re.MULTILINE)
            check(fragment[1:] in map(anchor, headings), f"{name} links to {target}{fragment}")
    for option in set(re.findall(r"--(Tsar\w+\.\w+)", text)) if name not in OF_THEIR_TIME else ():
        check(option in options, f"{name} names --{option}")
    for command in set(re.findall(r"colmap(?:_tsar)? +(tsar_\w+)", text)):
        check(command in commands, f"{name} names {command}")
