# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Strecha's multi-view stereo data; see scripts/strecha.sh."""
import pathlib

import dense
import submission
from command_line import at_paper_size, make_parser, run_main
from features import extract_features, match_features
from files import (IMAGE_ENDINGS, DatasetError, check_photo, find_scenes, image_size,
                   parse_numbers, read_lines, write_text)
from model import Camera, pose_from_camera_to_world
from ply import read_ply
from triangulation import triangulate
from virtual_scans import scan_mesh
from workspace import write_workspace

ENDING = ".camera"
PAPER_FRACTION = 0.5  # Of the images' size, which the paper's maps have.
SETS = {"paper": ("fountain", "herzjesu")}  # Beginnings of the folders' names.
SUBMIT_HELP = """\
put the clouds of the scenes that the paper scores, fountain-P11 and Herz-Jesu-P8, into
OUTPUT/submission/strecha/, with the seconds that each took: there is no server, but whoever has
the ground truth can score them. Implies --paper_size"""
TOLERANCES = "0.01,0.02,0.05,0.1"  # Units of the data, which are meters.

DESCRIPTION = """\
Reconstructs scenes of Strecha's multi-view stereo data (fountain-P11, Herz-Jesu-P8
and others): points are triangulated by COLMAP with the given cameras held fixed,
then come depth maps (by tsar_stereo or COLMAP), tsar_refine, and tsar_fuse or
stereo_fusion.

A scene is a folder with images and their cameras, in any subfolders: to the image
0000.jpg belongs 0000.jpg.camera, which holds

  three lines of the calibration matrix, a line of zeros,
  three lines of the rotation from camera to world,
  the position of the camera, and the width and height of the image

What comes out:

  OUTPUT/SCENE/sparse/      the cameras with the triangulated points
  OUTPUT/SCENE/dense/       the workspace with the depth maps before refinement
  OUTPUT/SCENE/refined/     the same with refined maps
  OUTPUT/SCENE/before.ply, after.ply
  OUTPUT/SCENE/scores/      before.json and after.json, with --ground_truth
  OUTPUT/SCENE/logs/        what the programs printed, one file per step
  OUTPUT/submission/strecha/SCENE.ply and SCENE.txt, with --submit

Every scene is reconstructed with the same parameters."""


def read_camera(path):
    """Camera and pose of a .camera file."""
    lines = [line for line in read_lines(path, "a camera") if line.strip()]
    if len(lines) != 9:
        raise DatasetError(f"{path}: {len(lines)} lines instead of 9 (3 of the calibration, "
                           "zeros, 3 of the rotation, position, size)")
    rows = [parse_numbers(line, 3, f"{path}: line {number}")
            for number, line in enumerate(lines[:8], 1)]
    (fx, skew, cx), (zero, fy, cy), last = rows[:3]
    if [zero, *last] != [0, 0, 0, 1] or fx <= 0 or fy <= 0:
        raise DatasetError(f"{path}: the first three lines are not a calibration matrix")
    if skew != 0 or any(rows[3]):
        raise DatasetError(f"{path}: has skew or distortion, which COLMAP's PINHOLE has not")
    width, height = parse_numbers(lines[8], 2, f"{path}: line 9", int)
    pose = pose_from_camera_to_world(rows[4:7], rows[7], f"{path}: lines 5 to 7")
    return Camera("PINHOLE", width, height, [fx, fy, cx, cy]), pose


def camera_files(path):
    return sorted(path.glob("*" + ENDING)) + sorted(path.glob("*/*" + ENDING))


def find_images(path):
    """All images of a scene's folder by their names."""
    found = sorted([*path.glob("*"), *path.glob("*/*")])
    return {p.name: p for p in found if p.suffix.lower() in IMAGE_ENDINGS}


def read_scene(path):
    """Cameras and poses by image name, and the folder of the images."""
    images = find_images(path)
    cameras, poses, folders = {}, {}, set()
    for file in camera_files(path):
        name = file.name[:-len(ENDING)]
        if name not in images:
            raise DatasetError(f"{file}: there is no image {name} in {path}")
        cameras[name], poses[name] = read_camera(file)
        size = check_photo(images[name])
        camera = cameras[name]
        if size != (camera.width, camera.height):
            raise DatasetError(f"{images[name]}: is {size[0]} x {size[1]}, its camera file "
                               f"says {camera.width} x {camera.height}")
        folders.add(images[name].parent)
    if len(poses) < 2:
        raise DatasetError(f"{path}: {len(poses)} images with cameras; stereo needs two")
    if len(folders) > 1:
        raise DatasetError(f"{path}: its images lie in several folders: "
                           f"{', '.join(map(str, sorted(folders)))}; put them into one")
    return cameras, poses, folders.pop()


def kind(name):
    """The scene that a folder's name means: Herz-Jesu-P8 and herzjesu_dense are herzjesu."""
    plain = "".join(c for c in name.lower() if c.isalnum())
    return next((scene for scene in SETS["paper"] if plain.startswith(scene)), plain)


def open_workspace(path, args, programs):
    """The outputs of a scene with its workspace, and its cameras and poses."""
    cameras, poses, image_folder = read_scene(path)
    scene = dense.open_scene(args, path.name)
    extract_features(scene, programs, image_folder, sorted(poses), cameras=cameras)
    match_features(scene, programs, "exhaustive")
    scene.step(
        "sparse", lambda step: triangulate(step, programs, image_folder, cameras, poses,
                                           scene.folder / "sparse"),
        outputs=["sparse"], after=["matches"], inputs=camera_files(path))
    dense.make_workspace(
        scene, lambda step: write_workspace(scene.folder / dense.WORKSPACE,
                                            scene.folder / "sparse", image_folder),
        after=["sparse"])
    return scene, cameras, poses


def scene_options(cameras, args):
    """The options for one scene."""
    longer_side = max(max(camera.width, camera.height) for camera in cameras.values())
    return at_paper_size(args, longer_side, PAPER_FRACTION)


def reconstruct(path, args, programs):
    scene, cameras, poses = open_workspace(path, args, programs)
    dense.reconstruct(scene, scene_options(cameras, args), programs)
    if args.submit:
        submit(scene, args)
    if args.ground_truth:
        score(scene, args, programs, cameras, poses)
    else:
        scene.say("no --ground_truth: not scored")


def submit(scene, args):
    folder = scene.folder.parent / "submission" / "strecha"
    submission.put_into(folder, scene.folder / "after.ply", f"{scene.name}.ply")
    seconds = dense.prior_seconds(args, scene.name) + scene.seconds(*dense.TIMED_STEPS)
    write_text(folder / f"{scene.name}.txt", f"runtime {seconds:.3f}\n")
    scene.say(f"{folder / scene.name}.ply and .txt ({seconds:.1f} s)")


def prepare_truth(scene, truth, cameras, poses):
    """The project of scans to score against, and the options of tsar_evaluate."""
    options = {"tolerances": TOLERANCES}
    if truth.suffix == ".mlp":
        return truth, options

    def action(step):
        mesh = read_ply(truth)
        if len(mesh.faces) == 0:
            raise DatasetError(f"{truth}: has no faces; a mesh is needed, or scans with "
                               "their poses as a .mlp file")
        scan_mesh(mesh, cameras, poses, scene.folder / "scans")

    scene.step("scans", action, outputs=["scans"], inputs=[truth], after=["sparse"])
    angle = (scene.folder / "scans" / "beam_angle.txt").read_text(encoding="utf-8").strip()
    return scene.folder / "scans" / "scan_alignment.mlp", {**options, "beam_angle": angle}


def score(scene, args, programs, cameras, poses):
    truth = pathlib.Path(args.ground_truth).resolve()
    project, options = prepare_truth(scene, truth, cameras, poses)
    dense.score(scene, programs, project, options,
                **({"inputs": [truth.parent]} if project == truth else {"after": ["scans"]}))


def main():
    parser = make_parser(
        "strecha", DESCRIPTION, "a scene's folder, or a folder of such folders", SETS, SUBMIT_HELP)
    parser.add_argument(
        "--ground_truth", metavar="FILE", help="what to score against: a mesh as a PLY file "
        "(each camera then scans it), or laser scans as a MeshLab project (.mlp)")

    def run(args, programs):
        scenes = find_scenes(args.scene, lambda path: bool(camera_files(path)),
                             f"{ENDING} files")
        if args.ground_truth and len(scenes) > 1:
            raise DatasetError("--ground_truth: belongs to one scene, not to a folder of them")
        if args.ground_truth and not pathlib.Path(args.ground_truth).is_file():
            raise DatasetError(f"--ground_truth {args.ground_truth}: not found")
        if args.submit:
            args.paper_size = True
            submission.check_set(f"--submit {args.submit}", SETS[args.submit],
                                 [kind(path.name) for path in scenes])
            submission.check_times({path.name: dense.prior_seconds(args, path.name)
                                    for path in scenes})
        for path in scenes:
            read_scene(path)
        for path in scenes:
            reconstruct(path, args, programs)

    run_main(parser, run)


if __name__ == "__main__":
    main()
