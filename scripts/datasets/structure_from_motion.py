# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""From matches to undistorted images with poses, by COLMAP."""
import os
import shutil

from features import DATABASE
from files import DatasetError
from model import read_images
from programs import as_words
from steps import ProgramError
from triangulation import check, to_text
from workspace import WORKSPACE, image_names

# What to do if no poses are found, after what was already tried.
ADVICE = {
    "exhaustive": "take sharp photos, each of which shares two thirds of what it shows with "
                  "the next, of things that have texture and do not move",
    "sequential": "--matcher exhaustive compares all photos instead of neighbors in the "
                  "order of their names",
    "vocab_tree": "--matcher exhaustive compares all photos instead of those that look alike",
}


def size_of(model):
    return len(read_images(model / "images.txt"))


def find_poses(step, programs, image_folder, output, advice, options=None):
    """Makes the folder output: the largest model that the mapper finds. advice: what
    to do if it finds none, or several. options: of mapper, name by value."""
    models = output.with_name("sparse.models")
    shutil.rmtree(models, ignore_errors=True)
    models.mkdir()
    said = ""
    list_models = lambda: [model for model in models.iterdir() if model.is_dir()]
    try:
        step.run(programs.colmap, "mapper", "--database_path", step.scene.folder / DATABASE,
                 "--image_path", image_folder, "--output_path", models, *as_words(options or {}))
    except ProgramError as error:
        # Some versions fail where others end well without a model; what they say
        # tells whether that is the reason.
        if list_models():
            raise
        said = f" ({error})"
    found = list_models()
    if not found:
        raise DatasetError(f"{step.scene.name}: COLMAP could not find the camera poses{said}; "
                           f"{advice}; see {step.log}")
    for model in found:
        to_text(step, programs, model)
    best, *others = sorted(found, key=lambda model: (-size_of(model), model.name))
    if others:
        step.scene.say(f"{len(found)} models that no photos connect, of "
                       f"{', '.join(str(size_of(model)) for model in [best, *others])} images; "
                       f"going on with the largest. To connect them: {advice}")
    shutil.rmtree(output, ignore_errors=True)
    os.replace(best, output)
    shutil.rmtree(models)
    check(step, output, read_images(output / "images.txt"), advice)


def undistort(step, programs, image_folder, sparse, options=None):
    """Makes the scene's workspace. options: of image_undistorter, name by value."""
    workspace = step.scene.folder / WORKSPACE
    part = workspace.with_name(f"{WORKSPACE}.part")
    shutil.rmtree(part, ignore_errors=True)
    step.run(programs.colmap, "image_undistorter", "--image_path", image_folder,
             "--input_path", sparse, "--output_path", part, *as_words(options or {}))
    for name in image_names(part):
        if not (part / "images" / name).is_file():
            raise DatasetError(f"{part / 'images' / name}: COLMAP did not write it; see {step.log}")
    os.replace(part, workspace)
