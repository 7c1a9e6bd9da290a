#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Submissions: whole sets, archives, limits, and options that are passed on."""
import contextlib
import io
import os
import shutil
import subprocess
import unittest
from unittest import mock

from dataset_testing import FolderTest, vertex_count

import numpy as np

import eth3d
import ply
import strecha
import submission
import tanks_and_temples
from command_line import PRIORS, dense_commands, make_parser, take_passed


def write_cloud(path, count):
    """A cloud as stereo_fusion writes it: positions 0, 1, 2, ... and a color."""
    rows = np.zeros(count, [("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("red", "u1")])
    rows["x"], rows["red"] = np.arange(count), np.arange(count) % 200
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(
        f"ply\nformat binary_little_endian 1.0\nelement vertex {count}\nproperty float x\n"
        "property float y\nproperty float z\nproperty uchar red\nend_header\n".encode()
        + rows.tobytes())


class SubmissionTest(FolderTest):
    def test_thinning_keeps_whole_rows_evenly(self):
        write_cloud(self.root / "a.ply", 1000)
        ply.thin(self.root / "a.ply", self.root / "b.ply", 10)
        self.assertTrue(ply.is_whole(self.root / "b.ply"))
        np.testing.assert_array_equal(ply.read_ply(self.root / "b.ply").points[:, 0],
                                      np.arange(0, 1000, 100))
        self.assertEqual((self.root / "b.ply").read_bytes()[-1], 900 % 200)
        ply.thin(self.root / "a.ply", self.root / "c.ply", 999)
        points = ply.read_ply(self.root / "c.ply").points[:, 0]
        self.assertEqual(len(np.unique(points)), 999)
        (self.root / "d.ply").write_text("ply\nformat ascii 1.0\nelement vertex 1\n"
                                         "property float x\nend_header\n0\n")
        self.rejects("not a binary cloud", ply.thin, self.root / "d.ply", self.root / "e.ply", 1)

    def test_clouds_beyond_the_limit_are_thinned_with_a_word(self):
        write_cloud(self.root / "after.ply", 30)
        said = submission.put_into(self.root / "s", self.root / "after.ply", "a.ply", 20)
        self.assertIn("from 30 to 20 points", said)
        self.assertEqual(vertex_count(self.root / "s" / "a.ply"), 20)
        self.assertEqual(submission.put_into(self.root / "s", self.root / "after.ply", "a.ply", 30), "")
        self.assertEqual((self.root / "s" / "a.ply").read_bytes(),
                         (self.root / "after.ply").read_bytes())

    def test_limit_of_all_clouds_together(self):
        # 10 + 2 x 40 points of 10 bytes; small ones stay whole.
        self.assertEqual(submission.points_within([(10, 10), (90, 10), (60, 10)], 900), 40)
        self.assertEqual(submission.points_within([(10, 10), (90, 10)], 1000), 90)
        self.assertEqual(submission.points_within([(10, 10), (90, 10)], 5), 0)

    def test_archive_of_eth3d(self):
        folder = self.root / "submission"
        for name in (*eth3d.TRAINING, "of_another_set"):
            write_cloud(folder / "high_res_multi_view" / f"{name}.ply", 100)
            (folder / "high_res_multi_view" / f"{name}.txt").write_text("runtime 1.000\n")
        with mock.patch.object(submission, "MAX_BYTES", 13 * 50 * 13), \
                contextlib.redirect_stdout(io.StringIO()) as out:
            eth3d.pack(folder, eth3d.TRAINING)
        self.assertEqual(out.getvalue().count("thinned evenly from 100 to 50 points"), 13)
        archive = folder / "high_res_multi_view.7z"
        self.assertEqual(archive.read_bytes()[:6], b"7z\xbc\xaf\x27\x1c")
        listed = subprocess.run(["cmake", "-E", "tar", "tf", str(archive)], check=True,
                                stdout=subprocess.PIPE, text=True).stdout.split()
        self.assertEqual(sorted(listed), sorted(f"high_res_multi_view/{name}.{ending}"
                                                for name in eth3d.TRAINING for ending in ("ply", "txt")))
        target = self.root / "unpacked"
        target.mkdir()
        subprocess.run(["cmake", "-E", "tar", "xf", str(archive)], cwd=target, check=True)
        self.assertEqual(vertex_count(target / "high_res_multi_view" / "pipes.ply"), 50)
        self.assertEqual(sorted(p.name for p in folder.iterdir()),
                         ["high_res_multi_view", "high_res_multi_view.7z"])

    def test_archive_that_cannot_be_written(self):
        with mock.patch.dict(os.environ, {"PATH": str(self.root)}):
            self.rejects("without cmake", submission.pack, self.root / "a.7z", self.root, ["x"])
        self.rejects("cmake -E tar", submission.pack, self.root / "a.7z", self.root, ["not_there"])
        self.assertEqual(list(self.root.iterdir()), [])
        # A full disk, which cmake ignores, leaves part of it, or nothing.
        (self.root / "x").write_bytes(os.urandom(9999))
        real, stand_in = shutil.which("cmake"), self.root / "bin" / "cmake"
        stand_in.parent.mkdir()
        for size in (0, 99, 5000):
            stand_in.write_text(f'#!/bin/sh\n{real} "$@" || exit\n[ $3 = tf ] || '
                                f'truncate -s {size} "$4"\n')
            stand_in.chmod(0o755)
            with mock.patch.dict(os.environ, {"PATH": f"{stand_in.parent}:{os.environ['PATH']}"}):
                self.rejects("a.7z: is not whole; see that its disk has room", submission.pack,
                             self.root / "a.7z", self.root, ["x"])
        self.assertEqual(sorted(os.listdir(self.root)), ["bin", "x"])

    def test_sets(self):
        self.assertEqual([len(eth3d.SETS[name]) for name in ("training", "test", "all")], [13, 12, 25])
        self.assertEqual([len(tanks_and_temples.SETS[name]) for name in
                          ("intermediate", "advanced", "both")], [8, 6, 14])
        self.rejects("--submit test: 11 of 12 scenes are missing, boulders, bridge",
                     submission.check_set, "--submit test", eth3d.TEST,
                     ["pipes", "botanical_garden"])
        submission.check_set("--submit test", eth3d.TEST, [*eth3d.TEST, "pipes"])
        self.rejects("maps of pipes did", submission.check_times, {"pipes": None, "door": 1.0})
        for name in ("fountain-P11", "Fountain", "fountain_dense"):
            self.assertEqual(strecha.kind(name), "fountain")
        for name in ("Herz-Jesu-P8", "herzjesu_dense", "HerzJesu"):
            self.assertEqual(strecha.kind(name), "herzjesu")
        self.assertEqual(strecha.kind("castle-P19"), "castlep19")

    def test_options_that_are_handed_on(self):
        words, passed = take_passed(["a", "--TsarRefine.filter", "0",
                                     "--TsarStereo.num_levels=3", "--output_path", "b"])
        self.assertEqual(words, ["a", "--output_path", "b"])
        self.assertEqual(passed, {"TsarRefine.filter": "0", "TsarStereo.num_levels": "3"})
        args = make_parser("x", "", "", {"set": ()}, "").parse_args([*words, "--fusion", "paper"])
        args.stereo = PRIORS["gp"]
        self.assertEqual(dense_commands(args),
                         ["tsar_stereo", "tsar_refine", "tsar_fuse"])


if __name__ == "__main__":
    unittest.main()
