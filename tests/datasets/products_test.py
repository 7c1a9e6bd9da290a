#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Meshes and exports of scripts/reconstruct.sh with stand-ins for the programs;
and once all of it with the programs, on photos of the sample scene."""
import subprocess
import unittest

from dataset_testing import (COLMAP, PROGRAM, REPOSITORY, DatasetTest, vertex_count,
                             write_gray_png)
from stand_in_testing import StandInTest

import numpy as np
import ply
from files import image_size


class ProductsTest(StandInTest):
    def test_meshes(self):
        self.run_well("--mesh", "--mesh", "delaunay")
        poisson, delaunay = (self.output / f"mesh_{kind}.ply" for kind in ("poisson", "delaunay"))
        self.assertEqual(ply.count(poisson, "face"), 7)
        self.assertEqual(ply.count(delaunay, "face"), len((self.output / "after.ply").read_bytes()))
        self.assertEqual(self.commands("--mesh", "poisson", "--PoissonMeshing.trim", 5),
                         ["poisson_mesher"])
        self.refuses("the mesh is empty", "--mesh", "--PoissonMeshing.trim", 9)
        self.assertFalse(poisson.exists())
        self.write("no_cgal", "1")
        self.refuses("without CGAL; use --mesh poisson", "--mesh", "delaunay")

    def test_textures(self):
        texture = self.output / "textured_poisson"
        text, calls = self.run_well("--mesh", "--texture")
        self.assertIn(f"textured mesh: {texture / 'mesh.ply'}", text)
        self.assertEqual([c.split()[0] for c in calls[-2:]], ["poisson_mesher", "mesh_texturer"])
        self.assertEqual((texture / "texture.png").read_text(), "texture")
        _, calls = self.run_well("--mesh", "--texture",
                                 "--MeshTextureMapping.min_cos_normal_angle", 0.2)
        self.assertEqual(len(calls), 1)
        self.assertIn(" --MeshTextureMapping.min_cos_normal_angle 0.2", calls[0])
        # A texture of the same mesh stays, of another mesh it is made anew or
        # removed, and of another cloud it is kept elsewhere, like its mesh.
        self.assertEqual(self.commands("--mesh"), [])
        self.assertTrue(texture.is_dir())
        self.assertEqual(self.commands("--mesh", "--texture", "--PoissonMeshing.trim", 5),
                         ["poisson_mesher", "mesh_texturer"])
        self.assertEqual(self.commands("--mesh", "--PoissonMeshing.trim", 6), ["poisson_mesher"])
        self.assertFalse(texture.exists())
        self.assertEqual(
            self.commands("--mesh", "delaunay", "--mesh", "--texture"),
            ["delaunay_mesher", "poisson_mesher", "mesh_texturer", "mesh_texturer"])
        for kind in ("poisson", "delaunay"):
            self.assertEqual((self.output / f"textured_{kind}" / "mesh.ply").read_bytes(),
                             (self.output / f"mesh_{kind}.ply").read_bytes())
        self.run_well("--preset", "paper")
        self.assertFalse(texture.exists())
        self.assertEqual(len(list((self.output / "outdated").glob("*_textured_*"))), 2)

    def test_textures_that_cannot_be(self):
        self.refuses("--texture: is for meshes", "--texture")
        self.write("no_texture", "1")
        self.refuses("texture_poisson: COLMAP wrote no mesh", "--mesh", "--texture")
        self.assertFalse((self.output / "textured_poisson").exists())
        self.write("no_cgal", "1")
        self.refuses("without CGAL and cannot tell", "--mesh", "--texture")
        self.write("old", "1")
        self.refuses("has no mesh_texturer", "--mesh", "--texture")

    def test_products_of_earlier_runs(self):
        self.run_well("--mesh", "--export", "npy")
        mesh, export = self.output / "mesh_poisson.ply", self.output / "export_npy"
        # Made from the same cloud: they stay, but are no result of this run.
        text, calls = self.run_well()
        self.assertNotIn("mesh", text)
        self.assertEqual((calls, mesh.exists(), export.exists()), ([], True, True))
        # Made from another one: they are kept elsewhere.
        content = mesh.read_bytes()
        text, _ = self.run_well("--preset", "paper")
        self.assertFalse(mesh.exists() or export.exists())
        self.assertIn("mesh_poisson.ply is of an earlier run; moved to", text)
        (kept,) = (self.output / "outdated").glob("*_mesh_poisson.ply")
        self.assertEqual(kept.read_bytes(), content)
        self.assertEqual(len(list((self.output / "outdated").glob("*_export_npy/npy"))), 1)
        # Asked for again, they are made again.
        self.assertEqual(self.commands("--preset", "paper", "--mesh", "--export", "npy"),
                         ["poisson_mesher", "export"])

    def test_exports(self):
        _, calls = self.run_well("--export", "png16", "--depth_scale", 0.01, "--export", "3dgs")
        exports = [c for c in calls if c.startswith("export")]
        self.assertIn("--format png16", exports[0])
        self.assertIn("--overwrite 1 --depth_scale 0.01", exports[0])
        self.assertNotIn("depth_scale", exports[1])
        self.assertNotIn("cloud_path", exports[0] + exports[1])
        _, (export,) = self.run_well("--export", "nerfstudio")
        self.assertIn(f"--cloud_path {self.output / 'after.ply'}", export)
        self.assertEqual(self.commands("--export", "png16"), ["export"])
        self.refuses("--depth_scale: is for", "--export", "npy", "--depth_scale", 1)
        self.write("no_cv2", "1")
        self.refuses("cannot import colmap_tsar, numpy, cv2", "--export", "exr")

    def test_clouds_without_points(self):
        self.write("nothing", "1")
        self.refuses("after.ply: has no points")
        self.assertTrue((self.output / "report" / "index.html").is_file())


class PhotosTest(DatasetTest):
    """With the programs themselves."""

    def test_from_photos_to_mesh(self):
        photos, output = self.folder / "photos", self.folder / "out"
        self.sample.copy_images(photos)
        masked = self.sample.names[0]
        width, height = image_size(photos / masked)
        mask = np.full((height, width), 255)
        mask[:, :width // 4] = 0
        write_gray_png(self.folder / "masks" / f"{masked}.png", mask)
        result = subprocess.run(
            [str(part) for part in (
                REPOSITORY / "scripts" / "reconstruct.sh", photos, output, "--colmap", COLMAP,
                "--colmap_tsar", PROGRAM, "--max_image_size", 64, "--ImageReader.single_camera", 1,
                "--fusion", "colmap", "--StereoFusion.min_num_pixels", 3,
                "--mask_path", self.folder / "masks",
                "--PoissonMeshing.depth", 6, "--mesh")],
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.assertEqual(result.returncode, 0, result.stdout)
        self.check_workspace(output / "dense")
        self.check_workspace(output / "refined")
        before, after = (vertex_count(output / f"{name}.ply") for name in ("before", "after"))
        self.assertGreater(after, before)
        self.assertIn(f"{before} → {after}", result.stdout)
        self.assertGreater(ply.count(output / "mesh_poisson.ply", "face"), 0)
        self.assertTrue((output / "report" / "index.html").is_file())
        path = output / "refined" / "stereo" / "depth_maps" / f"{masked}.geometric.bin"
        width, height, _, values = path.read_bytes().split(b"&", 3)
        depth = np.frombuffer(values, "<f4").reshape(int(height), int(width))
        border = int(width) // 4
        self.assertFalse(depth[:, :border - 2].any())
        self.assertTrue(depth[:, border + 2:].any())


if __name__ == "__main__":
    unittest.main()
