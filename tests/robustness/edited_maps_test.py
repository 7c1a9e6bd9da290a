#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Does to refined maps what users and other programs do, and undoes
the work then, or refines again. What is no complete map is damage, and the
original comes back; any other map is the new original and stays. No original and
nothing that others wrote is removed."""
import itertools
import os
import resource
import shutil

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


def anew(kind):
    """What patch_match_stereo would write with other options."""
    depths = [synthetic_workspace.DEPTH * (1.002 + 0.0001 * (i % 13)) for i in range(NUM_PIXELS)]
    channel = [0.01 + 0.0001 * (i % 7) for i in range(NUM_PIXELS)]
    return synthetic_workspace.map_file(
        [depths] if kind == "depth_maps" else [channel, channel, [-0.99] * NUM_PIXELS])


# What becomes of a map, and whether it is the user's then.
CHANGES = {
    "left alone": (None, False),
    "copied": (lambda kind, content: content, False),
    "masked": (lambda kind, content: mask(content), True),
    "cut in half": (lambda kind, content: content[:len(content) // 2], False),
    "emptied": (lambda kind, content: b"", False),
    "made anew": (lambda kind, content: anew(kind), True),
}
KEPT = "stereo/tsar/original"
RESTORE = ["tsar_refine", work, "--restore", 1]
REFINE_AGAIN = ["tsar_refine", work, "--TsarRefine.superpixel_size", 300]


def change(source, changes):
    """A copy of a workspace with changed maps; returns what these hold."""
    copy(source, work)
    written = {}
    for kind, name in zip(KINDS, changes):
        edit, _ = CHANGES[name]
        if edit:
            content = edit(kind, read(path_of(kind)))
            synthetic_workspace.write(path_of(kind), content)
            set_time(path_of(kind), 1)
            written[kind] = content
    return written


def check_owners(changes, written, tree, what, place_of):
    """That each original is where it belongs, and what gave way is aside."""
    for kind, name in zip(KINDS, changes):
        original = untouched[f"stereo/{kind}/{MAP}"]
        is_users = CHANGES[name][1]
        check(tree.get(place_of(kind)) == (written[kind] if is_users else original),
              f"{what}: {kind} are of another source")
        if is_users:
            check(tree.get(f"stereo/tsar/superseded/{kind}/{MAP}") == original,
                  f"{what}: the original before of {kind} is lost")


num_cases = 0
for changes in itertools.product(CHANGES, repeat=2):
    what = f"restoring: depth {changes[0]}, normals {changes[1]}"
    written = change(start.refined, changes)
    program.run(*RESTORE)
    tree = read_tree(work)
    check_owners(changes, written, tree, what, lambda kind: f"stereo/{kind}/{MAP}")
    if not any(CHANGES[name][1] for name in changes):
        rest = {path: content for path, content in tree.items()
                if not path.startswith("stereo/tsar/superseded/")}
        check_same(rest, untouched, what)
    num_cases += 1
    what = f"refining again: depth {changes[0]}, normals {changes[1]}"
    written = change(start.refined, changes)
    program.run(*REFINE_AGAIN)
    check_owners(changes, written, read_tree(work), what,
                 lambda kind: f"{KEPT}/{kind}/{MAP}")
    num_cases += 1

# An original that is kept is no map any more, or gone: the whole refined map stays.
for name, content in (("empty", b""), ("gone", None)):
    copy(start.refined, work)
    kept = os.path.join(work, "stereo", "tsar", "original", "depth_maps", MAP)
    if content is None:
        os.remove(kept)
    else:
        synthetic_workspace.write(kept, content)
    before = read_tree(work)
    for command in (REFINE_AGAIN, RESTORE):
        program.fails_with_one_line(*command, texts=[MAP])
        after = read_tree(work)
        for path in before:
            if MAP in path:
                check(after.get(path) == before[path], f"{command}, {name}: {path} changed")
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
codes = set()
for number in range(3, 16):
    copy(start.refined, work)
    code, _ = program.call(*RESTORE, prepare=lambda: limit_descriptors(number))
    codes.add(code)
    tree = read_tree(work)
    for path in untouched:
        if "_maps/" in path:
            stored = KEPT + path[len("stereo"):]
            check(untouched[path] in (tree.get(path), tree.get(stored)),
                  f"{number} descriptors lose {path}")
    program.call(*RESTORE)
    check_same(read_tree(work), untouched, f"after {number} descriptors")
    num_cases += 1
check(codes == {0, 1} or codes == {0, 1, 127}, f"few descriptors: {codes}")
print(f"{num_cases} cases")
