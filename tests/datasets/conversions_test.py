#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""What the scripts for data sets read and write, on small files with known contents."""
import unittest

from dataset_testing import FolderTest  # First: it sets the path.

import numpy as np

import strecha
from files import check_photo, find_scenes, image_size
from model import (Camera, Image, Pose, quaternion, read_cameras, read_images,
                   rotation_matrix, write_model)
from ply import read_ply
from trajectory import read_trajectory, write_trajectory
from workspace import remove_partial_maps


def random_poses(count, seed=1):
    rng = np.random.default_rng(seed)
    return [Pose(rotation_matrix(rng.normal(size=4)), rng.normal(size=3) * 5)
            for _ in range(count)]


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
        write_model(self.root, cameras, images)
        self.assertEqual(read_cameras(self.root / "cameras.txt"), cameras)
        again = read_images(self.root / "images.txt")
        for old, new in zip(images, again, strict=True):
            self.assertEqual((old.image_id, old.camera_id, old.name),
                             (new.image_id, new.camera_id, new.name))
            np.testing.assert_allclose(new.pose.rotation, old.pose.rotation, atol=1e-14)
            self.assertEqual(new.pose.translation.tolist(), old.pose.translation.tolist())

    def test_damaged_models(self):
        self.rejects_changes("1 PINHOLE 4 4 1 2 3 4\n", read_cameras, (
            ("line 1", "PINHOLE", "OPENCV"), ("3 numbers", "1 2 3 4", "1 2 3"),
            ("not numbers", "2", "x")))
        self.rejects_changes("1 1 0 0 0 2 3 4 1 a.jpg\n\n", read_images, (
            ("not finite", "1 0 0 0", "1 0 0 nan"), ("quaternion", "1 0 0 0", "0 0 0 0"),
            ("line 1", " a.jpg", "")))
        self.rejects("not found", read_images, self.root / "nothing")


class TrajectoryTest(FolderTest):
    names = [f"{i:03}.jpg" for i in range(4)]

    def test_poses_go_there_and_back(self):
        poses = dict(zip(self.names, random_poses(4)))
        del poses["002.jpg"]
        path = self.root / "scene.log"
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
        entry = "0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"
        self.rejects_changes(entry, lambda path: read_trajectory(path, self.names), (
            ("4 lines", "0 0 0 1\n", ""), ("image 4", "0 0 0\n1", "4 4 0\n1"),
            ("second time", entry, 2 * entry), ("not a rotation", "1 0 0 0", "2 0 0 0"),
            ("not a rotation", "1 0 0 0", "-1 0 0 0"), ("0 0 0 1", "0 0 0 1", "0 0 1 1"),
            ("line 2: 3 numbers", "1 0 0 0", "1 0 0")))


class StrechaCameraTest(FolderTest):
    text = "500 0 320\n0 501 240\n0 0 1\n0 0 0\n0 0 1\n-1 0 0\n0 -1 0\n1 2 3\n640 480\n"

    def test_a_camera(self):
        camera, pose = strecha.read_camera(self.write("a.camera", self.text))
        self.assertEqual(camera, Camera("PINHOLE", 640, 480, [500, 501, 320, 240]))
        np.testing.assert_allclose(pose.center(), [1, 2, 3])
        np.testing.assert_allclose(pose.rotation @ [5, 2, 3] + pose.translation, [0, 0, 4],
                                   atol=1e-15)

    def test_damaged_files(self):
        self.rejects_changes(self.text, strecha.read_camera, (
            ("8 lines", "640 480\n", ""), ("skew", "500 0 320", "500 1 320"),
            ("distortion", "0 0 1\n0 0 0\n", "0 0 1\n0.1 0 0\n"),
            ("calibration", "0 0 1\n0 0 0", "0 1 1\n0 0 0"),
            ("calibration", "500 0 320", "-500 0 320"), ("rotation", "-1 0 0\n", "1 0 0\n"),
            ("line 9", "640 480", "640.5 480")))


class FilesTest(FolderTest):
    def test_image_sizes(self):
        def chunked(*parts):
            path = self.root / "image"
            path.write_bytes(b"".join(parts))
            return path

        tables = b"\xff\xc4\x00\x04ab" + b"\xff\xe0\x00\x03x"
        frame = b"\xff\xc2\x00\x0b\x08\x00\x30\x00\x40"
        self.assertEqual(image_size(chunked(b"\xff\xd8", tables, frame)), (64, 48))
        self.assertEqual(image_size(chunked(
            b"\x89PNG\r\n\x1a\n", b"\0\0\0\rIHDR", b"\0\0\0\x40", b"\0\0\0\x30")), (64, 48))
        self.rejects("cannot be read", image_size, chunked(b"\xff\xd8", tables))
        self.rejects("cannot be read", image_size, chunked(b"GIF89a"))
        self.rejects("not found", image_size, self.root / "nothing.jpg")

    def test_photos_that_are_cut_short(self):
        """A photo with a thumbnail and several scans, cut off at each of its bytes."""
        def segment(code, content):
            return b"\xff" + bytes([code]) + (len(content) + 2).to_bytes(2, "big") + content

        frame = segment(0xC2, b"\x08\x00\x30\x00\x40" + bytes(4))
        thumbnail = segment(0xE1, b"Exif\0\0\xff\xd8\xff\xd9")
        scan = segment(0xDA, b"abc") + b"12\xff\x00\xff\xd0345\xff\x00"
        jpeg = b"\xff\xd8" + thumbnail + frame + scan + segment(0xC4, b"ab") + scan + b"\xff\xd9"
        chunk = lambda kind, content: (len(content).to_bytes(4, "big") + kind + content + b"_crc")
        png = (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", b"\0\0\0\x40\0\0\0\x30" + bytes(5))
               + chunk(b"IDAT", b"..IEND..") + chunk(b"IEND", b""))
        path = self.root / "photo"
        for whole in (jpeg, png):
            for tail in (b"", b"\xff more of the camera"):
                path.write_bytes(whole + tail)
                self.assertEqual(check_photo(path), (64, 48))
            for size in range(60, len(whole)):
                path.write_bytes(whole[:size])
                self.rejects("photo: the picture is cut short; copy it again", check_photo, path)
            path.write_bytes(whole[:60] + bytes(len(whole) - 60))  # A download that stopped.
            self.rejects("cut short", check_photo, path)

    def test_scenes(self):
        for name in ("b", "a", "other"):
            (self.root / name).mkdir()
        for name in ("a", "b"):
            self.write(f"{name}/mark", "")
        is_scene = lambda path: (path / "mark").exists()
        self.assertEqual(find_scenes(self.root / "a", is_scene, ""), [self.root / "a"])
        self.assertEqual(find_scenes(self.root, is_scene, ""), [self.root / "a", self.root / "b"])
        self.rejects("a scene has marks", find_scenes, self.root / "other", is_scene, "marks")
        self.rejects("not a folder", find_scenes, self.root / "nothing", is_scene, "marks")

    def test_half_written_maps_are_removed(self):
        whole = b"2&1&1&" + bytes(8)
        for name, content in (("whole", whole), ("half", whole[:-1]), ("header", b"2&1"),
                              ("empty", b"")):
            path = self.root / "stereo" / "depth_maps" / f"{name}.bin"
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)
        remove_partial_maps(self.root)
        self.assertEqual([p.stem for p in self.root.rglob("*.bin")], ["whole"])


class PlyTest(FolderTest):
    header = ("ply\nformat {}\ncomment x\nelement vertex 3\nproperty double x\n"
              "property float y\nproperty float z\nproperty uchar red\nelement face 1\n"
              "property list uchar int vertex_indices\nend_header\n")

    def test_ascii_and_binary_are_the_same(self):
        text = self.write("a.ply", self.header.format("ascii 1.0") +
                          "0 1 2 255\n3 4 5 0\n6 7 8 9\n3 0 1 2\n")
        kind = np.dtype([("x", "<f8"), ("y", "<f4"), ("z", "<f4"), ("r", "u1")])
        rows = np.array([(0, 1, 2, 255), (3, 4, 5, 0), (6, 7, 8, 9)], kind)
        binary = self.root / "b.ply"
        binary.write_bytes(self.header.format("binary_little_endian 1.0").encode() +
                           rows.tobytes() + b"\3" + np.arange(3, dtype="<i4").tobytes())
        for path in (text, binary):
            ply = read_ply(path)
            np.testing.assert_array_equal(ply.points, np.arange(9.0).reshape(3, 3))
            np.testing.assert_array_equal(ply.faces, [[0, 1, 2]])

    def test_damaged_files(self):
        good = self.header.format("ascii 1.0") + "0 1 2 255\n3 4 5 0\n6 7 8 9\n3 0 1 2\n"
        self.rejects_changes(good, read_ply, (
            ("damaged", "6 7 8 9\n3 0 1 2\n", "6 7"),
            ("vertices that are not there", "3 0 1 2", "3 0 1 3"),
            ("not triangles", "3 0 1 2", "4 0 1 2"),
            ("binary_big_endian", "ascii", "binary_big_endian"),
            ("not finite", "3 4 5", "nan 4 5"), ("header", "end_header\n", ""),
            ("not a PLY", "ply\n", "plx\n")))


if __name__ == "__main__":
    unittest.main()
