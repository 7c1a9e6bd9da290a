#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Refines the sample scene in place, fuses before and after with an unmodified
COLMAP, and checks the gain, the provenance of every pixel, that nothing but the
maps to refine changed, and that --restore gives every byte back."""

from sample_testing import check, digests, parse_arguments, run, score, unpack

args = parse_arguments("program", "colmap", "repository", "workspace")

unpack(args.repository, args.workspace)
original = digests(args.workspace)
before = score(args.colmap, args.program, args.workspace)
run(args.program, "tsar_refine", "--workspace_path", args.workspace)
refined = digests(args.workspace)
after = score(args.colmap, args.program, args.workspace)
print("before", before)
print("after ", after)
check(after["f1"] > before["f1"] + 0.15, "F1 at 2 cm rises by over 0.15")
check(after["accuracy"] > before["accuracy"] - 0.05, "accuracy falls by less than 0.05")

changed = {path for path in original if refined.get(path) != original[path]}
expected = {
    path
    for path in original
    if path.startswith(("stereo/depth_maps", "stereo/normal_maps")) and ".geometric." in path
}
check(changed == expected, "exactly the geometric maps changed")
kept = {
    path[len("stereo/tsar/original/"):]: digest
    for path, digest in refined.items()
    if path.startswith("stereo/tsar/original/")
}
check(
    kept == {path[len("stereo/"):]: original[path] for path in expected},
    "all originals are kept",
)

summary = run(args.program, "tsar_refine", "--workspace_path", args.workspace)
check("8 done before" in summary, "a second run has nothing to do")
run(args.program, "tsar_refine", "--workspace_path", args.workspace, "--restore", 1)
check(digests(args.workspace) == original, "--restore gives every byte back")
