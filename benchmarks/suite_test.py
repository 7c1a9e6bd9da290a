#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Runs suite on a tiny scene and checks that it continues where it stopped,
that seeds give other maps, and its tables; without OpenCV for Python the runs
at other sizes are left out. suite_measures_test.py checks the measures."""

import importlib.util
import json
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
from copied_scene import Scene, make_copies
from programs import run
from testing import check, programs_and_fresh_folder

FOLDER = Path(__file__).resolve().parent


def make_scene(folder):
    """The sample with every eighth pixel of its maps, and a binary model."""
    sample, scene = folder / "sample", folder / "tiny"
    run([sys.executable, FOLDER.parent / "scripts" / "sample_scene.py",
         "unpack", FOLDER.parent / "data" / "sample", sample])
    make_copies(Scene(sample, folder / "reduced", 8), scene, 1, "auto")
    truth = scene / "ground_truth" / "depth"
    truth.mkdir(parents=True)
    for path in (sample / "ground_truth" / "depth").iterdir():
        shutil.copy(path, truth / f"0000_{path.name}")
    return scene


class Suite:
    def __init__(self, program, folder):
        self.folder = folder
        self.common = [sys.executable, FOLDER / "suite", "--program", program,
                       "--device", "cpu", "--cache", folder / "cache"]

    def __call__(self, *options, results="results", fuse=False):
        """What it printed."""
        output = run([*self.common, "--results", self.folder / results,
                      *([] if fuse else ["--no_fusion"]), *options])
        print(output)
        return output

    def fail(self, *options):
        """Its one line of error."""
        done = subprocess.run(
            [str(word) for word in [*self.common, "--no_fusion", "--results",
                                    self.folder / "results", *options]],
            capture_output=True, text=True, check=False)
        check(done.returncode == 1 and done.stderr.startswith("ERROR: ")
              and len(done.stderr.splitlines()) == 1,
              f"one line of error: {done.stderr.strip()}")
        return done.stderr

    def records(self, results="results"):
        return {path.name: path.stat().st_mtime_ns
                for path in (self.folder / results / "runs").glob("*.json")}

    def runs(self, results="results"):
        return json.loads((self.folder / results / "suite.json").read_text()
                          )["runs"]


def check_resumption(suite, scene):
    first = suite(scene, "--seeds", 2)
    check("[2/2]" in first and "→" in first, "progress and a table")
    records = suite.records()
    check(len(records) == 3, "two runs and the scores before are stored")
    scores = [one["scores"] for one in suite.runs()]
    check(scores[0] != scores[1], "another seed gives another result")
    before = suite.runs()[0]["before"]
    check(scores[0]["depth_all_0.05"][2] > before["depth_all_0.05"][2],
          "F1 rises")
    for key in ("harm", "lost", "view_disagreement", "sparse_right_1",
                "calibration_error"):
        check(0 <= scores[0][key] <= 1, f"{key} is a share")
    check(scores[0]["num_planes"] > 0 and before["true_num_planes"] > 0,
          "planes of the refined and of the true scene are counted")

    again = suite(scene, "--seeds", 2)
    check("min left" not in again and suite.records() == records,
          "nothing is measured twice")
    check(again == first[first.index("## "):], "the tables are the same")

    next(path for path in (suite.folder / "results" / "runs").glob("*.json")
         if '"seed": 1' in path.read_text()).unlink()
    output = suite(scene, "--seeds", 2)
    check("[2/2]" in output and "[1/2]" not in output,
          "what is missing is measured again")
    check([one["scores"] for one in suite.runs()] == scores,
          "the same seed gives the same result")

    variants = ("--variant", "default=", "--variant",
                "single=--TsarRefine.scene_planes 0")
    output = suite(scene, "--seeds", 2, *variants, "--compare", "default",
                   "single")
    check("[3/4]" in output and "[2/4]" not in output,
          "only the new variant is measured")
    check("### single against default" in output and "- HARM: " in output,
          "two variants are compared")


def check_other_inputs(suite, scene):
    output = suite(scene, "--seeds", 1, results="one")
    check("single" not in output, "results of another folder stay there")
    output = suite("--compare", suite.folder / "one",
                   f"{suite.folder / 'results'}:single")
    check("undecided" in output, "one seed decides nothing")
    shutil.copytree(scene, suite.folder / "bare",
                    ignore=shutil.ignore_patterns("ground_truth"))
    suite(suite.folder / "bare", "--seeds", 1, results="bare_results")
    scores = suite.runs("bare_results")[0]["scores"]
    check("harm" not in scores and "sparse_right_1" in scores,
          "without ground truth the sparse model tells")


def check_clouds(suite, scene):
    if shutil.which("colmap") is None:
        print("skipped: clouds; there is no COLMAP")
        return
    with_scans = suite.folder / "with_scans"
    shutil.copytree(scene, with_scans)
    shutil.copytree(suite.folder / "sample" / "scans", with_scans / "scans")
    options = (with_scans, "--seeds", 1, "--keep", suite.folder / "kept")
    output = suite(*options, results="clouds", fuse=True)
    check("by stereo_fusion and by tsar_fuse" in output, "a table of clouds")
    check("### Large surfaces" in output, "a table of surfaces")
    (one,) = suite.runs("clouds")
    for key in ("worst_surface", "tsar_fuse_worst_surface"):
        check(one["before"]["worst_surface"] < one["scores"][key] <= 1,
              f"{key} is better than before")
    for key in ("cloud_0.05", "tsar_fuse_cloud_0.05"):
        check(one["scores"][key][2] > 0, f"{key} is measured")
    check(not any(key.startswith("tsar_fuse") for key in one["before"]),
          "the maps before are fused by COLMAP alone")
    records = suite.records("clouds")
    suite(*options, results="clouds")
    check(suite.records("clouds") == records,
          "runs with clouds serve where none are asked for")
    for path in (suite.folder / "clouds" / "runs").glob("*.json"):
        path.unlink()
    suite(*options, results="clouds", fuse=True)
    check(suite.runs("clouds")[0]["scores"] == one["scores"],
          "kept clouds are replaced, and are the same")


def check_sizes(suite, scene):
    if importlib.util.find_spec("cv2") is None:
        print("skipped: other sizes and noise; there is no OpenCV for Python")
        return
    path = suite.folder / "scenes.json"
    path.write_text(json.dumps([
        {"name": "tiny", "path": scene.name, "role": "tuning", "maps":
         ["own", "tsar_stereo"], "sizes": [64, 96], "noise": [0, 4]}]))
    options = ("--scenes", path, "--root", scene.parent, "--seeds", 1)
    suite(*options, results="sizes")
    places = [(one["maps"], one["size"], one["noise"])
              for one in suite.runs("sizes")]
    check(places == [("own", 60, 0), ("tsar_stereo", 64, 0),
                     ("tsar_stereo", 64, 4), ("tsar_stereo", 96, 0),
                     ("tsar_stereo", 96, 4)], "a run of every kind")
    for axis in ("size", "noise"):
        check((suite.folder / "sizes" / f"suite_by_{axis}.svg").is_file(),
              f"a picture by {axis}")
    check(len(list((suite.folder / "cache").glob("*/made_from.json"))) == 4,
          "workspaces are kept")
    check("min left" not in suite(*options, results="sizes"),
          "made workspaces are recognized")


def check_normals(scene, folder):
    """The maps of a suite's smallest scene are too small for normals to count."""
    from suite_parts.simulated_priors import make_priors

    count = make_priors(scene, "normals", folder)
    paths = sorted(folder.rglob("*.normal.npy"))
    check(len(paths) == count > 0, "each image with a true depth has normals")
    normals = np.load(paths[0])
    check(np.allclose(np.linalg.norm(normals, axis=-1), 1, atol=1e-4),
          "they are unit vectors")
    check((normals[..., 2] < 0).mean() > 0.9, "most point towards the camera")


def check_priors(suite, scene):
    if importlib.util.find_spec("cv2") is None:
        print("skipped: simulated priors; there is no OpenCV for Python")
        return
    options = (scene, "--seeds", 1, "--priors")
    suite(*options, results="priors")
    scores = {one["variant"]: one["scores"] for one in suite.runs("priors")}
    check(list(scores) == ["default", "network prior", "lidar prior",
                           "normals prior"],
          "a run without and with each kind of prior")
    for kind in ("network prior", "lidar prior"):
        check(scores[kind]["depth_all_0.05"][1]
              > scores["default"]["depth_all_0.05"][1],
              f"more is right to 5 cm with the {kind}")
    check_normals(scene, suite.folder / "normals")
    check("min left" not in suite(*options, results="priors"),
          "runs with priors are recognized")
    check("ground_truth" in suite.fail(
        suite.folder / "bare", "--seeds", 1, "--variant",
        "one=--prior_path {network_prior}"),
          "without ground truth there are no priors")


def check_errors(suite, scene):
    check("nowhere" in suite.fail(scene, "--program", "nowhere"),
          "a missing program is named")
    check("no scenes" in suite.fail(), "no scenes are an error")
    check("NAME=" in suite.fail(scene, "--variant", "x"),
          "a variant without options is an error")
    path = suite.folder / "broken.json"
    for entry, words in (
            ({"role": "other"}, "not one of tuning, testing"),
            ({"role": "testing", "size": 640}, "'size' is unknown"),
            ({"role": "testing", "path": "nowhere"}, "no dense workspace"),
            ({"role": "testing", "maps": "tsar_stereo"}, "need 'sizes'")):
        path.write_text(json.dumps(
            [{"name": "tiny", "path": scene.name, **entry}]))
        check(words in suite.fail("--scenes", path, "--root", scene.parent),
              words)
    check("--compare" in suite.fail("--compare", suite.folder, "b"),
          "a folder without results is an error")


def main():
    program, folder = programs_and_fresh_folder("program")
    scene = make_scene(folder)
    suite = Suite(program, folder)
    check_resumption(suite, scene)
    check_other_inputs(suite, scene)
    check_clouds(suite, scene)
    check_sizes(suite, scene)
    check_priors(suite, scene)
    check_errors(suite, scene)
    shutil.rmtree(folder)


if __name__ == "__main__":
    main()
