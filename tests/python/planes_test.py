# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""read_planes() and read_plane_map() return as arrays what tsar_planes writes.

Needs NumPy: this Python's own, or that of a virtual environment that is kept in
the build folder. Skipped if it is not available."""
import json
import sys
from unittest import mock

import colmap_tsar
from sample_testing import digests
from support import HEIGHT, WIDTH, RefinedTest, run_program
from virtual_environment import optional, run_tests

np = optional("numpy")

MAP = "stereo/plane_maps/v001.jpg.geometric.png"


class PlanesTest(RefinedTest):
    def setUp(self):
        super().setUp()
        self.workspace = self.new_workspace("refined", self.refined)

    def test_gives_what_the_program_writes(self):
        before = digests(self.workspace)
        planes = colmap_tsar.read_planes(self.workspace)
        self.assertEqual(digests(self.workspace), before)
        output = self.folder / "planes.json"
        run_program("tsar_planes", "--workspace_path", self.workspace, "--output_path", output)
        expected = json.loads(output.read_text())
        self.assertGreaterEqual(len(planes), 3)
        self.assertEqual(len(planes), len(expected["planes"]))
        self.assertEqual(planes.input_type, expected["maps"])
        self.assertEqual(planes.num_images, expected["num_images"])
        self.assertEqual(planes.vertical.tolist(), expected["vertical"])
        self.assertEqual(planes.vertical_from, expected["vertical_from"])
        self.assertEqual(planes.frames.tolist(), expected["frames"])
        for name, key in (
            *((key + "s", key) for key in ("id", "normal", "offset", "center", "area", "resolution",
                                           "support", "component")),
            ("shares_measured", "share_measured"),
            ("num_pixels", "num_pixels"),
        ):
            with self.subTest(name=name):
                self.assertEqual(getattr(planes, name).tolist(),
                                 [plane[key] for plane in expected["planes"]])
        for i, plane in enumerate(expected["planes"]):
            with self.subTest(plane=plane["id"]):
                self.assertEqual(planes.classes[i], plane["class"])
                self.assertEqual(planes.meets[i], plane["meets"])
                self.assertEqual(planes.axes[i].tolist(), [plane["axis_s"], plane["axis_t"]])
                covariance = [[np.inf if value is None else value for value in row]
                              for row in plane["covariance"]]
                self.assertEqual(planes.covariances[i].tolist(), covariance)
                for numbers, key in ((planes.frame_ids, "frame"), (planes.frame_axes, "axis")):
                    value = -1 if plane[key] is None else plane[key]
                    self.assertEqual(numbers[i], value)
                self.assertEqual(planes.images[i], {image["name"]: image["num_pixels"]
                                                    for image in plane["images"]})
                self.assertEqual(len(planes.polygons[i]), len(plane["polygons"]))
                for polygon, other in zip(planes.polygons[i], plane["polygons"]):
                    self.assertEqual(polygon.outline.tolist(), other["outline"])
                    self.assertEqual([hole.tolist() for hole in polygon.holes], other["holes"])

    def test_shapes_hold_without_any_plane(self):
        planes = colmap_tsar.read_planes(self.workspace, min_area=1e9)
        self.assertEqual(len(planes), 0)
        self.assertEqual(planes.normals.shape, (0, 3))
        self.assertEqual(planes.covariances.shape, (0, 3, 3))
        self.assertEqual(planes.ids.shape, (0,))

    def test_maps_hold_the_ids(self):
        planes = colmap_tsar.read_planes(self.workspace)
        labels = colmap_tsar.read_plane_map(self.workspace / MAP)
        self.assertEqual(labels.shape, (HEIGHT, WIDTH))
        self.assertEqual(labels.dtype, np.int32)
        self.assertTrue(set(np.unique(labels)) <= {-1, *planes.ids.tolist()})
        for i, plane in enumerate(planes.ids):
            count = planes.images[i].get("v001.jpg", 0)
            # A few pixels may be too far off their plane to be counted.
            self.assertLessEqual(abs((labels == plane).sum() - count), count * 0.01)
        labels[:] = 0  # It is the caller's own.

    def test_missing_and_damaged_files_are_named(self):
        with self.assertRaisesRegex(FileNotFoundError, "nowhere.*no such"):
            colmap_tsar.read_planes(self.folder / "nowhere")
        with self.assertRaisesRegex(colmap_tsar.NotFoundError, "nowhere.png"):
            colmap_tsar.read_plane_map(self.folder / "nowhere.png")
        for name in ("stereo/tsar/planes.bin", MAP):
            path = self.workspace / name
            content = path.read_bytes()
            for size in (len(content) * 2 // 3, 0):
                with self.subTest(name=name, size=size):
                    path.write_bytes(content[:size])
                    with self.assertRaisesRegex(colmap_tsar.CorruptError, path.name):
                        colmap_tsar.read_planes(self.workspace)
                    if name == MAP:
                        with self.assertRaises(colmap_tsar.CorruptError):
                            colmap_tsar.read_plane_map(path)
            path.write_bytes(content)
        with self.assertRaisesRegex(colmap_tsar.CorruptError, "16 bits"):
            colmap_tsar.read_plane_map(self.sample / "images" / "v000.jpg")

    def test_planes_and_maps_of_different_runs_are_not_mixed(self):
        labels = colmap_tsar.read_plane_map(self.workspace / MAP)
        self.assertGreaterEqual(labels.max(), 0)
        (self.workspace / "stereo/tsar/planes.bin").unlink()
        with self.assertRaisesRegex(colmap_tsar.NotFoundError, "tsar_refine"):
            colmap_tsar.read_planes(self.workspace)

    def test_a_workspace_that_was_not_refined_has_none(self):
        colmap_tsar.restore(self.workspace)
        text = "no refined geometric maps; run tsar_refine"
        with self.assertRaisesRegex(colmap_tsar.NotFoundError, text):
            colmap_tsar.read_planes(self.workspace)

    def test_bad_arguments_are_named(self):
        for area in (-1.0, float("nan"), float("inf")):
            with self.assertRaisesRegex(ValueError, "^min_area: "):
                colmap_tsar.read_planes(self.workspace, min_area=area)
        with self.assertRaisesRegex(ValueError, "^input_type: 'a.b'"):
            colmap_tsar.read_planes(self.workspace, input_type="a.b")
        with self.assertRaisesRegex(colmap_tsar.NotFoundError, "photometric"):
            colmap_tsar.read_planes(self.workspace, input_type="photometric")

    def test_says_that_it_needs_numpy(self):
        with mock.patch.dict(sys.modules, {"numpy": None}):
            for read in (colmap_tsar.read_planes, colmap_tsar.read_plane_map):
                with self.assertRaisesRegex(ImportError, "planes are .*pip install numpy"):
                    read(self.workspace)


if __name__ == "__main__":
    run_tests(__file__, ["numpy"], np)
