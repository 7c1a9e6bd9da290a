#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Changes what results depend on after a run has ended, one thing at a time and
many at random. The same command again gives the bytes of a fresh run, names what
has changed; tsar_stereo, which would have to do all of it again, names it and
stops."""
import copy as objects
import json
import os
import random
import shutil

from changing_workspace import ChangingWorkspace
from synthetic_workspace import NAMES
from robustness import (Program, check, check_same, copy, make_folder, maps_of, parse_arguments,
                        read_tree)

SEED = 20250131
NUM_ROUNDS = 5

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
THREE = {A: [B], B: [A, C], C: [B]}
RESULTS = ("depth_maps", "normal_maps", "confidence_maps", "sigma_maps",
           "provenance_maps", "plane_maps")
OPTIONS = {"with the planes of the scene": [],
           "by themselves": ["--TsarRefine.scene_planes", 0]}
# Of those by themselves, what the other modes are tried with, too.
CHANGES_BY_THEMSELVES = ("a pose", "new costs of the other type")


def call(*words):
    code, errors = program.call("tsar_refine", *words)
    check(code == 0, f"{words} ended with {code}: {errors}")
    return errors


def in_place(root, options):
    return call(root, *options)


def to_second(root, options):
    return call(root, "--output_path", second, *options)


def by_shards(root, options):
    errors = ""
    for shard_pass in ("observe", "compose"):
        if shard_pass == "compose":
            errors += call(root, "--TsarRefine.pass", "model", *options)
        for shard in ("0/2", "1/2"):
            errors += call(root, "--TsarRefine.pass", shard_pass, "--TsarRefine.shard", shard,
                           *options)
    return errors + call(root, "--TsarRefine.pass", "merge", *options)


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
    found = {}
    for name in NAMES:
        path = os.path.join(root, "stereo", "confidence_maps", name + ".geometric.png")
        found[name] = os.stat(path).st_ino if os.path.exists(path) else None
    return found


def reasons(errors):
    """Why an image is refined again, by its name."""
    found = {}
    for line in errors.splitlines():
        place, _, reason = line.partition(": refined again, since ")
        if reason:
            # The progress may stand before it.
            name = next(name for name in NAMES if place.endswith(name))
            check(name not in found, f"{name} is named twice: {errors}")
            found[name] = reason
    return found


# Said of all other images.
SCENE = "other images of the scene have changed"

# What is changed, and what is then said of the images that it is of.
CHANGES = {
    "a pose": (lambda w: w.move(A), {A: "its camera has changed"}),
    "a focal length": (lambda w: w.zoom(D), {D: "its camera has changed"}),
    "a photo": (lambda w: w.repaint(B), {B: "its photo has changed"}),
    "most of the photos": (lambda w: (w.repaint(A), w.repaint(C), w.repaint(D)),
                           dict.fromkeys((A, C, D), "its photo has changed")),
    "a geometric map": (lambda w: w.match_again(D, "geometric"), {D: "its maps have changed"}),
    "a photometric map": (lambda w: w.match_again(A, "photometric"), {
        A: "its maps have changed"}),
    "new costs": (lambda w: w.export_costs(A, "geometric"), {A: "its cost maps have changed"}),
    "new costs of the other type": (
        lambda w: (w.export_costs(B, "geometric"), w.export_costs(B, "photometric")), {
            B: "its cost maps have changed"}),
    "a list of sources": (lambda w: w.set_sources({**CHAIN, A: [B, C]}), {
        A: "its list of sources has changed"}),
    "the order of sources": (lambda w: w.set_sources({**CHAIN, C: [D, B]}), {
        C: "its list of sources has changed"}),
    "a source is no reference": (
        lambda w: w.set_sources({A: [B], B: [A, C], C: [B, D]}), {}),
    "an image is gone": (lambda w: w.set_sources(THREE, NAMES[:3]), {
        C: "its list of sources has changed"}),
}
ADDING = {"an image is added": (lambda w: w.set_sources(CHAIN, NAMES), {
    D: None, C: "its list of sources has changed"})}


class Start:
    """A workspace that is in `drawn`, and refined in `begin`."""

    def __init__(self, sources, names, mode, options):
        self.run, self.target = MODES[mode]
        self.options = options
        for root in (work, drawn):
            shutil.rmtree(root, ignore_errors=True)
        self.workspace = ChangingWorkspace(drawn, CHAIN)
        self.workspace.set_sources(sources, names)
        copy(drawn, dense)
        check(not reasons(self.run(dense, options)), "nothing was refined before")
        copy(work, begin)

    def check_nothing_to_do(self, what):
        """Whoever does it: each knows what the others did."""
        before = written(self.target)
        for mode, (run, target) in MODES.items():
            if target == self.target:
                check(not reasons(run(dense, self.options)) and written(target) == before,
                      f"{what}, {mode} again: nothing is done")

    def check_change(self, case, what, change, expected, fresh_results):
        """fresh_results: by case, what fresh runs made; filled as need be."""
        copy(begin, work)
        copy(drawn, fresh)
        workspace = objects.deepcopy(self.workspace)
        workspace.roots = [dense, fresh]
        change(workspace)
        before = written(self.target)
        found = reasons(self.run(dense, self.options))
        expected = {**dict.fromkeys(workspace.sources, SCENE), **expected}
        told = {name: reason for name, reason in expected.items() if reason}
        check(found == told, f"{case}, {what}: told {found}, not {told}")
        after = written(self.target)
        again = {name for name in NAMES if after[name] != before[name]}
        check(again == set(expected), f"{case}, {what}: {again} were done again")
        if case not in fresh_results:
            in_place(fresh, self.options)
            fresh_results[case] = results(fresh, workspace.sources)
        check_same(results(self.target, workspace.sources), fresh_results[case], f"{case}, {what}")


def change_one_thing():
    num_changes = 0
    for about, options in OPTIONS.items():
        fresh_results = {}
        for mode in MODES:
            what = f"{about}, {mode}"
            for sources, names, changes in ((CHAIN, NAMES, CHANGES), (THREE, NAMES[:3], ADDING)):
                start = Start(sources, names, mode, options)
                start.check_nothing_to_do(what)
                for case, (change, expected) in changes.items():
                    if options and mode != "in place" and case not in CHANGES_BY_THEMSELVES:
                        continue
                    start.check_change(case, what, change, expected, fresh_results)
                    num_changes += 1
    return num_changes


def change_at_random():
    """Several things at a time, after one run after the other."""
    print(f"seed {SEED}")
    draw = random.Random(SEED)

    def one_change(workspace):
        image = draw.choice(workspace.names)
        kind = draw.choice(("geometric", "photometric"))
        factor = draw.uniform(1.001, 1.01)
        draw.choice((
            lambda: workspace.move(image, factor - 1),
            lambda: workspace.zoom(image, factor),
            lambda: workspace.repaint(image, draw.randrange(1, 9)),
            lambda: workspace.match_again(image, kind, factor),
            lambda: workspace.export_costs(image, kind, factor - 0.9),
            lambda: new_sources(workspace)))()

    def new_sources(workspace):
        references = draw.sample(NAMES, draw.randrange(2, 5))
        workspace.set_sources({name: draw.sample([other for other in NAMES if other != name],
                                                 draw.randrange(1, 4)) for name in references})

    num_again = 0
    for mode, (run, target) in MODES.items():
        workspace = Start(CHAIN, NAMES, mode, []).workspace
        workspace.roots = [dense, drawn]
        for round_number in range(NUM_ROUNDS):
            for _ in range(draw.randrange(1, 3)):
                one_change(workspace)
            num_again += len(reasons(run(dense, [])))
            copy(drawn, fresh)
            in_place(fresh, [])
            check_same(results(target, workspace.sources), results(fresh, workspace.sources),
                       f"{mode}, random change {round_number}")
    return num_again


def records_of_other_versions():
    Start(CHAIN, NAMES, "in place", [])
    path = os.path.join(dense, "stereo", "tsar", "records", B + ".geometric.json")
    copy(begin, work)
    with open(path, encoding="utf-8") as file:
        record = json.load(file)
    record.update(version="0.0.1")
    with open(path, "w", encoding="utf-8") as file:
        json.dump(record, file)
    before = written(dense)
    found = reasons(in_place(dense, []))
    check(found == {B: "it was refined by another version"}, f"told {found}")
    check([name for name in NAMES if written(dense)[name] != before[name]] == [B],
          "one image is done again")


STEREO = [word for name, value in (("num_iterations", 1), ("num_levels", 1),
                                   ("num_geometric_passes", 2))
          for word in ("--TsarStereo." + name, value)]
# What is changed before tsar_stereo is called again, and what it says.
STEREO_CHANGES = {
    "a pose": (lambda w: w.move(A), [f"images/{A}: its camera"]),
    "a focal length": (lambda w: w.zoom(D), [f"images/{D}: its camera has changed"]),
    "a photo": (lambda w: w.repaint(B), [f"images/{B}: its photo has changed since the maps"]),
    "two photos": (lambda w: (w.repaint(C), w.repaint(D)), [
        f"images/{C}: its photo has changed", "and 1 other image has changed, too"]),
    "a list of sources": (lambda w: w.set_sources({**CHAIN, A: [B, C]}), [
        f"images/{A}: its list of sources has changed"]),
    "a source is no reference": (lambda w: w.set_sources({A: [B], B: [A, C], C: [B, D]}), [
        f"images/{D}: its list of sources and the range of its sparse points have changed"]),
    "an image is gone": (lambda w: w.set_sources({A: [B], B: [A, C], C: [B]}, [A, B, C]), [
        f"images/{C}: its list of sources"]),
    "a sparse point": (lambda w: w.write("sparse/points3D.txt", b"1 0 0 6 0 0 0 0 1 0 2 0 3 0 4 0\n"), [
        f"images/{B}: the range of its sparse points has changed", "3 other images have"]),
}


class StereoStart:
    """Maps that tsar_stereo made in `work`, and none in `drawn`."""

    def __init__(self, sources):
        for root in (work, drawn):
            shutil.rmtree(root, ignore_errors=True)
        self.workspace = ChangingWorkspace(drawn, CHAIN, with_maps=False)
        self.workspace.set_sources(sources)
        copy(drawn, dense)
        program.run("tsar_stereo", dense, *STEREO)
        self.workspace.roots = [dense, drawn]

    def check_result(self, case):
        copy(drawn, fresh)
        program.run("tsar_stereo", fresh, *STEREO)
        made = maps_of(read_tree(fresh))
        # Maps of images that are no references any more stay.
        found = maps_of(read_tree(dense))
        check_same({path: found.get(path) for path in made}, made, case)

    def check_refused(self, case, texts):
        before = read_tree(dense)
        program.fails_with_one_line("tsar_stereo", dense, *STEREO,
                                    texts=[*texts, "give --overwrite 1"])
        check_same(read_tree(dense), before, f"{case} is refused")

    def check_goes_on(self, case, names):
        """That maps of these images alone are written."""
        def depths():
            folder = os.path.join(dense, "stereo", "depth_maps")
            return {path: os.stat(os.path.join(folder, path)).st_ino for path in read_tree(folder)}

        before = depths()
        program.run("tsar_stereo", dense, *STEREO)
        made = {path for path, number in depths().items() if before.get(path) != number}
        expected = {f"{name}.{kind}.bin" for name in names
                    for kind in ("photometric", "geometric")}
        check(made == expected, f"{case}: {made} were made")


def stereo():
    for case, (change, texts) in STEREO_CHANGES.items():
        start = StereoStart(CHAIN)
        start.check_goes_on("nothing", [])
        change(start.workspace)
        start.check_refused(case, texts)
        program.run("tsar_stereo", dense, *STEREO, "--overwrite", 1)
        start.check_result(case)
        start.check_goes_on("nothing", [])

    # An image on which no other one depends can come and go.
    four = {**THREE, D: [C]}
    start = StereoStart(THREE)
    start.workspace.set_sources(four)
    start.check_goes_on("an image is added", [D])
    start.check_result("an image is added")
    start.workspace.set_sources(THREE)
    start.check_goes_on("it goes", [])
    start.workspace.set_sources(four)
    start.check_goes_on("it comes back", [])
    start.check_result("it comes back")
    # But not with another photo, or with maps of another time.
    start.workspace.set_sources(THREE)
    start.workspace.repaint(D)
    start.check_goes_on("what is not used changes", [])
    start.workspace.set_sources(four)
    start.check_refused("it comes back as another one", [f"images/{D}: its photo"])
    start.workspace.set_sources(THREE)
    start.workspace.repaint(A)
    program.run("tsar_stereo", dense, *STEREO, "--overwrite", 1)
    start.workspace.set_sources(four)
    start.check_refused("it comes back from another time", [f"{D}.photometric.bin: is of another"])
    program.run("tsar_stereo", dense, *STEREO, "--overwrite", 1)
    start.check_result("it comes back from another time")


changes = change_one_thing()
done_again = change_at_random()
records_of_other_versions()
stereo()
print(f"{changes} changes, {done_again} images done again after random ones")
