# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""What can be done with a Workspace is what the commands do.

Needs NumPy: this Python's own, or that of a virtual environment that is kept in
the build folder. Skipped if it is not available."""
import pathlib

import colmap_tsar
from sample_testing import digests, results
from support import QUICK, SampleTest, run_program, words_of
from virtual_environment import optional, run_tests

np = optional("numpy")

QUICK_STEREO = {"num_sources": 3, "num_levels": 2, "num_iterations": 2, "max_image_size": 160,
                "num_geometric_passes": 1}


class Enough(Exception):
    pass


def stop_at_the_first(name, done, total):
    if done == 1:
        raise Enough(name)


class WorkspaceRunsTest(SampleTest):
    def setUp(self):
        super().setUp()
        self.ws = colmap_tsar.Workspace(self.workspace)

    def test_refine_is_the_function(self):
        other = self.new_workspace("by_function")
        colmap_tsar.refine(other, **QUICK, device="cpu", progress=False)
        summary = self.ws.refine(device="cpu", progress=False, **QUICK)
        self.assertEqual(summary.num_refined, self.num_images)
        self.assertEqual(results(self.workspace), results(other))
        self.assertEqual(self.ws.restore().num_restored, self.num_images)
        self.assertEqual(results(self.workspace), results(self.sample))
        paper = {"preset": "paper", "segment": False, "num_iterations": 1}
        self.ws.refine(**paper, device="cpu", progress=False)
        again = colmap_tsar.refine(self.workspace, **paper, device="cpu", progress=False)
        self.assertEqual(again.num_skipped, self.num_images)

    def test_wrong_options_are_named(self):
        before = digests(self.workspace)
        for method, keywords, error, text in (
            (self.ws.refine, {"num_thread": 1}, TypeError, "did you mean num_threads"),
            (self.ws.stereo, {"num_source": 1}, TypeError, "did you mean num_sources"),
            (self.ws.stereo, {"num_sources": 1.5}, TypeError, "^num_sources: .* integer"),
            (self.ws.stereo, {"depth_min": "1"}, TypeError, "^depth_min: give a number"),
            (self.ws.stereo, {"depth_min": 1.0}, ValueError, "^depth_min and depth_max"),
            (self.ws.stereo, {"overwrite": 1}, TypeError, "^overwrite: .*True or False"),
            (self.ws.stereo, {"device": "gpu"}, ValueError, "^device: 'gpu'.*cuda"),
            (self.ws.stereo, {"workspace_path": "x"}, TypeError, "no option 'workspace"),
            (self.ws.stereo, {}, colmap_tsar.UnsupportedError, "give overwrite=True"),
            (self.ws.fuse, {"output_path": "a", "preset": "x"}, ValueError, "^preset: 'x"),
            (self.ws.fuse, {"output_path": "a", "min_num_views": 0}, ValueError, "^min_num_views: '0'"),
            (self.ws.fuse, {"output_path": self.workspace / "images/a.ply"}, colmap_tsar.Error, "images"),
            (self.ws.report, {}, colmap_tsar.NotFoundError, "run tsar_refine"),
            (self.ws.report, {"max_image_size": 1}, ValueError, "^max_image_size"),
        ):
            with self.subTest(keywords=keywords):
                with self.assertRaisesRegex(error, text) as caught:
                    method(progress=False, **keywords)
                self.assertNotIn("--", str(caught.exception))
        self.assertEqual(digests(self.workspace), before)

    def test_stereo_is_the_command(self):
        other = self.new_workspace("by_program")
        run_program("tsar_stereo", "--workspace_path", other, "--overwrite", 1,
                    *words_of({"device": "cpu", **QUICK_STEREO}, "TsarStereo."))
        steps = []
        run = {"overwrite": True, "device": "cpu", **QUICK_STEREO}
        summary = self.ws.stereo(**run, progress=lambda *step: steps.append(step))
        self.assertEqual(results(self.workspace), results(other))
        self.assertNotEqual(results(self.workspace), results(self.sample))
        self.assertEqual(summary.num_images, self.num_images)
        self.assertEqual(summary.input_type, "geometric")
        self.assertIn(f"{self.num_images} images on", str(summary))
        self.assertEqual(self.ws["v000.jpg"].depth.shape, (120, 160))
        self.assertEqual(self.ws["v000.jpg"].camera.width, 160)
        passes = list(dict.fromkeys(name for name, _, _ in steps))
        self.assertEqual(steps, [(name, i, 3) for name in passes for i in range(self.num_images + 1)])
        self.assertRegex(passes[0], "^Pass 1 of [0-9]$")
        self.assertEqual(self.ws.stereo(**run, progress=False).num_skipped, 3)

    def test_fuse_is_the_command(self):
        output = self.folder / "by_method" / "fused.ply"
        other = self.folder / "by_program" / "fused.ply"
        output.parent.mkdir()
        other.parent.mkdir()
        steps = []
        run = {"device": "cpu", "preset": "paper", "point_spacing": 4}
        summary = self.ws.fuse(output, **run, progress=lambda *step: steps.append(step))
        run_program("tsar_fuse", "--workspace_path", self.workspace, "--output_path", other,
                    *words_of(run, "TsarFuse."))
        self.assertEqual(digests(output.parent), digests(other.parent))
        self.assertEqual(set(digests(output.parent)), {"fused.ply", "fused.ply.vis"})
        self.assertEqual(summary.output_path, output)
        self.assertEqual((summary.num_images, summary.num_masks), (8, None))
        self.assertGreater(summary.num_points, 0)
        header = f"element vertex {summary.num_points}\n".encode()
        self.assertIn(header, output.read_bytes()[:1000])
        self.assertRegex(summary.device, "CPU")
        self.assertEqual([done for _, done, _ in steps], list(range(9)))
        with self.assertRaisesRegex(colmap_tsar.Error, "fused.ply.*overwrite=True"):
            self.ws.fuse(output, progress=False)
        with self.assertRaises(Enough):
            self.ws.fuse(self.folder / "stopped.ply", **run, progress=stop_at_the_first)

    def test_what_progress_raises_ends_the_work_and_is_raised(self):
        run = {"device": "cpu", "num_threads": 1}
        with self.assertRaisesRegex(Enough, "^Pass 1 of"):
            self.ws.stereo(overwrite=True, progress=stop_at_the_first, **run, **QUICK_STEREO)
        self.ws.stereo(overwrite=True, progress=False, **run, **QUICK_STEREO)
        with self.assertRaisesRegex(Enough, "^refine$"):
            self.ws.refine(progress=stop_at_the_first, **run, **QUICK)
        self.ws.refine(progress=False, **run, **QUICK)
        before = digests(self.workspace)
        with self.assertRaisesRegex(Enough, "^report$"):
            self.ws.report(progress=stop_at_the_first, num_threads=1)
        # Such short work may end before it stops: a page is whole or absent.
        after = digests(self.workspace)
        others = {name: of for name, of in after.items() if name[:7] != "report/"}
        self.assertEqual(others, before)
        report = self.workspace / "report"
        self.assertEqual((report / "index.html").exists(), report.exists())

    def test_import_makes_a_workspace(self):
        folder, output = self.folder / "sensor", self.folder / "imported"
        folder.mkdir()
        for name in self.ws:  # A plane in front of each camera.
            depth = np.full((36, 48), 3.0, np.float32)
            np.save(folder / pathlib.Path(name).with_suffix(".npy"), depth)
        for options, text in (
            ({"format": "best"}, "^format: 'best'"),
            ({"format": "acm", "normal_path": folder}, "^normal_path is for format depth"),
        ):
            with self.assertRaisesRegex(ValueError, text):
                self.ws.import_maps(folder, output_path=output, **options)
        steps = []
        run = {"depth_scale": 0.5, "check_scale": False}
        summary = self.ws.import_maps(folder, "depth", output,
                                      progress=lambda *step: steps.append(step), **run)
        self.assertEqual((summary.num_imported, summary.num_images), (8, 8))
        self.assertEqual(summary.output_path, output)
        self.assertEqual(summary.output_type, "geometric")
        self.assertIn("8 imported", str(summary))
        self.assertEqual(steps[0], ("Checking", 0, 8))
        self.assertEqual(steps[-1], ("Importing", 8, 8))
        depth = colmap_tsar.Workspace(output)["v001.jpg"].depth
        np.testing.assert_array_equal(depth, np.full((36, 48), 1.5, np.float32))
        self.assertEqual(digests(self.workspace), digests(self.sample))
        with self.assertRaisesRegex(colmap_tsar.UnsupportedError, "overwrite=True"):
            self.ws.import_maps(folder, "depth", output, progress=False, **run)

    def test_report(self):
        self.ws.refine(progress=False, device="cpu", **QUICK)
        summary = self.ws.report(report_path=self.folder / "page", progress=False)
        self.assertEqual(summary.page_path, self.folder / "page" / "index.html")
        self.assertTrue(summary.page_path.is_file())
        self.assertEqual(summary.num_images, self.num_images)
        chosen = colmap_tsar.Workspace(self.workspace, input_type="geometric")
        with self.assertRaisesRegex(colmap_tsar.Error, "page.*overwrite=True"):
            chosen.report(report_path=self.folder / "page", progress=False)


if __name__ == "__main__":
    run_tests(__file__, ["numpy"], np)
