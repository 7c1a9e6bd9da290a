#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Masks of photos: which steps of reconstruct.sh get them, with stand-ins for
the programs; and, with COLMAP, that they are undistorted like their photos."""
import unittest

from dataset_testing import COLMAP, PROGRAM, FolderTest, write_gray_png
from stand_in_testing import COMMANDS, PHOTO, StandInTest

import numpy as np
from files import DatasetError
from masks import undistort_masks
from programs import Programs
from steps import Scene
from structure_from_motion import undistort

AFTER_FEATURES = COMMANDS[1:5] + ["image_undistorter"] + COMMANDS[5:]


class MasksTest(StandInTest):
    def setUp(self):
        super().setUp()
        self.masks = self.root / "my masks"
        for name in ("a.jpg.png.png", "left/c d.png.png"):
            path = self.masks / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(PHOTO)
        self.options = ("--mask_path", self.masks)

    def test_every_step_gets_its_masks(self):
        text, calls = self.run_well(*self.options, "--export", "nerfstudio")
        self.assertIn("step 5 of 11: masks", text)
        self.assertEqual([c.split()[0] for c in calls if c[0] != " "],
                         COMMANDS[:1] + AFTER_FEATURES + ["export"])
        call = lambda command: [c for c in calls if c.startswith(command)]
        self.assertIn(f"--ImageReader.mask_path {self.masks}", calls[0])
        masks = self.output / "masks"
        for command in ("tsar_stereo", "tsar_refine", "export"):
            self.assertIn(f" --mask_path {masks}", call(command)[0])
        for fusion in call("tsar_fuse"):
            self.assertIn(f" --mask_path {masks}", fusion)
        self.assertEqual(sorted(p.relative_to(masks).as_posix() for p in masks.rglob("*.png")),
                         ["a.jpg.png.png", "left/c d.png.png"])
        self.assertEqual(list(self.output.glob("*.part")), [])

    def test_stereo_fusion_gets_them(self):
        _, calls = self.run_well(*self.options, "--fusion", "colmap")
        fusions = [c for c in calls if c.startswith("stereo_fusion")]
        self.assertEqual(len(fusions), 2)
        for fusion in fusions:
            self.assertIn(f"--StereoFusion.mask_path {self.output / 'masks'}", fusion)

    def test_masks_are_inputs(self):
        self.run_well(*self.options)
        self.assertEqual(self.commands(*self.options), [])
        (self.masks / "left" / "c d.png.png").write_bytes(PHOTO + b"changed")
        self.assertEqual(self.commands(*self.options), COMMANDS[:1] + AFTER_FEATURES)
        # Undistorted like their photos.
        options = (*self.options, "--undistorted_size", 64)
        _, calls = self.run_well(*options)
        self.assertEqual([c.endswith("--max_image_size 64") for c in calls
                          if c.startswith("image_undistorter")], [True, True])
        self.assertEqual(self.commands(), COMMANDS)  # Without them.

    def test_options_of_the_programs_come_first(self):
        _, calls = self.run_well(*self.options, "--fusion", "colmap", "--StereoFusion.mask_path",
                                 "others")
        for fusion in (c for c in calls if c.startswith("stereo_fusion")):
            self.assertIn("--StereoFusion.mask_path others", fusion)
            self.assertNotIn(str(self.output / "masks"), fusion)

    def test_photos_with_masks_but_without_a_pose(self):
        self.write("models", "4")
        self.run_well(*self.options)
        self.assertEqual([p.name for p in (self.output / "masks").rglob("*.png")],
                         ["a.jpg.png.png"])
        (self.masks / "a.jpg.png.png").unlink()
        text, calls = self.run_well(*self.options)
        self.assertIn("no photo with a mask has a pose: going on without masks", text)
        self.assertIn("--ImageReader.mask_path", calls[0])
        self.assertEqual([c for c in calls if " --mask_path" in c], [])

    def test_masks_that_cannot_be_used(self):
        self.refuses("nowhere: no such folder", "--mask_path", self.root / "nowhere")
        self.refuses("is in the folder of the photos", "--mask_path", self.photos / "left")
        empty = self.write("empty/other.png", "").parent
        self.refuses("empty: holds no mask of any photo; that of a.jpg.png would be a.jpg.png.png",
                     "--mask_path", empty)
        mask = self.masks / "a.jpg.png.png"
        mask.write_bytes(PHOTO.replace(b"\x10", b"\x11"))
        self.refuses("a.jpg.png.png: is 17 x 12, its photo 16 x 12; make it of the photo's size",
                     *self.options)
        mask.write_text("no picture")
        self.refuses("a.jpg.png.png: cannot be read as a JPEG or PNG image", *self.options)
        self.assertFalse(self.output.exists())
        mask.write_bytes(PHOTO)
        self.run_well(*self.options)
        self.refuses("is in the output folder", "--mask_path", self.output / "masks")


class UndistortedMasksTest(FolderTest):
    """With COLMAP itself: pictures that are equal before are equal after."""

    def setUp(self):
        super().setUp()
        self.programs = Programs(COLMAP, PROGRAM)
        self.scene = Scene("scene", self.root / "out")
        self.photos, self.masks = self.root / "photos", self.root / "my masks"
        y, x = np.mgrid[:60, :80]
        for i, name in enumerate(("a.png", "left/c.png", "d.png")):
            pixels = np.where((x + 7 * i) // 10 % 2 + y // 15 % 2 == 1, 0, 255)
            write_gray_png(self.photos / name, pixels)
            write_gray_png(self.masks / f"{name}.png", pixels)
        (self.masks / "d.png.png").unlink()
        self.write("out/sparse/cameras.txt", "1 OPENCV 80 60 70 71 40 30 0.2 0.05 0.01 0\n")
        self.write_images("a.png", "left/c.png", "d.png")
        self.write("out/sparse/points3D.txt", "1 0 0 5 9 9 9 0.1 1 0 2 0\n")

    def write_images(self, *names):
        self.write("out/sparse/images.txt", "# A comment.\n" + "".join(
            f"{i} 1 0 0 0 {i} 0 0 1 {name}\n" + ("\n" if i == 3 else "40 30 1\n")
            for i, name in enumerate(names, 1)))

    def undistort_masks(self, names, options=None):
        return undistort_masks(self.scene, self.programs, self.masks, names, options or {})

    def test_masks_are_undistorted_as_their_photos(self):
        for options in ({}, {"max_image_size": 40}):
            self.scene.step("workspace", lambda step: undistort(
                step, self.programs, self.photos, self.scene.folder / "sparse", options),
                outputs=["dense"], options=options)
            masks = self.undistort_masks(["a.png", "left/c.png"], options)
            images = self.scene.folder / "dense" / "images"
            for name in ("a.png", "left/c.png"):
                mask = (masks / f"{name}.png").read_bytes()
                self.assertEqual(mask, (images / name).read_bytes(), name)
                self.assertNotEqual(mask, (self.masks / f"{name}.png").read_bytes())
            self.assertEqual(len(list(masks.rglob("*.png"))), 2)

    def test_names_with_spaces(self):
        masks = self.undistort_masks(["a.png"])
        expected = (masks / "a.png.png").read_bytes()
        (self.masks / "a.png.png").rename(self.masks / "a  b.jpg.png")
        self.write_images("a  b.jpg", "left/c.png", "d.png")
        self.undistort_masks(["a  b.jpg"])
        self.assertEqual((masks / "a  b.jpg.png").read_bytes(), expected)

    def test_what_colmap_cannot_read_is_named(self):
        (self.masks / "a.png.png").write_text("no picture")
        with self.assertRaisesRegex(DatasetError, "my masks/a.png.png: COLMAP could not undistort"):
            self.undistort_masks(["a.png", "left/c.png"])


if __name__ == "__main__":
    unittest.main()
