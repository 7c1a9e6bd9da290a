#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""scripts/reconstruct.sh with stand-ins for the programs: which steps it runs
in which order, what it repeats, and what it prints."""
import os
import shutil
import unittest
from unittest import mock

from stand_in_testing import COMMANDS, PHOTO, STEPS, StandInTest  # First: it sets the path.

import ply
import steps


class ReconstructTest(StandInTest):
    def test_steps_in_their_order(self):
        text, calls = self.run_well()
        lines = text.splitlines()
        told = [line.split("] ")[1] for line in lines if " of 9: " in line]
        self.assertEqual(told, [f"step {i} of 9: {name}" for i, name in enumerate(STEPS, 1)])
        self.assertEqual([c.split()[0] for c in calls if c[0] != " "], COMMANDS)
        self.assertIn("6 of 6 photos have a pose", text)
        self.assertIn("fused points before → after: 40 → 50, +25 %", text)
        self.assertTrue((self.output / "report" / "index.html").is_file())
        for name in STEPS:
            self.assertTrue((self.output / "logs" / f"{name}.log").is_file(), name)
        names = (self.output / "images.txt").read_text().splitlines()
        self.assertEqual(names, ["a.jpg.png", "e.png", "f.png", "g.png", "left/b.PNG",
                                 "left/c d.png"])

    def test_options_redo_what_depends_on_them(self):
        """Each run adds an option of an earlier step than those before."""
        self.run_well()
        options = []
        after = lambda command: COMMANDS[COMMANDS.index(command):]
        for option, expected in (
                ("--TsarFuse.min_num_views=3", ["tsar_fuse", "tsar_fuse"]),
                ("--TsarRefine.scene_planes=0", after("tsar_refine")),
                ("--preset=paper", after("tsar_refine")),
                ("--TsarStereo.num_levels=2", after("tsar_stereo")),
                ("--max_image_size=64", after("tsar_stereo")),
                ("--undistorted_size=64", after("image_undistorter")),
                ("--Mapper.min_num_matches=9", after("mapper")),
                ("--SiftMatching.max_ratio=0.9", after("exhaustive_matcher")),
                ("--ImageReader.single_camera=0", COMMANDS)):
            options.append(option)
            self.assertEqual(self.commands(*options), expected, option)
        (self.photos / "e.png").write_bytes(PHOTO + b"changed")
        self.assertEqual(self.commands(*options), COMMANDS)

    def test_options_reach_their_command(self):
        mask = self.write("masks/a.png", "1")
        options = ("--fusion", "colmap", "--StereoFusion.mask_path", mask.parent,
                   "--StereoFusion.min_num_pixels=3", "--min_num_pixels", 7,
                   "--undistorted_size", 99, "--max_image_size", 88)
        _, calls = self.run_well(*options)
        (undistorter,) = [c for c in calls if c.startswith("image_undistorter")]
        self.assertTrue(undistorter.endswith("--max_image_size 99"), undistorter)
        (stereo,) = [c for c in calls if c.startswith("tsar_stereo")]
        self.assertIn("--TsarStereo.max_image_size 88", stereo)
        fusions = [c for c in calls if c.startswith("stereo_fusion")]
        self.assertEqual(len(fusions), 2)
        for call in fusions:
            self.assertIn(f"--StereoFusion.mask_path {mask.parent}", call)
            self.assertEqual(call.count("min_num_pixels"), 1)
            self.assertIn("--StereoFusion.min_num_pixels 3", call)
        mask.write_text("22")  # The masks are inputs.
        self.assertEqual(self.commands(*options), ["stereo_fusion", "stereo_fusion"])
        self.refuses("--TsarRefine.nonsense: none of the commands of this run",
                     "--TsarRefine.nonsense", 1)
        self.refuses("--PoissonMeshing.trim: none", "--PoissonMeshing.trim", 5)
        self.refuses("--TsarRefine.scene_planes: has no value", "--TsarRefine.scene_planes")
        self.refuses("--TsarRefine.scene_planes: has no value", "--TsarRefine.scene_planes",
                     "--mesh")

    def test_depth_priors_are_of_the_refinement(self):
        self.run_well()
        prior = self.write("priors/a.npy", "1")
        options = ("--prior_path", prior.parent, "--prior_type", "metric")
        _, calls = self.run_well(*options)
        self.assertEqual([c.split()[0] for c in calls],
                         ["tsar_refine", "tsar_fuse", "tsar_report"])
        self.assertIn(f"--prior_path {prior.parent} --prior_type metric", calls[0])
        self.assertEqual(self.commands(*options), [])
        prior.write_text("22")  # The priors are inputs.
        self.assertEqual(self.commands(*options)[0], "tsar_refine")
        _, calls = self.run_well("--prior_path", prior.parent)
        self.assertNotIn("--prior_type", calls[0])
        self.refuses("no such folder", "--prior_path", prior)
        self.refuses("give --prior_path as well", "--prior_type", "metric")

    def test_one_fusion_before_and_after(self):
        self.run_well("--mesh", "--fusion", "colmap")
        for fusion, preset in (("tsar", "default"), ("paper", "paper")):
            _, calls = self.run_well("--mesh", "--fusion", fusion)
            self.assertEqual([c.split()[0] for c in calls],
                             ["tsar_fuse", "tsar_fuse", "poisson_mesher"])
            for call, workspace in zip(calls, ("dense", "refined")):
                self.assertIn(f"--workspace_path {self.output}/{workspace} --input_type geometric",
                              call)
                self.assertTrue(call.endswith(f"--TsarFuse.preset {preset}"), call)
            self.assertEqual(self.commands("--mesh", "--fusion", fusion), [])
        self.assertEqual((self.output / "after.ply.vis").read_text(), "vis")
        self.assertEqual(list(self.output.glob("part.*")), [])
        _, calls = self.run_well("--min_num_pixels", 4, "--TsarFuse.max_normal_error", 20)
        for call in calls[:2]:
            self.assertTrue(call.endswith("--TsarFuse.min_num_views 4 "
                                          "--TsarFuse.max_normal_error 20"), call)
        self.refuses("--TsarFuse.max_normal_error: none of the commands of this run",
                     "--fusion", "colmap", "--TsarFuse.max_normal_error", 20)

    def test_what_a_stopped_fusion_left(self):
        for fusion, command in (("tsar", "tsar_fuse"), ("colmap", "stereo_fusion"),
                                ("paper", "tsar_fuse")):
            self.run_well("--fusion", fusion)
            (self.output / "after.ply").unlink()
            self.write("half", "1")
            self.refuses(f"fusion_after: {command} wrote no cloud, or half of one",
                         "--fusion", fusion)
            (self.root / "half").unlink()
            self.assertFalse((self.output / "after.ply").exists())
            self.assertTrue((self.output / "part.after.ply.vis").exists())
            self.write("out/part.after.ply.tmp", "")  # As a killed tsar_fuse leaves it.
            self.assertEqual(self.commands("--fusion", fusion), [command])
            self.assertTrue(ply.is_whole(self.output / "after.ply"))
            self.assertEqual(list(self.output.glob("part.*")), [])

    def test_photos_of_one_camera(self):
        text, calls = self.run_well()
        self.assertIn("taken as those of one camera", text)
        self.assertIn("--ImageReader.single_camera 1", calls[0])
        _, calls = self.run_well("--ImageReader.camera_model", "OPENCV")
        self.assertIn("--ImageReader.single_camera 1", calls[0])
        text, calls = self.run_well("--ImageReader.single_camera", 0)
        self.assertNotIn("one camera", text)
        self.assertIn("--ImageReader.single_camera 0", calls[0])
        for name, content in (("larger.png", PHOTO.replace(b"\x10", b"\x11")),
                              ("with_exif.png", PHOTO + b"eXIf")):
            (self.photos / name).write_bytes(content)
            _, calls = self.run_well()
            self.assertNotIn("single_camera", calls[0], name)
            (self.photos / name).unlink()

    @unittest.skipIf(shutil.which("nvidia-smi"), "stereo is fast here")
    def test_long_waits_are_announced(self):
        large = PHOTO[:16] + b"\0\1\0\0\0\1\0\0" + PHOTO[24:]  # 65,536 pixels each way.
        for number in range(201):
            (self.photos / f"{number}.png").write_bytes(large)
        text, _ = self.run_well("--max_image_size", 65536)
        self.assertIn("207 photos: comparing all pairs may take hours", text)
        self.assertIn("stereo on the CPU takes some", text)
        text, _ = self.run_well("--max_image_size", 65536, "--matcher", "exhaustive")
        self.assertNotIn("may take hours", text)  # It was asked for.
        self.assertNotIn("on the CPU", text)  # It is done.

    def test_colmap_makes_the_maps_where_told_to(self):
        self.refuses("--stereo colmap: ", stereo="colmap")
        gpu = self.write("bin/nvidia-smi", "#!/bin/sh\necho 'GPU 0: stand-in'\n")
        gpu.chmod(0o755)
        self.write("cuda", "1")
        path = f"{gpu.parent}{os.pathsep}{os.environ['PATH']}"
        with mock.patch.dict(os.environ, {"PATH": path}):
            _, calls = self.run_well("--max_image_size", 77, stereo="colmap")
        self.assertEqual([c for c in calls if c.startswith("tsar_stereo")], [])
        (stereo,) = [c for c in calls if c.startswith("patch_match_stereo")]
        self.assertTrue(stereo.endswith("--PatchMatchStereo.max_image_size 77"), stereo)
        self.assertIn("--SiftExtraction.use_gpu 1", calls[0])

    def test_another_matcher_matches_anew(self):
        self.run_well()
        text, calls = self.run_well("--matcher", "sequential")
        self.assertIn("features: done before", text)
        self.assertTrue(calls[0].startswith("  0 pairs") or calls[1] == "  0 pairs were matched",
                        calls)
        # Interrupted midway, it continues with the pairs that are there.
        self.write("fail", "exhaustive_matcher")
        self.refuses("matches failed", "--matcher", "exhaustive")
        (self.root / "fail").unlink()
        text, calls = self.run_well("--matcher", "exhaustive")
        self.assertIn("step 2 of 9: matches goes on", text)
        self.assertEqual(calls[1], "  1 pairs were matched")

    def test_vocabulary_trees(self):
        self.refuses("needs --vocab_tree FILE", "--matcher", "vocab_tree")
        self.refuses("no such file", "--matcher", "vocab_tree", "--vocab_tree", self.root / "no")
        tree = self.write("tree.bin", "1")
        self.refuses("is for --matcher vocab_tree", "--vocab_tree", tree)
        _, calls = self.run_well("--matcher", "vocab_tree", "--vocab_tree", tree)
        self.assertIn(f"--VocabTreeMatching.vocab_tree_path {tree}", calls[1])
        self.write("tree", "1")
        self.run_well("--matcher", "vocab_tree")

    def test_a_failing_step_leaves_what_was_done(self):
        self.write("fail", "tsar_refine")
        error = self.refuses("refinement failed")
        self.assertIn("'cannot go on'", error)
        self.assertIn("logs/refinement.log", error)
        self.assertTrue((self.output / "before.ply").is_file())
        self.assertFalse((self.output / "after.ply").exists())
        (self.root / "fail").unlink()
        text, calls = self.run_well()
        self.assertEqual(text.count("done before"), 6)
        self.assertIn("step 7 of 9: refinement goes on", text)
        self.assertEqual([c.split()[0] for c in calls],
                         ["tsar_refine", "tsar_fuse", "tsar_report"])

    def test_largest_of_several_models(self):
        self.write("models", "2 4 3")
        text, calls = self.run_well()
        self.assertTrue(calls[-2].endswith("--TsarFuse.preset default"), calls)
        self.assertIn("--Mapper.min_model_size 3", (self.output / "logs/sparse.log").read_text())
        self.assertIn("3 models that no photos connect, of 4, 3, 2 images", text)
        self.assertIn("4 of 6 photos have a pose; left out: left/b.PNG, left/c d.png", text)
        self.assertEqual(len((self.output / "dense/stereo/fusion.cfg").read_text().split("\n")), 5)
        # Fewer images than the views that stereo_fusion requires.
        text, calls = self.run_well("--fusion", "colmap")
        self.assertTrue(calls[0].endswith("--StereoFusion.min_num_pixels 4"), calls[0])
        self.assertIn("4 of 6 photos", text)
        self.assertNotIn("sharp photos", text)

    def test_no_model(self):
        self.write("models", " ")
        error = self.refuses("could not find the camera poses")
        self.assertNotIn("--matcher", error)
        self.assertIn("sharp photos", error)
        # With the message of a program that fails.
        self.write("fail", "mapper")
        error = self.refuses("could not find the camera poses (out: sparse failed: "
                             "stand_ins.py mapper says 'cannot go on'")
        self.assertIn("sharp photos", error)
        self.write("models", "4")
        self.refuses("sparse failed: stand_ins.py mapper says 'cannot go on'")
        self.write("models", " ")
        self.assertNotIn("--ImageReader", error)
        self.assertIn("for photos of one camera with one zoom, --ImageReader.single_camera 1",
                      self.refuses("poses", "--ImageReader.single_camera_per_folder", 1))
        self.write("models", "2")
        (self.root / "fail").unlink()
        self.assertIn("2 of 6 photos have a pose; left out: f.png, g.png, left/b.PNG, left/c d.png. "
                      "For more: take sharp photos", self.run_well()[0])
        self.write("models", " ")
        for matcher in ("sequential", "vocab_tree"):
            self.write("tree", "1")
            self.assertIn("--matcher exhaustive", self.refuses("poses", "--matcher", matcher))

    def test_photos_that_cannot_be_used(self):
        nowhere = self.root / "nowhere"
        self.refuses("no such folder", photos=nowhere)
        self.refuses("is not a folder", photos=self.write("video.mp4", ""))
        self.write("phone/a.heic", "")
        self.write("phone/.hidden.png", "")
        error = self.refuses("has no photos (.jpg, .jpeg, .png); it has files with .heic",
                             photos=self.root / "phone")
        self.assertIn("heif-convert", error)
        for name in "ab":
            (self.root / "phone" / f"{name}.png").write_bytes(PHOTO)
        self.refuses("has 2 photos; at least 3", photos=self.root / "phone")
        self.refuses("is in the folder of the photos", output=self.photos / "out")
        self.refuses("is in the folder of the photos", output=self.photos)
        self.assertEqual(list(self.photos.glob("out")), [])
        self.refuses("output: is empty", output="")
        self.refuses("photos: is empty", photos="")
        (self.photos / "bad.jpg").write_text("no picture")
        self.refuses("bad.jpg: cannot be read as a JPEG or PNG image; copy it again")
        (self.photos / "cut.png").write_bytes(PHOTO[:-1])
        self.refuses("bad.jpg: cannot be read")
        (self.photos / "bad.jpg").unlink()
        self.refuses("cut.png: the picture is cut short; copy it again, or remove it")
        (self.photos / "cut.png").rename(self.photos / "new\nline.jpg")
        self.refuses("rename the photo")
        (self.photos / "new\nline.jpg").unlink()
        self.refuses("--undistorted_size 9: is below 16", "--undistorted_size", 9)
        self.assertFalse(self.output.exists())

    def test_what_is_left_out_of_photos_is_told(self):
        (self.photos / "h.HEIC").write_bytes(b"")
        with_alpha = bytearray(PHOTO)
        with_alpha[25] = 6
        (self.photos / "e.png").write_bytes(with_alpha)
        text, _ = self.run_well()
        self.assertIn("photos with .heic are left out; convert them by heif-convert", text)
        self.assertIn("1 photos have an alpha channel, which is ignored", text)
        self.assertIn("6 of 6 photos have a pose", text)

    def test_full_disks(self):
        scene = steps.Scene("scene", self.root / "full")
        usage = shutil.disk_usage(self.root)._replace(free=1 << 20)
        with mock.patch.object(shutil, "disk_usage", return_value=usage):
            self.rejects("the disk is full (1 MB left)", scene.step, "copy",
                         lambda step: step.run("true"), [])
        self.assertEqual(scene.record("copy")["state"], "running")


if __name__ == "__main__":
    unittest.main()
