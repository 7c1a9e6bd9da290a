#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""The parts of the scripts for data sets, each alone, on small inputs with known
answers."""
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import time
import unittest

from dataset_testing import PROGRAM, COLMAP  # First: it sets the path.

import numpy as np

import strecha
from files import DatasetError, find_scenes, image_size
from focal_length import estimate_focal_length
from model import (Camera, Image, Pose, quaternion, read_cameras, read_images,
                   rotation_matrix, write_model)
from ply import Ply, read_ply, write_points
from programs import Programs
from steps import Scene
from tanks_and_temples_score import Crop, Truth, read_crop, score, thin_out
from trajectory import read_trajectory, write_trajectory
from virtual_scans import scan_from, scan_mesh
from workspace import remove_partial_maps

FOLDER = pathlib.Path(os.environ["TSAR_WORK_FOLDER"]) / "conversions"


def random_poses(count, seed=1):
    rng = np.random.default_rng(seed)
    return [Pose(rotation_matrix(rng.normal(size=4)), rng.normal(size=3) * 5)
            for _ in range(count)]


class FolderTest(unittest.TestCase):
    def setUp(self):
        shutil.rmtree(FOLDER, ignore_errors=True)
        FOLDER.mkdir(parents=True)

    def write(self, name, text):
        path = FOLDER / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        return path

    def rejects(self, text, function, *arguments):
        with self.assertRaises(DatasetError) as caught:
            function(*arguments)
        self.assertIn(text, str(caught.exception))
        self.assertNotIn("\n", str(caught.exception))


class ModelTest(FolderTest):
    def test_quaternions_of_all_rotations(self):
        rng = np.random.default_rng(3)
        halves = [q for q in np.eye(4)] + [np.array([0, 1, 1, 0]), np.array([0, 1, 1, 1])]
        for q in [*rng.normal(size=(100, 4)), *halves]:
            rotation = rotation_matrix(q)
            np.testing.assert_allclose(rotation_matrix(quaternion(rotation)), rotation,
                                       atol=1e-14)
            self.assertGreaterEqual(quaternion(rotation)[0], 0)

    def test_a_known_quaternion(self):
        quarter = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]])  # About z.
        np.testing.assert_allclose(quaternion(quarter), [0.5**0.5, 0, 0, 0.5**0.5], atol=1e-15)

    def test_what_is_written_is_read_again(self):
        cameras = {3: Camera("PINHOLE", 64, 48, [50.1, 50.2, 31.9, 24.3])}
        images = [Image(i + 1, 3, f"folder/a b{i}.jpg", pose)
                  for i, pose in enumerate(random_poses(20))]
        write_model(FOLDER, cameras, images)
        self.assertEqual(read_cameras(FOLDER / "cameras.txt"), cameras)
        again = read_images(FOLDER / "images.txt")
        for old, new in zip(images, again, strict=True):
            self.assertEqual((old.image_id, old.camera_id, old.name),
                             (new.image_id, new.camera_id, new.name))
            np.testing.assert_allclose(new.pose.rotation, old.pose.rotation, atol=1e-14)
            self.assertEqual(new.pose.translation.tolist(), old.pose.translation.tolist())

    def test_damaged_models(self):
        self.rejects("line 1", read_cameras, self.write("c", "1 OPENCV 4 4 1 1 1 1 0 0 0 0\n"))
        self.rejects("3 numbers", read_cameras, self.write("c", "1 PINHOLE 4 4 1 1 1\n"))
        self.rejects("not numbers", read_cameras, self.write("c", "1 PINHOLE 4 4 1 x 1 1\n"))
        self.rejects("not finite", read_images, self.write("i", "1 1 0 0 nan 0 0 0 1 a.jpg\n\n"))
        self.rejects("quaternion", read_images, self.write("i", "1 0 0 0 0 0 0 0 1 a.jpg\n\n"))
        self.rejects("line 1", read_images, self.write("i", "1 1 0 0 0 0 0 0 1\n\n"))
        self.rejects("not found", read_images, FOLDER / "nothing")


class TrajectoryTest(FolderTest):
    names = [f"{i:03}.jpg" for i in range(4)]

    def test_poses_go_there_and_back(self):
        poses = dict(zip(self.names, random_poses(4)))
        del poses["002.jpg"]
        path = FOLDER / "scene.log"
        write_trajectory(path, self.names, poses)
        lines = path.read_text().splitlines()
        self.assertEqual(lines[::5], ["0 0 0", "1 1 0", "2 -1 0", "3 3 0"])
        again = read_trajectory(path, self.names)
        self.assertEqual(sorted(again), sorted(poses))
        for name, pose in poses.items():
            np.testing.assert_allclose(again[name].rotation, pose.rotation, atol=1e-14)
            np.testing.assert_allclose(again[name].translation, pose.translation, atol=1e-13)

    def test_the_matrix_takes_camera_to_world(self):
        # A camera at (1, 2, 3) that looks along the world's x axis.
        path = self.write("a.log", "0 0 0\n0 0 1 1\n-1 0 0 2\n0 -1 0 3\n0 0 0 1\n")
        pose = read_trajectory(path, self.names)["000.jpg"]
        np.testing.assert_allclose(pose.rotation @ [5, 2, 3] + pose.translation, [0, 0, 4],
                                   atol=1e-15)

    def test_damaged_files(self):
        entry = "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"
        read = lambda text: read_trajectory(self.write("a.log", text), self.names)
        self.assertEqual(len(read("0 0 0\n" + entry)), 1)
        self.rejects("4 lines", read, "0 0 0\n" + entry[:24])
        self.rejects("image 4", read, "4 4 0\n" + entry)
        self.rejects("second time", read, ("0 0 0\n" + entry) * 2)
        self.rejects("not a rotation", read, "0 0 0\n" + entry.replace("1 0 0 0", "2 0 0 0"))
        self.rejects("not a rotation", read, "0 0 0\n" + entry.replace("1 0 0 0", "-1 0 0 0"))
        self.rejects("0 0 0 1", read, "0 0 0\n" + entry.replace("0 0 0 1", "0 0 1 1"))
        self.rejects("line 2: 3 numbers", read, "0 0 0\n" + entry.replace("1 0 0 0", "1 0 0"))


class StrechaCameraTest(FolderTest):
    text = "500 0 320\n0 501 240\n0 0 1\n0 0 0\n0 0 1\n-1 0 0\n0 -1 0\n1 2 3\n640 480\n"

    def test_a_camera(self):
        camera, pose = strecha.read_camera(self.write("a.camera", self.text))
        self.assertEqual(camera, Camera("PINHOLE", 640, 480, [500, 501, 320, 240]))
        np.testing.assert_allclose(pose.center(), [1, 2, 3])
        np.testing.assert_allclose(pose.rotation @ [5, 2, 3] + pose.translation, [0, 0, 4],
                                   atol=1e-15)

    def test_damaged_files(self):
        read = lambda old, new: strecha.read_camera(
            self.write("a.camera", self.text.replace(old, new)))
        self.rejects("8 lines", read, "640 480\n", "")
        self.rejects("skew", read, "500 0 320", "500 1 320")
        self.rejects("distortion", read, "0 0 1\n0 0 0\n", "0 0 1\n0.1 0 0\n")
        self.rejects("calibration", read, "0 0 1\n0 0 0", "0 1 1\n0 0 0")
        self.rejects("calibration", read, "500 0 320", "-500 0 320")
        self.rejects("rotation", read, "-1 0 0\n", "1 0 0\n")
        self.rejects("line 9", read, "640 480", "640.5 480")


class FilesTest(FolderTest):
    def test_image_sizes(self):
        def chunked(*parts):
            path = FOLDER / "image"
            path.write_bytes(b"".join(parts))
            return path

        tables = b"\xff\xc4\x00\x04ab" + b"\xff\xe0\x00\x03x"
        frame = b"\xff\xc2\x00\x0b\x08\x00\x30\x00\x40"
        self.assertEqual(image_size(chunked(b"\xff\xd8", tables, frame)), (64, 48))
        self.assertEqual(image_size(chunked(
            b"\x89PNG\r\n\x1a\n", b"\0\0\0\rIHDR", b"\0\0\0\x40", b"\0\0\0\x30")), (64, 48))
        self.rejects("cannot be read", image_size, chunked(b"\xff\xd8", tables))
        self.rejects("cannot be read", image_size, chunked(b"GIF89a"))
        self.rejects("not found", image_size, FOLDER / "nothing.jpg")

    def test_scenes(self):
        for name in ("b", "a", "other"):
            (FOLDER / name).mkdir()
        for name in ("a", "b"):
            self.write(f"{name}/mark", "")
        is_scene = lambda path: (path / "mark").exists()
        self.assertEqual(find_scenes(FOLDER / "a", is_scene, ""), [FOLDER / "a"])
        self.assertEqual(find_scenes(FOLDER, is_scene, ""), [FOLDER / "a", FOLDER / "b"])
        self.rejects("a scene has marks", find_scenes, FOLDER / "other", is_scene, "marks")
        self.rejects("not a folder", find_scenes, FOLDER / "nothing", is_scene, "marks")

    def test_half_written_maps_are_removed(self):
        whole = b"2&1&1&" + bytes(8)
        for name, content in (("whole", whole), ("half", whole[:-1]), ("header", b"2&1"),
                              ("empty", b"")):
            path = FOLDER / "stereo" / "depth_maps" / f"{name}.bin"
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)
        remove_partial_maps(FOLDER)
        self.assertEqual([p.stem for p in FOLDER.rglob("*.bin")], ["whole"])


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
                wrong = rng.uniform(0, 480, (20, 2))  # A tenth is wrong.
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

    def test_the_nearer_one_is_seen_in_any_order(self):
        walls = square(4, 8.0), square(2, 4.0)  # Both cover the same pixels.
        for first, second in (walls, walls[::-1]):
            np.testing.assert_allclose(self.scan(first, second)[:, 2], 4, atol=1e-12)

    def test_nothing_behind_the_camera(self):
        self.assertEqual(len(self.scan(square(10, -5.0))), 0)

    def test_the_frame_is_the_cameras(self):
        pose = Pose(np.diag([1.0, -1, -1]), np.array([0, 0, 7.0]))  # Looks from z = 7 down.
        np.testing.assert_allclose(self.scan(square(20, 1.0), pose=pose)[:, 2], 6, atol=1e-12)

    def test_files(self):
        points, faces = square(10, 5.0)
        scan_mesh(Ply(points, faces), {"a": self.camera}, {"a": self.pose}, FOLDER / "scans")
        self.assertEqual(len(read_ply(FOLDER / "scans" / "a.ply").points), 80 * 60)
        angle = float((FOLDER / "scans" / "beam_angle.txt").read_text())
        self.assertAlmostEqual(angle, np.degrees(np.arctan(0.5 / 70)), places=4)
        self.rejects("no camera sees", scan_mesh, Ply(-points, faces), {"a": self.camera},
                     {"a": self.pose}, FOLDER / "empty")


class PlyTest(FolderTest):
    header = ("ply\nformat {}\ncomment x\nelement vertex 3\nproperty double x\n"
              "property float y\nproperty float z\nproperty uchar red\nelement face 1\n"
              "property list uchar int vertex_indices\nend_header\n")

    def test_ascii_and_binary_are_the_same(self):
        text = self.write("a.ply", self.header.format("ascii 1.0") +
                          "0 1 2 255\n3 4 5 0\n6 7 8 9\n3 0 1 2\n")
        kind = np.dtype([("x", "<f8"), ("y", "<f4"), ("z", "<f4"), ("r", "u1")])
        rows = np.array([(0, 1, 2, 255), (3, 4, 5, 0), (6, 7, 8, 9)], kind)
        binary = FOLDER / "b.ply"
        binary.write_bytes(self.header.format("binary_little_endian 1.0").encode() +
                           rows.tobytes() + b"\3" + np.arange(3, dtype="<i4").tobytes())
        for path in (text, binary):
            ply = read_ply(path)
            np.testing.assert_array_equal(ply.points, np.arange(9.0).reshape(3, 3))
            np.testing.assert_array_equal(ply.faces, [[0, 1, 2]])

    def test_damaged_files(self):
        good = self.header.format("ascii 1.0") + "0 1 2 255\n3 4 5 0\n6 7 8 9\n3 0 1 2\n"
        read = lambda old, new: read_ply(self.write("a.ply", good.replace(old, new)))
        self.assertEqual(len(read("", "").points), 3)
        self.rejects("damaged", read, "6 7 8 9\n3 0 1 2\n", "6 7")
        self.rejects("vertices that are not there", read, "3 0 1 2", "3 0 1 3")
        self.rejects("not triangles", read, "3 0 1 2", "4 0 1 2")
        self.rejects("binary_big_endian", read, "ascii", "binary_big_endian")
        self.rejects("not finite", read, "3 4 5", "nan 4 5")
        self.rejects("header", read, "end_header\n", "")
        self.rejects("not a PLY", read, "ply\n", "plx\n")


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
        scene = Scene(name, FOLDER / name)
        x, y = np.meshgrid(np.arange(40) / 40 + 0.01, np.arange(40) / 40 + 0.01)
        grid = np.stack([x.ravel(), y.ravel(), 0.01 + 0 * x.ravel()], 1)
        write_points(FOLDER / "truth.ply", grid)
        # Clouds are in a frame of half the size, and moved.
        transform = np.diag([2.0, 2, 2, 1])
        transform[:3, 3] = [1, 2, 3]
        for name, cloud in (("before", before(grid)), ("after", after(grid))):
            write_points(scene.folder / f"{name}.ply", (cloud - transform[:3, 3]) / 2)
        crop = Crop(2, -1, 1, np.array([[-1, -1], [3, -1], [3, 3], [-1, 3]]))
        truth = Truth(FOLDER / "truth.ply", [FOLDER / "truth.ply"], transform, crop)
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


class StepsTest(FolderTest):
    def setUp(self):
        super().setUp()
        self.ran = []
        self.input = self.write("input", "1")
        self.scene = Scene("scene", FOLDER / "out")

    def run_steps(self, option=1, fail=False):
        """Two steps, the second after the first; returns the names of those run."""
        self.ran = []

        def first(step):
            self.ran.append("first goes on" if step.continued else "first")
            path = self.scene.folder / "a"
            path.write_text(path.read_text() + "+" if path.exists() else "a")
            step.run("sh", "-c", "exit 3" if fail else "exit 0")

        def second(_):
            self.ran.append("second")
            (self.scene.folder / "b").write_text("b")

        self.scene.step("first", first, ["a"], {"option": option}, [self.input], resumes=True)
        self.scene.step("second", second, ["b"], after=["first"])
        return self.ran

    def test_done_is_done(self):
        self.assertEqual(self.run_steps(), ["first", "second"])
        self.assertEqual(self.run_steps(), [])

    def test_what_changed_is_done_again_with_what_follows(self):
        self.run_steps()
        self.assertEqual(self.run_steps(option=2), ["first", "second"])
        self.input.write_text("12")
        self.assertEqual(self.run_steps(option=2), ["first", "second"])
        (self.scene.folder / "b").unlink()
        self.assertEqual(self.run_steps(option=2), ["second"])
        (self.scene.folder / "a").unlink()
        self.assertEqual(self.run_steps(option=2), ["first", "second"])
        self.assertEqual((self.scene.folder / "a").read_text(), "a")

    def test_what_failed_goes_on_and_keeps_its_seconds(self):
        with self.assertRaisesRegex(DatasetError, "scene: first failed.*first.log"):
            self.run_steps(fail=True)
        record = self.scene.record("first")
        self.scene.write_record("first", {**record, "seconds": 100.0})
        self.assertEqual(self.run_steps(), ["first goes on", "second"])
        self.assertEqual((self.scene.folder / "a").read_text(), "a+")
        self.assertGreaterEqual(self.scene.seconds("first"), 100)
        self.assertLess(self.scene.seconds("second"), 100)

    def test_what_failed_with_other_options_starts_anew(self):
        with self.assertRaises(DatasetError):
            self.run_steps(fail=True)
        self.assertEqual(self.run_steps(option=2), ["first", "second"])
        self.assertEqual((self.scene.folder / "a").read_text(), "a")

    def test_a_damaged_record_is_as_none(self):
        self.run_steps()
        self.scene.record_path("first").write_text("{")
        self.assertEqual(self.run_steps(), ["first", "second"])

    def test_the_program_ends_with_the_script(self):
        pid_file = FOLDER / "pid"
        script = self.write("script.py", f'''
import dense
def run(args, programs):
    scene = dense.open_scene(args, "sleeper")
    scene.step("sleep", lambda step: step.run(
        "sh", "-c", "echo $$ > {pid_file}.part; mv {pid_file}.part {pid_file}; exec sleep 9999"),
        outputs=[])
dense.run_main(dense.make_parser("test", "", ""), run)
''')
        process = subprocess.Popen(
            [sys.executable, script, "scene", "--output_path", FOLDER / "out2", "--colmap",
             COLMAP, "--colmap_tsar", PROGRAM], stdout=subprocess.DEVNULL,
            env=dict(os.environ, PYTHONPATH=os.pathsep.join(sys.path)))
        while process.poll() is None and not pid_file.exists():
            time.sleep(0.02)
        pid = int(pid_file.read_text())
        process.terminate()
        self.assertEqual(process.wait(), 128 + signal.SIGTERM)
        self.assertRaises(ProcessLookupError, os.kill, pid, 0)

    def test_one_run_at_a_time(self):
        self.rejects("another run", Scene, "scene", FOLDER / "out")


if __name__ == "__main__":
    unittest.main()
