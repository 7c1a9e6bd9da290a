#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Puts users' files in every place that tsar_report writes to or removes: one
clear line, and all of them are as they were."""
import os
import shutil
import signal

import synthetic_workspace
from robustness import (Program, check, check_same, copy, make_folder, parse_arguments, read_tree,
                        wait_until_stopped)
from start_workspaces import StartWorkspaces

args = parse_arguments("shim")
program = Program(args.program, args.shim)
folder = make_folder(args.folder)
site, outside = (os.path.join(folder.name, name) for name in ("site", "outside"))
page = os.path.join(site, "report")
start = StartWorkspaces(folder.name)
start.make(program)
WORK = start.refined
REPORT = ["tsar_report", WORK, "--report_path", page]
REPLACE = [*REPORT, "--overwrite", 1]
PRECIOUS = b"years of work"
num_cases = 0


def describe(root):
    """What every name stands for: a file's bytes, a link's target, a folder."""
    found = {}
    for parent, folders, names in os.walk(root):
        for name in folders + names:
            path = os.path.join(parent, name)
            if os.path.islink(path):
                content = os.readlink(path)
            elif os.path.isfile(path):
                with open(path, "rb") as file:
                    content = file.read()
            else:
                content = None
            found[os.path.relpath(path, root)] = content
    return found


def fails(case, command, *texts):
    """That a command fails and every file of the test stays as it was."""
    global num_cases
    before = describe(folder.name)
    line = program.fails_with_one_line(*command)
    for text in texts:
        check(text in line, f"{case}: no '{text}' in: {line}")
    check_same(describe(folder.name), before, case)
    num_cases += 1


def make_page():
    shutil.rmtree(site, ignore_errors=True)
    os.mkdir(site)
    program.run(*REPORT)


# Below a page.
make_page()
kept = os.path.join(folder.name, "kept")
copy(site, kept)
folders = sorted(name for name, content in describe(page).items() if content is None)
check("images" in folders and len(folders) >= 3, f"a page has {folders}")
fails("a page without --overwrite", REPORT, "--overwrite 1")
for place in ["", *folders]:
    for name in ("thesis.tex", "mine/thesis.tex", "..data"):
        copy(kept, site)
        path = os.path.join(place, name)
        synthetic_workspace.write(os.path.join(page, path), PRECIOUS)
        fails(f"a file {path}", REPLACE, os.path.join(page, path), "move it", "--report_path")
    copy(kept, site)
    path = os.path.join(page, place, "link.png")
    os.symlink(os.path.join(WORK, "images", "v0.png"), path)
    fails(f"a link in {place}", REPLACE, path)

# Links in the place of a page, its folders and its files.
for name in ["", *folders, "index.html", "tsar_report.txt"]:
    copy(kept, site)
    path = os.path.join(page, name).rstrip("/")
    os.rename(path, outside)
    os.symlink(outside, path)
    fails(f"a link as {name or 'the page'}", REPLACE, path)
    os.remove(path)
    if not name:
        os.symlink("nowhere", path)
        fails("a dangling link as the page", REPLACE, path)
    shutil.rmtree(outside) if os.path.isdir(outside) else os.remove(outside)

# Pages without their whole list.
with open(os.path.join(kept, "report", "tsar_report.txt"), "rb") as file:
    files = file.read()
for content in (None, b"", files[:len(files) // 2], b"\0" * 100):
    copy(kept, site)
    path = os.path.join(page, "tsar_report.txt")
    os.remove(path)
    if content is not None:
        synthetic_workspace.write(path, content)
    fails("a page without its list", REPLACE, page,
          "is no report" if content is None else "tsar_report.txt")

# Beside a page.
for name in ("report.tsar_tmp", "report.tsar_tmp/thesis.tex", "report.tsar_tmp/tsar_report.txt"):
    copy(kept, site)
    synthetic_workspace.write(os.path.join(site, name), PRECIOUS)
    fails(name, REPLACE, "report.tsar_tmp", "move it away")
    shutil.rmtree(page)
    fails(f"{name}, no page", REPORT, "report.tsar_tmp", "move it away")
copy(kept, site)
synthetic_workspace.write(os.path.join(outside, "unfinished_page"), PRECIOUS)
os.symlink(outside, page + ".tsar_tmp")
fails("a link as report.tsar_tmp", REPLACE, "report.tsar_tmp")
shutil.rmtree(outside)
copy(kept, site)
synthetic_workspace.write(page + ".tsar_old/tsar_report.txt", PRECIOUS)
before = describe(site)
program.run(*REPLACE)
check_same(describe(site), before, "a folder that is called as a former page")
code, errors = program.call(*REPLACE, no_exchange=1)
check(code == 1 and "report.tsar_old" in errors, f"a former page in the way: {errors}")
after = {path: content for path, content in describe(site).items()
         if os.path.basename(path) != "unfinished_page"}
check_same(after, before, "a former page in the way")
num_cases += 2

# Two at a time.
copy(kept, site)
process = program.start(*REPLACE, stop_at=60)
try:
    wait_until_stopped(process)
    fails("a second tsar_report", REPLACE, "another tsar_report")
finally:
    process.send_signal(signal.SIGCONT)
    _, errors = process.communicate()
check(process.returncode == 0, f"the first tsar_report: {errors}")
check_same(describe(site), describe(kept), "after two at a time")

# Into the folders of the workspace, through links or not, and of the one that it
# is the output of.
output = os.path.join(folder.name, "output")
program.run("tsar_refine", start.mapped, "--output_path", output)
os.symlink(WORK, os.path.join(folder.name, "by_link"))
for name in ("images", "sparse", "stereo", "stereo/depth_maps", "images/new"):
    first = name.split("/", maxsplit=1)[0]
    for work, root in ((WORK, WORK), (WORK, os.path.join(folder.name, "by_link")),
                       (WORK, os.path.join(site, "..", "refined")), (output, start.mapped)):
        place = os.path.join(root, name)
        fails(f"a page in {place}", ["tsar_report", work, "--report_path",
                                     os.path.join(place, "report")], f"folder {first} of", "--report_path")

print(f"{num_cases} cases")
