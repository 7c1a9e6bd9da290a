# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Together with the newest pycolmap of the package index: it reads and fuses what
refine() writes, and refine() reads the workspaces that it makes.

Runs in a virtual environment that is kept in the build folder. Skipped if
pycolmap is not available."""
import shutil

import colmap_tsar
from sample_testing import digests, results
from support import HEIGHT, WIDTH, RefinedTest
from virtual_environment import IS_INSIDE, run_in_environment, run_tests

if IS_INSIDE:
    import numpy as np
    import pycolmap


def as_vectors(normal_map):
    """Height x width x 3. The array of pycolmap 4.2 has this shape, but holds all x
    first, then all y, then all z, as the file does: also for COLMAP's own maps."""
    array = normal_map.to_array()
    height, width, _ = array.shape
    if np.allclose(np.linalg.norm(array, axis=-1).max(), 1.0, atol=1e-4):
        return array
    return array.reshape(3, height, width).transpose(1, 2, 0)


class PycolmapTest(RefinedTest):
    num_images = 8

    def test_maps_of_a_workspace_are_those_of_pycolmap(self):
        ws = colmap_tsar.Workspace(self.refined)
        reconstruction = pycolmap.Reconstruction(self.refined / "sparse")
        self.assertEqual(len(ws), reconstruction.num_images())
        for other in reconstruction.images.values():
            image = ws[other.name]
            depth, normal = pycolmap.DepthMap(), pycolmap.NormalMap()
            stereo = self.refined / "stereo"
            depth.read(stereo / "depth_maps" / f"{image.name}.geometric.bin")
            normal.read(stereo / "normal_maps" / f"{image.name}.geometric.bin")
            self.assertEqual((depth.width, depth.height), (WIDTH, HEIGHT))
            for mine, theirs in ((image.depth, depth.to_array()), (image.normals, as_vectors(normal))):
                np.testing.assert_array_equal(mine, theirs)
                self.assertEqual(mine.dtype, theirs.dtype)
            # The colors are made of x, y and z, each as pycolmap understands it.
            has_depth = image.depth > 0
            colors = -255 * image.normals[has_depth]
            colors[:, :2] = 127.5 + colors[:, :2] / 2
            found = normal.to_bitmap().to_array()[has_depth]
            np.testing.assert_allclose(found, np.clip(colors, 0, 255), atol=1.0)
            pose = other.cam_from_world().matrix()
            self.assertEqual(image.cam_from_world.shape, pose.shape)
            np.testing.assert_allclose(image.cam_from_world, pose, atol=1e-12)
            camera = reconstruction.cameras[other.camera_id]
            camera.rescale(WIDTH, HEIGHT)
            np.testing.assert_allclose(image.camera.K, camera.calibration_matrix(), rtol=1e-12)

    def fuse(self, workspace, name):
        """F1 at 2 cm of what pycolmap fuses."""
        cloud = self.folder / name
        options = pycolmap.StereoFusionOptions()
        options.num_threads = 1  # The result depends on the threads' order.
        pycolmap.stereo_fusion(cloud, workspace, options=options, output_type="PLY")
        scans = self.sample / "scans" / "scan_alignment.mlp"
        evaluation = colmap_tsar.evaluate_cloud(cloud, scans, tolerances=[0.02])
        print(name, evaluation)
        return evaluation.scores[0]

    def test_fuses_a_better_cloud(self):
        before = self.fuse(self.sample, "before.ply")
        after = self.fuse(self.refined, "after.ply")
        self.assertGreater(after.f1, before.f1 + 0.15)
        self.assertGreater(after.completeness, before.completeness + 0.15)
        self.assertGreater(after.accuracy, before.accuracy - 0.1)

    def test_workspaces_of_pycolmap_are_refined(self):
        """The whole dense folder is pycolmap's own, except the maps, which need
        a GPU."""
        dense = self.folder / "undistorted"
        pycolmap.undistort_images(dense, self.sample / "sparse", self.sample / "images")
        for name in ("rigs.bin", "frames.bin", "images.bin"):
            self.assertTrue((dense / "sparse" / name).is_file(), name)
        for kind in ("depth_maps", "normal_maps"):
            for path in (self.sample / "stereo" / kind).iterdir():
                shutil.copy(path, dense / "stereo" / kind)
        self.assertEqual(digests(dense / "images"), digests(self.sample / "images"))
        summary = colmap_tsar.refine(dense, device="cpu", progress=False)
        self.assertEqual(summary.num_refined, self.num_images)
        self.assertEqual((summary.kept, summary.num_sources_without_maps), ({}, 0))
        self.assertEqual(results(dense), results(self.refined))

    def test_text_models_of_pycolmap_are_read(self):
        reconstruction = pycolmap.Reconstruction(self.workspace / "sparse")
        shutil.rmtree(self.workspace / "sparse")
        (self.workspace / "sparse").mkdir()
        reconstruction.write_text(self.workspace / "sparse")
        for name in ("rigs.txt", "frames.txt", "images.txt"):
            self.assertTrue((self.workspace / "sparse" / name).is_file(), name)
        colmap_tsar.refine(self.workspace, device="cpu", progress=False)
        self.assertEqual(results(self.workspace), results(self.refined))


if __name__ == "__main__":
    if not IS_INSIDE:
        run_in_environment(__file__, "pycolmap", "numpy")
    print("pycolmap", pycolmap.__version__, "numpy", np.__version__)
    run_tests(__file__, [])
