#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Runs scale on few tiny images and checks its tables and its picture, and that
copies have the sources and the maps of the scene. Its interrupted run is left
out: so few images may be done before they are interrupted."""

import json
import shutil
import subprocess
import sys
import xml.etree.ElementTree
from pathlib import Path

from copied_scene import Scene, SceneError, make_copies
from line_plot import write_line_plot
from programs import run
from testing import check, programs_and_fresh_folder

FOLDER = Path(__file__).resolve().parent
RUNS = ["again, every image done", "--restore 1", "to a second workspace",
        "to it again, every image done"]


def table(lines, title):
    """The rows of the table under this title."""
    rows = []
    for line in lines[lines.index(title) + 4:]:
        if not line.startswith("|"):
            break
        rows.append([cell.strip() for cell in line.strip("|").split("|")])
    return rows


def refine(program, workspace):
    run([program, "tsar_refine", "--workspace_path", workspace,
         "--TsarRefine.device", "cpu"])
    return {path.relative_to(workspace): path.read_bytes()
            for path in (workspace / "stereo" / "depth_maps").iterdir()}


def check_copies(program, folder):
    """Every copy of a scene gives nearly what the scene alone gives, whoever
    chooses the sources."""
    sample = folder / "sample"
    run([sys.executable, FOLDER.parent / "scripts" / "sample_scene.py",
         "unpack", FOLDER.parent / "data" / "sample", sample])
    scene = Scene(sample, folder / "reduced", 8)
    check(scene.map_size == (60, 45), "maps have every eighth pixel")
    results = {}
    for sources in ("auto", "listed"):
        make_copies(scene, folder / sources, 2, sources)
        results[sources] = refine(program, folder / sources)
    check(len(results["auto"]) == 2 * len(scene.maps) / 2,
          "every map of every copy is there")
    check(results["auto"] == results["listed"],
          "each image finds all others of its copy, and none of another")
    make_copies(scene, folder / "linked", 4, "linked")
    config = (folder / "linked" / "stereo" / "patch-match.cfg").read_text()
    sources = dict(zip(*[iter(config.splitlines())] * 2))
    names = [image.name for image in scene.images]
    check([source.split("_")[0] for source
           in sources[f"0000_{names[0]}"].split(", ")[-3:]]
          == ["0000", "0001", "0002"],
          "linked copies have sources to the right and below")
    check(len(sources[f"0003_{names[0]}"].split(", ")) == len(names) - 1,
          "the last one has none but its own")
    refine(program, folder / "linked")
    run([program, "tsar_planes", "--workspace_path", folder / "linked",
         "--output_path", folder / "planes.json"])
    planes = json.loads((folder / "planes.json").read_text())["planes"]
    check({plane["component"] for plane in planes} == {0},
          "all of their views are connected")
    check(any(len(plane["images"]) > len(names) for plane in planes),
          "a wall goes on from copy to copy")
    broken = folder / "broken"
    shutil.copytree(sample, broken)
    (broken / "sparse" / "cameras.txt").write_text(
        "1 OPENCV 640 480 500 500 320 240 0 0 0 0\n")
    try:
        Scene(broken, folder / "reduced_broken", 8)
        check(False, "a camera with distortion is refused")
    except SceneError as error:
        check("distortion" in str(error),
              "a camera with distortion is refused")


def check_picture(folder):
    path = folder / "plot.svg"
    write_line_plot(path, "n", [10, 100, 1000],
                    [("a < b", [5.0, 5.0, 5.0]), ("c", [0.0, 40.0, 130.0])])
    root = xml.etree.ElementTree.parse(path).getroot()
    space = "{http://www.w3.org/2000/svg}"
    curves = [[tuple(map(float, point.split(",")))
               for point in line.get("points").split()]
              for line in root.iter(space + "polyline")]
    check(len(curves) == 2, "a curve for each row of numbers")
    check(len({y for _, y in curves[0]}) == 1, "what is flat is drawn flat")
    xs = [x for x, _ in curves[1]]
    check(abs(xs[2] - 2 * xs[1] + xs[0]) < 0.2, "the x axis is logarithmic")
    ys = [y for _, y in curves[1]]
    check(ys[0] > ys[1] > ys[2], "larger is higher")
    check("a < b" in [text.text for text in root.iter(space + "text")],
          "names may hold any character")


def main():
    program, folder = programs_and_fresh_folder("program")
    check_picture(folder)
    check_copies(program, folder)

    output = run([sys.executable, FOLDER / "scale", "--program",
                  program, "--device", "cpu", "--num_images", 24, 5,
                  "--folder", folder / "work", "--plot", folder / "scale.svg",
                  "--passes", "--fuse",
                  "--also", "resume", "restore", "output"])
    print(output)
    lines = output.splitlines()
    sizes = table(lines, "### Time and memory by the number of images")
    check([row[0] for row in sizes] == ["8", "24"],
          "numbers of images are those of whole copies, in order")
    check(all(float(cell) > 0 for row in sizes for cell in row[1:6]),
          "times and memory are positive")
    fusions = table(lines, "### tsar_fuse by the number of images")
    check([row[0] for row in fusions] == ["8", "24"],
          "clouds are fused of the same numbers of images")
    check(all(float(cell) > 0 for row in fusions for cell in row[2:]),
          "fusion takes time and memory")
    passes = table(
        lines, "### Processor ms per image and peak memory (GB) by pass")
    check([row[0] for row in passes] == ["8", "24"],
          "passes are measured on the same numbers of images")
    check(all(len(row) == 9 and float(cell) > 0
              for row in passes for cell in row[1:]),
          "each pass takes time and memory")
    others = table(lines, "### Other runs on 24 images")
    check([row[0] for row in others] == RUNS, "the other runs are all there")
    check((folder / "scale.svg").is_file(), "there is a picture")
    check(not list((folder / "work").iterdir()), "no workspace is left")

    failed = subprocess.run(
        [sys.executable, FOLDER / "scale", "--program", folder / "missing",
         "--folder", folder / "work"], capture_output=True, text=True,
        check=False)
    check(failed.returncode == 1 and failed.stderr.startswith("ERROR: ") and
          len(failed.stderr.splitlines()) == 1,
          "a missing program is one line of error")
    shutil.rmtree(folder)


if __name__ == "__main__":
    main()
