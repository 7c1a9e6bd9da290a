#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""scripts/tanks_and_temples.sh on the sample scene in the layout of Tanks and
Temples, with given poses and from images alone."""
import json
import shutil
import unittest

from dataset_testing import DatasetTest, make_tanks_and_temples

import numpy as np

from model import read_cameras, read_images
from trajectory import read_trajectory


def turned_and_scaled():
    """A matrix from the poses' frame to that of the ground truth."""
    matrix = np.diag([1.5, 1.5, 1.5, 1.0])
    matrix[:2, :2] = 1.5 * np.array([[0.8, -0.6], [0.6, 0.8]])
    matrix[:3, 3] = [1, 2, 3]
    return matrix


class TanksAndTemplesTest(DatasetTest):
    script = "tanks_and_temples"

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.output = cls.folder / "out"
        cls.room = cls.folder / "Room"
        make_tanks_and_temples(cls.sample, cls.room, truth_from_world=turned_and_scaled())

    def test_given_poses(self):
        command = (self.room, "--output_path", self.output, "--threshold", 0.1)
        text = self.run_well(*command)
        scene = self.output / "Room"
        for workspace in ("dense", "refined"):
            self.check_workspace(scene / workspace)
        self.check_poses(read_images(scene / "sparse" / "images.txt"), 1e-9)
        # The calibration, which the data set does not provide.
        (camera,) = read_cameras(scene / "sparse" / "cameras.txt").values()
        true = self.sample.camera(self.sample.images[0]).params[0]
        self.assertAlmostEqual(camera.params[0] / true, 1, delta=0.005)
        self.assertAlmostEqual(camera.params[3], 0, delta=0.02)

        submission = self.output / "submission"
        self.assertEqual((submission / "Room.ply").read_bytes(),
                         (scene / "after.ply").read_bytes())
        poses = read_trajectory(submission / "Room.log", self.sample.names)
        self.assertEqual(sorted(poses), self.sample.names)
        for image in self.sample.images:
            np.testing.assert_allclose(poses[image.name].world_from_camera(),
                                       image.pose.world_from_camera(), atol=1e-9)

        before, after = (json.loads((scene / "scores" / f"{name}.json").read_text())
                         for name in ("before", "after"))
        self.assertGreater(after["recall"], before["recall"])
        self.assertGreater(after["precision"], 0.3)  # Both are in one frame.
        self.assertIn(f"{after['f_score']:.3f}", text)
        files = self.files_of(self.output)
        self.run_well(*command)
        again = self.files_of(self.output)
        self.assertEqual(again[0], files[0])
        steps = lambda times: {path: t for path, t in times.items() if "submission" not in path}
        self.assertEqual(steps(again[1]), steps(files[1]))

    def test_images_alone(self):
        scene = self.folder / "Images"
        make_tanks_and_temples(self.sample, scene, with_poses=False,
                               truth_from_world=turned_and_scaled())
        # Images directly in the scene's folder, as in the archives.
        for image in (scene / "images").iterdir():
            image.rename(scene / image.name)
        (scene / "images").rmdir()
        text = self.run_well(scene, "--output_path", self.output, "--max_image_size", 64)
        self.assertIn("not scored: without given poses", text)
        self.check_workspace(self.output / "Images" / "dense")
        # The submission's poses are those of the cloud: up to a similarity, which
        # leaves angles between cameras and ratios of their distances.
        poses = read_trajectory(self.output / "submission" / "Images.log", self.sample.names)
        self.assertEqual(sorted(poses), self.sample.names)
        given = {image.name: image.pose for image in self.sample.images}

        def relations(of):
            first, *others = (of[name] for name in self.sample.names)
            scale = np.linalg.norm(others[-1].center() - first.center())
            return [(pose.rotation @ first.rotation.T,
                     first.rotation @ (pose.center() - first.center()) / scale)
                    for pose in others]

        for found, true in zip(relations(poses), relations(given)):
            np.testing.assert_allclose(found[0], true[0], atol=0.02)
            np.testing.assert_allclose(found[1], true[1], atol=0.03)

    def test_mistakes(self):
        output = ("--output_path", self.folder / "nothing", "--threshold", 0.1)

        log = "Room_COLMAP_SfM.log"
        self.fails_of_changes(self.room, output[2:], (
            (log, "4 4 0", "5 5 0", "image 5, but there are 5"),
            (log, "0.0 0.0 0.0 1.0", "", "24 lines"),
            (log, "1 1 0", "1 1", "line 6: 2 numbers"),
            ("images/v004.jpg", None, None, "image 4, but there are 4"),
            ("Room.json", None, None, "Room.json: not found"),
            ("Room.json", "axis_min", "axis", "Room.json: is not a volume"),
            ("Room_trans.txt", None, None, "Room_trans.txt: not found")))
        self.fails_of_changes(self.room.rename(self.folder / "renamed"), (*output[2:], "--poses", "log"), (
            ("images/v004.jpg", None, None, "renamed_COLMAP_SfM.log: not found"),))
        (self.folder / "renamed").rename(self.room)
        self.fails(self.room, *output, "--submit", "advanced", text="--submit advanced: 6 of 6 "
                   "scenes are missing, Auditorium, Ballroom")
        self.fails(self.room, *output[:2], text="give the threshold")
        self.fails(self.room, *output, "--threshold", -1, text="give the threshold")

    def test_poses_of_other_images(self):
        scene = self.folder / "swapped" / "Room"
        shutil.copytree(self.room, scene)
        log = scene / "Room_COLMAP_SfM.log"
        text = log.read_text().replace("0 0 0\n", "x\n", 1).replace("4 4 0\n", "0 0 0\n")
        log.write_text(text.replace("x\n", "4 4 0\n", 1))
        self.fails(scene, "--output_path", self.folder / "swapped_out",
                   "--threshold", 0.1, text="do not fit")


if __name__ == "__main__":
    unittest.main()
