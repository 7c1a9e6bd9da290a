# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Tanks and Temples; see scripts/tanks_and_temples.sh."""
import pathlib
import shutil

import dense
import submission
from command_line import at_paper_size, make_parser, run_main
from database import read_matches
from features import DATABASE, extract_features, match_features
from files import DatasetError, check_photo, find_scenes, list_images
from focal_length import estimate_focal_length
from model import Camera, read_cameras, read_images
from programs import as_words
from structure_from_motion import ADVICE, find_poses, undistort
from tanks_and_temples_score import THRESHOLDS, read_truth, score
from trajectory import read_trajectory, write_trajectory
from triangulation import to_text, triangulate

DESCRIPTION = f"""\
Reconstructs scenes of Tanks and Temples: camera poses (by COLMAP from the images,
or the data set's own), depth maps (by tsar_stereo or COLMAP), tsar_refine,
tsar_fuse or stereo_fusion. Makes a submission of them, and scores the scenes that
come with ground truth before and after refinement.

  SCENE/images/*.jpg        or SCENE/*.jpg, the image set
  SCENE/SCENE_COLMAP_SfM.log, or SCENE/SCENE.log: camera poses (may be missing)
  SCENE/SCENE.ply, SCENE_trans.txt, SCENE.json: ground truth of training scenes

The poses come without a calibration. The focal length is found from matches, then
refined with principal point and distortion while the poses stay fixed.

What comes out:

  OUTPUT/SCENE/sparse/      the cameras with the sparse points
  OUTPUT/SCENE/dense/       the workspace with the depth maps before refinement
  OUTPUT/SCENE/refined/     the same with refined maps
  OUTPUT/SCENE/before.ply, after.ply
  OUTPUT/SCENE/scores/      before.json and after.json: precision, recall, F (only
                            with given poses: others are in no known frame)
  OUTPUT/SCENE/logs/        what the programs printed, one file per step
  OUTPUT/submission/SCENE.ply and SCENE.log, which the benchmark's own
                            upload_t2_results.py, started there, uploads

The images of a scene are taken by one camera. Every scene is reconstructed with
the same parameters. The threshold of the score is the benchmark's own
({", ".join(f"{name} {1000 * t:g} mm" for name, t in THRESHOLDS.items())})."""

PAPER_FRACTION = 1.0  # Of the images' size, which the paper's maps have.
INTERMEDIATE = ("Family", "Francis", "Horse", "Lighthouse", "M60", "Panther", "Playground", "Train")
ADVANCED = ("Auditorium", "Ballroom", "Courtroom", "Museum", "Palace", "Temple")
SETS = {"intermediate": INTERMEDIATE, "advanced": ADVANCED, "both": INTERMEDIATE + ADVANCED}
SUBMIT_HELP = """\
see to it that the submission has all scenes of a set, which the server asks for. SCENES must
have the whole set, so that all of it is made with the same options; what was made before is
not made again"""

CAMERA_OPTIONS = {
    "ImageReader.single_camera": 1, "ImageReader.camera_model": "SIMPLE_RADIAL",
    # In widths, as the data set's pages give it.
    "ImageReader.default_focal_length_factor": 0.7}


def image_folder_of(path):
    return path / "images" if (path / "images").is_dir() else path


def is_scene(path):
    return len(list_images(image_folder_of(path))) > 0


def poses_file(path):
    """The file of given poses, or None."""
    candidates = [path / f"{path.name}_COLMAP_SfM.log", path / f"{path.name}.log"]
    return next((file for file in candidates if file.is_file()), None)


def read_scene(path, args):
    """Sorted image names, their size, and poses by name (None: by SfM)."""
    images = list_images(image_folder_of(path))
    names = [image.name for image in images]
    size = check_photo(images[0])
    for image in images:
        if check_photo(image) != size:
            raise DatasetError(f"{image}: has another size than {images[0].name}; a scene's "
                               "images are of one camera")
    file = poses_file(path)
    if args.poses == "log" and file is None:
        raise DatasetError(f"{path / path.name}_COLMAP_SfM.log: not found; give the poses, "
                           "or do without --poses log")
    poses = None if args.poses == "sfm" or file is None else read_trajectory(file, names)
    if len(names if poses is None else poses) < 2:
        raise DatasetError(f"{path}: fewer than two images with poses; stereo needs two")
    return names, size, poses


def triangulate_with_poses(step, programs, path, size, poses, output):
    """The sparse model with given poses: focal length, points, the rest of the
    calibration, and points anew."""
    image_folder = image_folder_of(path)
    width, height = size
    focal = estimate_focal_length(read_matches(step.scene.folder / DATABASE), poses, width,
                                  height, poses_file(path))
    step.scene.say(f"focal length {focal:.1f} pixels from matches")
    camera = Camera("SIMPLE_RADIAL", width, height, [focal, width / 2, height / 2, 0.0])
    first = output.with_name("sparse.first")
    triangulate(step, programs, image_folder, dict.fromkeys(poses, camera), poses, first)
    fixed = programs.colmap_option("bundle_adjuster", "BundleAdjustment.refine_extrinsics",
                                   "BundleAdjustment.refine_rig_from_world")
    step.run(programs.colmap, "bundle_adjuster", "--input_path", first, "--output_path", first,
             *as_words({fixed: 0, "BundleAdjustment.refine_principal_point": 1}))
    to_text(step, programs, first)
    (camera,) = read_cameras(first / "cameras.txt").values()
    step.scene.say("calibrated: focal length {:.1f}, principal point {:.1f} {:.1f}, "
                   "distortion {:.4f}".format(*camera.params))
    triangulate(step, programs, image_folder, dict.fromkeys(poses, camera), poses, output)
    shutil.rmtree(first)


def reconstruct(path, args, programs):
    names, size, poses = read_scene(path, args)
    scene = dense.open_scene(args, path.name)
    sparse = scene.folder / "sparse"
    images = image_folder_of(path)
    extract_features(scene, programs, images, names if poses is None else sorted(poses),
                     options=CAMERA_OPTIONS)
    match_features(scene, programs, args.matcher)
    if poses is None:
        scene.step("sparse", lambda step: find_poses(step, programs, images, sparse,
                                                           ADVICE[args.matcher]),
                   outputs=["sparse"], after=["matches"], options={"poses": "sfm"})
    else:
        scene.step("sparse", lambda step: triangulate_with_poses(
            step, programs, path, size, poses, sparse),
            outputs=["sparse"], after=["matches"], inputs=[poses_file(path)])
    dense.make_workspace(scene, lambda step: undistort(step, programs, images, sparse),
                         after=["sparse"])
    dense.reconstruct(scene, at_paper_size(args, max(size), PAPER_FRACTION), programs)
    submit(scene, names, sparse)
    score_scene(scene, path, args, programs, poses is not None)


def submit(scene, names, sparse):
    folder = scene.folder.parent / "submission"
    poses = {image.name: image.pose for image in read_images(sparse / "images.txt")}
    submission.put_into(folder, scene.folder / "after.ply", f"{scene.name}.ply")
    write_trajectory(folder / f"{scene.name}.log", names, poses)
    scene.say(f"{folder / scene.name}.ply and .log ({len(poses)} of {len(names)} images "
              "have poses)")


def score_threshold(path, args):
    threshold = args.threshold or THRESHOLDS.get(path.name)
    if threshold is None or not threshold > 0:
        raise DatasetError(f"{path}: has ground truth, but is no training scene of the "
                           "benchmark; give the threshold of its score by --threshold")
    return threshold


def score_scene(scene, path, args, programs, given_poses):
    truth = read_truth(path)
    if truth is None:
        scene.say("no ground truth: not scored")
    elif not given_poses:
        scene.say("not scored: without given poses the cloud is not in the frame of the "
                  "ground truth; the benchmark's own toolbox aligns it by the .log file")
    else:
        score(scene, programs, truth, score_threshold(path, args))


def main():
    parser = make_parser(
        "tanks_and_temples", DESCRIPTION, "a scene's folder, or a folder of such folders", SETS,
        SUBMIT_HELP)
    parser.add_argument("--poses", choices=("auto", "log", "sfm"), default="auto",
                        help="camera poses: log, the data set's .log file; sfm, by COLMAP "
                        "from the images; auto (the default): log where there is one")
    parser.add_argument("--matcher", choices=("exhaustive", "sequential"),
                        default="exhaustive", help="which images COLMAP compares: all with "
                        "all (the default), or each with the next ones, which takes less "
                        "time where the images are hundreds of a video")
    parser.add_argument("--threshold", type=float, metavar="METRES", help="distance up to "
                        "which a point is right, for scenes that are not the benchmark's")

    def run(args, programs):
        scenes = find_scenes(args.scene, is_scene, "images, in itself or in images/")
        if args.submit:
            submission.check_set(f"--submit {args.submit}", SETS[args.submit],
                                 [path.name for path in scenes])
        for path in scenes:
            _, _, poses = read_scene(path, args)
            if read_truth(path) and poses is not None:
                score_threshold(path, args)
        for path in scenes:
            reconstruct(path, args, programs)
        if args.submit:
            folder = pathlib.Path(args.output_path).resolve() / "submission"
            print(f"{folder}: all {len(SETS[args.submit])} scenes; in it, with the site's "
                  "t2_submission_credentials.txt, start the benchmark's upload_t2_results.py "
                  f"--group {args.submit}", flush=True)

    run_main(parser, run)


if __name__ == "__main__":
    main()
