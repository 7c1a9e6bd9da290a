#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""scripts/cluster/submit.sh on a Slurm of one machine: three shards, one killed
in the first pass, one requeued by the scheduler in the second."""
import re
import time

from cluster_testing import NUM_SHARDS, Scene, check_as_one_run
from sample_testing import check, skip
from slurm import NotAvailable, Slurm


def refine(slurm, scene):
    """A workspace refined through Slurm."""
    workspace = scene.copy("sharded")
    program = scene.disturbed_program(observe_1="kill -KILL $$", compose_2="exec sleep 600")
    output = slurm.run(
        scene.repository / "scripts/cluster/submit.sh", workspace, NUM_SHARDS,
        "--TsarRefine.device", "cpu", "--TsarRefine.num_threads", "1",
        TSAR_PROGRAM=str(program), SBATCH_OUTPUT=str(scene.folder / "sharded-%x-%a.txt"),
        SBATCH_CHDIR=str(scene.folder))
    observe, _, compose, merge = re.fullmatch(
        r"observe (\d+), model (\d+), compose (\d+), merge (\d+)\n", output).groups()
    while jobs := slurm.jobs():
        if (scene.folder / "compose_2").exists() and jobs.get(f"{compose}_2") == "RUNNING" and \
                slurm.describe(f"{compose}_2")["Restarts"] == "0":
            slurm.run("scontrol", "requeue", f"{compose}_2")
        time.sleep(0.2)
    state = slurm.describe(merge)["JobState"]
    if state != "COMPLETED":
        for path in sorted(scene.folder.glob("sharded-*.txt")):
            print(f"== {path.name}\n{path.read_text()}")
        print(slurm.logs())
    check(state == "COMPLETED", f"all jobs come to their end ({state})")
    for job, restarts in ((f"{observe}_1", "1"), (f"{compose}_2", "1"), (f"{compose}_0", "0")):
        check(slurm.describe(job)["Restarts"] == restarts, f"{job} was queued again {restarts} times")
    return workspace


try:
    with Scene() as scene, Slurm() as slurm:
        check_as_one_run(refine(slurm, scene), scene.whole())
except NotAvailable as reason:
    skip(reason)
