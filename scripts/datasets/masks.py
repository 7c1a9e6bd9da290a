# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Masks of photos, and by COLMAP those of the undistorted images.

image_undistorter knows no masks, but undistorts whatever pictures the images of a
model are. That these are PNG files keeps it from writing JPEG, in which black is not
always 0.
"""
import os
import shutil

from files import DatasetError, check_photo, image_size, write_text
from model import numbered_lines
from programs import as_words
from steps import remove

MASKS = "masks"  # Their folder among a scene's outputs.


def mask_of(name):
    """The name of an image's mask, as COLMAP has it."""
    return f"{name}.png"


def find_masks(folder, photos, output, names):
    """The names of the photos that have a mask in the folder."""
    if not folder.is_dir():
        raise DatasetError(f"--mask_path {folder}: no such folder")
    for other, where in ((photos, "the folder of the photos, where they would be taken for photos"),
                         (output, "the output folder, of which all is made anew")):
        if other == folder or other in folder.parents:
            raise DatasetError(f"--mask_path {folder}: is in {where}; put the masks elsewhere")
    masked = [name for name in names if (folder / mask_of(name)).is_file()]
    if not masked:
        raise DatasetError(f"--mask_path {folder}: holds no mask of any photo; that of {names[0]} "
                           f"would be {mask_of(names[0])}")
    for name in masked:
        size, expected = check_photo(folder / mask_of(name)), image_size(photos / name)
        if size != expected:
            raise DatasetError(f"{folder / mask_of(name)}: is {size[0]} x {size[1]}, its photo "
                               f"{expected[0]} x {expected[1]}; make it of the photo's size")
    return masked


def write_model(sparse, numbers, output):
    """The model of these photos, as images with other names and without points.
    numbers: the new names by the old ones."""
    output.mkdir(parents=True)
    shutil.copyfile(sparse / "cameras.txt", output / "cameras.txt")
    images = ""
    for _, line in numbered_lines(sparse / "images.txt", "COLMAP's images as text")[::2]:
        words = line.split(maxsplit=9)
        if words and words[9].strip() in numbers:
            images += " ".join([*words[:9], numbers[words[9].strip()]]) + "\n\n"
    write_text(output / "images.txt", images)
    write_text(output / "points3D.txt", "")


def undistort_masks(scene, programs, folder, names, options):
    """Makes the masks of the undistorted images of these photos; returns their
    folder. options: those with which the photos were undistorted."""
    masks = scene.folder / MASKS

    def action(step):
        part = scene.folder / f"{MASKS}.part"
        remove(part)
        # In a model as text, COLMAP ends the name of an image at a space.
        numbers = {name: f"{number}.png" for number, name in enumerate(names)}
        write_model(scene.folder / "sparse", numbers, part / "sparse")
        (part / "given").mkdir()
        for name, number in numbers.items():
            (part / "given" / number).symlink_to(folder / mask_of(name))
        step.run(programs.colmap, "image_undistorter", "--image_path", part / "given",
                 "--input_path", part / "sparse", "--output_path", part / "dense",
                 *as_words(options))
        for name, number in numbers.items():
            undistorted = part / "dense" / "images" / number
            if not undistorted.is_file():
                raise DatasetError(f"{folder / mask_of(name)}: COLMAP could not undistort it; "
                                   f"see {step.log}")
            target = part / "masks" / mask_of(name)
            target.parent.mkdir(parents=True, exist_ok=True)
            os.replace(undistorted, target)
        os.replace(part / "masks", masks)
        remove(part)

    scene.step("masks", action, outputs=[MASKS], after=["sparse"],
               inputs=[folder / mask_of(name) for name in names],
               options={**options, "colmap": programs.versions["colmap"]})
    return masks
