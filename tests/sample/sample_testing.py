# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""What the tests on the sample scene, of the Python module and of the documents share."""
import argparse
import array
import hashlib
import json
import os
import pathlib
import shutil
import struct
import subprocess
import sys
import zlib

SKIPPED = 77  # CTest's SKIP_RETURN_CODE.


def parse_arguments(*names):
    """--name VALUE for each of these."""
    parser = argparse.ArgumentParser()
    for name in names:
        parser.add_argument("--" + name, required=True)
    return parser.parse_args()


def call(*command, env=os.environ):
    """The ended process, with its output and errors as text."""
    return subprocess.run([str(part) for part in command], stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, text=True,
                          env=dict(env, QT_QPA_PLATFORM="offscreen"))


def run(*command, env=os.environ):
    """What a command prints that has to succeed."""
    result = call(*command, env=env)
    if result.returncode != 0:
        raise AssertionError(
            f"failed: {' '.join(map(str, command))}\n{result.stdout}{result.stderr}")
    return result.stdout


def check(condition, message):
    if not condition:
        sys.exit("FAILED: " + message)
    print("ok:", message)


def skip(reason):
    print("SKIPPED:", reason)
    sys.exit(SKIPPED)


def digests(folder):
    """The content of every file below a folder, by relative path."""
    return {os.path.relpath(path, folder): hashlib.sha256(path.read_bytes()).hexdigest()
            for path in pathlib.Path(folder).rglob("*") if path.is_file()}


def results(workspace):
    """The digests of all that depends on the input and the options alone."""
    return {path: digest for path, digest in digests(workspace).items()
            if path.startswith("stereo/") and not path.startswith("stereo/tsar/")}


def gray_png(rows, bits=8):
    """A PNG file of these rows of bytes."""
    def chunk(kind, data):
        body = kind + data
        return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))

    header = struct.pack(">IIBBBBB", len(rows[0]) * 8 // bits, len(rows), bits, 0, 0, 0, 0)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header)
            + chunk(b"IDAT", zlib.compress(b"".join(b"\0" + row for row in rows)))
            + chunk(b"IEND", b""))


def find_python_with_numpy():
    for python in (sys.executable, "/usr/bin/python3"):
        if subprocess.run([python, "-c", "import numpy"], stderr=subprocess.DEVNULL).returncode == 0:
            return python
    raise AssertionError("no python3 with numpy: install python3-numpy")


def unpack(repository, workspace):
    """Makes the sample scene anew."""
    shutil.rmtree(workspace, ignore_errors=True)
    run(find_python_with_numpy(), os.path.join(repository, "scripts", "sample_scene.py"), "unpack",
        os.path.join(repository, "data", "sample"), workspace)


def unpack_small(repository, workspace):
    """The same with maps of half the size, 240 x 180, with which everything
    takes a fifth of the time."""
    unpack(repository, workspace)
    for path in pathlib.Path(workspace, "stereo").glob("*_maps/*"):
        width, height, channels, body = path.read_bytes().split(b"&", 3)
        width, height, channels = int(width), int(height), int(channels)
        values, halved = array.array("f", body), array.array("f")
        for row in range(0, height * channels, 2):  # The sample's heights are even.
            halved.extend(values[row * width:(row + 1) * width:2])
        header = f"{width // 2}&{height // 2}&{channels}&"
        path.write_bytes(header.encode() + halved.tobytes())


def keep_images(workspace, count):
    """Has only the first images of the sample refined; the rest are sources."""
    text = "".join(f"v{i:03d}.jpg\n__auto__, 20\n" for i in range(count))
    pathlib.Path(workspace, "stereo", "patch-match.cfg").write_text(text)


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
