#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Three shards run as parallel processes, one of which is killed in each pass:
what the others and further programs may do meanwhile, and that the result is
that of a single run."""
import json
import os
import re
import shutil
import signal
import subprocess
import time

from cluster_testing import NUM_IMAGES, NUM_SHARDS, Scene, check_as_one_run
from sample_testing import call, check, digests, run


def files(workspace):
    """All but the locks of the workspace and of shards, which may stay."""
    return {path: digest for path, digest in digests(workspace).items()
            if not path.endswith("lock")}


def expect_refusal(workspace, texts, command, what):
    before = files(workspace)
    result = call(*command)
    check(result.returncode == 1 and result.stderr.count("\n") == 1
          and all(text in result.stderr for text in texts) and files(workspace) == before,
          f"{what} is refused: {result.stderr.strip()}")


def num_done(workspace, pass_name):
    stereo = workspace / "stereo"
    if pass_name == "observe":
        return len(list(stereo.glob("tsar/evidence/*.geometric.bin")))
    # The record comes first, and the map of planes last.
    return sum(json.loads(record.read_text())["status"] == "done"
               and (stereo / "plane_maps" / f"{record.stem}.png").exists()
               for record in stereo.glob("tsar/records/*.json"))


def start(command):
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def run_shards(scene, workspace, pass_name, victim):
    """Runs all shards. Number `victim` starts first, is stopped after an image,
    and killed once the others ended. Returns whether it stopped in time."""
    shard = start(scene.shard(workspace, pass_name, victim))
    while num_done(workspace, pass_name) == 0 and shard.poll() is None:
        time.sleep(0.002)
    shard.send_signal(signal.SIGSTOP)
    if shard.poll() is not None or num_done(workspace, pass_name) != 1:
        shard.kill()
        shard.communicate()
        return False
    others = [start(scene.shard(workspace, pass_name, index))
              for index in range(NUM_SHARDS) if index != victim]
    for other in others:
        output = other.communicate()[0]
        check(other.returncode == 0, f"a shard comes to its end\n{output}")
    expect_refusal(workspace, ["lock", f"shard {victim}"], scene.shard(workspace, pass_name, victim),
                   f"a second {pass_name} of a shard that is at work")
    for options in ([], ["--TsarRefine.pass", "merge"], ["--restore", "1"]):
        expect_refusal(workspace, ["lock", "another program"], scene.command(workspace, *options),
                       f"{' '.join(options) or 'a whole run'} while a shard is at work")
    shard.kill()
    shard.communicate()
    check(num_done(workspace, pass_name) == NUM_IMAGES - 1,
          f"a shard was killed in the middle of the pass {pass_name}")
    return True


def run_with_a_killed_shard(scene, start_state, pass_name, victim):
    """The workspace after run_shards; repeated if the shard was too fast."""
    while True:
        workspace = scene.copy(pass_name, start_state)
        if run_shards(scene, workspace, pass_name, victim):
            return workspace
        shutil.rmtree(workspace)


def check_restore(scene, workspace, when):
    copy = scene.copy("restored", workspace)
    run(*scene.command(copy, "--restore", "1"))
    check(digests(copy) == digests(scene.sample), f"--restore gives every byte back {when}")
    shutil.rmtree(copy)


def test_shards(scene):
    expected = scene.whole()
    workspace = run_with_a_killed_shard(scene, scene.sample, "observe", 1)
    maps = {path: digest for path, digest in digests(workspace).items() if "/tsar/" not in path}
    check(maps == digests(scene.sample), "observing changes no map")
    expect_refusal(workspace, ["was not observed", "observe of all shards"],
                   scene.shard(workspace, "compose", 0), "compose before all are observed")
    expect_refusal(workspace, ["was not observed with these options"],
                   scene.shard(workspace, "compose", 1, "--TsarRefine.segment", "0"),
                   "a shard with other options")
    check_restore(scene, workspace, "after a shard was killed while it observed")
    check("2 images: 1 observed, 1 observed before" in run(*scene.shard(workspace, "observe", 1)),
          "a shard that observes goes on where it was killed")
    result = call(*scene.shard(workspace, "compose", 0))
    check(result.returncode == 1 and "pass model first" in result.stderr,
          f"compose before the planes of the scene are found is refused: {result.stderr.strip()}")

    run(*scene.command(workspace, "--TsarRefine.pass", "model"))
    check_restore(scene, workspace, "after the planes of the scene were found")
    workspace = run_with_a_killed_shard(scene, workspace, "compose", 2)
    expect_refusal(workspace, ["of 6 images have not been refined", "compose of all shards"],
                   scene.command(workspace, "--TsarRefine.pass", "merge"),
                   "merge before all are composed")
    check_restore(scene, workspace, "after a shard was killed while it composed")
    # The last file of the image at which it was stopped may have been missing.
    check(re.search("2 images: [12] refined", run(*scene.shard(workspace, "compose", 2))),
          "a shard that composes goes on where it was killed")
    check((workspace / "stereo/tsar/evidence").exists(), "the evidence stays until the merge")
    run(*scene.command(workspace, "--TsarRefine.pass", "merge"))
    check_as_one_run(workspace, expected)
    check(sorted(os.listdir(workspace / "stereo/tsar")) == sorted(os.listdir(expected / "stereo/tsar")),
          "nothing else is left")
    before = digests(workspace)
    run(*scene.command(workspace, "--TsarRefine.pass", "merge"))
    check(digests(workspace) == before, "a second merge changes nothing")
    check("6 done before" in run(*scene.command(workspace)), "a whole run has nothing to do")
    check_restore(scene, workspace, "after all is done")


with Scene() as small_scene:
    test_shards(small_scene)
