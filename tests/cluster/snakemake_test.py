#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""scripts/cluster/Snakefile with three shards, one of which is killed once."""
import os
import shutil

from cluster_testing import NUM_SHARDS, Scene, check_as_one_run
from sample_testing import call, check, skip

if shutil.which("snakemake") is None:
    skip("snakemake is not installed")
with Scene() as scene:
    expected = scene.whole()
    workspace = scene.copy("sharded")
    result = call(
        "snakemake", f"--snakefile={scene.repository}/scripts/cluster/Snakefile",
        f"--directory={scene.folder}", f"--jobs={NUM_SHARDS}", "--config",
        f"workspace={workspace}", f"shards={NUM_SHARDS}",
        f"program={scene.disturbed_program(observe_1='kill -KILL $$')}",
        "options=--TsarRefine.device cpu", env=dict(os.environ, HOME=str(scene.folder)))
    check(result.returncode == 0, "snakemake comes to its end\n" + result.stderr)
    check("Trying to restart" in result.stdout + result.stderr, "the killed shard was started again")
    check_as_one_run(workspace, expected)
