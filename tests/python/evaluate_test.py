# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""evaluate_depth() and evaluate_cloud() say what the command says."""
import json
import shutil
import struct
import unittest
import xml.etree.ElementTree

import colmap_tsar
from support import SampleTest, run_program, write_black_mask


def write_cloud(path, scans):
    """Some points of the first scan of a MeshLab project, in the world's frame."""
    mesh = xml.etree.ElementTree.parse(scans).find(".//MLMesh")
    matrix = [float(value) for value in mesh.findtext("MLMatrix44").split()]
    body = (scans.parent / mesh.get("filename")).read_bytes()
    body = body[body.index(b"end_header\n") + len(b"end_header\n") :]
    points = list(struct.iter_unpack("<3f", body))[::7]
    with open(path, "w") as file:
        file.write(f"ply\nformat ascii 1.0\nelement vertex {len(points)}\n")
        file.write("".join(f"property float {axis}\n" for axis in "xyz"))
        file.write("end_header\n")
        for point in points:
            for row in range(3):
                a, b, c, d = matrix[4 * row : 4 * row + 4]
                file.write(f"{a * point[0] + b * point[1] + c * point[2] + d} ")
            file.write("\n")


def evaluate_by_program(*arguments):
    return json.loads(run_program("tsar_evaluate", *arguments, "--json", 1))


class EvaluateTest(SampleTest):
    def setUp(self):
        self.folder = self.class_folder
        self.workspace = self.sample  # Nothing here changes it.
        self.scans = self.sample / "scans" / "scan_alignment.mlp"

    def test_depth(self):
        moved = self.class_folder / "truth"
        shutil.copytree(self.sample / "ground_truth" / "depth", moved)
        masks = self.class_folder / "masks"
        write_black_mask(masks / "v000.jpg.png", 480, 360)
        for keywords, arguments in (
            ({}, []),
            (
                {
                    "input_type": "photometric",
                    "ground_truth_path": moved,
                    "tolerances": [0.05],
                },
                [
                    "--input_type",
                    "photometric",
                    "--ground_truth_path",
                    moved,
                    "--tolerances",
                    "0.05",
                ],
            ),
            ({"mask_path": masks}, ["--mask_path", masks]),
        ):
            with self.subTest(keywords=keywords):
                expected = evaluate_by_program(
                    "depth", "--workspace_path", self.sample, *arguments
                )
                evaluation = colmap_tsar.evaluate_depth(self.sample, **keywords)
                found = evaluation.todict()
                num_masks = 1 if "mask_path" in keywords else None
                self.assertEqual(found.pop("num_masks"), num_masks)
                self.assertEqual(expected.pop("num_masks", None), num_masks)
                for score in found["scores"]:
                    right = score.pop("num_right")
                    self.assertEqual(
                        score["precision"], right / score.pop("num_estimated")
                    )
                    self.assertEqual(score["recall"], right / score.pop("num_known"))
                self.assertEqual(found, expected)
                self.assertEqual(evaluation.scores[0].area, "all")
                self.assertGreater(evaluation.scores[0].f1, 0.1)

    def test_cloud(self):
        cloud = self.class_folder / "cloud.ply"
        write_cloud(cloud, self.scans)
        for keywords, arguments in (
            ({}, []),
            (
                {
                    "tolerances": (0.5,),
                    "voxel_size": 0.5,
                    "beam_radius": 0.01,
                    "beam_angle": 0.1,
                },
                [
                    *("--tolerances", 0.5, "--voxel_size", 0.5),
                    *("--beam_radius", 0.01, "--beam_angle", 0.1),
                ],
            ),
        ):
            with self.subTest(keywords=keywords):
                expected = evaluate_by_program(
                    "cloud",
                    "--input_path",
                    cloud,
                    "--ground_truth_path",
                    self.scans,
                    *arguments,
                )
                evaluation = colmap_tsar.evaluate_cloud(
                    str(cloud), self.scans, **keywords
                )
                self.assertEqual(evaluation.todict(), expected)
                self.assertGreater(evaluation.scores[-1].f1, 0.0)

    def test_errors(self):
        with self.assertRaisesRegex(FileNotFoundError, "missing.ply"):
            colmap_tsar.evaluate_cloud("missing.ply", self.scans)
        with self.assertRaisesRegex(colmap_tsar.BadOptionError, "^voxel_size: "):
            colmap_tsar.evaluate_cloud("missing.ply", self.scans, voxel_size=0)
        with self.assertRaisesRegex(ValueError, "^tolerances: "):
            colmap_tsar.evaluate_depth(self.sample, tolerances=[0.1, 0.1])
        with self.assertRaisesRegex(ValueError, "^input_type: 'best'"):
            colmap_tsar.evaluate_depth(self.sample, input_type="best")
        with self.assertRaisesRegex(colmap_tsar.NotFoundError, "check workspace_path"):
            colmap_tsar.evaluate_depth(
                self.class_folder,
                ground_truth_path=self.sample / "ground_truth" / "depth",
            )


if __name__ == "__main__":
    unittest.main()
