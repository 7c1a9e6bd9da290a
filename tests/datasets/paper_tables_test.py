#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""scripts/paper_tables.sh on the sample scene in the layouts of ETH3D and Strecha,
and what its tables are made of."""
import argparse
import json
import unittest

from dataset_testing import DatasetTest, FolderTest, make_eth3d, make_strecha

import numpy as np

import dense
import eth3d_depth
import paper_results as paper
import paper_tables
from command_line import PRIORS, choose_stereo
from files import DatasetError
from model import Camera
from sample_scene import read_map


def make_distorted_truth(sample, scene):
    """The true depth of the sample's images as an equidistant fisheye sees it, in the
    layout of ETH3D."""
    calibration = scene / "dslr_calibration_jpg"
    calibration.mkdir()
    width, height, focal = 640, 480, 500.0
    cameras, images = "", ""
    for image in sample.images:
        camera = sample.camera(image)
        cameras += f"{image.image_id} THIN_PRISM_FISHEYE {width} {height} {focal} {focal} " \
            f"{width / 2} {height / 2}" + " 0" * 8 + "\n"
        images += f"{image.image_id} 1 0 0 0 0 0 0 {image.image_id} dslr_images/{image.name}\n\n"
        depth = read_map(sample.folder / "ground_truth" / "depth" / f"{image.name}.bin")[0]
        fx, fy, cx, cy = camera.params
        x, y = np.meshgrid((np.arange(width) + 0.5 - width / 2) / focal,
                           (np.arange(height) + 0.5 - height / 2) / focal)
        angle = np.hypot(x, y)
        column = (fx * x * np.tan(angle) / angle + cx) * depth.shape[1] / camera.width
        row = (fy * y * np.tan(angle) / angle + cy) * depth.shape[0] / camera.height
        inside = ((column >= 0) & (column < depth.shape[1]) & (row >= 0) & (row < depth.shape[0]))
        distorted = np.full((height, width), np.inf, "<f4")
        distorted[inside] = depth[row[inside].astype(int), column[inside].astype(int)]
        file = scene / "ground_truth_depth" / "dslr_images" / image.name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(distorted.tobytes())
    (calibration / "cameras.txt").write_text(cameras)
    (calibration / "images.txt").write_text(images)


class PartsTest(FolderTest):
    def test_projection_of_the_distorted_camera(self):
        # By hand: the point (0.3, 0.4, 1) is arctan(0.5) = 0.463648 off the axis, in the
        # direction (0.6, 0.8): at (0.278189, 0.370918).
        params = [1000, 2000, 300, 200]
        plain = Camera("THIN_PRISM_FISHEYE", 1, 1, params + [0] * 8)
        np.testing.assert_allclose(eth3d_depth.project(plain, 0.3, 0.4),
                                   (1000 * 0.278189 + 300, 2000 * 0.370918 + 200), atol=2e-3)
        # r^2 = 0.214969; 2 x y = 0.206371; r^2 + 2 x^2 = 0.369747; r^2 + 2 y^2 = 0.490129.
        for index, (dx, dy) in {
                0: (0.278189 * 0.214969, 0.370918 * 0.214969),  # k1
                1: (0.278189 * 0.046212, 0.370918 * 0.046212),  # k2
                2: (0.206371, 0.490129), 3: (0.369747, 0.206371),  # p1, p2
                4: (0.278189 * 0.009934, 0.370918 * 0.009934),  # k3
                5: (0.278189 * 0.002136, 0.370918 * 0.002136),  # k4
                6: (0.214969, 0), 7: (0, 0.214969)}.items():  # sx, sy
            distortion = [0.1 if i == index else 0 for i in range(8)]
            found = eth3d_depth.project(Camera("THIN_PRISM_FISHEYE", 1, 1, params + distortion), 0.3, 0.4)
            np.testing.assert_allclose(found, (1000 * (0.278189 + 0.1 * dx) + 300,
                                               2000 * (0.370918 + 0.1 * dy) + 200), atol=5e-3)

    def test_numbers_of_the_paper(self):
        for rows in paper.ABLATION.values():
            self.assertEqual(list(rows)[0], "prior")
            self.assertEqual(set(rows) - {"prior", "TSAR-MVS"}, set(paper_tables.ABLATION))
            for mean, *scenes in rows.values():
                self.assertEqual(len(scenes), len(paper.ABLATION_SCENES))
                self.assertAlmostEqual(mean, np.mean(scenes), delta=0.006)
        self.assertEqual(set(paper.ETH3D), set(PRIORS))
        for clouds in paper.ETH3D.values():
            for row in clouds:
                for accuracy, completeness, f1 in (row[:3], row[3:]):
                    # The printed F1 is a mean over scenes.
                    self.assertAlmostEqual(
                        f1, 2 * accuracy * completeness / (accuracy + completeness), delta=2)
        for _, _, _, values in paper.PARAMETERS:
            self.assertIn(paper.ETH3D["gp"][1][2], values.values())

    def test_maps_of_acmm_are_imported(self):
        args = argparse.Namespace(prior="acmm", stereo=None, maps_path=self.root)
        choose_stereo(args, None)
        self.assertEqual(dense.stereo_command(args, "pipes", None), (
            "tsar_import", {"format": "acm", "input_path": str(self.root.resolve() / "pipes")}))
        args = argparse.Namespace(prior="acmm", stereo=None, maps_path=None)
        with self.assertRaisesRegex(DatasetError, "--prior acmm: needs --maps_path"):
            choose_stereo(args, None)
        tables = paper_tables.Tables()
        paper_tables.show_clouds(tables, "clouds", "acmm", paper.ETH3D["acmm"], [])
        self.assertEqual(tables.tables["clouds"]["acmm after, paper"]["F1@2cm"], 85.1)

    def test_runs(self):
        self.assertEqual(paper_tables.variants(["clouds"]),
                         {"prior": (None, {"cloud"}), "TSAR-MVS": ("", {"cloud"})})
        runs = paper_tables.variants(["ablation"])
        self.assertEqual(len(runs), 9)
        self.assertEqual(runs["w/o ICR"], ("refine=0", {"fused_pixels"}))
        runs = paper_tables.variants(["parameters"])
        self.assertEqual(len(runs), 37)  # Four other values of nine parameters.
        self.assertEqual(runs["min_region_size=3000"], ("min_region_size=3000", {"cloud"}))
        self.assertNotIn("num_iterations=4", runs)


class PaperTablesTest(DatasetTest):
    script = "paper_tables"

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.room = cls.folder / "eth3d" / "pipes"
        make_eth3d(cls.sample, cls.room)
        make_distorted_truth(cls.sample, cls.room)
        make_strecha(cls.sample, cls.folder / "strecha" / "fountain-P5")
        truth = cls.folder / "truth" / "fountain-P5"
        truth.parent.mkdir()
        truth.symlink_to(cls.sample.folder / "scans")

    def test_tables(self):
        output = self.folder / "out"
        command = ("--output_path", output, "--eth3d", self.room.parent, "--strecha",
                   self.folder / "strecha", "--ground_truth", self.folder / "truth", "--tables",
                   "clouds", "ablation", "--seeds", 2)
        text = self.run_well(*command)
        variants = output / "gp" / "pipes" / "variants"
        self.assertEqual(sorted(p.name for p in variants.iterdir()), sorted(
            [f"{name}{seed}.json" for seed in ("", ".seed1")
             for name in ["TSAR-MVS", *(f"w_o_{n}" for n in "JHF DD CE ICR SP WMF TS".split())]]
            + ["prior.json"]))
        log = (output / "gp" / "pipes" / "logs" / "variant_w_o_TS.log").read_text()
        self.assertIn("--TsarRefine.preset paper --TsarRefine.segment 0", log)
        full, other = (json.loads((variants / f"TSAR-MVS{seed}.json").read_text())
                       for seed in ("", ".seed1"))
        f1 = [100 * scores["cloud"]["scores"][0]["f1"] for scores in (full, other)]
        tables = json.loads((output / "gp" / "tables.json").read_text())["tables"]
        clouds = tables["ETH3D, training set, mean of the scenes"]
        self.assertAlmostEqual(clouds["gp after, ours"]["F1@2cm"], sum(f1) / 2)
        self.assertAlmostEqual(clouds["gp after, ours, ±"]["F1@2cm"], abs(f1[0] - f1[1]) / 2)
        self.assertEqual(clouds["gp after, paper"]["Acc@2cm"], 85.32)
        self.assertIn(f"{sum(f1) / 2:.2f}", text)
        self.assertIn("ETH3D: 16 refinements of each scene", text)
        # Each stage of the published method does something.
        fused = tables["Fused pixels right to 10 cm (the paper's with the prior gp)"]
        for name in paper_tables.ABLATION:
            self.assertNotEqual(fused[f"{name}, ours"], fused["TSAR-MVS, ours"], name)
            self.assertGreater(fused[f"{name}, ours of fused"]["mean"], fused[f"{name}, ours"]["mean"])
        self.assertIn("12 of 13 scenes are missing", text)
        self.assertIn("Strecha, fountain-P5", text)
        # The truth went through the distorted photos and back.
        name = self.sample.names[0]
        found = read_map(output / "gp" / "pipes" / "ground_truth" / "dslr_images_undistorted" /
                         f"{name}.bin")[0]
        true = read_map(self.sample.folder / "ground_truth" / "depth" / f"{name}.bin")[0]
        rows, columns = (((np.arange(n) + 0.5) * m / n).astype(int)
                         for n, m in zip(found.shape, true.shape))
        true = true[np.ix_(rows, columns)]
        both = (found > 0) & (true > 0)
        self.assertGreater(both.mean(), 0.85)
        self.assertGreater((abs(found - true) < 0.01 * true)[both].mean(), 0.95)

        again = self.run_well(*command)
        self.assertNotIn("variant_TSAR-MVS\n", again)  # All was done before.
        tables = lambda printed: [line for line in printed.splitlines() if line[:1] != "["]
        self.assertEqual(tables(again), tables(text))

    def test_mistakes(self):
        output = ("--output_path", self.folder / "nothing")
        self.fails(*output, text="give --eth3d or --strecha")
        self.fails(*output, "--strecha", self.folder / "strecha", text="needs --ground_truth")
        self.fails(*output, "--strecha", self.folder / "strecha", "--ground_truth",
                   self.folder / "eth3d", text="has neither fountain-P5.ply nor")
        plain = self.folder / "plain" / "pipes"
        make_eth3d(self.sample, plain)
        self.fails(*output, "--eth3d", plain, text="ground_truth_depth: not found")
        self.assertFalse((self.folder / "nothing").exists())


if __name__ == "__main__":
    unittest.main()
