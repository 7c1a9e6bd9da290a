#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Gives every command workspaces whose names and links lead elsewhere, whose
files are no files or are cut off. Each ends with one clear line; nothing
outside the workspace is written or removed, and no map in it changes. What is
harmless, such as maps that are links to files that may not change, works."""
import os
import resource
import shutil
import socket
import stat
import sys

import synthetic_workspace
from robustness import (KEY, Setting, check, check_same, copy, describe, edit, maps_of, read,
                        read_tree, without_accounts)

setting = Setting()
program, work, outside = setting.program, setting.work, setting.outside
SHARD = ["tsar_refine", work, "--TsarRefine.shard", "0/1", "--TsarRefine.pass"]
WORKERS = ("refine", "restore", "stereo")
num_cases = 0


def spread_outside():
    shutil.rmtree(outside, ignore_errors=True)
    synthetic_workspace.write(os.path.join(outside, "precious"), b"precious")


def fails(case, command, **expected):
    """Checks that a command fails on `work` and changes nothing outside."""
    global num_cases
    before = read_tree(outside)
    line = program.fails_with_one_line(*command, **expected)
    check(not any(ord(letter) < 0x20 for letter in line), f"{case}: {line!r}")
    check_same(read_tree(outside), before, case)
    num_cases += 1


def rename_image(name):
    """Gives the first image another name in the model and the lists alone."""
    for file in ("sparse/images.txt", "stereo/patch-match.cfg", "stereo/fusion.cfg"):
        edit(os.path.join(work, file), b"v0.png", name)


def check_names():
    """Undoing goes by the files that are there and needs no names."""
    for name, text in (
            (b"../../outside/v0.png", "leads out"),
            (os.path.join(outside, "v0.png").encode(), "leads out"),
            (b"left/../../v0.png", "leads out"),
            (b"v\x1b[2J0.png", "no usable name"), (b"v\x000.png", "no usable name"),
            (b"./left//v1.png", "same file"), (b"x" * 300 + b".png", ""),
            (b"x/" * 3000 + b"v0.png", "")):
        for case in ("refine", "stereo", "report") if text else ("refine", "stereo"):
            command = setting.prepare(case)
            rename_image(name)
            before = read_tree(work)
            fails(f"{case} of {name[:40]}", command, texts=[text])
            # The accounts list what failed, and which images are kept.
            check_same(without_accounts(read_tree(work)), without_accounts(before),
                       f"{case} of {name[:40]}")

    # A name for which there is a map, but no temporary file beside it.
    command = setting.prepare("refine")
    name = "y" * 232 + ".png"
    for parent, _, files in list(os.walk(work)):
        for file in files:
            if file.startswith("v0.png"):
                os.rename(os.path.join(parent, file),
                          os.path.join(parent, file.replace("v0.png", name)))
    rename_image(name.encode())
    before = read_tree(os.path.join(work, "stereo", "depth_maps"))
    fails("refine of a long name", command, texts=["File name too long"])
    check_same(read_tree(os.path.join(work, "stereo", "depth_maps")), before, "maps of a long name")


def check_links():
    # Folders that are links to others, which hold what a command would replace.
    for link in ("stereo", "stereo/depth_maps", "stereo/normal_maps/left",
                 "stereo/confidence_maps", "stereo/sigma_maps/left", "stereo/provenance_maps/left",
                 "stereo/cost_maps", "stereo/tsar", "stereo/tsar/records", "stereo/tsar/original",
                 "stereo/tsar/original/depth_maps", "stereo/tsar_stereo"):
        for case in WORKERS:
            command = setting.prepare(case)
            spread_outside()
            path, target = os.path.join(work, link), os.path.join(outside, "folder")
            if os.path.isdir(path):
                shutil.move(path, target)
            else:
                os.makedirs(target)
                os.makedirs(os.path.dirname(path), exist_ok=True)
            for name in ("evidence/precious", "v0.png.geometric.bin.tsar_tmp"):
                synthetic_workspace.write(os.path.join(target, name), b"precious")
            os.symlink(target, path)
            fails(f"{case} with {link} as a link", command, texts=[link, "leads out"])
    spread_outside()
    synthetic_workspace.write(os.path.join(outside, "v0.png.geometric.bin.tsar_tmp"), b"precious")
    sys.setrecursionlimit(10000)  # For Python's own walks.
    for case in WORKERS:
        # In a tree so deep that there are fewer descriptors than levels.
        command = setting.prepare(case)
        deep = os.path.join(work, "stereo", "depth_maps", "x/" * 300)
        os.makedirs(deep)
        os.symlink(outside, os.path.join(deep, "folder"))
        os.symlink(outside, os.path.join(work, "stereo", "depth_maps", "zzz"))
        fails(f"{case} in a deep tree", command, texts=["leads out"],
              prepare=lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (256, 256)))
        # A link in place of the lock, to a file that does not exist.
        command = setting.prepare(case)
        os.makedirs(os.path.join(work, "stereo", "tsar"), exist_ok=True)
        os.symlink(os.path.join(outside, "made"), os.path.join(work, "stereo", "tsar", "lock"))
        fails(f"{case} with a link as lock", command, texts=["lock", "symbolic links"])


def check_false_records():
    """What a record says does not count: the files' own names do."""
    restore = setting.prepare("restore")
    edit(os.path.join(work, "stereo", "tsar", "records", KEY + ".json"),
         b'"v0.png"', b'"../../../../outside/precious"')
    synthetic_workspace.write(os.path.join(work, "stereo", "tsar", "manifest.json"),
                              b'{"images": [{"image": "../../../outside/precious"}]}')
    precious = read_tree(outside)
    program.run(*restore)
    check_same(read_tree(work), read_tree(setting.mapped), "restoring with a false record")
    check_same(read_tree(outside), precious, "restoring with a false record")
    for name, target, text in (("folder.bin", outside, "leads out"),
                               ("nowhere.bin", os.path.join(outside, "precious"), "nowhere.bin")):
        setting.prepare("restore")
        os.symlink(target, os.path.join(work, "stereo/tsar/original/depth_maps/left", name))
        fails(f"restoring the link {name}", restore, texts=[text])


def check_linked_files():
    """All files are links to others outside, which must not change."""
    shutil.rmtree(work)
    before = read_tree(setting.mapped)
    for path in before:
        target = os.path.join(work, path)
        os.makedirs(os.path.dirname(target), exist_ok=True)
        os.symlink(os.path.join(setting.mapped, path), target)
    for case in ("refine", "restore"):
        program.run(*setting.commands[case][0])
        check_same(read_tree(setting.mapped), before, f"{case} of linked files")
        check((read_tree(work) != before) == (case == "refine"), f"{case} does its work")

    # An output workspace leads to its input by design; nothing is written there.
    shutil.rmtree(work)
    copy(setting.mapped, outside)
    costs = [0.5] * (synthetic_workspace.WIDTH * synthetic_workspace.HEIGHT)
    synthetic_workspace.write(os.path.join(outside, "stereo", "cost_maps", KEY + ".bin"),
                              synthetic_workspace.map_file([costs, costs]))
    before = read_tree(outside)
    program.run("tsar_refine", outside, "--output_path", work)
    for case in ("refine", "stereo"):
        program.call(*setting.commands[case][0])
        check_same(read_tree(outside), before, f"{case} on an output")
    spread_outside()


def make_socket(path):
    # Its own folder, since the path of a socket has to be short.
    before = os.getcwd()
    os.chdir(os.path.dirname(path))
    socket.socket(socket.AF_UNIX).bind(os.path.basename(path))
    os.chdir(before)


# What may be in place of a file. Opening a FIFO would wait for a writer.
KINDS = {
    "FIFO": lambda path, content: os.mkfifo(path),
    "folder": lambda path, content: os.mkdir(path),
    "socket": lambda path, content: make_socket(path),
    "device": lambda path, content: os.mknod(path, stat.S_IFCHR | 0o666, os.makedev(1, 5)),
    "half": lambda path, content: synthetic_workspace.write(path, content[:len(content) // 2]),
    # What a disk makes of a part in the middle, too long to pass for noise.
    "zeroed": lambda path, content: synthetic_workspace.write(
        path, content[:len(content) // 3] + bytes(200) + content[len(content) // 3 + 200:]),
}
SPECIAL = list(KINDS)[:4]


def replace(path, kind):
    content = read(path) if os.path.isfile(path) else b""
    if os.path.lexists(path):
        os.remove(path)
    os.makedirs(os.path.dirname(path), exist_ok=True)
    try:
        KINDS[kind](path, content)
        return True
    except PermissionError:
        return False  # Devices are the superuser's.


def state_of_work():
    # A run records what failed in its manifest, which it writes first.
    return {path: content for path, content in describe(work).items()
            if path not in ("stereo/tsar", "stereo/tsar/manifest.json")}


def check_files():
    """Replaces or damages each file that a command reads."""
    observed = setting.path("observed")
    copy(setting.mapped, work)
    program.run(*SHARD, "observe")
    program.run("tsar_refine", work, "--TsarRefine.pass", "model")
    os.rename(work, observed)
    with_ini = setting.path("with_ini")
    copy(setting.mapped, with_ini)
    synthetic_workspace.write(os.path.join(with_ini, "project.ini"), b"")
    mapped, refined = setting.mapped, setting.refined
    refine, restore, stereo, report = (setting.commands[case][0] for case in
                                       ("refine", "restore", "stereo", "report"))
    ini = [*refine, "--project_path", os.path.join(work, "project.ini")]
    for index, (file, source, commands, damages) in enumerate((
            *((f"sparse/{name}.txt", mapped, [refine, stereo], [])
              for name in ("cameras", "images", "points3D")),
            ("stereo/patch-match.cfg", mapped, [refine, stereo], []),
            ("images/v0.png", mapped, [refine, stereo], ["half", "zeroed"]),
            ("images/left/v1.png", refined, [report], ["half", "zeroed"]),
            *((f"stereo/{kind}/{KEY}.bin", mapped, [refine], ["half"])
              for kind in ("depth_maps", "normal_maps")),
            (f"stereo/cost_maps/{KEY}.bin", mapped, [refine], []),
            (f"stereo/tsar/records/{KEY}.json", refined, [refine, restore, report], []),
            (f"stereo/tsar/original/depth_maps/{KEY}.bin", refined, [refine, report], []),
            ("stereo/tsar/lock", refined, [refine, restore, stereo], []),
            (f"stereo/provenance_maps/{KEY}.png", refined, [report], ["half"]),
            (f"stereo/tsar/evidence/{KEY}.bin", observed, [[*SHARD, "compose"]], []),
            ("project.ini", with_ini, [ini], []))):
        # A FIFO in place of each; then another kind, in turn.
        for kind in ("FIFO", SPECIAL[1 + index % 3], *damages):
            for command in commands[:1] if kind in SPECIAL[1:] else commands:
                copy(source, work)
                if not replace(os.path.join(work, file), kind):
                    continue
                before = state_of_work()
                what = f"{command} with a {kind} as {file}"
                fails(what, command, texts=[os.path.basename(file)])
                after = state_of_work()
                if kind == "zeroed":  # Seen when it is read: tsar_stereo is done with others.
                    before, after = (maps_of(tree) if command != stereo else {} for tree in (before, after))
                check_same(after, before, what)

    # Those of other programs that are imported.
    copy(setting.external, work)
    for kind in SPECIAL:
        if replace(os.path.join(work, "v0.npy"), kind):
            command = setting.import_to(setting.imported)
            command[command.index(setting.external)] = work
            fails(f"import of a {kind}", command, texts=["v0.npy: ", f"it is a {kind}"])
            check(not os.path.exists(setting.imported), f"import of a {kind} writes")
            shutil.rmtree(work)
            copy(setting.external, work)

    # tsar_evaluate looks for texture in the photos.
    copy(mapped, work)
    depths = synthetic_workspace.map_file([synthetic_workspace.depth_map(0, "geometric")])
    for name in synthetic_workspace.NAMES[:2]:
        synthetic_workspace.write(os.path.join(work, "ground_truth", "depth", name + ".bin"), depths)
    evaluate = ["tsar_evaluate", work]
    program.run(*evaluate)
    replace(os.path.join(work, "images", "v0.png"), "half")
    fails("evaluating", evaluate, texts=["v0.png", "the image is damaged"])


def check_pages():
    """What users put in place of a page, or beside it, stays."""
    page = os.path.join(work, "report")
    for case, change, text in (
            ("a file in it", lambda: synthetic_workspace.write(f"{page}/mine/a.tex", b"a"), "move it"),
            ("a link as a file", lambda: (os.remove(f"{page}/index.html"), os.symlink(
                outside + "/precious", f"{page}/index.html")), "index.html"),
            ("a link", lambda: (shutil.rmtree(page), os.symlink(outside, page)), "is a link"),
            ("no list", lambda: os.remove(f"{page}/tsar_report.txt"), "is no report"),
            ("a folder beside it", lambda: synthetic_workspace.write(
                f"{page}.tsar_tmp/a.tex", b"a"), "move it away")):
        command = setting.prepare("report")
        program.run(*command)
        change()
        before = describe(work)
        fails(f"a page with {case}", command, texts=[text])
        check_same(describe(work), before, f"a page with {case}")


spread_outside()
check_names()
check_links()
check_false_records()
check_linked_files()
check_files()
check_pages()
print(f"{num_cases} cases")
