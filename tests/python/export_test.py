# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Exports hold the maps of the workspace, in the formats of docs/export.md, and
are written as a whole or not at all.

Needs NumPy and OpenCV: this Python's own, or those of a virtual environment
that is kept in the build folder. Skipped if they are not available."""
import json
import os
import shutil
import subprocess
import sys
import unittest

import colmap_tsar
from sample_testing import digests
from support import new_folder, write_black_mask
from virtual_environment import optional, run_tests

os.environ["OPENCV_IO_ENABLE_OPENEXR"] = "1"
cv2, np = optional("cv2"), optional("numpy")

NAMES = ["a.png", "left/b.png", "c.png"]  # The last has no maps.
WIDTH, HEIGHT = 8, 6  # Of photos; maps have half the size.
FX, FY, CX, CY = 7.0, 6.5, 4.2, 2.9
KILLED = """
import os, sys
import colmap_tsar
CHANGES = {"open", "os.mkdir", "os.remove", "os.rename", "os.rmdir"}
left = int(sys.argv[3])
def count(event, args):
    global left
    if event in CHANGES and sys.argv[2] in str(args[0]):
        left -= 1
        if left == 0:
            os._exit(9)
workspace = colmap_tsar.Workspace(sys.argv[1])
sys.addaudithook(count)
workspace.export(sys.argv[2], "npy", overwrite=True, progress=False)
"""


def write_map(path, values):
    path.parent.mkdir(parents=True, exist_ok=True)
    pixels = values.reshape(3, 4, -1).transpose(2, 0, 1).astype("<f4")
    path.write_bytes(b"4&3&%d&" % len(pixels) + pixels.tobytes())


def depth_of(index):
    rows, columns = np.mgrid[:3, :4]
    depth = (2 + index + 0.25 * columns + 0.1 * rows).astype("f4")
    depth[1, 1] = 0
    return depth


def normals_of(index):
    normals = np.dstack([0.1 * depth_of(index), 0 * depth_of(index), -1 + 0 * depth_of(index)])
    normals /= np.linalg.norm(normals, axis=2, keepdims=True)
    return normals.astype("f4") * (depth_of(index) > 0)[..., None]


def make_workspace(root):
    sparse, stereo = root / "sparse", root / "stereo"
    sparse.mkdir(parents=True)
    stereo.mkdir()
    (sparse / "cameras.txt").write_text(f"1 PINHOLE {WIDTH} {HEIGHT} {FX} {FY} {CX} {CY}\n")
    lines = [f"{i + 1} 0.9 0.1 -0.3 0.2 0.{i} 1 2 1 {name}\n\n" for i, name in enumerate(NAMES)]
    (sparse / "images.txt").write_text("".join(lines))
    (sparse / "points3D.txt").write_text("")
    (stereo / "patch-match.cfg").write_text("".join(f"{name}\n__auto__, 20\n" for name in NAMES))
    (stereo / "fusion.cfg").write_text("".join(f"{name}\n" for name in NAMES))
    for i, name in enumerate(NAMES):
        photo = root / "images" / name
        photo.parent.mkdir(parents=True, exist_ok=True)
        cv2.imwrite(str(photo), np.full((HEIGHT, WIDTH, 3), 40 * i, "u1"))
    for i, name in enumerate(NAMES[:2]):
        write_map(stereo / f"depth_maps/{name}.geometric.bin", depth_of(i))
        write_map(stereo / f"normal_maps/{name}.geometric.bin", normals_of(i))
    for kind, values in (
        ("confidence", np.full((3, 4), 51, "u1")),
        ("provenance", np.full((3, 4), 4, "u1")),
        ("plane", np.arange(12, dtype="u2").reshape(3, 4)),
    ):
        (stereo / f"{kind}_maps").mkdir()
        cv2.imwrite(str(stereo / f"{kind}_maps/a.png.geometric.png"), values)


class ExportTest(unittest.TestCase):
    def setUp(self):
        self.folder = new_folder()
        self.addCleanup(shutil.rmtree, self.folder)
        self.root, self.site = self.folder / "dense", self.folder / "site"
        self.output = self.site / "exported"
        make_workspace(self.root)
        self.ws = colmap_tsar.Workspace(self.root)

    def export(self, format, **options):
        before = digests(self.root)
        summary = self.ws.export(self.output, format, progress=False, **options)
        changed = {name for name, _ in digests(self.root).items() ^ before.items()}
        self.assertLessEqual(changed, {"stereo/tsar/lock"})
        self.manifest = self.json("manifest.json")
        return summary

    def json(self, name):
        return json.loads((self.output / name).read_text())

    def read(self, image, kind):
        """An exported map of an image, by what the manifest says."""
        path = self.output / self.manifest["images"][image]["files"][kind]
        if path.suffix == ".npy":
            stored = np.load(path)
        else:
            stored = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
            stored = stored[..., ::-1] if stored.ndim == 3 else stored
        about = self.manifest["maps"][kind]
        self.assertEqual(str(stored.dtype), about["stored"].split(",")[0])
        return stored * about.get("scale", 1) + about.get("offset", 0)

    def mask_right_half(self):
        masks = self.folder / "masks"
        masks.mkdir(exist_ok=True)
        mask = np.full((HEIGHT, WIDTH), 255, "u1")
        mask[:, WIDTH // 2 :] = 0
        cv2.imwrite(str(masks / "a.png.png"), mask)
        return masks

    def test_maps_hold_those_of_the_workspace(self):
        for format, tolerance in (("npy", 0), ("exr", 0), ("png16", 0.0005)):
            with self.subTest(format=format):
                if format == "exr" and not cv2.haveImageWriter("a.exr"):
                    self.skipTest("needs an OpenCV that writes OpenEXR")
                summary = self.export(format, overwrite=True)
                self.assertEqual(summary.num_images, 2)
                self.assertEqual((summary.num_pixels, summary.num_depths), (24, 22))
                self.assertEqual(self.manifest["images_left_out"], ["c.png"])
                for i, entry in enumerate(self.manifest["images"]):
                    self.assertEqual(entry["name"], NAMES[i])
                    self.assertEqual(entry["refined"], i == 0)
                    self.assertEqual(set(entry["files"]) - {"depth", "normals"},
                                     {"confidence", "provenance", "planes"} if i == 0 else set())
                    np.testing.assert_allclose(self.read(i, "depth"), depth_of(i), 0, 1.001 * tolerance)
                    np.testing.assert_allclose(self.read(i, "normals"), normals_of(i), 0, 2 * tolerance)
                    self.assertEqual(entry["camera"]["cx"], CX / 2)
                    pose = np.array(entry["world_to_camera"])
                    np.testing.assert_allclose(pose[:3], self.ws[NAMES[i]].cam_from_world)
                    np.testing.assert_allclose(pose @ entry["camera_to_world"], np.eye(4), atol=1e-12)
                self.assertAlmostEqual(self.read(0, "confidence").max(), 0.2, 6)
                self.assertTrue((self.read(0, "provenance") == 4).all())
                self.assertEqual(self.read(0, "planes").ravel().tolist(), list(range(12)))

    def test_16_bits_leave_out_what_they_do_not_hold(self):
        self.export("png16", depth_scale=4e-5)
        expected = np.where(depth_of(0) < 65535.5 * 4e-5, depth_of(0), 0)
        np.testing.assert_allclose(self.read(0, "depth"), expected, 0, 2.1e-5)
        num_left_out = np.count_nonzero(depth_of(0)) - np.count_nonzero(expected)
        self.assertEqual(self.manifest["images"][0]["num_out_of_range"], num_left_out)

    def test_masked_pixels_have_no_depth(self):
        for format in ("nerfstudio", "3dgs", "npy"):
            summary = self.export(format, overwrite=True, mask_path=self.mask_right_half())
            self.assertEqual((summary.num_masks, summary.num_depths), (1, 5 + 11))
        for kind in ("depth", "normals", "confidence", "provenance", "planes"):
            self.assertFalse(self.read(0, kind)[:, 2:].any(), kind)

    def test_nerfstudio_sees_each_depth_at_its_pixel(self):
        cloud = self.folder / "fused.ply"
        cloud.write_bytes(b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n")
        masks = self.mask_right_half()
        # Masks of the size that maps would have.
        cv2.imwrite(str(masks / "c.png.png"), np.full((3, 4), 255, "u1"))
        self.export("nerfstudio", mask_path=masks, cloud_path=cloud)
        transforms = self.json("transforms.json")
        points = self.output / transforms["ply_file_path"]
        self.assertEqual(points.read_bytes(), cloud.read_bytes())
        self.assertEqual(transforms["applied_transform"], np.eye(3, 4).tolist())
        self.assertEqual(len(transforms["frames"]), 3)
        for i, frame in enumerate(transforms["frames"]):
            photo = self.output / frame["file_path"]
            self.assertEqual(photo.read_bytes(), (self.root / "images" / NAMES[i]).read_bytes())
            depth = np.load(self.output / frame["depth_file_path"]) * 0.001
            depth = cv2.resize(depth, (frame["w"], frame["h"]), interpolation=cv2.INTER_NEAREST)
            mask = cv2.imread(str(self.output / frame["mask_path"]), cv2.IMREAD_UNCHANGED)
            np.testing.assert_array_equal(mask, [[255] * 4 + [255 if i else 0] * 4] * HEIGHT)
            expected = np.zeros((HEIGHT, WIDTH)) if i == 2 else np.kron(depth_of(i), np.ones((2, 2)))
            np.testing.assert_allclose(depth, np.where(mask > 0, expected, 0), 1e-5)
            normals = self.read(i, "normals")
            expected = 0 * normals if i == 2 else np.kron(normals_of(i), np.ones((2, 2, 1)))
            np.testing.assert_allclose(normals, np.where(mask[..., None] > 0, expected, 0), 0, 0.5 / 127)
            # OpenGL's camera, whose rays go through the centers of the photo's pixels.
            v, u = np.nonzero(depth)
            z = depth[v, u]
            x, y = (u + 0.5 - frame["cx"]) / frame["fl_x"], (v + 0.5 - frame["cy"]) / frame["fl_y"]
            world = np.array(frame["transform_matrix"]) @ [z * x, -z * y, -z, 1 + 0 * z]
            seen = self.ws[NAMES[i]].cam_from_world @ world
            np.testing.assert_allclose(FX * seen[0] / seen[2] + CX, u + 0.5, 1e-9)
            np.testing.assert_allclose(FY * seen[1] / seen[2] + CY, v + 0.5, 1e-9)

    def test_gaussian_splatting_gets_inverse_depth(self):
        self.export("3dgs")
        params = self.json("sparse/0/depth_params.json")
        self.assertEqual(list(params), ["a", "left/b", "c"])
        self.assertEqual(digests(self.output / "sparse/0").items() - digests(self.root / "sparse").items(),
                         {("depth_params.json", digests(self.output / "sparse/0")["depth_params.json"])})
        for i, (stem, param) in enumerate(params.items()):
            self.assertTrue((self.output / f"images/{NAMES[i]}").is_file())
            depth = depth_of(i) if i < 2 else np.zeros((HEIGHT, WIDTH), "f4")
            levels = cv2.imread(str(self.output / f"depths/{stem}.png"), cv2.IMREAD_UNCHANGED)
            mask = cv2.imread(str(self.output / f"depth_masks/{stem}.png"), cv2.IMREAD_UNCHANGED)
            np.testing.assert_array_equal(mask, np.where(depth > 0, 255, 0))
            inverse = levels / 65536 * param["scale"] + param["offset"]
            expected = np.divide(1, depth, out=np.zeros_like(depth), where=depth > 0)
            np.testing.assert_allclose(inverse, expected, 0, param["scale"] / 65536)
            self.assertEqual(param["scale"] > 0, i < 2)

    def test_what_cannot_be_exported_is_one_line(self):
        empty, mine, link = (self.folder / name for name in ("empty.ply", "mine", "link"))
        empty.write_bytes(b"ply\nformat ascii 1.0\nelement vertex 0\nend_header\n")
        mine.mkdir()
        (mine / "notes.txt").write_text("mine")
        link.symlink_to(mine)
        write_black_mask(self.folder / "wrong" / "a.png.png", 5, 5)
        for format, options, text in (
            ("ply", {}, "^format: 'ply' is not known; give npy"),
            ("npy", {"depth_scale": 0.1}, "^depth_scale is for the format png16 alone"),
            ("npy", {"cloud_path": empty}, "^cloud_path is for the format nerfstudio alone"),
            ("nerfstudio", {"cloud_path": empty}, "empty.ply: is no PLY file with points"),
            ("npy", {"mask_path": self.folder / "wrong"}, "a.png.png"),
            ("npy", {"output_path": self.root / "images/new"}, "in the folder images"),
            ("npy", {"output_path": mine, "overwrite": True}, "mine: is there already and is no export"),
            ("npy", {"output_path": link}, "link: is a link"),
        ):
            with self.subTest(text=text), self.assertRaisesRegex(colmap_tsar.Error, text) as caught:
                self.ws.export(**{"output_path": self.output, **options}, format=format, progress=False)
            self.assertNotIn("\n", str(caught.exception))
        self.assertFalse(self.site.exists() and os.listdir(self.site))
        self.assertEqual((mine / "notes.txt").read_text(), "mine")

    def test_replaces_an_export_alone_and_only_when_asked(self):
        self.export("npy")
        with self.assertRaisesRegex(colmap_tsar.UnsupportedError, "give overwrite=True"):
            self.export("png16")
        trained = self.output / "depth" / "trained.bin"
        trained.write_text("mine")
        with self.assertRaisesRegex(colmap_tsar.UnsupportedError, "trained.bin: is not of the export"):
            self.export("png16", overwrite=True)
        trained.unlink()
        self.export("png16", overwrite=True)
        self.assertFalse((self.output / "depth/a.png.npy").exists())

    def test_names_that_the_format_cannot_tell_apart_are_refused(self):
        for old, new, text in (("c.png", "a.jpg", "a.png and a.jpg"), ("a.jpg", "c", "c has no ext")):
            for name in ("sparse/images.txt", "stereo/patch-match.cfg", "stereo/fusion.cfg"):
                path = self.root / name
                path.write_text(path.read_text().replace(old, new))
            shutil.move(self.root / "images" / old, self.root / "images" / new)
            self.ws = colmap_tsar.Workspace(self.root)
            with self.assertRaisesRegex(colmap_tsar.UnsupportedError, text):
                self.ws.export(self.output, "3dgs", progress=False)

    def test_whenever_it_is_killed_a_whole_export_stays(self):
        self.export("png16")
        old = digests(self.output)
        shutil.copytree(self.site, self.folder / "kept")
        self.export("npy", overwrite=True)
        new = digests(self.output)
        for kill_at in range(1, 200):
            shutil.rmtree(self.site)
            shutil.copytree(self.folder / "kept", self.site)
            code = subprocess.run([sys.executable, "-c", KILLED, self.root, self.output, str(kill_at)]).returncode
            left = {path.name: digests(path) for path in self.site.iterdir()}
            self.assertTrue(left.get("exported") in (old, new) or old in left.values(), kill_at)
            self.export("npy", overwrite=True)
            self.assertEqual(digests(self.output), new)
            self.assertEqual(os.listdir(self.site), ["exported"])
            if code == 0:
                break
        self.assertGreater(kill_at, 20)

    def test_the_command_tells_what_it_wrote(self):
        command = [sys.executable, "-m", "colmap_tsar", "export", "--format", "3dgs",
                   "--workspace_path", self.root, "--output_path", self.output]
        done = subprocess.run(command, capture_output=True, text=True)
        self.assertIn(f"Exported 3 images to {self.output}\n  with depth: 2 images, ", done.stdout)
        self.assertIn(f"Train with: python train.py -s {self.output} -d depths\n", done.stdout)
        again = subprocess.run(command, capture_output=True, text=True)
        self.assertRegex(again.stderr, "c.png.geometric.bin: there is no such map, so that its image "
                         "is left out.*\nERROR: .*give overwrite=True.*\n$")


if __name__ == "__main__":
    run_tests(__file__, ["opencv-python-headless", "numpy"], cv2, np)
