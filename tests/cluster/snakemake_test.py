#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""scripts/cluster/Snakefile with three shards, of which one is killed once."""
import os
import shutil
import signal
import subprocess

from cluster_testing import (
    NUM_SHARDS,
    Scene,
    account,
    parse_arguments,
    results,
    skip,
    stop_half_way,
)
from sample_testing import check


def refine(scene, arguments, name):
    """A workspace that Snakemake refined, or None where the shard was too fast."""
    workspace = scene.copy(name)
    with open(scene.folder / f"{name}.txt", "w+") as log:
        snakemake = subprocess.Popen(
            [
                "snakemake",
                f"--snakefile={arguments.repository}/scripts/cluster/Snakefile",
                f"--directory={scene.folder}",
                f"--jobs={NUM_SHARDS}",
                "--config",
                f"workspace={workspace}",
                f"shards={NUM_SHARDS}",
                f"program={arguments.program}",
                "options=--TsarRefine.device cpu",
            ],
            stdout=log,
            stderr=subprocess.STDOUT,
            env=dict(os.environ, HOME=str(scene.folder)),
        )
        process = stop_half_way(
            workspace, "observe", 1, lambda: snakemake.poll() is not None
        )
        if process is not None:
            os.kill(process, signal.SIGKILL)
        snakemake.wait()
        log.seek(0)
        text = log.read()
    if snakemake.returncode != 0:
        print(text)
    check(snakemake.returncode == 0, "snakemake comes to its end")
    if process is None:
        return None
    check("Trying to restart" in text, "the killed shard was started again")
    return workspace


def main():
    arguments = parse_arguments()
    arguments.program = arguments.program.resolve()
    if shutil.which("snakemake") is None:
        skip("snakemake is not installed")
    with Scene(arguments) as scene:
        expected = scene.whole("whole")
        workspace = None
        count = 0
        while workspace is None:
            count += 1
            workspace = refine(scene, arguments, f"sharded{count}")
        check(results(workspace) == results(expected), "the bytes are those of one run")
        check(account(workspace) == account(expected), "so is the account")


main()
