#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Provokes every error that docs/troubleshooting.md quotes after a command, and
looks up in the sources what it quotes without one (those need a GPU, a full
disk or patience)."""
import os
import re
import shutil
import sys
import tempfile

from sample_testing import call, check, parse_arguments, unpack
from situations import SITUATIONS

args = parse_arguments("program", "repository")

# What the page writes for the folder where a command is run.
HOME = "/home/you/scene"
ANYTHING = "\u2026"  # Stands for names and numbers in a quotation.


def one_line(lines):
    return " ".join(" ".join(lines).split())


def quotations():
    """(heading, command or None, text) of each indented block of the page. A
    line that begins with "$" is a command; long lines are broken."""
    with open(os.path.join(args.repository, "docs", "troubleshooting.md"), encoding="utf-8") as file:
        lines = file.read().split("\n")
    heading, block = None, []
    for line in lines + ["end"]:
        if line.startswith("    "):
            block.append(line.strip())
            continue
        if block:
            text = one_line(block)
            if text.startswith("$ "):
                command, text = text[2:].split(" ERROR: ", 1)
                yield heading, command, "ERROR: " + text
            else:
                yield heading, None, text
            block = []
        if line.startswith("#"):
            heading = line.lstrip("#").strip()


def literals():
    """All strings of the sources; those side by side are one, and so are those
    on both sides of an option's name."""
    texts = []
    for parent, _, names in os.walk(os.path.join(args.repository, "colmap_tsar")):
        for name in names:
            with open(os.path.join(parent, name), encoding="utf-8") as file:
                source = re.sub(r"^\s*//.*$", "", file.read(), flags=re.MULTILINE)
            source = re.sub(r'"\s*\+\s*OptionName\("(\w+)"\)\s*\+\s*"',
                            r"--TsarRefine.\1", source)
            for group in re.findall(r'"(?:[^"\\\n]|\\.)*"(?:\s*"(?:[^"\\\n]|\\.)*")*', source):
                texts.append("".join(re.findall(r'"((?:[^"\\\n]|\\.)*)"', group)))
    return texts


def provoke(heading, command, quoted, work):
    folder, base = os.path.join(work, "situation"), os.path.join(work, "sample")
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    shutil.copytree(base, os.path.join(folder, "dense"), copy_function=os.link)
    os.chdir(folder)
    # Kept: a lock lasts as long as its file is open.
    state = SITUATIONS[heading]()
    words = command.split()
    check(words[0] == "colmap_tsar", f"{heading}: the command is colmap_tsar")
    result = call(args.program, *words[1:])
    del state
    told = result.stderr.splitlines()[-1] if result.stderr else ""
    told = one_line([told.replace(os.path.realpath(folder), HOME)])
    check(result.returncode == 1 and told == quoted,
          f"{heading}\n  told:   {told}\n  quoted: {quoted}")


def look_up(heading, quoted, texts):
    parts = [part.strip() for part in quoted.split(ANYTHING)]
    check(any(parts), f"{heading}: a quotation has words")
    for part in parts:
        check(any(part in text for text in texts), f"{heading}: '{part}' is in the sources")


args.program, args.repository = map(os.path.abspath, (args.program, args.repository))
os.environ["COLMAP_TSAR"] = args.program  # For situations that come of a run.
sources = literals()
found = list(quotations())
provoked = [heading for heading, command, _ in found if command]
if sorted(provoked) != sorted(SITUATIONS):
    sys.exit("FAILED: the page has commands under other headings than situations.py: "
             f"{sorted(set(provoked) ^ set(SITUATIONS))}")
with tempfile.TemporaryDirectory() as work_folder:
    unpack(args.repository, os.path.join(work_folder, "sample"))
    for heading, command, text in found:
        if command:
            provoke(heading, command, text, work_folder)
        else:
            look_up(heading, text, sources)
    os.chdir(args.repository)
check(len(found) > len(provoked) > 20, f"{len(found)} quotations")
