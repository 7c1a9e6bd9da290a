# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""evaluate_depth() and evaluate_cloud() return what the command reports."""
import json
import shutil
import unittest

import colmap_tsar
from support import SampleTest, run_program, words_of, write_black_mask


def evaluate_by_program(*arguments):
    return json.loads(run_program("tsar_evaluate", *arguments, "--json", 1))


class EvaluateTest(SampleTest):
    def setUp(self):  # Nothing here changes the sample.
        self.scans = self.sample / "scans" / "scan_alignment.mlp"

    def test_depth(self):
        moved = self.class_folder / "truth"
        shutil.copytree(self.sample / "ground_truth" / "depth", moved)
        masks = self.class_folder / "masks"
        write_black_mask(masks / "v000.jpg.png", 640, 480)
        for keywords in (
            {},
            {"input_type": "photometric", "ground_truth_path": moved, "tolerances": [0.05]},
            {"mask_path": masks},
        ):
            with self.subTest(keywords=keywords):
                expected = evaluate_by_program(
                    "depth", "--workspace_path", self.sample, *words_of(keywords))
                evaluation = colmap_tsar.evaluate_depth(self.sample, **keywords)
                found = evaluation.todict()
                num_masks = 1 if "mask_path" in keywords else None
                self.assertEqual(found.pop("num_masks"), num_masks)
                self.assertEqual(expected.pop("num_masks", None), num_masks)
                for score in found["scores"]:
                    right = score.pop("num_right")
                    self.assertEqual(score["precision"], right / score.pop("num_estimated"))
                    self.assertEqual(score["recall"], right / score.pop("num_known"))
                self.assertEqual(found, expected)
                self.assertEqual(evaluation.scores[0].area, "all")
                self.assertGreater(evaluation.scores[0].f1, 0.1)

    def test_cloud(self):
        cloud = self.class_folder / "cloud.ply"
        workspace = colmap_tsar.Workspace(self.sample)
        workspace.fuse(cloud, device="cpu", point_spacing=4, progress=False)
        for keywords in (
            {},
            {"tolerances": (0.5,), "voxel_size": 0.5, "beam_radius": 0.01, "beam_angle": 0.1},
        ):
            with self.subTest(keywords=keywords):
                expected = evaluate_by_program("cloud", "--input_path", cloud, "--ground_truth_path",
                                               self.scans, *words_of(keywords))
                evaluation = colmap_tsar.evaluate_cloud(str(cloud), self.scans, **keywords)
                self.assertEqual(evaluation.todict(), expected)
                self.assertGreater(evaluation.scores[-1].f1, 0.0)

    def test_errors(self):
        depth, cloud = colmap_tsar.evaluate_depth, colmap_tsar.evaluate_cloud
        truth = {"ground_truth_path": self.sample / "ground_truth" / "depth"}
        for kind, text, function, arguments, keywords in (
            (FileNotFoundError, "missing.ply", cloud, ("missing.ply", self.scans), {}),
            (colmap_tsar.BadOptionError, "^voxel_size: ", cloud, ("a.ply", self.scans), {"voxel_size": 0}),
            (ValueError, "^tolerances: ", depth, (self.sample,), {"tolerances": [0.1, 0.1]}),
            (ValueError, "^input_type: 'a.b'", depth, (self.sample,), {"input_type": "a.b"}),
            (colmap_tsar.NotFoundError, "check workspace_path", depth, (self.class_folder,), truth),
        ):
            with self.subTest(text=text), self.assertRaisesRegex(kind, text):
                function(*arguments, **keywords)


if __name__ == "__main__":
    unittest.main()
