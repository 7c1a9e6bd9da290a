#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Stands in for COLMAP and colmap_tsar in tests of reconstruct.sh: writes at
once what their commands leave behind, and adds each call to calls.txt in the
folder that STAND_IN_FOLDER names. Files there change its behavior:

  fail       a command that fails, after it has done its work
  models     the number of images of each model of the mapper
  cuda       COLMAP is built with CUDA
  no_cgal    COLMAP is built without CGAL
  old        COLMAP has no mesh_texturer
  tree       vocab_tree_matcher brings its own tree
  nothing    clouds have no points
  half       clouds are cut off
  no_texture mesh_texturer writes nothing
"""
import os
import pathlib
import shutil
import sqlite3
import sys
import time

FOLDER = pathlib.Path(os.environ["STAND_IN_FOLDER"])
BEFORE, AFTER, TRIANGLES = 40, 50, 7
OPTIONS = {
    "feature_extractor": "ImageReader.single_camera ImageReader.single_camera_per_folder "
                         "ImageReader.camera_model SiftExtraction.use_gpu",
    "exhaustive_matcher": "SiftMatching.use_gpu SiftMatching.max_ratio",
    "sequential_matcher": "SiftMatching.use_gpu SequentialMatching.overlap",
    "vocab_tree_matcher": "SiftMatching.use_gpu VocabTreeMatching.vocab_tree_path",
    "mapper": "Mapper.min_num_matches",
    "stereo_fusion": "StereoFusion.min_num_pixels StereoFusion.mask_path",
    "patch_match_stereo": "PatchMatchStereo.max_image_size",
    "poisson_mesher": "PoissonMeshing.trim",
    "delaunay_mesher": "DelaunayMeshing.quality_regularization",
    "mesh_texturer": "MeshTextureMapping.min_cos_normal_angle",
    "tsar_stereo": "TsarStereo.num_levels",
    "tsar_refine": "TsarRefine.scene_planes",
    "tsar_fuse": "TsarFuse.max_normal_error TsarFuse.min_num_views",
}


def told(name):
    path = FOLDER / name
    return path.read_text() if path.exists() else ""


def print_help(command):
    # As in COLMAP 3.9 and later.
    print(f"I2026 {time.time_ns()} {os.getpid()} option_manager.cc:1] COLMAP 3.9 (stand-in)")
    if command == "delaunay_mesher" and told("no_cgal"):
        print("ERROR: Delaunay meshing requires CGAL, which is not available on your system.")
        return
    if command == "mesh_texturer" and told("old"):
        print("ERROR: Command 'mesh_texturer' not recognized.")
        return
    options = OPTIONS.get(command, "")
    if command == "patch_match_stereo" and not told("cuda"):
        options = ""
    for option in options.split():
        default = "(=tree.bin)" if "tree_path" in option and told("tree") else ""
        print(f"  --{option} arg {default}")


def write_ply(path, vertices, faces=0):
    header = (f"ply\nformat binary_little_endian 1.0\nelement vertex {vertices}\nproperty float x\n"
              f"property float y\nproperty float z\nelement face {faces}\n"
              "property list uchar int vertex_indices\nend_header\n")
    pathlib.Path(path).write_bytes(header.encode() + bytes(12 * vertices + 13 * faces))


def feature_extractor(given):
    with sqlite3.connect(given["database_path"]) as database:
        for table in ("matches", "two_view_geometries"):
            database.execute(f"CREATE TABLE IF NOT EXISTS {table} (pair_id INTEGER)")


def matcher(given):
    with sqlite3.connect(given["database_path"]) as database:
        (left,) = database.execute("SELECT COUNT(*) FROM two_view_geometries").fetchone()
        database.execute("INSERT INTO two_view_geometries VALUES (1)")
    with open(FOLDER / "calls.txt", "a", encoding="utf-8") as calls:
        calls.write(f"  {left} pairs were matched\n")


def mapper(given):
    database = pathlib.Path(given["database_path"])
    names = (database.parent / "images.txt").read_text().splitlines()
    for number, size in enumerate((told("models") or str(len(names))).split()):
        model = pathlib.Path(given["output_path"]) / str(number)
        model.mkdir()
        (model / "images.txt").write_text("".join(
            f"{i} 1 0 0 0 {i} 0 0 1 {name}\n\n" for i, name in enumerate(names[:int(size)], 1)))
        (model / "cameras.txt").write_text("1 PINHOLE 16 12 9 9 8 6\n")
        (model / "points3D.txt").write_text("1 0 0 0\n" * (20 + len(names)))


def image_undistorter(given):
    output = pathlib.Path(given["output_path"])
    names = [line.split(maxsplit=9)[9] for line in
             (pathlib.Path(given["input_path"]) / "images.txt").read_text().splitlines()[::2]]
    for name in names:
        target = output / "images" / name
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(pathlib.Path(given["image_path"]) / name, target)
    (output / "stereo").mkdir()
    (output / "stereo" / "fusion.cfg").write_text("".join(f"{name}\n" for name in names))


def make_maps(given):
    stereo = pathlib.Path(given["workspace_path"]) / "stereo"
    for name in (stereo / "fusion.cfg").read_text().splitlines():
        for kind in ("depth_maps", "normal_maps"):
            (stereo / kind / f"{name}.geometric.bin").write_bytes(b"1&1&1&0000")


def tsar_refine(given):
    shutil.copytree(given["workspace_path"], given["output_path"], dirs_exist_ok=True)
    (pathlib.Path(given["output_path"]) / "is_refined").touch()


def stereo_fusion(given):
    is_refined = (pathlib.Path(given["workspace_path"]) / "is_refined").exists()
    cloud = pathlib.Path(given["output_path"])
    write_ply(cloud, 0 if told("nothing") else AFTER if is_refined else BEFORE)
    if told("half"):
        cloud.write_bytes(cloud.read_bytes()[:-1])
    pathlib.Path(f"{cloud}.vis").write_text("vis")


def tsar_fuse(given):
    for ending in ("", ".vis"):
        if os.path.exists(given["output_path"] + ending):
            sys.exit("is there already")
    stereo_fusion(given)


def poisson_mesher(given):
    write_ply(given["output_path"], 9, 0 if given["PoissonMeshing.trim"] == "9" else TRIANGLES)


def delaunay_mesher(given):
    workspace = pathlib.Path(given["input_path"])
    assert (workspace / "fused.ply.vis").read_text() == "vis"
    write_ply(given["output_path"], 9, len((workspace / "fused.ply").read_bytes()))


def mesh_texturer(given):
    assert (pathlib.Path(given["workspace_path"]) / "is_refined").exists()
    output = pathlib.Path(given["output_path"])
    output.mkdir()
    if told("no_texture"):
        return
    shutil.copyfile(given["input_path"], output / "mesh.ply")
    (output / "texture.png").write_text("texture")


def make_folder(path, name):
    pathlib.Path(path).mkdir(exist_ok=True)
    (pathlib.Path(path) / name).write_text(name)


COMMANDS = {
    "feature_extractor": feature_extractor, "exhaustive_matcher": matcher,
    "sequential_matcher": matcher, "vocab_tree_matcher": matcher, "mapper": mapper,
    "model_converter": lambda given: None, "image_undistorter": image_undistorter,
    "patch_match_stereo": make_maps, "tsar_stereo": make_maps, "tsar_refine": tsar_refine,
    "stereo_fusion": stereo_fusion, "tsar_fuse": tsar_fuse,
    "poisson_mesher": poisson_mesher, "delaunay_mesher": delaunay_mesher,
    "mesh_texturer": mesh_texturer,
    "tsar_report": lambda given: make_folder(given["report_path"], "index.html"),
    "export": lambda given: make_folder(given["output_path"], given["format"]),
}


def main():
    # Called as a Python interpreter.
    if sys.argv[1] == "-c":
        sys.exit("cv2" in sys.argv[2] and bool(told("no_cv2")))
    if sys.argv[1:3] == ["-m", "colmap_tsar"]:
        del sys.argv[1:3]
    command, *words = sys.argv[1:]
    if command == "--version":
        print("colmap_tsar (stand-in)")
        return
    if words in (["-h"], ["--help_all"]):
        print_help(command)
        return
    with open(FOLDER / "calls.txt", "a", encoding="utf-8") as calls:
        calls.write(" ".join(sys.argv[1:]) + "\n")
    words = [part for word in words for part in word.split("=", 1)]
    COMMANDS[command](dict(zip((word.lstrip("-") for word in words[::2]), words[1::2])))
    if told("fail") == command:
        print("cannot go on")
        sys.exit(1)


main()
