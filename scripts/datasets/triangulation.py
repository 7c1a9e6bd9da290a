# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Sparse models for images whose poses are given, by COLMAP's triangulation."""
import shutil

from database import read_image_ids
from features import DATABASE
from files import DatasetError
from model import Image, largest_pose_change, read_images, write_model

# COLMAP keeps given poses to the last digits; more is a pose that it adjusted.
MAX_POSE_CHANGE = 1e-9


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
                           f"see {step.scene.folder}/logs/features.log")
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


def check(step, model_folder, images, advice="do poses and images belong together?"):
    """That the poses are still the given ones, and that there are points. advice:
    what to do if there are not."""
    change = largest_pose_change(images, read_images(model_folder / "images.txt"))
    if change > MAX_POSE_CHANGE:
        raise DatasetError(f"{model_folder}: COLMAP moved the given poses, by {change:.1g}; "
                           "use another version of it")
    text = (model_folder / "points3D.txt").read_text(encoding="utf-8")
    points = sum(1 for line in text.splitlines() if line and line[0] != "#")
    if points < len(images):
        raise DatasetError(f"{step.scene.name}: {points} points could be triangulated; "
                           f"{advice}")
    step.scene.say(f"{points} points from {len(images)} images")
