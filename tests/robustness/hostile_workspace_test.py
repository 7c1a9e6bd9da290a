#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Gives every command workspaces whose names and links lead elsewhere. Nothing
outside of the workspace is written or removed, whatever they do; and what is
harmless, such as maps that are links to files that may not change, works."""
import os
import resource
import shutil
import sys

import synthetic_workspace
from robustness import (Program, check, check_same, copy, make_folder, parse_arguments, read_tree,
                        without_accounts)
from start_workspaces import STEREO, StartWorkspaces

args = parse_arguments()
program = Program(args.program)
folder = make_folder(args.folder)
work, outside = (os.path.join(folder.name, name) for name in ("work", "outside"))
start = StartWorkspaces(folder.name)
COMMANDS = {
    "refine": (["tsar_refine", work], start.mapped),
    "restore": (["tsar_refine", work, "--restore", 1], start.refined),
    "stereo": (["tsar_stereo", work, *STEREO, "--overwrite", 1], start.bare),
}
REPORT = ["tsar_report", work, "--report_path", os.path.join(folder.name, "report"),
          "--overwrite", 1]


def rename_image(root, name):
    """Gives the first image another name in the model and the lists alone."""
    for file in ("sparse/images.txt", "stereo/patch-match.cfg", "stereo/fusion.cfg"):
        path = os.path.join(root, file)
        with open(path, "rb") as stream:
            content = stream.read()
        synthetic_workspace.write(path, content.replace(b"v0.png", name))


def fails(case, command, **expected):
    """That a command fails on `work` and changes nothing outside."""
    before = read_tree(outside)
    line = program.fails_with_one_line(*command, **expected)
    check(not any(ord(letter) < 0x20 for letter in line), f"{case}: {line!r}")
    check_same(read_tree(outside), before, case)


start.make(program)
synthetic_workspace.write(os.path.join(outside, "precious"), b"precious")
num_cases = 0

# Names. Undoing goes by the files that are there and needs no names.
LONG = b"x" * 300 + b".png"
NAMES = {
    b"../../outside/v0.png": "leads out",
    os.path.join(outside, "v0.png").encode(): "leads out",
    b"left/../../v0.png": "leads out",
    b"v\x1b[2J0.png": "no usable name",
    b"v\x000.png": "no usable name",
    b"./left//v1.png": "same file",
    LONG: "",
    b"x/" * 3000 + b"v0.png": "",
}
for name, text in NAMES.items():
    for case in ("refine", "stereo"):
        command, source = COMMANDS[case]
        copy(source, work)
        rename_image(work, name)
        before = read_tree(work)
        fails(f"{case} of {name[:40]}", command, texts=[text] if text else [])
        # The accounts list what failed, and which images are kept.
        check_same(without_accounts(read_tree(work)), without_accounts(before),
                   f"{case} of {name[:40]}")
        num_cases += 1
    copy(start.refined, work)
    rename_image(work, name)
    if text:
        fails(f"report of {name[:40]}", REPORT, texts=[text])
    num_cases += 1

# A name for which there is a map, but no temporary file beside it.
copy(start.mapped, work)
name = "y" * 232 + ".png"
for parent, _, files in list(os.walk(work)):
    for file in files:
        if file.startswith("v0.png"):
            os.rename(os.path.join(parent, file), os.path.join(parent, file.replace("v0.png", name)))
rename_image(work, name.encode())
before = read_tree(os.path.join(work, "stereo", "depth_maps"))
fails("refine of a long name", COMMANDS["refine"][0], texts=["File name too long"])
check_same(read_tree(os.path.join(work, "stereo", "depth_maps")), before, "maps of a long name")

# Folders that are links to others, which hold what a command would replace.
LINKS = ("stereo", "stereo/depth_maps", "stereo/normal_maps/left", "stereo/confidence_maps",
         "stereo/sigma_maps/left",
         "stereo/provenance_maps/left", "stereo/cost_maps", "stereo/tsar", "stereo/tsar/records",
         "stereo/tsar/original", "stereo/tsar/original/depth_maps",
         "stereo/tsar_stereo")
for link in LINKS:
    for case, (command, source) in COMMANDS.items():
        copy(source, work)
        shutil.rmtree(outside)
        synthetic_workspace.write(os.path.join(outside, "precious"), b"precious")
        path = os.path.join(work, link)
        target = os.path.join(outside, "folder")
        if os.path.isdir(path):
            shutil.move(path, target)
        else:
            os.makedirs(target)
            os.makedirs(os.path.dirname(path), exist_ok=True)
        synthetic_workspace.write(os.path.join(target, "evidence", "precious"), b"precious")
        synthetic_workspace.write(os.path.join(target, "v0.png.geometric.bin.tsar_tmp"), b"precious")
        os.symlink(target, path)
        fails(f"{case} with {link} as a link", command, texts=[link, "leads out"])
        num_cases += 1
shutil.rmtree(outside)
synthetic_workspace.write(os.path.join(outside, "precious"), b"precious")

# In a tree so deep that there are fewer descriptors than levels.
DEEP = "x/" * 300
sys.setrecursionlimit(10000)  # For Python's own walks.
for case, (command, source) in COMMANDS.items():
    copy(source, work)
    path = os.path.join(work, "stereo", "depth_maps")
    os.makedirs(os.path.join(path, DEEP))
    os.symlink(outside, os.path.join(path, DEEP, "folder"))
    os.symlink(outside, os.path.join(path, "zzz"))
    synthetic_workspace.write(os.path.join(outside, "v0.png.geometric.bin.tsar_tmp"), b"precious")
    fails(f"{case} in a deep tree", command, texts=["leads out"],
          prepare=lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (256, 256)))
    num_cases += 1
os.remove(os.path.join(outside, "v0.png.geometric.bin.tsar_tmp"))

# A link in the place of the lock, to a file that is not there.
for case, (command, source) in COMMANDS.items():
    copy(source, work)
    os.makedirs(os.path.join(work, "stereo", "tsar"), exist_ok=True)
    os.symlink(os.path.join(outside, "made"), os.path.join(work, "stereo", "tsar", "lock"))
    fails(f"{case} with a link as lock", command, texts=["lock", "symbolic links"])
    check("made" not in os.listdir(outside), f"{case} with a link as lock makes a file")
    num_cases += 1

# What stands in a record counts for nothing: the files' own names do.
copy(start.refined, work)
record = os.path.join(work, "stereo", "tsar", "records", "v0.png.geometric.json")
with open(record, encoding="utf-8") as file:
    text = file.read()
synthetic_workspace.write(record, text.replace('"v0.png"', '"../../../../outside/precious"').encode())
synthetic_workspace.write(os.path.join(work, "stereo", "tsar", "manifest.json"),
                      b'{"images": [{"image": "../../../outside/precious"}]}')
precious = read_tree(outside)
program.run(*COMMANDS["restore"][0])
check_same(read_tree(work), read_tree(start.mapped), "restoring with a false record")
check_same(read_tree(outside), precious, "restoring with a false record")
copy(start.refined, work)
nowhere = os.path.join(work, "stereo", "tsar", "original", "depth_maps", "left", "nowhere.bin")
os.symlink(os.path.join(outside, "precious"), nowhere)
os.symlink(outside, os.path.join(os.path.dirname(nowhere), "folder.bin"))
fails("restoring a linked folder", COMMANDS["restore"][0], texts=["leads out"])
os.remove(os.path.join(os.path.dirname(nowhere), "folder.bin"))
fails("restoring a link", COMMANDS["restore"][0], texts=["nowhere.bin"])
check_same(read_tree(outside), precious, "restoring a link")
num_cases += 3

# Maps that are links: to files that may not change, out of the workspace.
shutil.rmtree(work)
for parent, _, files in os.walk(start.mapped):
    for file in files:
        path = os.path.join(parent, file)
        target = os.path.join(work, os.path.relpath(path, start.mapped))
        os.makedirs(os.path.dirname(target), exist_ok=True)
        os.symlink(path, target)
before = read_tree(start.mapped)
program.run(*COMMANDS["refine"][0])
check_same(read_tree(start.mapped), before, "refining linked maps")
check(read_tree(work) != before, "refining linked maps does something")
program.run(*COMMANDS["restore"][0])
check_same(read_tree(work), before, "restoring linked maps")
check_same(read_tree(start.mapped), before, "restoring linked maps")
num_cases += 1

# An output workspace leads to its input by design; nothing is written there.
shutil.rmtree(work)
copy(start.mapped, outside)
nothing = [2.0] * (synthetic_workspace.WIDTH * synthetic_workspace.HEIGHT)
synthetic_workspace.write(os.path.join(outside, "stereo", "cost_maps", "v0.png.geometric.bin"),
                      synthetic_workspace.map_file([nothing, nothing]))
before = read_tree(outside)
program.run("tsar_refine", outside, "--output_path", work)
for case in ("refine", "stereo"):
    program.call(*COMMANDS[case][0])
    check_same(read_tree(outside), before, f"{case} on an output")
    num_cases += 1
print(f"{num_cases} cases")
