# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Sparse models for images whose poses are given, by COLMAP's features and
triangulation."""
import shutil

from database import read_image_ids, set_cameras
from files import DatasetError, write_text
from model import Image, largest_pose_change, read_images, write_model

DATABASE = "database.db"
# COLMAP keeps given poses to the last digits; more is a pose that it adjusted.
MAX_POSE_CHANGE = 1e-9


def match(scene, programs, image_folder, names, matcher="exhaustive", cameras=None,
          camera_options=("--ImageReader.single_camera_per_image", 1)):
    """The step that finds and matches features. cameras: those that are known, by
    image name."""
    database = scene.folder / DATABASE
    image_list = scene.folder / "images.txt"

    def action(step):
        write_text(image_list, "".join(f"{name}\n" for name in names))
        step.run(programs.colmap, "feature_extractor", "--database_path", database,
                 "--image_path", image_folder, "--image_list_path", image_list,
                 *camera_options, *programs.gpu_option(
                     "feature_extractor", "SiftExtraction.use_gpu", "FeatureExtraction.use_gpu"))
        if cameras:
            ids = read_image_ids(database)
            set_cameras(database, {ids[name][1]: cameras[name] for name in names if name in ids})
        command = f"{matcher}_matcher"
        step.run(programs.colmap, command, "--database_path", database, *programs.gpu_option(
            command, "SiftMatching.use_gpu", "FeatureMatching.use_gpu"))

    known = {n: [c.model, c.width, c.height, *c.params] for n, c in (cameras or {}).items()}
    scene.step("matches", action, outputs=[DATABASE], resumes=True,
               inputs=[image_folder / name for name in names],
               options={"names": names, "cameras": known, "options": list(camera_options),
                        "matcher": matcher, "colmap": programs.versions["colmap"]})


def to_text(step, programs, model_folder):
    """Writes a model's text form into its folder, beside the binary one."""
    step.run(programs.colmap, "model_converter", "--input_path", model_folder,
             "--output_path", model_folder, "--output_type", "TXT")


def triangulate(step, programs, image_folder, cameras, poses, output):
    """Makes the folder output: the model with these poses, by image name, held
    fixed, and points triangulated from the scene's database. cameras: by image
    name, those of images that share one in the database being equal."""
    database = step.scene.folder / DATABASE
    ids = read_image_ids(database)
    missing = sorted(set(poses) - set(ids))
    if missing:
        raise DatasetError(f"{image_folder / missing[0]}: COLMAP found no features in it; "
                           f"see {step.scene.folder}/logs/matches.log")
    images = [Image(*ids[name], name, pose) for name, pose in poses.items()]
    given = output.with_name(output.name + ".given")
    for folder in (given, output):
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
    write_model(given, {ids[name][1]: cameras[name] for name in poses}, images)
    step.run(programs.colmap, "point_triangulator", "--database_path", database,
             "--image_path", image_folder, "--input_path", given, "--output_path", output)
    to_text(step, programs, output)
    shutil.rmtree(given)
    check(step, output, images)


def check(step, model_folder, images):
    """That the poses are still the given ones, and that there are points."""
    change = largest_pose_change(images, read_images(model_folder / "images.txt"))
    if change > MAX_POSE_CHANGE:
        raise DatasetError(f"{model_folder}: COLMAP moved the given poses, by {change:.1g}; "
                           "use another version of it")
    text = (model_folder / "points3D.txt").read_text(encoding="utf-8")
    points = sum(1 for line in text.splitlines() if line and line[0] != "#")
    if points < len(images):
        raise DatasetError(f"{step.scene.name}: {points} points could be triangulated; do "
                           "poses and images belong together?")
    step.scene.say(f"{points} points from {len(images)} images")
