#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Puts a FIFO, a device, a socket and a folder in the place of every file that a
command reads: it ends with one clear line instead of waiting, and changes
nothing."""
import os
import shutil
import socket
import stat

import synthetic_workspace
from robustness import Program, check, copy, make_folder, parse_arguments
from start_workspaces import STEREO, StartWorkspaces

args = parse_arguments()
program = Program(args.program)
folder = make_folder(args.folder)
work, external = (os.path.join(folder.name, name) for name in ("work", "arrays"))
start = StartWorkspaces(folder.name)
start.make(program)
REFINE = ["tsar_refine", work]
RESTORE = ["tsar_refine", work, "--restore", 1]
TO_STEREO = ["tsar_stereo", work, *STEREO, "--overwrite", 1]
REPORT = ["tsar_report", work, "--report_path", os.path.join(folder.name, "report"),
          "--overwrite", 1]
SHARD = [*REFINE, "--TsarRefine.shard", "0/1", "--TsarRefine.pass"]
observed = os.path.join(folder.name, "observed")
copy(start.mapped, observed)
program.run("tsar_refine", observed, *SHARD[2:], "observe")
program.run("tsar_refine", observed, "--TsarRefine.pass", "model")
KEY = "v0.png.geometric"
ini = os.path.join(work, "project.ini")
with_ini = os.path.join(folder.name, "with_ini")
copy(start.mapped, with_ini)
synthetic_workspace.write(os.path.join(with_ini, "project.ini"), b"")

# The file, the workspace, and the commands that read it.
FILES = [
    *((f"sparse/{name}.txt", start.mapped, [REFINE, TO_STEREO])
      for name in ("cameras", "images", "points3D")),
    ("stereo/patch-match.cfg", start.mapped, [REFINE, TO_STEREO]),
    ("images/v0.png", start.mapped, [REFINE, TO_STEREO]),
    *((f"stereo/{kind}/{KEY}.bin", start.mapped, [REFINE])
      for kind in ("depth_maps", "normal_maps", "cost_maps")),
    ("stereo/depth_maps/v0.png.photometric.bin", start.mapped, [REFINE]),
    (f"stereo/tsar/records/{KEY}.json", start.refined, [REFINE, RESTORE, REPORT]),
    (f"stereo/tsar/original/depth_maps/{KEY}.bin", start.refined, [REFINE, REPORT]),
    ("stereo/tsar/lock", start.refined, [REFINE, RESTORE, TO_STEREO]),
    (f"stereo/provenance_maps/{KEY}.png", start.refined, [REPORT]),
    (f"stereo/tsar/evidence/{KEY}.bin", observed, [[*SHARD, "compose"]]),
    ("project.ini", with_ini, [[*REFINE, "--project_path", ini]]),
]


def make_socket(path):
    # Its own folder, since the path of a socket has to be short.
    before = os.getcwd()
    os.chdir(os.path.dirname(path))
    socket.socket(socket.AF_UNIX).bind(os.path.basename(path))
    os.chdir(before)


KINDS = {
    "FIFO": os.mkfifo,
    "folder": os.mkdir,
    "socket": make_socket,
    "device": lambda path: os.mknod(path, stat.S_IFCHR | 0o666, os.makedev(1, 5)),
}


def describe(root):
    """What every name stands for; the bytes of regular files."""
    found = {}
    for parent, folders, names in os.walk(root):
        for name in folders + names:
            path = os.path.join(parent, name)
            mode = os.lstat(path).st_mode
            found[os.path.relpath(path, root)] = stat.S_IFMT(mode)
            if stat.S_ISREG(mode):
                with open(path, "rb") as file:
                    found[os.path.relpath(path, root)] = file.read()
    # A run tells there what failed, and begins with it.
    return {path: content for path, content in found.items()
            if path not in ("stereo/tsar", "stereo/tsar/manifest.json")}


def replace(path, kind):
    if os.path.lexists(path):
        os.remove(path)
    os.makedirs(os.path.dirname(path), exist_ok=True)
    try:
        KINDS[kind](path)
        return True
    except PermissionError:
        return False  # Devices are the superuser's.


num_cases = 0
for index, (file, source, commands) in enumerate(FILES):
    # A FIFO, which a reader waits for, in the place of each; another kind in turn.
    for kind in ("FIFO", list(KINDS)[1 + index % 3]):
        for command in commands if kind == "FIFO" else commands[:1]:
            copy(source, work)
            if not replace(os.path.join(work, file), kind):
                continue
            before = describe(work)
            line = program.fails_with_one_line(*command)
            what = f"{' '.join(map(str, command[:1] + command[2:]))} with a {kind} as {file}: {line}"
            check(os.path.basename(file) in line, what)
            after = describe(work)
            changed = [path for path in before.keys() | after.keys()
                       if before.get(path) != after.get(path)]
            check(not changed, f"{what}: {changed} changed")
            num_cases += 1

# Those of other programs that are imported.
for kind in KINDS:
    copy(start.mapped, work)
    shutil.rmtree(external, ignore_errors=True)
    shutil.copytree(start.external, external)
    if replace(os.path.join(external, "v0.npy"), kind):
        before = describe(work)
        program.fails_with_one_line("tsar_import", work, "--input_path", external, "--format", "depth",
                                    "--output_path", start.imported,
                                    texts=["v0.npy: ", f"it is a {kind}"])
        check(describe(work) == before, f"import of a {kind} changed something")
        num_cases += 1
print(f"{num_cases} cases")
