#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Gives the commands that read photos such as are cut off or damaged. They end
with one line that names the photo, and change no map. Photos of every format
that is easily drawn work, whatever their names say."""
import itertools
import os
import shutil

import synthetic_photos
import synthetic_workspace
from robustness import (Program, check, check_same, copy, make_folder, maps_of, parse_arguments,
                        read_tree)
from start_workspaces import STEREO, StartWorkspaces

args = parse_arguments()
program = Program(args.program)
folder = make_folder(args.folder)
work, outside = (os.path.join(folder.name, name) for name in ("work", "outside"))
start = StartWorkspaces(folder.name)
STEREO_COMMAND = ["tsar_stereo", work, *STEREO, "--overwrite", 1]
COMMANDS = {
    "refine": (["tsar_refine", work], start.mapped),
    "refine without planes": (["tsar_refine", work, "--TsarRefine.scene_planes", 0], start.mapped),
    "stereo": (STEREO_COMMAND, start.mapped),
    "report": (["tsar_report", work, "--report_path", os.path.join(folder.name, "report")],
               start.refined),
}
FORMATS = {
    "png": synthetic_photos.png,
    "deep": lambda rows: synthetic_photos.png(rows, 16),
    "jpeg": synthetic_photos.jpeg,
    "tiff": synthetic_photos.tiff,
    "bmp": synthetic_photos.bmp,
    "ppm": synthetic_photos.ppm,
}
PHOTO = os.path.join("images", *synthetic_workspace.NAMES[1].split("/"))
PHOTOS = {name: encode(synthetic_workspace.photo_rows(1)) for name, encode in FORMATS.items()}


def zeroed(content):
    """What a disk makes of a part in the middle, too long to pass for noise."""
    begin, length = len(content) // 3, min(1000, len(content) // 3)
    return content[:begin] + bytes(length) + content[begin + length:]


def fails(case, content, texts, in_the_middle=False, commands=tuple(COMMANDS)):
    """That these commands refuse the photo. Of damage in the middle nothing is
    seen before it is read, when the first pass of tsar_stereo, or a run that
    refines image by image, may be done with others."""
    for name in commands:
        command, source = COMMANDS[name]
        copy(source, work)
        synthetic_workspace.write(os.path.join(work, PHOTO), content)
        before = read_tree(work)
        program.fails_with_one_line(*command, texts=[PHOTO, *texts])
        if not in_the_middle:
            check_same(read_tree(work), before, f"{name} of {case}")
        elif name == "refine":
            check_same(maps_of(read_tree(work)), maps_of(before), f"{name} of {case}")


start.make(program)
num_cases = 0
turns = itertools.cycle(COMMANDS)
for name, content in PHOTOS.items():
    for share in (10, 2, 1):
        cut = content[: min(len(content) // share, len(content) - 1)]
        if name == "tiff" and share == 1:
            continue  # The last byte says that there is no second picture.
        # All commands read photos alike: rarer formats are given to one in turn.
        has_marker = name in ("png", "deep", "jpeg")
        commands = COMMANDS if name in ("png", "jpeg") else [next(turns)]
        fails(f"{name} cut to 1/{share}", cut, ["the image is damaged"], not has_marker, commands)
        num_cases += 1
for name in ("png", "deep"):
    fails(f"{name} with zeros", zeroed(PHOTOS[name]), ["the image is damaged"], True)
    num_cases += 1
fails("a JPEG with zeros up to its end", PHOTOS["jpeg"][:400] + bytes(len(PHOTOS["jpeg"]) - 400),
      ["the image is damaged"])
fails("an empty photo", b"", ["empty"])
fails("a text", b"no photo", ["not a readable image"])

# What is no file: opening a FIFO would wait for a writer.
for name, (command, source) in COMMANDS.items():
    copy(source, work)
    os.remove(os.path.join(work, PHOTO))
    program.fails_with_one_line(*command, texts=[PHOTO, "no such image"])
    os.mkfifo(os.path.join(work, PHOTO))
    program.fails_with_one_line(*command, texts=[PHOTO, "FIFO"])
    num_cases += 2

# tsar_evaluate looks for texture in the photos.
copy(start.mapped, work)
truth = os.path.join(work, "ground_truth", "depth")
for name in synthetic_workspace.NAMES[:2]:
    depths = synthetic_workspace.depth_map(0, "geometric")
    synthetic_workspace.write(os.path.join(truth, name + ".bin"), synthetic_workspace.map_file([depths]))
code, errors = program.evaluate(work)
check(code == 0, errors)
synthetic_workspace.write(os.path.join(work, PHOTO), PHOTOS["jpeg"][:1000])
code, errors = program.evaluate(work)
check(code == 1 and errors.startswith("ERROR: ") and errors.count("\n") == 1
      and PHOTO in errors and "the image is damaged" in errors, errors)

# Whole photos work, and so do links to them; all of the same pixels give the
# same maps.
results = {}
for name, encode in FORMATS.items():
    for case in ("refine", "stereo"):
        command, source = COMMANDS[case]
        copy(source, work)
        shutil.rmtree(outside, ignore_errors=True)
        for view, photo in enumerate(synthetic_workspace.NAMES[:2]):
            target = os.path.join(outside, str(view))
            synthetic_workspace.write(target, encode(synthetic_workspace.photo_rows(view)))
            path = os.path.join(work, "images", photo)
            os.remove(path)
            os.symlink(target, path)
        program.run(*command)
        results[case, name] = maps_of(read_tree(work))
        if name != "jpeg":  # It rounds.
            check_same(results[case, name], results[case, "png"], f"{case} of {name}")
        num_cases += 1
print(f"{num_cases} cases")
