#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Three shards as processes side by side, of which one is killed in each pass:
what the others and further programs may do meanwhile, and that the result is that
of one run."""
import os
import shutil
import signal

from cluster_testing import (
    NUM_SHARDS,
    Scene,
    account,
    end,
    num_done,
    parse_arguments,
    results,
    start,
    stop_half_way,
)
from sample_testing import call, check, digests, run


def files(workspace):
    """All but the locks of the whole and of shards, which may stay."""
    return {path: digest for path, digest in digests(workspace).items()
            if not path.endswith("lock")}


def expect_refusal(workspace, texts, command, what):
    before = files(workspace)
    result = call(*command)
    check(
        result.returncode == 1
        and result.stderr.count("\n") == 1
        and all(text in result.stderr for text in texts)
        and files(workspace) == before,
        f"{what} is refused: {result.stderr.strip()}",
    )


def run_shards(scene, workspace, pass_name, victim):
    """Runs all shards. That number `victim` comes first, is stopped in the middle,
    and, when the others have ended, killed. Returns whether that came in time."""
    before = num_done(workspace, pass_name)
    shard = start(scene.shard(workspace, pass_name, victim))
    process = stop_half_way(
        workspace, pass_name, victim, lambda: shard.poll() is not None
    )
    if process is None or num_done(workspace, pass_name) != before + 1:
        shard.kill()
        shard.communicate()
        return False
    others = [
        start(scene.shard(workspace, pass_name, index))
        for index in range(NUM_SHARDS)
        if index != victim
    ]
    for other in others:
        end(other)
    expect_refusal(
        workspace,
        ["lock", f"shard {victim}"],
        scene.shard(workspace, pass_name, victim),
        f"a second {pass_name} of a shard that is at work",
    )
    for options in ([], ["--TsarRefine.pass", "merge"], ["--restore", "1"]):
        expect_refusal(
            workspace,
            ["lock", "another program"],
            scene.command(workspace, *options),
            f"{' '.join(options) or 'a whole run'} while a shard is at work",
        )
    os.kill(process, signal.SIGKILL)
    shard.communicate()
    check(
        num_done(workspace, pass_name) == 5,
        f"a shard was killed in the middle of the pass {pass_name}",
    )
    return True


def run_with_a_killed_shard(scene, start_state, pass_name, victim):
    """The workspace after run_shards; anew until the shard was not too fast."""
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


def test_planes_of_the_scene(scene):
    expected = scene.whole("whole")
    workspace = run_with_a_killed_shard(scene, scene.sample, "observe", 1)
    check(
        {path: digest for path, digest in digests(workspace).items() if "/tsar/" not in path}
        == digests(scene.sample),
        "observing changes no map",
    )
    expect_refusal(
        workspace,
        ["was not observed", "observe of all shards"],
        scene.shard(workspace, "compose", 0),
        "compose before all are observed",
    )
    expect_refusal(
        workspace,
        ["was not observed with these options"],
        scene.shard(workspace, "compose", 1, "--TsarRefine.segment", "0"),
        "a shard with other options",
    )
    check_restore(scene, workspace, "after a shard was killed while it observed")
    output = run(*scene.shard(workspace, "observe", 1))
    check(
        "2 images: 1 observed, 1 observed before" in output,
        "a shard that observes goes on where it was killed",
    )

    result = call(*scene.shard(workspace, "compose", 0))
    check(
        result.returncode == 1 and "pass model first" in result.stderr,
        f"compose before the planes of the scene are found is refused: {result.stderr.strip()}",
    )
    run(*scene.command(workspace, "--TsarRefine.pass", "model"))
    check_restore(scene, workspace, "after the planes of the scene were found")
    workspace = run_with_a_killed_shard(scene, workspace, "compose", 2)
    expect_refusal(
        workspace,
        ["1 of 6 images", "compose of all shards"],
        scene.command(workspace, "--TsarRefine.pass", "merge"),
        "merge before all are composed",
    )
    check_restore(scene, workspace, "after a shard was killed while it composed")
    output = run(*scene.shard(workspace, "compose", 2))
    check(
        "2 images: 1 refined, 1 done before" in output,
        "a shard that composes goes on where it was killed",
    )
    check((workspace / "stereo/tsar/evidence").exists(), "the evidence stays until the merge")
    run(*scene.command(workspace, "--TsarRefine.pass", "merge"))
    check(results(workspace) == results(expected), "the bytes are those of one run")
    check(account(workspace) == account(expected), "the account is that of one run")
    check(
        sorted(os.listdir(workspace / "stereo/tsar"))
        == sorted(os.listdir(expected / "stereo/tsar")),
        "nothing else is left",
    )
    before = digests(workspace)
    run(*scene.command(workspace, "--TsarRefine.pass", "merge"))
    check(digests(workspace) == before, "a second merge changes nothing")
    output = run(*scene.command(workspace))
    check("6 done before" in output, "a whole run has nothing to do")
    check_restore(scene, workspace, "after all is done")


def test_images_by_themselves(scene):
    """Where shards read the originals of images that others are refining."""
    options = ["--TsarRefine.scene_planes", "0", "--TsarRefine.segment", "0"]
    expected = scene.whole("whole_by_themselves", *options)
    workspace = scene.copy("by_themselves")
    for pass_name in ("observe", "compose"):
        shards = [
            start(scene.shard(workspace, pass_name, index, *options))
            for index in range(NUM_SHARDS)
        ]
        for shard in shards:
            end(shard)
        if pass_name == "observe":
            run(*scene.command(workspace, "--TsarRefine.pass", "model", *options))
    run(*scene.command(workspace, "--TsarRefine.pass", "merge", *options))
    check(
        results(workspace) == results(expected),
        "the bytes are those of one run, also of images by themselves",
    )
    check_restore(scene, workspace, "of images by themselves")


with Scene(parse_arguments()) as small_scene:
    test_planes_of_the_scene(small_scene)
    test_images_by_themselves(small_scene)
