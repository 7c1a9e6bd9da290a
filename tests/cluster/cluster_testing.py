# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of shards share: a small workspace, and what to expect of it."""
import json
import pathlib
import shutil
import tempfile

from sample_testing import check, keep_images, parse_arguments, results, run, unpack_small

NUM_IMAGES = 6
NUM_SHARDS = 3


class Scene:
    """Six images of the sample, in a folder of the test's own that is removed
    at its end."""

    def __init__(self):
        args = parse_arguments("program", "repository", "folder")
        self.program = pathlib.Path(args.program).resolve()
        self.repository = pathlib.Path(args.repository)
        pathlib.Path(args.folder).mkdir(parents=True, exist_ok=True)
        self.folder = pathlib.Path(tempfile.mkdtemp(dir=args.folder))
        self.sample = self.folder / "sample"
        unpack_small(self.repository, self.sample)
        shutil.rmtree(self.sample / "ground_truth")
        shutil.rmtree(self.sample / "scans")
        keep_images(self.sample, NUM_IMAGES)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        shutil.rmtree(self.folder)

    def copy(self, name, source=None):
        # With the files' times, by which observations are found valid.
        return pathlib.Path(
            shutil.copytree(source or self.sample, self.folder / name, symlinks=True))

    def command(self, workspace, *options):
        return [str(self.program), "tsar_refine", "--workspace_path", str(workspace),
                "--TsarRefine.device", "cpu", *options]

    def shard(self, workspace, pass_name, index, *options):
        return self.command(workspace, "--TsarRefine.num_threads", "1", "--TsarRefine.pass",
                            pass_name, "--TsarRefine.shard", f"{index}/{NUM_SHARDS}", *options)

    def whole(self):
        """A copy that one run refined."""
        workspace = self.copy("whole")
        run(*self.command(workspace))
        return workspace

    def disturbed_program(self, **actions):
        """A program that does the same, except that the first call for a shard
        of a pass runs an action first. actions: shell commands by names such as
        observe_1."""
        lines = ["#!/bin/sh", 'case "$*" in']
        for name, action in actions.items():
            pass_name, index = name.split("_")
            shard = f'*" {index}/{NUM_SHARDS}"*'
            lines.append(f'{shard}" {pass_name} "*|*" {pass_name} "{shard})'
                         f" mkdir '{self.folder / name}' 2>/dev/null && {action};;")
        program = self.folder / "disturbed"
        program.write_text("\n".join([*lines, "esac", f"exec '{self.program}' \"$@\"", ""]))
        program.chmod(0o755)
        return program


def account(workspace):
    """The manifest, without what differs from run to run."""
    manifest = json.loads((workspace / "stereo/tsar/manifest.json").read_text())
    del manifest["runtime"], manifest["seconds"]
    for image in manifest["images"]:
        del image["seconds"]
    return manifest


def check_as_one_run(workspace, expected):
    check(results(workspace) == results(expected), "the bytes are those of one run")
    check(account(workspace) == account(expected), "so is the account")
