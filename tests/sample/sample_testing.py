# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""What the tests on the sample scene and of the Python module share."""
import hashlib
import json
import os
import shutil
import subprocess
import sys


def call(*command, env=os.environ):
    """The ended process, with its output and errors as text."""
    return subprocess.run(
        [str(part) for part in command],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=dict(env, QT_QPA_PLATFORM="offscreen"),
    )


def run(*command, env=os.environ):
    """What a command prints that has to succeed."""
    result = call(*command, env=env)
    if result.returncode != 0:
        raise AssertionError(
            f"failed: {' '.join(map(str, command))}\n{result.stdout}{result.stderr}"
        )
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
    raise AssertionError("no python3 with numpy: install python3-numpy")


def unpack(repository, workspace):
    """Makes the sample scene anew."""
    shutil.rmtree(workspace, ignore_errors=True)
    run(
        find_python_with_numpy(),
        os.path.join(repository, "scripts", "sample_scene.py"),
        "unpack",
        os.path.join(repository, "data", "sample"),
        workspace,
    )


def score(colmap, program, workspace, sample=None):
    """ETH3D's measure, at 2 cm, of the cloud that this COLMAP fuses now; program
    has tsar_evaluate, sample the scans if the workspace is a copy."""
    cloud = os.path.join(workspace, "cloud.ply")
    # One thread, because COLMAP's result depends on the threads' order.
    run(colmap, "stereo_fusion", "--workspace_path", workspace, "--input_type",
        "geometric", "--output_path", cloud, "--StereoFusion.num_threads", 1)
    text = run(program, "tsar_evaluate", "cloud", "--input_path", cloud,
               "--ground_truth_path", os.path.join(sample or workspace, "scans", "scan_alignment.mlp"),
               "--tolerances", "0.02", "--json", 1)
    os.remove(cloud)
    os.remove(cloud + ".vis")
    return json.loads(text)["scores"][0]
