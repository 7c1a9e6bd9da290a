#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""scripts/eth3d.sh on the sample scene in the layout of ETH3D: from images to a
submission and scores, interrupted in the middle and resumed."""
import fcntl
import glob
import json
import os
import re
import shutil
import signal
import struct
import subprocess
import time
import unittest
from unittest import mock

from dataset_testing import DatasetTest, make_eth3d, vertex_count

import numpy as np

from model import read_images
from sample_scene import read_map

PREFIX = "dslr_images_undistorted/"


class Eth3dTest(DatasetTest):
    script = "eth3d"

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        make_eth3d(cls.sample, cls.folder / "scenes" / "room")
        cls.scenes = cls.folder / "scenes"
        cls.output = cls.folder / "out"

    def kill_in_stereo(self):
        """Starts the script, and kills it and its program without warning when the
        first depth map is there."""
        maps = self.output / "room" / "dense" / "stereo" / "depth_maps"
        process = subprocess.Popen(self.command(self.scenes, "--output_path", self.output),
                                   stdout=subprocess.DEVNULL, start_new_session=True)
        # The folder may be replaced meanwhile, which glob ignores.
        while process.poll() is None and not glob.glob(f"{maps}/**/*.bin", recursive=True):
            time.sleep(0.05)
        self.assertIsNone(process.poll(), "it is at work when the first map appears")
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()

    def test_from_images_to_submission(self):
        self.kill_in_stereo()
        self.assertFalse((self.output / "submission").exists())
        text = self.run_well(self.scenes, "--output_path", self.output)
        self.assertIn("workspace: done before", text)
        self.assertIn("stereo goes on", text)

        scene = self.output / "room"
        for workspace in ("dense", "refined"):
            self.check_workspace(scene / workspace, PREFIX)
        self.check_poses(read_images(scene / "dense" / "sparse" / "images.txt"), 1e-12, PREFIX)
        self.check_submission(scene)
        self.check_scores(scene, text)
        self.check_that_it_rests(text)
        self.check_paper(scene)
        self.check_priors()
        self.check_other_options()

    def check_submission(self, scene):
        folder = self.output / "submission"
        self.assertEqual(sorted(str(p.relative_to(folder)) for p in folder.rglob("*.*")),
                         ["high_res_multi_view/room.ply", "high_res_multi_view/room.txt"])
        folder = folder / "high_res_multi_view"
        self.assertEqual((folder / "room.ply").read_bytes(), (scene / "after.ply").read_bytes())
        self.assertGreater(vertex_count(folder / "room.ply"), 100)
        runtime = re.fullmatch(r"runtime (\d+\.\d+)\n", (folder / "room.txt").read_text())
        records = [json.loads((scene / "steps" / f"{name}.json").read_text())
                   for name in ("stereo", "refinement", "fusion_after")]
        self.assertAlmostEqual(float(runtime[1]), sum(r["seconds"] for r in records), delta=1e-2)

    def check_scores(self, scene, text):
        before, after = (json.loads((scene / "scores" / f"{name}.json").read_text())
                         for name in ("before", "after"))
        self.assertEqual(before["num_points"], vertex_count(scene / "before.ply"))
        self.assertEqual(after["num_points"], vertex_count(scene / "after.ply"))
        self.assertEqual([s["tolerance"] for s in after["scores"]],
                         [0.01, 0.02, 0.05, 0.1, 0.2, 0.5])
        self.assertGreater(after["scores"][3]["completeness"],
                           before["scores"][3]["completeness"])
        self.assertIn(f"{after['scores'][1]['f1']:.3f}", text)

    def check_that_it_rests(self, text):
        files = self.files_of(self.output / "room")
        again = self.run_well(self.scenes / "room", "--output_path", self.output)
        self.assertEqual(self.files_of(self.output / "room"), files)
        self.assertEqual(again.count("done before"), 6)  # All steps there are.
        self.assertEqual([l for l in again.splitlines() if l[0] != "["],
                         [l for l in text.splitlines() if l[0] != "["])  # The scores.

    def check_paper(self, scene):
        """Another preset and fusion repeat what depends on them, on a copy."""
        copy = self.folder / "paper"
        shutil.copytree(self.output / "room", copy / "room", symlinks=True)
        text = self.run_well(self.scenes, "--output_path", copy, "--preset", "paper",
                             "--fusion", "paper", "--min_num_pixels", 2)
        self.assertEqual(text.count("done before"), 2)  # The workspace and stereo.
        logs = copy / "room" / "logs"
        self.assertIn("--TsarRefine.preset paper",
                      (logs / "refinement.log").read_text())
        for name in ("before", "after"):
            self.assertIn("--TsarFuse.preset paper --TsarFuse.min_num_views 2",
                          (logs / f"fusion_{name}.log").read_text())
        for name in ("before.ply", "after.ply"):
            self.assertGreater(vertex_count(copy / "room" / name), vertex_count(scene / name))

    def check_priors(self):
        """Stereo without geometric passes, and maps of another program, with
        options that are passed on; on copies."""
        copy = self.folder / "priors"
        command = (self.scenes, "--output_path", copy / "gp", "--prior", "gp", "--paper_size")
        self.run_well(*command, "--TsarStereo.num_levels", 1, "--TsarRefine.segment", 0)
        room = copy / "gp" / "room"
        log = (room / "logs" / "stereo.log").read_text()
        self.assertIn("--TsarStereo.max_image_size 320", log)  # Half of the images' 640.
        self.assertIn("--TsarStereo.geom_consistency 0 --TsarStereo.num_levels 1", log)
        self.assertIn("--TsarRefine.segment 0", (room / "logs" / "refinement.log").read_text())
        maps = room / "dense" / "stereo" / "depth_maps"
        self.assertEqual({p.name.split(".")[-2] for p in maps.rglob("*.bin")}, {"photometric"})

        given, out = copy / "maps", copy / "mp"
        for number, image in enumerate(self.sample.images):
            target = given / "room" / "ACMMP" / f"2333_{number:08d}"
            target.mkdir(parents=True)
            for kind, file in (("depth", "depths_geom.dmb"), ("normal", "normals.dmb")):
                values = read_map(self.output / "room" / "dense" / "stereo" / f"{kind}_maps" /
                                  PREFIX / f"{image.name}.geometric.bin")
                values = np.moveaxis(values, 0, -1)
                if kind == "normal":
                    values = values @ image.pose.rotation  # In the frame of the world.
                values = values.astype("<f4")
                (target / file).write_bytes(struct.pack("<4i", 1, *values.shape) + values.tobytes())
        mp = (self.scenes, "--output_path", out, "--prior", "mp")
        self.fails(*mp, text="--prior mp: needs --maps_path")
        self.fails(*mp, "--maps_path", given, "--stereo", "tsar", text="give one of them")
        self.run_well(*mp, "--maps_path", given)
        folder = out / "submission" / "high_res_multi_view"
        self.assertEqual([p.name for p in folder.iterdir()], ["room.ply"])
        (given / "room" / "runtime.txt").write_text("runtime 1000\n")
        self.run_well(*mp, "--maps_path", given)
        self.assertGreater(float((folder / "room.txt").read_text().split()[1]), 1000)
        name = f"{PREFIX}{self.sample.names[0]}.geometric.bin"
        depth = [read_map(root / "room" / "dense" / "stereo" / "depth_maps" / name)
                 for root in (self.output, out)]
        # The import leaves out what no other view confirms, and changes nothing else.
        is_kept = depth[1] > 0
        np.testing.assert_array_equal(depth[0][is_kept], depth[1][is_kept])
        self.assertGreater(np.mean(is_kept), 0.95 * np.mean(depth[0] > 0))
        self.fails(*mp, "--maps_path", given, "--submit", "training",
                   text="--submit training: 13 of 13 scenes are missing, courtyard, delivery_area")

    def check_other_options(self):
        """Maps given by hand in place of stereo, for a scene without scans."""
        make_eth3d(self.sample, self.folder / "test" / "hall", with_scans=False)
        hall = self.folder / "test" / "hall"
        none = ("--output_path", self.output, "--stereo", "none")
        self.fails(hall, *none, text="has no depth maps")
        # Without the costs, depths without evidence would count as measured.
        for kind in ("depth_maps", "normal_maps", "cost_maps"):
            shutil.copytree(self.output / "room" / "dense" / "stereo" / kind,
                            self.output / "hall" / "dense" / "stereo" / kind,
                            dirs_exist_ok=True)
        text = self.run_well(hall, *none)
        self.assertIn("not known how long", text)
        self.assertFalse((self.output / "hall" / "scores").exists())
        folder = self.output / "submission" / "high_res_multi_view"
        self.assertEqual(sorted(p.name for p in folder.iterdir()),
                         ["hall.ply", "room.ply", "room.txt"])
        refined = (self.output / name / "refined" / "stereo" / "depth_maps" / PREFIX /
                   "v000.jpg.geometric.bin" for name in ("room", "hall"))
        self.assertEqual(*(path.read_bytes() for path in refined))
        # Other inputs or options do not destroy maps that a user put there.
        maps = self.files_of(self.output / "hall" / "dense" / "stereo")
        self.fails(hall, "--output_path", self.output, "--stereo", "tsar",
                   text="were not made by this script")
        calibration = hall / "dslr_calibration_undistorted" / "cameras.txt"
        calibration.write_text(calibration.read_text().replace("532.56", "532.57"))
        self.fails(hall, *none, text="was made from other inputs")
        self.assertEqual(self.files_of(self.output / "hall" / "dense" / "stereo"), maps)
        self.fails(self.scenes / "room", *none, text="made by this script")

    def test_mistakes(self):
        room = self.scenes / "room"
        output = ("--output_path", self.folder / "nothing")
        calibration = "dslr_calibration_undistorted"
        self.fails(self.folder / "nowhere", *output, text="nowhere: is not a folder")
        self.fails(self.folder / "sample", *output, text="neither a scene nor")
        for option, value, text in (
                ("--max_image_size", 4, "--max_image_size 4"),
                ("--min_num_pixels", 0, "--min_num_pixels 0"),
                ("--TsarStereo.nothing", 1, "--TsarStereo.nothing: none of"),
                ("--maps_path", room, "--maps_path: is for --prior mp"),
                ("--colmap", "/bin/nocolmap", "/bin/nocolmap"),
                ("--colmap_tsar", "/bin/notsar", "/bin/notsar")):
            self.fails(room, *output, option, value, text=text)
        if not shutil.which("nvidia-smi"):
            self.fails(room, *output, "--stereo", "colmap", text="--stereo colmap")

        images, cameras = f"{calibration}/images.txt", f"{calibration}/cameras.txt"
        self.fails_of_changes(room, (), (
            (images, None, None, "images.txt: not found"),
            (f"{calibration}/points3D.txt", None, None, "points3D.txt: not found"),
            (f"images/{PREFIX}v001.jpg", None, None, "v001.jpg: not found"),
            ("dslr_scan_eval/scan_alignment.mlp", None, None, "scan_alignment.mlp"),
            (cameras, "PINHOLE 640", "PINHOLE 320", "is 640 x 480"),
            (cameras, "PINHOLE", "THIN_PRISM_FISHEYE", "line 2"),
            (cameras, "1 PINHOLE", "7 PINHOLE", "camera 1"),
            (images, "v001.jpg", "../../x.jpg", "leaves"),
            (images, " 1 dslr", " one dslr", "not numbers")))

    def test_two_runs_at_once(self):
        folder = self.folder / "locked" / "room"
        folder.mkdir(parents=True)
        with open(folder / "lock", "w", encoding="utf-8") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            self.fails(self.scenes, "--output_path", folder.parent, text="another run")

    def test_help(self):
        for script, text in (("eth3d", "high_res_multi_view/SCENE.ply"), ("strecha", ".camera"),
                             ("tanks_and_temples", "submission/SCENE.ply")):
            with mock.patch.object(self, "script", script):
                self.assertIn(text, self.run_well("--help"))


if __name__ == "__main__":
    unittest.main()
