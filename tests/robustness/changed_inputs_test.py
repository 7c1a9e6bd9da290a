#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Changes what results depend on after a run has ended, one thing at a time. The
same command again names it and gives the bytes of a fresh run."""
import copy as objects
import math
import os
import shutil

import synthetic_workspace
from robustness import Setting, check, check_same, copy, read_tree
from synthetic_workspace import BASELINE, FOCAL, HEIGHT, NAMES, WIDTH

setting = Setting()
# An output workspace leads to its input by its full path, so that all is done in
# `work` and kept elsewhere.
work, begin, drawn, fresh = (setting.path(name) for name in ("work", "begin", "drawn", "fresh"))
dense, second = (os.path.join(work, name) for name in ("dense", "second"))
A, B, C, D = NAMES
# Each sees the next: all are one scene, but D is a neighbor of C alone.
CHAIN = {A: [B], B: [A, C], C: [B, D], D: [C]}
RESULTS = ("depth_maps", "normal_maps", "confidence_maps", "sigma_maps",
           "provenance_maps", "plane_maps")
BEGIN = 1_600_000_000  # Seconds; every file that is changed is a minute younger.


class ChangingWorkspace:
    """A synthetic workspace, in several folders at once, and what a user may change in
    it. Every change gives the files that it writes a later time than the one before,
    so that no two of them fall into one tick of the clock. sources: with which images
    each image is compared; those that are left out are no references."""

    def __init__(self, root):
        self.roots = [root]
        self.time = BEGIN
        self.position = {name: BASELINE * view for view, name in enumerate(NAMES)}
        self.focal = {name: FOCAL for name in NAMES}
        synthetic_workspace.draw(root, len(NAMES))
        for parent, _, files in os.walk(root):
            for file in files:
                os.utime(os.path.join(parent, file), (BEGIN, BEGIN))
        self.set_sources(CHAIN)

    def write(self, path, content):
        self.time += 60
        for root in self.roots:
            synthetic_workspace.write(os.path.join(root, path), content)
            os.utime(os.path.join(root, path), (self.time, self.time))

    def set_sources(self, sources, names=NAMES):
        """Writes the sparse model, in which each image has a camera of its own, and
        the lists of images."""
        self.sources = sources
        cameras = images = ""
        for number, name in enumerate(names, 1):
            focal = self.focal[name]
            cameras += f"{number} PINHOLE {WIDTH} {HEIGHT} {focal} {focal} {WIDTH / 2} {HEIGHT / 2}\n"
            images += f"{number} 1 0 0 0 {-self.position[name]} 0 0 {number} {name}\n\n"
        self.write("sparse/cameras.txt", cameras.encode())
        self.write("sparse/images.txt", images.encode())
        points = synthetic_workspace.sparse_model(names)["points3D.txt"]
        self.write("sparse/points3D.txt", points.encode())
        lists = "".join(f"{name}\n{', '.join(others)}\n" for name, others in sources.items())
        self.write("stereo/patch-match.cfg", lists.encode())
        self.write("stereo/fusion.cfg", "".join(f"{name}\n" for name in names).encode())

    def move(self, name):
        self.position[name] += 0.003
        self.set_sources(self.sources)

    def zoom(self, name):
        self.focal[name] *= 1.01
        self.set_sources(self.sources)

    def repaint(self, *names):
        for name in names:
            rows = [[level - 3 for level in row]
                    for row in synthetic_workspace.photo_rows(NAMES.index(name))]
            self.write("images/" + name, synthetic_workspace.png(rows))

    def match_again(self, name, kind):
        """As COLMAP does: both maps, over whatever has their names."""
        depths = [1.002 * d for d in synthetic_workspace.depth_map(NAMES.index(name), kind)]
        normals = [[0.002 if depth > 0 else 0.0 for depth in depths], [0.0] * len(depths),
                   [-math.sqrt(1 - 0.002**2) if depth > 0 else 0.0 for depth in depths]]
        tail = f"{name}.{kind}.bin"
        self.write("stereo/depth_maps/" + tail, synthetic_workspace.map_file([depths]))
        self.write("stereo/normal_maps/" + tail, synthetic_workspace.map_file(normals))

    def export_costs(self, name, *kinds):
        for kind in kinds:
            costs = [0.3 if x % 7 else 1.5 for _ in range(HEIGHT) for x in range(WIDTH)]
            self.write(f"stereo/cost_maps/{name}.{kind}.bin",
                       synthetic_workspace.map_file([costs, [2.0] * len(costs)]))


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
    """What becomes another one when an image is done again."""
    folder = os.path.join(root, "stereo", "confidence_maps")
    return {path: os.stat(os.path.join(folder, path)).st_ino for path in read_tree(folder)}


# What is changed, and what is said of it.
CHANGES = {
    "a pose": (lambda w: w.move(A), f"the camera of {A} has changed"),
    "a focal length": (lambda w: w.zoom(D), f"the camera of {D} has changed"),
    "a photo": (lambda w: w.repaint(B), f"the photo of {B} has changed"),
    "most of the photos": (lambda w: w.repaint(A, C, D), "and 2 other inputs have changed"),
    "a geometric map": (lambda w: w.match_again(D, "geometric"), f"map of {D}"),
    "a photometric map": (lambda w: w.match_again(A, "photometric"), f"map of {A}"),
    "new costs": (lambda w: w.export_costs(A, "geometric"),
                  f"the geometric cost map of {A} has changed"),
    "new costs of the other type": (lambda w: w.export_costs(B, "geometric", "photometric"),
                                    f"cost map of {B} and 1 other input have changed"),
    "a list of sources": (lambda w: w.set_sources({**CHAIN, A: [B, C]}),
                          f"the list of sources of {A} has changed"),
    "the order of sources": (lambda w: w.set_sources({**CHAIN, C: [D, B]}),
                             f"the list of sources of {C} has changed"),
    "a source is no reference": (lambda w: w.set_sources({A: [B], B: [A, C], C: [B, D]}),
                                 f"the list of sources of {D} has changed"),
    "an image is gone": (lambda w: w.set_sources({A: [B], B: [A, C], C: [B]}, NAMES[:3]),
                         "other inputs have changed"),
}

fresh_results = {}
for mode, (run, target) in MODES.items():
    for root in (work, drawn):
        shutil.rmtree(root, ignore_errors=True)
    start = ChangingWorkspace(drawn)
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
print(f"{len(CHANGES)} changes in {len(MODES)} ways")
