#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Changes refined maps as users and other programs do, then undoes the
refinement, or refines again. Anything but a complete map is damage, and the
original comes back; any other map is the new original and stays. No original is
removed, nor anything that others wrote."""
import itertools
import os
import shutil

import synthetic_workspace
from robustness import KEY, Setting, check, check_same, copy, read, read_tree, set_time

KINDS = ("depth_maps", "normal_maps")
MAP = KEY + ".bin"
NUM_PIXELS = synthetic_workspace.WIDTH * synthetic_workspace.HEIGHT

setting = Setting()
program, work = setting.program, setting.work
untouched = read_tree(setting.mapped)
RESTORE = ["tsar_refine", work, "--restore", 1]
REFINE_AGAIN = ["tsar_refine", work, "--TsarRefine.superpixel_size", 300]


def path_of(kind):
    return os.path.join(work, "stereo", kind, MAP)


def mask(content):
    """Without the values of the upper half, as if a user had masked them."""
    head = content.rindex(b"&", 0, 20) + 1
    values = content[head:]
    plane = 4 * NUM_PIXELS
    planes = [values[i:i + plane] for i in range(0, len(values), plane)]
    return content[:head] + b"".join(bytes(plane // 2) + p[plane // 2:] for p in planes)


# What becomes of a map, and whether it is then the user's; more cases of a
# single map are in tests/run/store/ownership_test.cc.
CHANGES = {
    "left alone": (None, False),
    "copied": (lambda content: content, False),
    "masked": (mask, True),
    "cut in half": (lambda content: content[:len(content) // 2], False),
}


def check_owners(what, command, place):
    """Checks that after this command each original is in its place, a user's
    map is unchanged, and what was superseded is aside."""
    copy(setting.refined, work)
    written = {}
    for kind, name in zip(KINDS, changes):
        change, _ = CHANGES[name]
        if change:
            written[kind] = change(read(path_of(kind)))
            synthetic_workspace.write(path_of(kind), written[kind])
            set_time(path_of(kind), 1)
    program.run(*command)
    tree = read_tree(work)
    for kind, name in zip(KINDS, changes):
        original = untouched[f"stereo/{kind}/{MAP}"]
        is_users = CHANGES[name][1]
        check(tree.get(f"{place}/{kind}/{MAP}") == (written[kind] if is_users else original),
              f"{what} {changes}: {kind} are of another source")
        if is_users:
            check(tree.get(f"stereo/tsar/superseded/{kind}/{MAP}") == original,
                  f"{what} {changes}: the original before of {kind} is lost")
    return tree


num_cases = 0
for changes in itertools.product(CHANGES, repeat=2):
    restored = check_owners("restoring", RESTORE, "stereo")
    if not any(CHANGES[name][1] for name in changes):
        rest = {path: content for path, content in restored.items()
                if not path.startswith("stereo/tsar/superseded/")}
        check_same(rest, untouched, f"restoring {changes}")
    check_owners("refining again", REFINE_AGAIN, "stereo/tsar/original")
    num_cases += 2

# A kept original is no longer a map, or is gone: the whole refined map stays.
for is_gone in (False, True):
    copy(setting.refined, work)
    kept = os.path.join(work, "stereo", "tsar", "original", "depth_maps", MAP)
    synthetic_workspace.write(kept, b"")
    if is_gone:
        os.remove(kept)
    before = read_tree(work)
    for command in (REFINE_AGAIN, RESTORE):
        program.fails_with_one_line(*command, texts=[MAP])
        after = read_tree(work)
        check_same({path: after.get(path) for path in before if MAP in path},
                   {path: before[path] for path in before if MAP in path}, f"{command}, {is_gone}")
        num_cases += 1

# Nothing that could be refined: what comes next must not continue with it.
copy(setting.mapped, work)
synthetic_workspace.write(os.path.join(work, "stereo", "patch-match.cfg"),
                          b"v0.png\nleft/v1.png\n")
for kind in KINDS:
    os.remove(os.path.join(work, "stereo", kind, "left", "v1.png.geometric.bin"))
program.fails_with_one_line("tsar_refine", work, texts=["no image could be refined; v0.png: none of"])
check(read(path_of("depth_maps")) == untouched[f"stereo/depth_maps/{MAP}"], "the map that was kept")

# stereo/tsar deleted by hand: what is left are refined maps, not originals.
copy(setting.refined, work)
shutil.rmtree(os.path.join(work, "stereo", "tsar"))
before = read_tree(work)
for command in ("tsar_refine", "tsar_stereo"):
    program.fails_with_one_line(command, work, *(["--overwrite", 1] if command == "tsar_stereo" else []),
                                texts=["has been refined", "provenance_maps"])
    check_same(read_tree(work), before, f"{command} without stereo/tsar")
print(f"{num_cases + 3} cases")
