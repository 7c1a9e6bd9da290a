#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Changes what results depend on after a run has ended, one thing at a time. The
same command again names it and gives the bytes of a fresh run."""
import copy as objects
import os
import shutil

from changing_workspace import ChangingWorkspace
from synthetic_workspace import NAMES
from robustness import (Program, check, check_same, copy, make_folder, parse_arguments,
                        read_tree)

args = parse_arguments()
program = Program(args.program)
folder = make_folder(args.folder)
# An output workspace leads to its input by its full path, so that all is done in
# `work` and kept elsewhere.
work, begin, drawn, fresh = (os.path.join(folder.name, name)
                             for name in ("work", "begin", "drawn", "fresh"))
dense, second = (os.path.join(work, name) for name in ("dense", "second"))
A, B, C, D = NAMES
# Each sees the next: all are one scene, but D is a neighbor of C alone.
CHAIN = {A: [B], B: [A, C], C: [B, D], D: [C]}
RESULTS = ("depth_maps", "normal_maps", "confidence_maps", "sigma_maps",
           "provenance_maps", "plane_maps")


def call(*words):
    code, errors = program.call("tsar_refine", *words)
    check(code == 0, f"{words} ended with {code}: {errors}")
    return errors


def in_place(root):
    return call(root)


def to_second(root):
    return call(root, "--output_path", second)


def by_shards(root):
    errors = ""
    for shard_pass in ("observe", "compose"):
        if shard_pass == "compose":
            errors += call(root, "--TsarRefine.pass", "model")
        for shard in ("0/2", "1/2"):
            errors += call(root, "--TsarRefine.pass", shard_pass, "--TsarRefine.shard", shard)
    return errors + call(root, "--TsarRefine.pass", "merge")


MODES = {"in place": (in_place, dense), "to a second workspace": (to_second, second),
         "by shards": (by_shards, dense)}


def results(root, names):
    """The maps of these images, by their paths."""
    stereo = os.path.join(root, "stereo")
    return {path: content
            for kind in RESULTS
            for path, content in read_tree(os.path.join(stereo, kind)).items()
            for name in names if path.startswith(name + ".geometric.")
            for path in [os.path.join(kind, path)]}


def written(root):
    """What becomes another one when an image is done again."""
    folder_path = os.path.join(root, "stereo", "confidence_maps")
    return {path: os.stat(os.path.join(folder_path, path)).st_ino
            for path in read_tree(folder_path)}


# What is changed, and what is said of it.
CHANGES = {
    "a pose": (lambda w: w.move(A), f"the camera of {A} has changed"),
    "a focal length": (lambda w: w.zoom(D), f"the camera of {D} has changed"),
    "a photo": (lambda w: w.repaint(B), f"the photo of {B} has changed"),
    "most of the photos": (lambda w: (w.repaint(A), w.repaint(C), w.repaint(D)),
                           "and 2 other inputs have changed"),
    "a geometric map": (lambda w: w.match_again(D, "geometric"), f"map of {D}"),
    "a photometric map": (lambda w: w.match_again(A, "photometric"), f"map of {A}"),
    "new costs": (lambda w: w.export_costs(A, "geometric"),
                  f"the geometric cost map of {A} has changed"),
    "new costs of the other type": (
        lambda w: (w.export_costs(B, "geometric"), w.export_costs(B, "photometric")),
        f"cost map of {B} and 1 other input have changed"),
    "a list of sources": (lambda w: w.set_sources({**CHAIN, A: [B, C]}),
                          f"the list of sources of {A} has changed"),
    "the order of sources": (lambda w: w.set_sources({**CHAIN, C: [D, B]}),
                             f"the list of sources of {C} has changed"),
    "a source is no reference": (
        lambda w: w.set_sources({A: [B], B: [A, C], C: [B, D]}),
        f"the list of sources of {D} has changed"),
    "an image is gone": (lambda w: w.set_sources({A: [B], B: [A, C], C: [B]}, NAMES[:3]),
                         "other inputs have changed"),
}


def change_one_thing():
    fresh_results = {}
    for mode, (run, target) in MODES.items():
        for root in (work, drawn):
            shutil.rmtree(root, ignore_errors=True)
        start = ChangingWorkspace(drawn, CHAIN)
        start.set_sources(CHAIN, NAMES)
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
            workspace = objects.deepcopy(start)
            workspace.roots = [dense, fresh]
            change(workspace)
            before = written(target)
            errors = run(dense)
            lines = [line for line in errors.splitlines() if ": refined again, since" in line]
            check(lines and all(told in line for line in lines), f"{case}, {mode}: told {errors}")
            after = written(target)
            again = {path for path in after if after[path] != before.get(path)}
            check(again == {f"{name}.geometric.png" for name in workspace.sources},
                  f"{case}, {mode}: {again} were done again")
            if case not in fresh_results:
                in_place(fresh)
                fresh_results[case] = results(fresh, workspace.sources)
            check_same(results(target, workspace.sources), fresh_results[case], f"{case}, {mode}")


change_one_thing()
print(f"{len(CHANGES)} changes in {len(MODES)} ways")
