#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Does to refined maps what users and other programs do, and undoes
the work then. No original is removed but by being put back, what others wrote in
its place is there afterwards, depth and normals are of one source, and where that
cannot be decided nothing changes and the exit code says so."""
import itertools
import os
import resource
import shutil
import struct

import synthetic_workspace
from robustness import (Program, check, check_same, copy, make_folder, parse_arguments, read_tree,
                        set_time)
from start_workspaces import StartWorkspaces

KINDS = ("depth_maps", "normal_maps")
MAP = "v0.png.geometric.bin"
NUM_PIXELS = synthetic_workspace.WIDTH * synthetic_workspace.HEIGHT

args = parse_arguments()
program = Program(args.program)
folder = make_folder(args.folder)
work = os.path.join(folder.name, "work")
start = StartWorkspaces(folder.name)
start.make(program)
untouched = read_tree(start.mapped)


def path_of(kind):
    return os.path.join(work, "stereo", kind, MAP)


def read(path):
    with open(path, "rb") as file:
        return file.read()


def mask(content):
    """Without the values of the upper half, as a mask that a user lays over it."""
    head = content.rindex(b"&", 0, 20) + 1
    values = content[head:]
    plane = 4 * NUM_PIXELS
    planes = [values[i:i + plane] for i in range(0, len(values), plane)]
    return content[:head] + b"".join(bytes(plane // 2) + p[plane // 2:] for p in planes)


def far_depths_removed(content):
    head = content.rindex(b"&", 0, 20) + 1
    values = struct.unpack(f"<{(len(content) - head) // 4}f", content[head:])
    limit = sorted(values)[len(values) * 3 // 4]
    return content[:head] + struct.pack(f"<{len(values)}f",
                                        *(v if v <= limit else 0.0 for v in values))


def anew(kind):
    """What patch_match_stereo would write with other options."""
    depths = [synthetic_workspace.DEPTH * (1.002 + 0.0001 * (i % 13)) for i in range(NUM_PIXELS)]
    channel = [0.01 + 0.0001 * (i % 7) for i in range(NUM_PIXELS)]
    return synthetic_workspace.map_file(
        [depths] if kind == "depth_maps" else [channel, channel, [-0.99] * NUM_PIXELS])


CHANGES = {
    "left alone": None,
    "masked": lambda kind, content: mask(content),
    "thresholded": lambda kind, content: far_depths_removed(content)
    if kind == "depth_maps" else mask(content),
    "cut in half": lambda kind, content: content[:len(content) // 2],
    "emptied": lambda kind, content: b"",
    "made anew": lambda kind, content: anew(kind),
}
UNDOINGS = {
    "refine": (start.refined, ["tsar_refine", work, "--restore", 1], "stereo/tsar/original"),
}


def change(source, changes):
    """A copy of a workspace with changed maps; returns what these hold."""
    copy(source, work)
    written = {}
    for kind, name in zip(KINDS, changes):
        if CHANGES[name]:
            content = CHANGES[name](kind, read(path_of(kind)))
            synthetic_workspace.write(path_of(kind), content)
            set_time(path_of(kind), 1)
            written[kind] = content
    return written


num_cases = 0
for (case, (source, command, kept)), changes in itertools.product(
        UNDOINGS.items(), itertools.product(CHANGES, repeat=2)):
    what = f"{case}: depth {changes[0]}, normals {changes[1]}"
    written = change(source, changes)
    before = read_tree(work)
    code, errors = program.call(*command)
    after = read_tree(work)
    num_anew = changes.count("made anew")
    for kind in KINDS:
        original = untouched[f"stereo/{kind}/{MAP}"]
        places = (f"stereo/{kind}/{MAP}", f"{kept}/{kind}/{MAP}")
        check(original in [after.get(place) for place in places], f"{what}: {kind} is lost")
        if kind in written:
            places = (f"stereo/{kind}/{MAP}", f"stereo/tsar/superseded/{kind}/{MAP}")
            check(written[kind] in [after.get(place) for place in places],
                  f"{what}: the change of {kind} is lost")
    if num_anew == 1:
        check(code == 1 and "--restore_conflicts" in errors, f"{what}: {code}, {errors}")
        for path in before:
            if MAP in path:
                check(after.get(path) == before[path], f"{what}: {path} changed")
        for decision, found in (("keep", before), ("original", untouched)):
            program.run(*command, "--restore_conflicts", decision)
            tree = read_tree(work)
            for kind in KINDS:
                path = f"stereo/{kind}/{MAP}"
                check(tree[path] == found[path], f"{what}: {decision} leaves another {path}")
    else:
        check(code == 0, f"{what}: {code}, {errors}")
        found = before if num_anew == 2 else untouched
        for kind in KINDS:
            path = f"stereo/{kind}/{MAP}"
            check(after[path] == found[path], f"{what}: {path} is of another source")
        if num_anew == 0:
            rest = {path: content for path, content in after.items()
                    if not path.startswith("stereo/tsar/superseded/")}
            check_same(rest, untouched, what)
    num_cases += 1

# Refining again, with other options: what was edited is no original, what was made anew is.
for changes in itertools.product(CHANGES, repeat=2):
    what = f"refining again: depth {changes[0]}, normals {changes[1]}"
    change(start.refined, changes)
    before = read_tree(work)
    command = ["tsar_refine", work, "--TsarRefine.superpixel_size", 300]
    is_edited = not {"masked", "thresholded"}.isdisjoint(changes)
    if is_edited or changes.count("made anew") == 1:
        program.fails_with_one_line(*command, texts=[MAP, "--restore 1"])
        check_same(read_tree(work), before, what)
        continue
    program.run(*command)
    after = read_tree(work)
    for kind in KINDS:
        original = untouched[f"stereo/{kind}/{MAP}"]
        if changes.count("made anew") == 2:
            check(after[f"stereo/tsar/original/{kind}/{MAP}"] == anew(kind), what)
            check(after[f"stereo/tsar/superseded/{kind}/{MAP}"] == original, what)
        else:
            check(after[f"stereo/tsar/original/{kind}/{MAP}"] == original, what)
    num_cases += 1

# An original that is kept was changed, or is gone: the whole refined map stays.
for name, content in (("changed", b"1&1&1&\0\0\0\0"), ("empty", b""), ("gone", None)):
    copy(start.refined, work)
    kept = os.path.join(work, "stereo", "tsar", "original", "depth_maps", MAP)
    if content is None:
        os.remove(kept)
    else:
        synthetic_workspace.write(kept, content)
    before = read_tree(work)
    for command in (["tsar_refine", work, "--TsarRefine.superpixel_size", 300],
                    ["tsar_refine", work, "--restore", 1]):
        program.fails_with_one_line(*command, texts=[MAP])
        after = read_tree(work)
        for path in before:
            if MAP in path:
                check(after.get(path) == before[path], f"{command}, {name}: {path} changed")
    # Maps that were made anew need it no longer.
    for kind in KINDS:
        synthetic_workspace.write(path_of(kind), anew(kind))
        set_time(path_of(kind), 1)
    program.run("tsar_refine", work)
    program.run("tsar_refine", work, "--restore", 1)
    for kind in KINDS:
        check(read(path_of(kind)) == anew(kind), f"{name}, then made anew: {kind}")
    num_cases += 1

# Nothing that could be refined: what comes next must not go on with it.
copy(start.mapped, work)
synthetic_workspace.write(os.path.join(work, "stereo", "patch-match.cfg"),
                          b"v0.png\nleft/v1.png\n")
for kind in KINDS:
    os.remove(os.path.join(work, "stereo", kind, "left", "v1.png.geometric.bin"))
program.fails_with_one_line("tsar_refine", work, texts=["no image could be refined; v0.png: none of"])
check(read(path_of("depth_maps")) == untouched[f"stereo/depth_maps/{MAP}"], "the map that was kept")
num_cases += 1

# stereo/tsar deleted by hand: what is left are refined maps, not originals.
copy(start.refined, work)
shutil.rmtree(os.path.join(work, "stereo", "tsar"))
before = read_tree(work)
for command in (["tsar_refine", work],
                ["tsar_stereo", work, "--overwrite", 1]):
    program.fails_with_one_line(*command, texts=["has been refined", "provenance_maps"])
    check_same(read_tree(work), before, f"{command[0]} without stereo/tsar")
    num_cases += 1


def limit_descriptors(number):
    resource.setrlimit(resource.RLIMIT_NOFILE, (number, number))


# Too few descriptors to list what is kept: an error, and nothing is lost.
for case, (source, command, kept) in UNDOINGS.items():
    codes = set()
    for number in range(3, 16):
        copy(source, work)
        code, errors = program.call(*command, prepare=lambda: limit_descriptors(number))
        codes.add(code)
        tree = read_tree(work)
        if code == 0:
            check_same(tree, untouched, f"{case} with {number} descriptors")
        for path in untouched:
            if "_maps/" in path:
                stored = kept + path[len("stereo"):]
                check(untouched[path] in (tree.get(path), tree.get(stored)),
                      f"{case} with {number} descriptors loses {path}")
        program.call(*command)
        check_same(read_tree(work), untouched, f"{case} after {number} descriptors")
        num_cases += 1
    check(codes == {0, 1} or codes == {0, 1, 127}, f"{case} with few descriptors: {codes}")

# The same with a folder that may not be listed; the superuser may list all.
if os.geteuid() == 0:
    for case, (source, command, kept) in UNDOINGS.items():
        copy(source, work)
        os.chmod(folder.name, 0o755)
        for parent, _, files in os.walk(work):
            for path in [parent] + [os.path.join(parent, file) for file in files]:
                os.chown(path, 65534, 65534)
        closed = os.path.join(work, kept, "depth_maps", "left")
        os.chmod(closed, 0o000)
        code, errors = program.call(*command, prepare=lambda: os.setuid(65534))
        os.chmod(closed, 0o755)
        if code == 1 and "Permission denied" in errors and "--workspace" in errors:
            continue  # The program itself may not be read there.
        check(code == 1 and closed in errors, f"{case} of what cannot be listed: {code}, {errors}")
        program.run(*command)
        check_same(read_tree(work), untouched, f"{case} of what could not be listed")
        num_cases += 1
print(f"{num_cases} cases")
