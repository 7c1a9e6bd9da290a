#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""scripts/cluster/submit.sh on a Slurm of one machine: three shards, of which one
is killed in the first pass and one queued again by the scheduler in the second."""
import os
import re
import signal
import time

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
from slurm import NotAvailable, Slurm


def states(slurm, job):
    return [slurm.jobs().get(f"{job}_{index}") for index in range(NUM_SHARDS)]


def wait_for_start(slurm, job):
    while None not in states(slurm, job) and "RUNNING" not in states(slurm, job):
        time.sleep(0.1)


def disturb(slurm, workspace, job, pass_name, victim, action):
    """Does it to a shard that is half done. Returns whether there was time."""
    wait_for_start(slurm, job)
    process = stop_half_way(
        workspace, pass_name, victim, lambda: f"{job}_{victim}" not in slurm.jobs()
    )
    if process is None:
        return False
    action(process)
    return True


def refine(slurm, scene, arguments, name):
    """A workspace that Slurm refined, or None where shards were too fast."""
    workspace = scene.copy(name)
    output = slurm.run(
        arguments.repository / "scripts/cluster/submit.sh",
        workspace,
        NUM_SHARDS,
        "--TsarRefine.device",
        "cpu",
        "--TsarRefine.num_threads",
        "1",
        TSAR_PROGRAM=str(arguments.program),
        SBATCH_OUTPUT=str(scene.folder / f"{name}-%x-%a.txt"),
        SBATCH_CHDIR=str(scene.folder),
    )
    observe, _, compose, merge = re.fullmatch(
        r"observe (\d+), model (\d+), compose (\d+), merge (\d+)\n", output
    ).groups()

    def queue_again(process):
        slurm.run("scontrol", "requeue", f"{compose}_2")
        os.kill(process, signal.SIGCONT)

    was_in_time = disturb(
        slurm, workspace, observe, "observe", 1, lambda p: os.kill(p, signal.SIGKILL)
    ) and disturb(slurm, workspace, compose, "compose", 2, queue_again)
    while slurm.jobs():
        time.sleep(0.2)
    state = slurm.describe(merge)["JobState"]
    if state != "COMPLETED":
        for path in sorted(scene.folder.glob(f"{name}-*.txt")):
            print(f"== {path.name}\n{path.read_text()}")
        print(slurm.logs())
    check(state == "COMPLETED", f"all jobs come to their end ({state})")
    if not was_in_time:
        return None
    check(slurm.describe(f"{observe}_1")["Restarts"] == "1", "a killed shard was queued again")
    check(slurm.describe(f"{compose}_2")["Restarts"] == "1", "a shard was queued again")
    check(slurm.describe(f"{compose}_0")["Restarts"] == "0", "no other was")
    return workspace


def main():
    arguments = parse_arguments()
    arguments.program = arguments.program.resolve()
    try:
        with Scene(arguments) as scene, Slurm() as slurm:
            expected = scene.whole("whole")
            workspace = None
            count = 0
            while workspace is None:
                count += 1
                workspace = refine(slurm, scene, arguments, f"sharded{count}")
            check(results(workspace) == results(expected), "the bytes are those of one run")
            check(account(workspace) == account(expected), "so is the account")
    except NotAvailable as reason:
        skip(reason)


main()
