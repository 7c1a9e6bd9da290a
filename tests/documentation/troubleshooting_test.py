#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Provokes every situation of situations.py, whose errors docs/troubleshooting.md
quotes, and looks up in the sources what else it quotes (that needs a GPU, a full
disk or patience)."""
import os
import re
import shutil
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
    """The messages of the page's tables: the first cell of each row."""
    with open(os.path.join(args.repository, "docs", "troubleshooting.md"), encoding="utf-8") as file:
        return re.findall(r"^\| `([^`]+)` \| .* \|$", file.read(), re.MULTILINE)


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


def provoke(command, spoil, work):
    """What the program says about what the function has spoiled."""
    folder, base = os.path.join(work, "situation"), os.path.join(work, "sample")
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    shutil.copytree(base, os.path.join(folder, "dense"), copy_function=os.link)
    os.chdir(folder)
    # Kept: a lock lasts as long as its file is open.
    state = spoil()
    result = call(args.program, *command.split())
    del state
    told = result.stderr.splitlines()[-1] if result.stderr else ""
    told = one_line([told.replace(os.path.realpath(folder), HOME)])
    check(result.returncode == 1 and told.startswith("ERROR: "), f"{command}: {told}")
    return told.removeprefix("ERROR: ")


def look_up(quoted, texts):
    parts = [part.strip() for part in quoted.split(ANYTHING) if part.strip()]
    check(parts, f"a quotation has words: {quoted}")
    for part in parts:
        check(any(part in text for text in texts), f"'{part}' is in the sources")


args.program, args.repository = map(os.path.abspath, (args.program, args.repository))
os.environ["COLMAP_TSAR"] = args.program  # For situations that arise in a run.
sources = literals()
quoted = quotations()
check(len(quoted) == len(set(quoted)), "the page quotes every message once")
provoked = set()
with tempfile.TemporaryDirectory() as work_folder:
    unpack(args.repository, os.path.join(work_folder, "sample"))
    for arguments, make in SITUATIONS:
        message = provoke(arguments, make, work_folder)
        check(message in quoted, f"the page has the message of {arguments}")
        provoked.add(message)
    os.chdir(args.repository)
for text in quoted:
    if text not in provoked:
        look_up(text, sources)
check(len(quoted) > len(provoked) > 20, f"{len(quoted)} quotations, {len(provoked)} provoked")
