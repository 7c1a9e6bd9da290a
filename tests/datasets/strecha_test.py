#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""scripts/strecha.sh on the sample scene in the layout of Strecha's data."""
import json
import shutil
import unittest

from dataset_testing import DatasetTest, make_strecha

import numpy as np

from model import read_cameras, read_images
from sample_scene import read_map


def write_mesh(path, sample):
    """The surface that each view sees, from the true depth: a mesh of every fourth
    pixel without the triangles that jump from one surface to another."""
    points, faces, step = [], [], 4
    for image in sample.images:
        camera = sample.camera(image)
        depth = read_map(sample.folder / "ground_truth" / "depth" / f"{image.name}.bin")[0]
        scale = camera.width / depth.shape[1]
        depth = depth[::step, ::step]
        row, column = np.indices(depth.shape)
        fx, fy, cx, cy = camera.params
        local = np.stack([(column * step * scale - cx) / fx, (row * step * scale - cy) / fy,
                          np.ones(depth.shape)], -1) * depth[..., None]
        index = sum(map(len, points)) + np.arange(depth.size).reshape(depth.shape)
        points.append((local.reshape(-1, 3) - image.pose.translation) @ image.pose.rotation)
        a, b, c, d = index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]
        corners = np.stack([depth[:-1, :-1], depth[:-1, 1:], depth[1:, 1:], depth[1:, :-1]])
        smooth = (corners.min(0) > 0) & (corners.max(0) < 1.05 * corners.min(0))
        for triangle in ((a, b, c), (a, c, d)):
            faces.append(np.stack([corner[smooth] for corner in triangle], 1))
    points, faces = np.concatenate(points), np.concatenate(faces)
    rows = np.zeros(len(faces), [("count", "u1"), ("vertices", "<i4", 3)])
    rows["count"], rows["vertices"] = 3, faces
    path.write_bytes(
        f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n"
        "property float x\nproperty float y\nproperty float z\n"
        f"element face {len(faces)}\nproperty list uchar int vertex_indices\n"
        "end_header\n".encode() + points.astype("<f4").tobytes() + rows.tobytes())


class StrechaTest(DatasetTest):
    script = "strecha"

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.scene = cls.folder / "room-P5"
        make_strecha(cls.sample, cls.scene)
        cls.mesh = cls.folder / "mesh.ply"
        write_mesh(cls.mesh, cls.sample)

    def scores(self, output):
        return [json.loads((output / "scores" / f"{name}.json").read_text())
                for name in ("before", "after")]

    def test_submission(self):
        scenes, output = self.folder / "set", self.folder / "submitted"
        command = (scenes, "--output_path", output, "--submit", "paper", "--prior", "gp",
                   "--TsarStereo.num_levels", 1, "--TsarStereo.num_iterations", 1)
        make_strecha(self.sample, scenes / "fountain-P5")
        self.fails(*command, text="--submit paper: 1 of 2 scenes are missing, herzjesu")
        self.assertFalse(output.exists())
        make_strecha(self.sample, scenes / "Herz-Jesu-P5")
        self.run_well(*command)
        folder = output / "submission" / "strecha"
        self.assertEqual(sorted(p.name for p in folder.iterdir()),
                         ["Herz-Jesu-P5.ply", "Herz-Jesu-P5.txt", "fountain-P5.ply", "fountain-P5.txt"])
        self.assertRegex((folder / "fountain-P5.txt").read_text(), r"^runtime \d+\.\d+\n$")
        self.assertIn("--TsarStereo.max_image_size 320",
                      (output / "fountain-P5" / "logs" / "stereo.log").read_text())

    def test_from_images_to_scores(self):
        output = self.folder / "out" / "room-P5"
        command = (self.scene, "--output_path", output.parent)
        self.assertIn("not scored", self.run_well(*command))
        for workspace in ("dense", "refined"):
            self.check_workspace(output / workspace)
        self.check_poses(read_images(output / "dense" / "sparse" / "images.txt"), 1e-12)
        cameras = read_cameras(output / "dense" / "sparse" / "cameras.txt")
        self.assertEqual([c.params for c in cameras.values()],
                         [self.sample.camera(i).params for i in self.sample.images])

        # Scored later, against a mesh and against scans of the same room.
        text = self.run_well(*command, "--ground_truth", self.mesh)
        self.assertIn("fusion_after: done before", text)
        by_mesh = self.scores(output)
        self.run_well(*command, "--ground_truth",
                      self.sample.folder / "scans" / "scan_alignment.mlp")
        by_scans = self.scores(output)
        for mesh, scans in zip(by_mesh, by_scans):
            self.assertGreater(mesh["num_scan_points"], 0)
            for share, tolerance in (("accuracy", 0.15), ("completeness", 0.15)):
                self.assertAlmostEqual(mesh["scores"][3][share], scans["scores"][3][share],
                                       delta=tolerance)
        for before, after in (by_mesh, by_scans):
            self.assertGreater(after["scores"][3]["f1"], before["scores"][3]["f1"])
        files = self.files_of(output)
        self.run_well(*command, "--ground_truth",
                      self.sample.folder / "scans" / "scan_alignment.mlp")
        self.assertEqual(self.files_of(output), files)

    def test_mistakes(self):
        output = ("--output_path", self.folder / "nothing")
        camera = "gt_dense_cameras/v001.jpg.camera"

        self.fails_of_changes(self.scene, (), (
            (camera, "640 480", "", "v001.jpg.camera: 8 lines"),
            (camera, "640 480", "320 240", "is 640 x 480"),
            (camera, "0.0 0.0 1.0", "0.0 0.0 x", "line 3"),
            ("images/v003.jpg", None, None, "no image v003.jpg")))
        copy = self.folder / "spread" / "room-P5"
        shutil.copytree(self.scene, copy)
        (copy / "images" / "v002.jpg").rename(copy / "v002.jpg")
        self.fails(copy, *output, text="several folders")
        for path in sorted((copy / "gt_dense_cameras").iterdir())[1:]:
            path.unlink()
        self.fails(copy, *output, text="1 images with cameras")
        self.fails(self.scene, *output, "--ground_truth", "no.ply", text="no.ply: not found")
        several = self.folder / "several"
        for name in ("a", "b"):
            shutil.copytree(self.scene, several / name)
        self.fails(several, *output, "--ground_truth", self.mesh, text="one scene")
        self.assertFalse((self.folder / "nothing").exists())


if __name__ == "__main__":
    unittest.main()
