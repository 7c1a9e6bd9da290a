#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Refines the sample scene in place, fuses before and after with an unmodified
COLMAP, and checks the gain, the provenance of every pixel, that nothing but the
maps to refine changed, and that --restore gives every byte back."""
import argparse
import hashlib
import json
import os
import shutil
import subprocess
import sys


def run(*command):
    result = subprocess.run(
        [str(part) for part in command],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        env=dict(os.environ, QT_QPA_PLATFORM="offscreen"),
    )
    if result.returncode != 0:
        sys.exit(f"failed: {' '.join(map(str, command))}\n{result.stdout}")
    return result.stdout


def check(condition, message):
    if not condition:
        sys.exit("FAILED: " + message)
    print("ok:", message)


def digests(folder):
    """The content of every file below a folder, by relative path."""
    found = {}
    for parent, _, names in os.walk(folder):
        for name in names:
            path = os.path.join(parent, name)
            with open(path, "rb") as file:
                found[os.path.relpath(path, folder)] = hashlib.sha256(
                    file.read()
                ).hexdigest()
    return found


def find_python_with_numpy():
    for python in (sys.executable, "/usr/bin/python3"):
        if subprocess.run([python, "-c", "import numpy"], stderr=subprocess.DEVNULL).returncode == 0:
            return python
    sys.exit("no python3 with numpy: install python3-numpy")


parser = argparse.ArgumentParser()
for name in ("program", "colmap", "repository", "workspace"):
    parser.add_argument("--" + name, required=True)
args = parser.parse_args()

shutil.rmtree(args.workspace, ignore_errors=True)
run(
    find_python_with_numpy(),
    os.path.join(args.repository, "scripts", "sample_scene.py"),
    "unpack",
    os.path.join(args.repository, "data", "sample"),
    args.workspace,
)


def score(name):
    """ETH3D's measure of the cloud that COLMAP fuses now, at 2 cm."""
    cloud = os.path.join(args.workspace, name + ".ply")
    # One thread, because COLMAP's result depends on the threads' order.
    run(args.colmap, "stereo_fusion", "--workspace_path", args.workspace, "--input_type",
        "geometric", "--output_path", cloud, "--StereoFusion.num_threads", 1)
    text = run(args.program, "tsar_evaluate", "cloud", "--input_path", cloud,
               "--ground_truth_path", os.path.join(args.workspace, "scans", "scan_alignment.mlp"),
               "--tolerances", "0.02", "--json", 1)
    result = json.loads(text)
    os.remove(cloud)
    os.remove(cloud + ".vis")
    return result["scores"][0]


original = digests(args.workspace)
before = score("before")
run(args.program, "tsar_refine", "--workspace_path", args.workspace)
refined = digests(args.workspace)
after = score("after")
print("before", before)
print("after ", after)
check(after["f1"] > before["f1"] + 0.15, "F1 at 2 cm rises by over 0.15")
check(after["accuracy"] > before["accuracy"] - 0.05, "accuracy falls by less than 0.05")

changed = {path for path in original if refined.get(path) != original[path]}
expected = {
    path
    for path in original
    if path.startswith(("stereo/depth_maps", "stereo/normal_maps")) and ".geometric." in path
}
check(changed == expected, "exactly the geometric maps changed")
kept = {
    path[len("stereo/tsar/original/"):]: digest
    for path, digest in refined.items()
    if path.startswith("stereo/tsar/original/")
}
check(
    kept == {path[len("stereo/"):]: original[path] for path in expected},
    "all originals are kept",
)

summary = run(args.program, "tsar_refine", "--workspace_path", args.workspace)
check("8 done before" in summary, "a second run has nothing to do")
run(args.program, "tsar_refine", "--workspace_path", args.workspace, "--restore", 1)
check(digests(args.workspace) == original, "--restore gives every byte back")
