# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""COLMAP's dense workspace, as image_undistorter writes it, for images that need
no undistortion."""
import os
import pathlib
import shutil

from files import DatasetError, check_photo, image_size, write_text
from model import read_cameras, read_images

WORKSPACE = "dense"  # Its folder among a scene's outputs.
MAX_SOURCES = 20  # As image_undistorter has it.
MAP_FOLDERS = ("depth_maps", "normal_maps", "consistency_graphs")


def check_model(cameras, images, image_folder, origin):
    """That the cameras have no distortion and the images are there, in the
    cameras' size. origin is the file or folder that the model comes from."""
    if len(images) < 2:
        raise DatasetError(f"{origin}: {len(images)} images; stereo needs at least two")
    for image in images:
        camera = cameras.get(image.camera_id)
        if camera is None:
            raise DatasetError(f"{origin}: image {image.name} has camera "
                               f"{image.camera_id}, which is not among the cameras")
        if camera.model not in ("PINHOLE", "SIMPLE_PINHOLE"):
            raise DatasetError(f"{origin}: camera {image.camera_id} is {camera.model}, "
                               "not PINHOLE; give the undistorted images")
        parts = pathlib.PurePosixPath(image.name).parts
        if image.name.startswith("/") or ".." in parts:
            raise DatasetError(f"{origin}: image name {image.name} leaves the image folder")
        size = check_photo(image_folder / image.name)
        if size != (camera.width, camera.height):
            raise DatasetError(
                f"{image_folder / image.name}: is {size[0]} x {size[1]}, its camera "
                f"{camera.width} x {camera.height}; take the images that the model is of")


def make_map_folders(workspace, names):
    """The folders of the maps, with the subfolders of the images' names, which
    COLMAP does not make."""
    for folder in MAP_FOLDERS:
        for name in names:
            (workspace / "stereo" / folder / name).parent.mkdir(parents=True, exist_ok=True)


def image_names(workspace):
    """The images of a workspace, from its fusion.cfg."""
    text = (workspace / "stereo" / "fusion.cfg").read_text(encoding="utf-8")
    return text.splitlines()


def write_workspace(workspace, model_folder, image_folder):
    """Makes a workspace: the text model is copied, images are linked. The folder
    appears when it is complete."""
    part = workspace.with_name(workspace.name + ".part")
    shutil.rmtree(part, ignore_errors=True)
    (part / "sparse").mkdir(parents=True)
    for name in ("cameras.txt", "images.txt", "points3D.txt"):
        shutil.copyfile(model_folder / name, part / "sparse" / name)
    cameras = read_cameras(part / "sparse" / "cameras.txt")
    images = read_images(part / "sparse" / "images.txt")
    check_model(cameras, images, image_folder, model_folder)
    names = sorted(image.name for image in images)
    for name in names:
        link = part / "images" / name
        link.parent.mkdir(parents=True, exist_ok=True)
        link.symlink_to((image_folder / name).resolve())
    make_map_folders(part, names)
    write_text(part / "stereo" / "fusion.cfg", "".join(f"{n}\n" for n in names))
    write_text(part / "stereo" / "patch-match.cfg",
               "".join(f"{n}\n__auto__, {MAX_SOURCES}\n" for n in names))
    shutil.rmtree(workspace, ignore_errors=True)
    os.replace(part, workspace)


def maps_of(workspace):
    """The depth map files of a workspace."""
    return sorted((workspace / "stereo" / "depth_maps").rglob("*.bin"))


def map_size(path):
    """Width and height of a map file."""
    with open(path, "rb") as file:
        width, height = file.read(64).split(b"&", 2)[:2]
    return int(width), int(height)


def is_whole_map(path):
    """Whether a map file is as long as its header says: a program that was killed
    may have left half of it."""
    with open(path, "rb") as file:
        header = file.read(64).split(b"&", 3)
    try:
        width, height, channels = map(int, header[:3])
    except ValueError:
        return False
    start = sum(len(part) + 1 for part in header[:3])
    return path.stat().st_size == start + 4 * width * height * channels


def remove_partial_maps(workspace):
    """Takes away the maps that patch_match_stereo would take for done. An image
    is left out by it when both its depth and its normal map are there."""
    for folder in ("depth_maps", "normal_maps"):
        for path in (workspace / "stereo" / folder).rglob("*.bin"):
            if not is_whole_map(path):
                path.unlink()
