# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""The images and maps of a Workspace are those of the files.

Needs NumPy: this Python's own, or that of a virtual environment that is kept in
the build folder. Skipped if it is not available."""
import os
import sys
from unittest import mock

import colmap_tsar
from support import HEIGHT, QUICK, WIDTH, RefinedTest, read_map
from virtual_environment import optional, run_tests

np = optional("numpy")


class WorkspaceMapsTest(RefinedTest):
    def test_is_a_mapping_of_all_images(self):
        ws = colmap_tsar.Workspace(self.sample)
        names = [f"v{i:03d}.jpg" for i in range(8)]
        self.assertEqual(list(ws), names)
        self.assertEqual([image.name for image in ws.images], names)
        self.assertEqual(len(ws), 8)
        self.assertIn("v003.jpg", ws)
        self.assertNotIn("v008.jpg", ws)
        self.assertNotIn(3, ws)
        self.assertIsNone(ws.get("v008.jpg"))
        with self.assertRaisesRegex(KeyError, "no image 'v0001.jpg'.*v001.jpg"):
            ws["v0001.jpg"]
        self.assertEqual(ws.path, self.sample)
        self.assertTrue(ws["v001.jpg"].path.is_file())
        self.assertEqual(ws.input_type, "geometric")
        self.assertNotEqual(ws, colmap_tsar.Workspace(self.sample))

    def test_maps_are_those_of_the_files(self):
        ws = colmap_tsar.Workspace(str(self.refined))
        image = ws["v001.jpg"]
        stereo = self.refined / "stereo"
        key = "v001.jpg.geometric"
        depth = read_map(stereo / f"depth_maps/{key}.bin")[..., 0]
        normals = read_map(stereo / f"normal_maps/{key}.bin")
        np.testing.assert_array_equal(image.depth, depth)
        np.testing.assert_array_equal(image.normals, normals)
        sigma = np.load(stereo / f"sigma_maps/{key}.npy", allow_pickle=False)
        self.assertEqual(sigma.dtype, np.float16)
        np.testing.assert_array_equal(image.sigma, sigma.astype("float32"))
        planes = colmap_tsar.read_plane_map(stereo / f"plane_maps/{key}.png")
        np.testing.assert_array_equal(image.planes, planes)
        for name, dtype in (
            *((name, np.float32) for name in ("depth", "normals", "confidence", "sigma")),
            ("provenance", np.uint8),
            ("planes", np.int32),
        ):
            with self.subTest(name=name):
                array = getattr(image, name)
                self.assertEqual(array.dtype, dtype)
                self.assertEqual(array.shape[:2], (HEIGHT, WIDTH))
                self.assertIs(getattr(image, name), array)  # Read once,
                array[:] = 0  # and the caller's own.
                self.assertIsNot(getattr(ws["v001.jpg"], name), array)

    def test_maps_agree_with_each_other(self):
        image = colmap_tsar.Workspace(self.refined)["v001.jpg"]
        has_depth = image.depth > 0
        self.assertGreater(has_depth.mean(), 0.8)
        lengths = np.linalg.norm(image.normals, axis=-1)[has_depth]
        np.testing.assert_allclose(lengths, 1.0, atol=1e-4)
        for name in ("confidence", "sigma", "provenance"):
            np.testing.assert_array_equal(getattr(image, name) > 0, has_depth, name)
        self.assertLessEqual(image.confidence.max(), 1.0)
        self.assertGreater(image.confidence.max(), 0.9)
        self.assertTrue((image.planes >= -1).all())

    def test_planes_of_the_scene_explain_the_labels(self):
        """Points of labeled pixels, through camera and pose, lie on their planes."""
        ws = colmap_tsar.Workspace(self.refined)
        self.assertIs(ws.planes, ws.planes)
        image = ws["v001.jpg"]
        rows, columns = np.nonzero(image.planes >= 0)
        self.assertGreater(len(rows), 2500)
        pixels = np.stack([columns, rows, np.ones(len(rows))])
        points = np.linalg.inv(image.camera.K) @ pixels * image.depth[rows, columns]
        pose = image.cam_from_world
        world = pose[:, :3].T @ (points - pose[:, 3:])
        index = np.searchsorted(ws.planes.ids, image.planes[rows, columns])
        distances = np.einsum("ij,ji->i", ws.planes.normals[index], world) + ws.planes.offsets[index]
        relative = np.abs(distances) / image.depth[rows, columns]
        self.assertLess(np.median(relative), 0.002)

    def test_camera_is_of_the_maps_size(self):
        ws = colmap_tsar.Workspace(self.workspace)
        camera = ws["v000.jpg"].camera
        self.assertEqual((camera.width, camera.height), (WIDTH, HEIGHT))
        for kind, channels in (("depth", 1), ("normal", 3)):
            path = self.workspace / f"stereo/{kind}_maps/v000.jpg.geometric.bin"
            path.write_bytes(f"120&90&{channels}&".encode() + bytes(4 * 120 * 90 * channels))
        half = ws["v000.jpg"].camera
        self.assertEqual((half.width, half.height), (120, 90))
        np.testing.assert_allclose(half.K[:2], camera.K[:2] / 2, rtol=1e-12)
        self.assertEqual(half.K[2].tolist(), [0, 0, 1])
        path.with_name("v000.jpg.geometric.bin").unlink()
        (self.workspace / "stereo/depth_maps/v000.jpg.geometric.bin").unlink()
        image = ws["v000.jpg"].camera  # The photo's, which is larger here.
        self.assertEqual((image.width, image.height), (640, 480))
        np.testing.assert_allclose(image.K[:2], camera.K[:2] * 8 / 3, rtol=1e-12)
        self.assertEqual(ws["v000.jpg"].cam_from_world.shape, (3, 4))

    def test_nothing_is_read_before_it_is_asked_for(self):
        for path in (self.workspace / "stereo/depth_maps").iterdir():
            path.write_bytes(b"damaged")
        image = colmap_tsar.Workspace(self.workspace)["v000.jpg"]
        self.assertEqual(image.normals.shape, (HEIGHT, WIDTH, 3))
        with self.assertRaisesRegex(colmap_tsar.CorruptError, "v000.jpg.geometric.bin"):
            image.depth

    def test_hostile_maps_are_named(self):
        self.workspace = self.new_workspace("refined", self.refined)
        for kind, suffix, attribute in (
            ("depth", "bin", "depth"),
            ("normal", "bin", "normals"),
            ("confidence", "png", "confidence"),
            ("sigma", "npy", "sigma"),
            ("provenance", "png", "provenance"),
            ("plane", "png", "planes"),
        ):
            path = self.workspace / f"stereo/{kind}_maps/v000.jpg.geometric.{suffix}"
            content = path.read_bytes()
            for damaged in (b"", content[: len(content) * 2 // 3], b"999999999&" * 9):
                path.write_bytes(damaged)
                image = colmap_tsar.Workspace(self.workspace)["v000.jpg"]
                with self.subTest(path=path, size=len(damaged)):
                    with self.assertRaisesRegex(colmap_tsar.CorruptError, path.name):
                        getattr(image, attribute)
            path.unlink()
            with self.assertRaisesRegex(FileNotFoundError, f"{path.name}: .*; "):
                getattr(image, attribute)

    def test_type_of_maps(self):
        ws = colmap_tsar.Workspace(self.workspace, input_type="photometric")
        expected = read_map(self.workspace / "stereo/depth_maps/v000.jpg.photometric.bin")[..., 0]
        np.testing.assert_array_equal(ws["v000.jpg"].depth, expected)
        ws = colmap_tsar.Workspace(self.workspace)
        for path in (self.workspace / "stereo/depth_maps").glob("*.geometric.bin"):
            path.unlink()
        self.assertEqual(ws.input_type, "photometric")
        with self.assertRaisesRegex(ValueError, "^input_type: 'a.b'"):
            colmap_tsar.Workspace(self.workspace, input_type="a.b")

    def test_what_is_no_workspace_is_named(self):
        with self.assertRaisesRegex(FileNotFoundError, "nowhere.*check workspace_path"):
            colmap_tsar.Workspace(self.folder / "nowhere")
        path = self.workspace / "sparse/images.txt"
        path.write_bytes(path.read_bytes().replace(b"v003.jpg", b""))
        with self.assertRaisesRegex(colmap_tsar.CorruptError, "images.txt"):
            colmap_tsar.Workspace(self.workspace)

    def test_says_that_it_needs_numpy(self):
        image = colmap_tsar.Workspace(self.sample)["v000.jpg"]
        with mock.patch.dict(sys.modules, {"numpy": None}):
            with self.assertRaisesRegex(ImportError, "^maps, .*pip install numpy"):
                image.depth

    def test_names_need_not_be_utf8(self):
        path = os.fsencode(self.folder) + b"/\xff"
        os.rename(self.workspace, path)
        ws = colmap_tsar.Workspace(path)
        self.assertEqual(ws["v000.jpg"].depth.shape, (HEIGHT, WIDTH))
        ws.refine(device="cpu", progress=False, **QUICK)
        self.assertEqual(ws.report(progress=False).num_images, self.num_images)


if __name__ == "__main__":
    run_tests(__file__, ["numpy"], np)
