#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Changes what results depend on after a run has ended, one thing at a time.
The same command then names the change and gives the bytes of a fresh run."""
import os
import shutil

import synthetic_workspace
from robustness import Setting, check, check_same, copy, edit, read, read_tree, set_time
from synthetic_workspace import NAMES

setting = Setting()
# An output workspace refers to its input by its full path, so everything is
# done in `work` and kept elsewhere.
work, begin, drawn, fresh = (setting.path(name) for name in ("work", "begin", "drawn", "fresh"))
dense, second = (os.path.join(work, name) for name in ("dense", "second"))
A, B, C, D = NAMES
# Each sees the next: all are one scene, but D is a neighbor of C alone.
CHAIN = {A: [B], B: [A, C], C: [B, D], D: [C]}
RESULTS = ("depth_maps", "normal_maps", "confidence_maps", "sigma_maps",
           "provenance_maps", "plane_maps")


def write(root, path, content):
    """With a later time than the file before."""
    path = os.path.join(root, path)
    synthetic_workspace.write(path, content)
    set_time(path, 1)


def write_lists(root, sources, names=NAMES):
    """sources: the images with which each image is compared; images left out
    are no references. names: the existing images."""
    lists = "".join(f"{name}\n{', '.join(others)}\n" for name, others in sources.items())
    write(root, "stereo/patch-match.cfg", lists.encode())
    write(root, "stereo/fusion.cfg", "".join(f"{name}\n" for name in names).encode())
    for name, text in synthetic_workspace.sparse_model(names).items():
        write(root, f"sparse/{name}", text.encode())


def references(root):
    return read(os.path.join(root, "stereo", "patch-match.cfg")).decode().splitlines()[::2]


def repaint(root):
    rows = [[level - 3 for level in row] for row in synthetic_workspace.photo_rows(1)]
    write(root, "images/" + B, synthetic_workspace.png(rows))


def match_again(root):
    depths = [1.002 * depth for depth in synthetic_workspace.depth_map(3, "geometric")]
    write(root, f"stereo/depth_maps/{D}.geometric.bin", synthetic_workspace.map_file([depths]))


def call(*words):
    return setting.program.run("tsar_refine", *words)


def in_place(root):
    return call(root)


def to_second(root):
    return call(root, "--output_path", second)


def by_shards(root):
    passes = [("observe", "0/2"), ("observe", "1/2"), ("model", None), ("compose", "0/2"),
              ("compose", "1/2"), ("merge", None)]
    return "".join(call(root, "--TsarRefine.pass", name,
                        *(["--TsarRefine.shard", shard] if shard else [])) for name, shard in passes)


MODES = {"in place": (in_place, dense), "to a second workspace": (to_second, second),
         "by shards": (by_shards, dense)}


def results(root, names):
    """The maps of these images, by their paths."""
    return {path: content for path, content in read_tree(os.path.join(root, "stereo")).items()
            if path.startswith(RESULTS) and
            any(f"_maps/{name}.geometric." in path for name in names)}


def written(root):
    """The files that are replaced when an image is refined again."""
    folder = os.path.join(root, "stereo", "confidence_maps")
    return {path: os.stat(os.path.join(folder, path)).st_ino for path in read_tree(folder)}


# Changes and what is reported; tests/run/input_fingerprints_test.cc has more.
CHANGES = {
    "a pose": (lambda root: edit(os.path.join(root, "sparse/images.txt"), b" -0.0 0 0 1 v0.png",
                                 b" -0.003 0 0 1 v0.png"), f"the camera of {A} has changed"),
    "a photo": (repaint, f"the photo of {B} has changed"),
    "a map": (match_again, f"map of {D}"),
    "the order of sources": (lambda root: write_lists(root, {**CHAIN, C: [D, B]}),
                             f"the list of sources of {C} has changed"),
    "a source is no reference": (lambda root: write_lists(root, {A: [B], B: [A, C], C: [B, D]}),
                                 f"the list of sources of {D} has changed"),
    "an image is gone": (lambda root: write_lists(root, {A: [B], B: [A, C], C: [B]}, NAMES[:3]),
                         "other inputs have changed"),
}

fresh_results = {}
synthetic_workspace.draw(drawn, len(NAMES))
write_lists(drawn, CHAIN)
for mode, (run, target) in MODES.items():
    shutil.rmtree(work, ignore_errors=True)
    copy(drawn, dense)
    check("refined again" not in run(dense), "nothing was refined before")
    copy(work, begin)
    # Whoever does it: each knows what the others did.
    before = written(target)
    for other, (run_other, other_target) in MODES.items():
        if other_target == target:
            check("refined again" not in run_other(dense) and written(target) == before,
                  f"{mode}, then {other}: nothing is done")
    for case, (change, told) in CHANGES.items():
        copy(begin, work)
        copy(drawn, fresh)
        change(dense)
        change(fresh)
        names = references(dense)
        before = written(target)
        errors = run(dense)
        lines = [line for line in errors.splitlines() if ": refined again, since" in line]
        check(lines and all(told in line for line in lines), f"{case}, {mode}: told {errors}")
        after = written(target)
        again = {path for path in after if after[path] != before.get(path)}
        check(again == {f"{name}.geometric.png" for name in names},
              f"{case}, {mode}: {again} were done again")
        if case not in fresh_results:
            in_place(fresh)
            fresh_results[case] = results(fresh, names)
        check_same(results(target, names), fresh_results[case], f"{case}, {mode}")
print(f"{len(CHANGES)} changes in {len(MODES)} ways")
