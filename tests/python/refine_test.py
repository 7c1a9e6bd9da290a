# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""refine() and restore() on the sample scene."""
import array
import contextlib
import io
import json
import os
import threading
import time
import unittest

import colmap_tsar
from sample_testing import digests, results
from support import HEIGHT, PLANES, QUICK, WIDTH, SampleTest, run_program, write_black_mask


def refine(workspace, **options):
    options.setdefault("progress", False)
    return colmap_tsar.refine(workspace, device="cpu", **options)


def manifest_of(workspace):
    return json.loads((workspace / "stereo/tsar/manifest.json").read_text())


class RefineTest(SampleTest):
    def test_gives_the_same_bytes_as_the_program(self):
        for preset in ("default", "paper"):
            with self.subTest(preset=preset):
                other = self.new_workspace("by_program_" + preset)
                run_program("tsar_refine", "--workspace_path", other, "--TsarRefine.device", "cpu",
                            "--TsarRefine.preset", preset)
                summary = refine(self.workspace, preset=preset)
                self.assertEqual(summary.num_refined, self.num_images)
                self.assertNotEqual(results(self.workspace), results(self.sample))
                self.assertEqual(results(self.workspace), results(other))
                manifest, expected = manifest_of(self.workspace), manifest_of(other)
                self.assertEqual(manifest["options"], expected["options"])
                self.assertEqual(summary.counts, expected["counts"])

    def test_summary_skipping_and_restore(self):
        before = digests(self.workspace)
        summary = refine(str(self.workspace), **QUICK)
        self.assertEqual(summary.workspace_path, self.workspace)
        self.assertEqual(summary.input_type, "geometric")
        self.assertIn("CPU", summary.device)
        self.assertEqual(summary.num_images, self.num_images)
        self.assertEqual(summary.num_refined, self.num_images)
        self.assertEqual((summary.num_skipped, summary.kept), (0, {}))
        self.assertEqual(summary.counts["pixels"], self.num_images * WIDTH * HEIGHT)
        self.assertGreater(summary.seconds["matching"], 0.0)
        self.assertGreater(summary.wall_seconds, 0.0)
        self.assertIn(f"{self.num_images} images: {self.num_images} ref", str(summary))
        self.assertEqual(summary.todict()["counts"], summary.counts)

        again = refine(self.workspace, **QUICK)
        self.assertEqual((again.num_refined, again.num_skipped), (0, self.num_images))

        self.assertEqual(
            colmap_tsar.restore(self.workspace).todict(),
            {"num_restored": self.num_images, "kept": [], "superseded": [], "lost": []},
        )
        self.assertEqual(digests(self.workspace), before)

    def test_images_without_maps_are_kept_with_the_reason(self):
        for kind in ("depth_maps", "normal_maps"):
            for path in (self.workspace / "stereo" / kind).glob("v001.jpg.*"):
                path.unlink()
        summary = refine(self.workspace, **QUICK)
        self.assertEqual(list(summary.kept), ["v001.jpg"])
        self.assertRegex(summary.kept["v001.jpg"], "map")
        self.assertEqual(summary.num_refined, self.num_images - 1)
        self.assertEqual(summary.num_sources_without_maps, self.num_images - 1)

    def test_masks(self):
        masks = self.workspace / "masks"
        write_black_mask(masks / "v000.jpg.png", 640, 480)
        summary = refine(self.workspace, **QUICK, mask_path=masks)
        self.assertEqual(summary.num_masks, 1)
        self.assertIn("masks for 1 of 3 images", str(summary))
        with open(self.workspace / "stereo/depth_maps/v000.jpg.geometric.bin", "rb") as file:
            self.assertEqual(set(file.read().split(b"&", 3)[3]), {0})
        self.assertIsNone(refine(self.workspace, **QUICK).num_masks)
        with self.assertRaises(colmap_tsar.NotFoundError):
            refine(self.workspace, **QUICK, mask_path=self.workspace / "sparse")

    def test_arrays_as_depth_priors(self):
        priors = self.workspace / "priors"
        priors.mkdir()
        depth = array.array("f", [1.0 + i % 64 for i in range(64 * 48)])
        view = memoryview(depth).cast("B").cast("f", (48, 64))
        normals = memoryview(bytes(48 * 3)).cast("f", (3, 4, 3))
        (priors / "v000.pfm").write_bytes(b"Pf\n64 48\n-1\n" + depth.tobytes())
        asked = []

        def tell(name):
            asked.append(name)
            return {"v000.jpg": view, "v001.jpg": (None, normals)}.get(name)

        summary = refine(self.workspace, **PLANES, priors=tell, prior_type="inverse")
        self.assertEqual(summary.num_priors, 2)
        self.assertEqual(asked, list(colmap_tsar.Workspace(self.workspace)))
        again = {"v000.jpg": (view, None), "v001.jpg": (None, normals), "v002.jpg": None}
        ws = colmap_tsar.Workspace(self.workspace)
        summary = ws.refine(**PLANES, priors=again, prior_type="inverse", device="cpu", progress=False)
        self.assertEqual((summary.num_refined, summary.num_skipped), (0, self.num_images))
        depth[0] = 7.0
        summary = refine(self.workspace, **PLANES, priors={"v000.jpg": view})
        self.assertEqual((summary.num_priors, summary.num_refined), (1, self.num_images))
        for kind, text, options in (
            (ValueError, "no image 'v00.jpg'; did you mean v00", {"priors": {"v00.jpg": view}}),
            (ValueError, "of none of the images", {"priors": {"v000.jpg": None}}),
            (ValueError, r"of v000.jpg: .*\(3, 4, 3\)", {"priors": {"v000.jpg": normals}}),
            (ValueError, r"of v000.jpg: .*x 3", {"priors": {"v000.jpg": (None, view)}}),
            (TypeError, "a dict or a function", {"priors": 3}),
            (TypeError, "prior_path", {"priors": {"v000.jpg": view}, "prior_path": priors}),
            (TypeError, "num_thread", {"priors": tell, "num_thread": 1}),
        ):
            with self.subTest(text=text), self.assertRaisesRegex(kind, text):
                refine(self.workspace, **PLANES, **options)

    def test_second_workspace(self):
        before = digests(self.workspace)
        output = self.folder / "out"
        summary = refine(self.workspace, **QUICK, output_path=output, input_type="photometric")
        self.assertEqual(summary.workspace_path, output)
        self.assertEqual(summary.input_type, "photometric")
        self.assertTrue((output / "stereo/depth_maps/v000.jpg.photometric.bin").exists())
        self.assertEqual(digests(self.workspace), before)

    def test_shards_give_the_same_bytes(self):
        other = self.new_workspace("whole")
        refine(other, **QUICK)
        for pass_name in ("observe", "compose"):
            for shard in ("0/2", "1/2"):
                refine(self.workspace, **QUICK, shard=shard, pass_=pass_name)
        summary = refine(self.workspace, **QUICK, pass_="merge")
        self.assertEqual(summary.num_refined, self.num_images)
        self.assertEqual(results(self.workspace), results(other))

    def test_progress_goes_where_it_is_wanted(self):
        lines = []
        refine(self.workspace, **QUICK, progress=lines.append)
        self.assertTrue(lines[-1].startswith(f"[{self.num_images}/{self.num_images}]"))
        for progress, expected in ((True, True), (False, False)):
            colmap_tsar.restore(self.workspace)
            with contextlib.redirect_stderr(io.StringIO()) as stream:
                refine(self.workspace, **QUICK, progress=progress)
            self.assertEqual("[3/3]" in stream.getvalue(), expected)

    def test_other_python_threads_run_meanwhile(self):
        num_ticks = 0
        is_done = threading.Event()

        def tick():
            nonlocal num_ticks
            while not is_done.is_set():
                num_ticks += 1
                time.sleep(0.001)

        thread = threading.Thread(target=tick)
        thread.start()
        try:
            refine(self.workspace, **QUICK)
        finally:
            is_done.set()
            thread.join()
        # If the GIL were held, there would be at most one each time it wakes.
        self.assertGreater(num_ticks, 100)

    def expect_error(self, kinds, texts, function, workspace, **options):
        """One line with these texts, of all these classes; no file changed."""
        before = digests(self.folder)
        with self.assertRaises(kinds[0]) as caught:
            function(workspace, **options)
        for kind in (*kinds, colmap_tsar.Error, RuntimeError):
            self.assertIsInstance(caught.exception, kind)
        message = str(caught.exception)
        for text in texts:
            self.assertIn(text, message)
        for text in ("\n", "--", "TsarRefine"):
            self.assertNotIn(text, message)
        self.assertEqual(digests(self.folder), before)

    def test_errors_say_file_and_advice(self):
        dense, missing, restore = self.workspace, self.folder / "missing", colmap_tsar.restore
        not_found = (colmap_tsar.NotFoundError, FileNotFoundError)
        bad_option = (colmap_tsar.BadOptionError, ValueError)
        unsupported, corrupt = (colmap_tsar.UnsupportedError,), (colmap_tsar.CorruptError,)
        for kinds, texts, function, workspace, options in (
            (not_found, [str(missing), "check workspace_path"], refine, missing, {}),
            (not_found, [str(missing)], restore, missing, {}),
            (not_found, [str(dense), "nothing to restore"], restore, dense, {}),
            (bad_option, ["workspace_path is missing"], refine, "", {}),
            (bad_option, ["num_threads: "], refine, dense, {"num_threads": 0}),
            (bad_option, ["cache_size: "], refine, dense, {"cache_size": 0}),
            (bad_option, ["gpu_index: ", "-3"], refine, dense, {"gpu_index": "0,-3"}),
            (bad_option, ["input_type: 'normal' is not one of"], refine, dense, {"input_type": "normal"}),
            (bad_option, ["device: "], colmap_tsar.refine, dense, {"device": "gpu"}),
            (unsupported, ["choose another output_path"], refine, dense, {"output_path": dense}),
        ):
            with self.subTest(texts=texts):
                self.expect_error(kinds, texts, function, workspace, **options)
        path = dense / "stereo/depth_maps/v000.jpg.geometric.bin"
        path.write_bytes(path.read_bytes()[:-1])
        self.expect_error(corrupt, [str(path)], refine, dense)
        # Nothing is missed of an image that has no maps.
        for name in ("images/v000.jpg", "stereo/depth_maps/v000.jpg.geometric.bin",
                     "stereo/normal_maps/v000.jpg.geometric.bin", "images/v001.jpg"):
            (dense / name).unlink()
        self.expect_error(not_found, ["images/v001.jpg"], refine, dense)

    def test_names_need_not_be_utf8_and_are_printable(self):
        path = os.fsencode(self.folder) + b"/\xff\x1b[2J\xc2\x9b\xc3\xa9"
        shown = str(self.folder) + "/??[2J?\u00e9"
        with self.assertRaises(colmap_tsar.NotFoundError) as caught:
            refine(path)
        self.assertIn(shown, str(caught.exception))
        os.rename(self.workspace, path)
        summary = refine(path, **QUICK)
        self.assertEqual(os.fsencode(summary.workspace_path), path)
        self.assertIn(shown, str(summary))

    def test_gpus_that_are_not_there(self):
        with self.assertRaises(colmap_tsar.DeviceError) as caught:
            colmap_tsar.refine(self.workspace, device="cuda", gpu_index="4095")
        self.assertEqual(caught.exception.code, "device")

    def test_wrong_arguments_are_type_errors(self):
        with self.assertRaisesRegex(TypeError, "not int"):
            refine(3)


if __name__ == "__main__":
    unittest.main()
