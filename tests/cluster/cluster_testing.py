# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of shards share: a small workspace, and what to expect of it."""
import argparse
import array
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time

from sample_testing import call, digests, run, unpack

SKIPPED = 77  # CTest's SKIP_RETURN_CODE.
NUM_IMAGES = 6
NUM_SHARDS = 3


def parse_arguments():
    parser = argparse.ArgumentParser()
    for name in ("program", "repository", "folder"):
        parser.add_argument("--" + name, type=pathlib.Path, required=True)
    return parser.parse_args()


def skip(reason):
    print("SKIPPED:", reason)
    sys.exit(SKIPPED)


def _halve(path):
    """Leaves every second pixel of a map in every second row."""
    width, height, channels, body = path.read_bytes().split(b"&", 3)
    width, height, channels = int(width), int(height), int(channels)
    values = array.array("f", body)
    halved = array.array("f")
    for row in range(0, height * channels, 2):  # The sample's heights are even.
        halved.extend(values[row * width : (row + 1) * width : 2])
    header = f"{(width + 1) // 2}&{height // 2}&{channels}&".encode()
    path.write_bytes(header + halved.tobytes())


class Scene:
    """Six images of the sample with maps of half the size, in a folder of the
    test's own that goes when the test ends."""

    def __init__(self, arguments):
        self.program = arguments.program
        arguments.folder.mkdir(parents=True, exist_ok=True)
        self.folder = pathlib.Path(tempfile.mkdtemp(dir=arguments.folder))
        self.sample = self.folder / "sample"
        unpack(arguments.repository, self.sample)
        shutil.rmtree(self.sample / "ground_truth")
        shutil.rmtree(self.sample / "scans")
        names = [f"v{i:03d}.jpg" for i in range(NUM_IMAGES)]
        config = "".join(f"{name}\n__auto__, 20\n" for name in names)
        (self.sample / "stereo" / "patch-match.cfg").write_text(config)
        for kind in ("depth_maps", "normal_maps"):
            for path in (self.sample / "stereo" / kind).iterdir():
                _halve(path)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        shutil.rmtree(self.folder)

    def copy(self, name, source=None):
        # With the files' times, by which what was observed in them is known.
        return pathlib.Path(
            shutil.copytree(source or self.sample, self.folder / name, symlinks=True)
        )

    def command(self, workspace, *options):
        return [
            str(self.program),
            "tsar_refine",
            "--workspace_path",
            str(workspace),
            "--TsarRefine.device",
            "cpu",
            *options,
        ]

    def shard(self, workspace, pass_name, index, *options):
        return self.command(
            workspace,
            "--TsarRefine.num_threads",
            "1",
            "--TsarRefine.pass",
            pass_name,
            "--TsarRefine.shard",
            f"{index}/{NUM_SHARDS}",
            *options,
        )

    def whole(self, name, *options):
        """A copy that one run refined."""
        workspace = self.copy(name)
        run(*self.command(workspace, *options))
        return workspace


def results(workspace):
    """The digests of all that depends on the input and the options alone."""
    return {
        path: digest
        for path, digest in digests(workspace).items()
        if not path.startswith("stereo/tsar/") or "/original/" in path
    }


def account(workspace):
    """The manifest, without what differs from run to run."""
    manifest = json.loads((workspace / "stereo/tsar/manifest.json").read_text())
    del manifest["runtime"], manifest["seconds"]
    for image in manifest["images"]:
        del image["seconds"]
    return manifest


def is_done(workspace, pass_name, image):
    folder = workspace / "stereo/tsar"
    if pass_name == "observe":
        return (folder / "evidence" / f"{image}.geometric.bin").exists()
    path = folder / "records" / f"{image}.geometric.json"
    if not path.exists() or json.loads(path.read_text())["status"] != "done":
        return False
    # The record comes first, and the map of planes last.
    return (workspace / "stereo/plane_maps" / f"{image}.geometric.png").exists()


def num_done(workspace, pass_name):
    return sum(is_done(workspace, pass_name, f"v{i:03d}.jpg") for i in range(NUM_IMAGES))


def find_process(workspace, pass_name, index):
    """The number of the process that works on a shard, or None."""
    wanted = {str(workspace), pass_name, f"{index}/{NUM_SHARDS}", "tsar_refine"}
    for folder in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            words = (folder / "cmdline").read_bytes().decode(errors="replace").split("\0")
        except OSError:
            continue
        if wanted <= set(words) and words[1] == "tsar_refine":
            return int(folder.name)
    return None


def stop_half_way(workspace, pass_name, index, is_over):
    """Waits until a shard is at work and an image has been done, and has the
    shard's process stand still then. Returns its number, or None where the shard
    got to its end before that."""
    before = num_done(workspace, pass_name)
    while not is_over():
        process = find_process(workspace, pass_name, index)
        if process is not None and num_done(workspace, pass_name) > before:
            try:
                os.kill(process, signal.SIGSTOP)
            except ProcessLookupError:
                return None
            return process
        time.sleep(0.002)
    return None


def start(command):
    return subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )


def end(process):
    """What a process printed that has to succeed."""
    output = process.communicate()[0]
    if process.returncode != 0:
        raise AssertionError(f"failed: {process.args}\n{output}")
    return output
