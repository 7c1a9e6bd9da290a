#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Works on workspaces parts of which are on other file systems, between which
nothing can be linked or renamed, and on one without links, permissions and letters
of two cases. Needs the right to mount, in a name space of its own; is skipped
without."""
import os
import shutil
import subprocess
import sys
import tempfile

from robustness import (SKIPPED, Program, check, check_same, copy, parse_arguments, read_tree,
                        set_time, without_accounts)
from start_workspaces import STEREO, StartWorkspaces

IN_NAME_SPACE = "TSAR_IN_NAME_SPACE"

args = parse_arguments()
if IN_NAME_SPACE not in os.environ:
    # Its mounts go when the program ends.
    probe = subprocess.run(["unshare", "--mount", "sh", "-c", "mount -t tmpfs tmpfs /mnt"],
                           stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    if probe.returncode != 0:
        print("SKIPPED: mounting is not permitted here")
        sys.exit(SKIPPED)
    os.environ[IN_NAME_SPACE] = "1"
    os.execvp("unshare", ["unshare", "--mount", sys.executable, *sys.argv])

os.makedirs(args.folder, exist_ok=True)
folder = tempfile.TemporaryDirectory(dir=args.folder)
program = Program(args.program)
start = StartWorkspaces(folder.name)
start.make(program)
work = os.path.join(folder.name, "work")
untouched = read_tree(start.mapped)


def mount(path):
    """Gives a folder a file system of its own, with the same content."""
    aside = os.path.join(folder.name, "aside")
    shutil.rmtree(aside, ignore_errors=True)
    shutil.copytree(path, aside, symlinks=True)
    subprocess.run(["mount", "-t", "tmpfs", "-o", "size=16M", "tmpfs", path], check=True)
    shutil.copytree(aside, path, symlinks=True, dirs_exist_ok=True)


COMMANDS = {
    "refine": (["tsar_refine", work], start.mapped, ["tsar_refine", work, "--restore", 1]),
    "stereo": (["tsar_stereo", work, *STEREO, "--overwrite", 1], start.bare, None),
}
expected = {}
for case, (command, source, _) in COMMANDS.items():
    copy(source, work)
    program.run(*command)
    expected[case] = without_accounts(read_tree(work))


def check_work_and_undo(case, what):
    command, source, undo = COMMANDS[case]
    program.run(*command)
    check_same(without_accounts(read_tree(work)), expected[case], what)
    program.run(*command)
    check_same(without_accounts(read_tree(work)), expected[case], f"{what}, again")
    if undo:
        program.run(*undo)
        check_same(read_tree(work), read_tree(source), f"{what}, undone")


# Of every subset that somebody might move to another disk.
MOUNTS = (("depth_maps",), ("normal_maps",), ("depth_maps", "normal_maps"),
          ("tsar",), ("confidence_maps", "sigma_maps", "provenance_maps"), ("depth_maps/left",))
num_cases = 0
for case in COMMANDS:
    for mounts in MOUNTS:
        copy(COMMANDS[case][1], work)
        paths = [os.path.join(work, "stereo", name) for name in mounts]
        for path in paths:
            os.makedirs(path, exist_ok=True)
            mount(path)
        check_work_and_undo(case, f"{case} with {mounts} on other file systems")
        for path in reversed(paths):
            subprocess.run(["umount", path], check=True)
        num_cases += 1

# What stands in the way is superseded between file systems, too.
copy(start.mapped, work)
depth_maps = os.path.join(work, "stereo", "depth_maps")
mount(depth_maps)
program.run("tsar_refine", work)
path = os.path.join(depth_maps, "v0.png.geometric.bin")
with open(path, "r+b") as file:
    file.truncate(100)
set_time(path, 1)
program.run("tsar_refine", work, "--restore", 1)
tree = read_tree(work)
check(len(tree.pop("stereo/tsar/superseded/depth_maps/v0.png.geometric.bin")) == 100,
      "a damaged map is superseded")
check_same(tree, untouched, "restoring a damaged map between file systems")
subprocess.run(["umount", depth_maps], check=True)
num_cases += 1


def mount_vfat():
    """Whether there is a folder now on a file system of cameras and sticks."""
    image = os.path.join(folder.name, "disk.img")
    point = os.path.join(folder.name, "vfat")
    os.makedirs(point, exist_ok=True)
    with open(image, "wb") as file:
        file.truncate(32 << 20)
    make = shutil.which("mkfs.vfat", path=os.environ["PATH"] + ":/sbin:/usr/sbin")
    if make is None or subprocess.run([make, image], stdout=subprocess.DEVNULL).returncode != 0:
        return None
    # Upper and lower case are one there by default.
    done = subprocess.run(["mount", "-o", "loop", "-t", "vfat", image, point],
                          stderr=subprocess.DEVNULL)
    return point if done.returncode == 0 else None


point = mount_vfat()
if point is None:
    print("left out: no vfat here")
else:
    work = os.path.join(point, "work")
    for case, (command, source, undo) in COMMANDS.items():
        COMMANDS[case] = ([work if word == os.path.join(folder.name, "work") else word
                           for word in command], source,
                          undo and [undo[0], work, *undo[2:]])
        shutil.rmtree(work, ignore_errors=True)
        shutil.copytree(source, work, copy_function=shutil.copyfile)
        check_work_and_undo(case, f"{case} on vfat")
        num_cases += 1
    # Symbolic links are not known there: one clear line.
    program.fails_with_one_line("tsar_refine", start.mapped, "--output_path",
                                os.path.join(point, "output"), texts=["cannot be made a link"])
    # An image whose maps are those of another one.
    shutil.rmtree(work)
    shutil.copytree(start.mapped, work, copy_function=shutil.copyfile)
    for file in ("sparse/images.txt", "stereo/patch-match.cfg", "stereo/fusion.cfg"):
        path = os.path.join(work, file)
        with open(path, encoding="utf-8") as stream:
            text = stream.read()
        with open(path, "w", encoding="utf-8") as stream:
            stream.write(text.replace("left/v1.png", "V0.png"))
    before = read_tree(work)
    program.fails_with_one_line("tsar_refine", work, texts=["V0.png", "v0.png"])
    check_same(without_accounts(read_tree(work)), without_accounts(before), "names of two cases")
    num_cases += 2
    subprocess.run(["umount", point], check=True)
print(f"{num_cases} cases")
