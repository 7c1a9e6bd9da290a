#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""What the scripts for data sets compute: focal lengths, scans of meshes and the
scores of Tanks and Temples, on synthetic scenes with known answers."""
import json
import unittest

from dataset_testing import COLMAP, PROGRAM, FolderTest  # First: it sets the path.

import numpy as np

from focal_length import estimate_focal_length
from model import Camera, Pose, rotation_matrix
from ply import Ply, read_ply, write_points
from programs import Programs
from steps import Scene
from tanks_and_temples_score import Crop, Truth, read_crop, score, thin_out
from virtual_scans import scan_from, scan_mesh


class FocalLengthTest(FolderTest):
    def matches(self, poses, focal, seed=5):
        """Projections of random points in front of all cameras."""
        rng = np.random.default_rng(seed)
        points = rng.uniform(-1, 1, (200, 3)) + [0, 0, 5]
        pixels = {}
        for name, pose in poses.items():
            local = points @ pose.rotation.T + pose.translation
            pixels[name] = focal * local[:, :2] / local[:, 2:] + [320, 240]
        names = sorted(poses)
        for i, a in enumerate(names):
            for b in names[i + 1:]:
                wrong = rng.uniform(0, 480, (20, 2))  # A tenth are wrong.
                yield a, b, pixels[a], np.concatenate([pixels[b][:180], wrong])

    def poses(self):
        angles = [(0.2, 0.0, 0.0), (-0.1, 0.2, 0.1), (0.0, -0.2, 0.0), (0.1, 0.1, -0.2)]
        return {str(i): Pose(rotation_matrix([1, *a]), np.array([i - 1.5, 0.3 * i * i, 0]))
                for i, a in enumerate(angles)}

    def test_it_is_found_without_a_first_guess(self):
        for focal in (300.0, 700.0, 1500.0):
            found = estimate_focal_length(self.matches(self.poses(), focal), self.poses(),
                                          640, 480, "log")
            self.assertAlmostEqual(found / focal, 1, delta=2e-3)

    def test_wrong_poses_are_noticed(self):
        poses = self.poses()
        shuffled = dict(zip(sorted(poses), [poses[k] for k in ("2", "0", "3", "1")]))
        self.rejects("do not fit", estimate_focal_length, self.matches(poses, 700.0),
                     shuffled, 640, 480, "log")
        self.rejects("no two images", estimate_focal_length, [], poses, 640, 480, "log")


def square(half, z):
    points = np.array([[-half, -half, z], [half, -half, z], [half, half, z], [-half, half, z]])
    return points, np.array([[0, 1, 2], [0, 2, 3]])


class VirtualScanTest(FolderTest):
    camera = Camera("PINHOLE", 80, 60, [70.0, 70.0, 40.0, 30.0])
    pose = Pose(np.eye(3), np.zeros(3))

    def scan(self, *squares, pose=None):
        points, faces = [], []
        for p, f in squares:
            faces.append(f + 4 * len(points))
            points.append(p)
        return scan_from(np.concatenate(points), np.concatenate(faces), self.camera,
                         pose or self.pose, (80, 60))

    def test_a_wall_fills_the_view(self):
        points = self.scan(square(10, 5.0))
        self.assertEqual(len(points), 80 * 60)  # One point per pixel, without gaps.
        np.testing.assert_allclose(points[:, 2], 5, atol=1e-12)

    def test_what_stands_in_front_hides(self):
        points = self.scan(square(10, 5.0), square(0.5, 2.0))
        near = points[:, 2] < 3
        # 0.5 / 2 * 70 is 17.5 pixels to each side.
        self.assertAlmostEqual(near.sum(), 35 * 35, delta=72)
        self.assertTrue((np.abs(points[near, :2]) <= 0.5 + 1e-9).all())
        far = points[~near]
        self.assertTrue((np.abs(far[:, :2]).max(1) > 0.5 / 2 * 5 - 2 * 5 / 70).all())

    def test_depths(self):
        turned = Pose(np.diag([1.0, -1, -1]), np.array([0, 0, 7.0]))  # Looks from z = 7 down.
        near, far = square(2, 4.0), square(4, 8.0)  # Both cover the same pixels.
        for squares, pose, depth in (((near, far), self.pose, 4), ((far, near), self.pose, 4),
                                     ((square(20, 1.0),), turned, 6)):
            np.testing.assert_allclose(self.scan(*squares, pose=pose)[:, 2], depth, atol=1e-12)
        self.assertEqual(len(self.scan(square(10, -5.0))), 0)  # Behind the camera.

    def test_files(self):
        points, faces = square(10, 5.0)
        scan_mesh(Ply(points, faces), {"a": self.camera}, {"a": self.pose}, self.root / "scans")
        self.assertEqual(len(read_ply(self.root / "scans" / "a.ply").points), 80 * 60)
        angle = float((self.root / "scans" / "beam_angle.txt").read_text())
        self.assertAlmostEqual(angle, np.degrees(np.arctan(0.5 / 70)), places=4)
        self.rejects("no camera sees", scan_mesh, Ply(-points, faces), {"a": self.camera},
                     {"a": self.pose}, self.root / "empty")


class ScoreTest(FolderTest):
    threshold = 0.05

    def test_crop_of_a_bent_polygon(self):
        bent = [[0, 0, 9], [4, 0, 9], [4, 1, 9], [1, 1, 9], [1, 4, 9], [0, 4, 9]]
        path = self.write("a.json", json.dumps(
            {"axis_min": 0, "axis_max": 2, "orthogonal_axis": "Z", "bounding_polygon": bent}))
        inside = read_crop(path).contains(np.array(
            [[0.5, 0.5, 1], [3, 0.5, 1], [0.5, 3, 1], [2, 2, 1], [-1, 0.5, 1], [5, 0.5, 1],
             [0.5, 0.5, 3], [0.5, 0.5, -1]]))
        self.assertEqual(inside.tolist(), [True] * 3 + [False] * 5)
        self.rejects("is not a volume", read_crop, self.write("a.json", "{}"))
        self.rejects("is not a volume", read_crop, self.write("a.json", "["))

    def test_crop_along_y(self):
        crop = Crop(1, 0, 1, np.array([[0, 0], [2, 0], [2, 3], [0, 3]]))  # x and z.
        inside = crop.contains(np.array([[1, 0.5, 2.5], [2.5, 0.5, 1], [1, 2, 1]]))
        self.assertEqual(inside.tolist(), [True, False, False])

    def test_thinning(self):
        points = np.array([[0.1, 0, 0], [0.3, 0, 0], [-0.1, 0, 0], [1.1, 0, 0]])
        thin = thin_out(points, 1.0)
        np.testing.assert_allclose(np.sort(thin[:, 0]), [-0.1, 0.2, 1.1])

    def scores(self, name, before, after):
        """precision, recall, F of two clouds against a grid on the unit square."""
        scene = Scene(name, self.root / name)
        x, y = np.meshgrid(np.arange(40) / 40 + 0.01, np.arange(40) / 40 + 0.01)
        grid = np.stack([x.ravel(), y.ravel(), 0.01 + 0 * x.ravel()], 1)
        write_points(self.root / "truth.ply", grid)
        # Clouds are in a frame of half the size, and moved.
        transform = np.diag([2.0, 2, 2, 1])
        transform[:3, 3] = [1, 2, 3]
        for name, cloud in (("before", before(grid)), ("after", after(grid))):
            write_points(scene.folder / f"{name}.ply", (cloud - transform[:3, 3]) / 2)
        crop = Crop(2, -1, 1, np.array([[-1, -1], [3, -1], [3, 3], [-1, 3]]))
        truth = Truth(self.root / "truth.ply", [self.root / "truth.ply"], transform, crop)
        score(scene, Programs(COLMAP, PROGRAM), truth, self.threshold)
        results = [json.loads((scene.folder / "scores" / f"{name}.json").read_text())
                   for name in ("before", "after")]
        return [(r["precision"], r["recall"], r["f_score"]) for r in results]

    def test_known_scores(self):
        half = lambda grid: grid[grid[:, 0] < 0.5]
        shifted = lambda grid: grid + [0, 0, 2 * self.threshold]
        with_wrong = lambda grid: np.concatenate([grid, shifted(grid)])
        same, part = self.scores("1", lambda grid: grid, half)
        np.testing.assert_allclose(same, [1, 1, 1])
        precision, recall, f = part
        self.assertEqual(precision, 1)
        self.assertAlmostEqual(recall, 0.5, delta=0.06)  # And a rim of the threshold.
        self.assertAlmostEqual(f, 2 * recall / (1 + recall), places=6)
        double, off = self.scores("2", with_wrong, shifted)
        self.assertAlmostEqual(double[0], 0.5, delta=0.02)
        self.assertEqual(double[1], 1)
        np.testing.assert_allclose(off, [0, 0, 0])


if __name__ == "__main__":
    unittest.main()
