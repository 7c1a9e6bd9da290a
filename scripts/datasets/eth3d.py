# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""ETH3D's high-resolution multi-view benchmark; see scripts/eth3d.sh."""
import pathlib

import dense
import ply
import submission
from command_line import at_paper_size, make_parser, run_main
from files import DatasetError, find_scenes, write_text
from model import read_cameras, read_images
from workspace import check_model, write_workspace

CALIBRATION = "dslr_calibration_undistorted"
SCANS = pathlib.Path("dslr_scan_eval", "scan_alignment.mlp")
TOLERANCES = "0.01,0.02,0.05,0.1,0.2,0.5"  # Meters; those of the benchmark.
PAPER_FRACTION = 0.5  # Of the images' size, which the paper's maps have.
SUBMISSION = "high_res_multi_view"
TRAINING = ("courtyard", "delivery_area", "electro", "facade", "kicker", "meadow", "office",
            "pipes", "playground", "relief", "relief_2", "terrace", "terrains")
TEST = ("botanical_garden", "boulders", "bridge", "door", "exhibition_hall", "lecture_room",
        "living_room", "lounge", "observatory", "old_computer", "statue", "terrace_2")
SETS = {"training": TRAINING, "test": TEST, "all": TRAINING + TEST}
SUBMIT_HELP = f"""\
pack OUTPUT/submission/{SUBMISSION}.7z of all scenes of a set as the server takes it, with
at most {submission.MAX_POINTS / 1e6:g} million points each and {submission.MAX_BYTES / 1e9:g} GB together:
more are thinned, which is said. SCENES must have the whole set, so that all of it is made
with the same options; what was made before is not made again"""

DESCRIPTION = """\
Reconstructs scenes of ETH3D's high-resolution multi-view benchmark: a COLMAP dense
workspace, depth maps (by tsar_stereo or COLMAP), tsar_refine, tsar_fuse or
stereo_fusion. Makes a submission of them, and scores the scenes that come with laser
scans before and after refinement.

Unpack the archives SCENE_dslr_undistorted.7z, and for training scenes
SCENE_dslr_scan_eval.7z too, into one folder, so that there are

  SCENE/images/dslr_images_undistorted/*.JPG
  SCENE/dslr_calibration_undistorted/{cameras,images,points3D}.txt
  SCENE/dslr_scan_eval/scan_alignment.mlp and its PLY files (training scenes)

What comes out:

  OUTPUT/SCENE/dense/       the workspace with the depth maps before refinement
  OUTPUT/SCENE/refined/     the same with refined maps
  OUTPUT/SCENE/before.ply, after.ply
  OUTPUT/SCENE/scores/      before.json and after.json (training scenes)
  OUTPUT/SCENE/logs/        what the programs printed, one file per step
  OUTPUT/submission/high_res_multi_view/SCENE.ply and SCENE.txt (the seconds from
                            the workspace to the refined cloud)
  OUTPUT/submission/high_res_multi_view.7z, with --submit

Every scene is reconstructed with the same parameters."""


def is_scene(path):
    return (path / CALIBRATION).is_dir()


def check_scene(path):
    """That a scene is whole, before any of them is worked on."""
    calibration = path / CALIBRATION
    for name in ("images.txt", "cameras.txt", "points3D.txt"):
        if not (calibration / name).is_file():
            raise DatasetError(f"{calibration / name}: not found; unpack the undistorted "
                               "images' archive of the scene again")
    check_model(read_cameras(calibration / "cameras.txt"),
                read_images(calibration / "images.txt"), path / "images", calibration)
    if SCANS.parent.name in [p.name for p in path.iterdir()] and not (path / SCANS).is_file():
        raise DatasetError(f"{path / SCANS}: not found beside the scans; unpack their "
                           "archive again")


def scene_options(path, args):
    """The options for one scene."""
    cameras = read_cameras(path / CALIBRATION / "cameras.txt").values()
    longer_side = max(max(camera.width, camera.height) for camera in cameras)
    return at_paper_size(args, longer_side, PAPER_FRACTION)


def open_workspace(path, args):
    """The outputs of a scene, with its workspace."""
    scene = dense.open_scene(args, path.name)
    calibration = path / CALIBRATION
    dense.make_workspace(
        scene, lambda step: write_workspace(scene.folder / dense.WORKSPACE,
                                            calibration, path / "images"),
        inputs=[calibration, path / "images"])
    return scene


def reconstruct(path, args, programs):
    scene = open_workspace(path, args)
    dense.reconstruct(scene, scene_options(path, args), programs)
    if (path / SCANS).is_file():
        dense.score(scene, programs, path / SCANS, {"tolerances": TOLERANCES},
                    inputs=[(path / SCANS).parent])
    submit(scene, args)


def submit(scene, args):
    """The scene's two files of a submission. The runtime is that of depth maps,
    refinement and fusion; what comes before is given by the benchmark."""
    folder = scene.folder.parent / "submission" / SUBMISSION
    thinned = submission.put_into(folder, scene.folder / "after.ply", f"{scene.name}.ply",
                                  submission.MAX_POINTS)
    if thinned:
        scene.say(thinned)
    earlier = dense.prior_seconds(args, scene.name)
    if earlier is None:
        (folder / f"{scene.name}.txt").unlink(missing_ok=True)
        scene.say(f"{folder / scene.name}.txt: not written, since it is not known how "
                  "long the depth maps took; a submission needs it")
        return
    seconds = earlier + scene.seconds(*dense.TIMED_STEPS)
    write_text(folder / f"{scene.name}.txt", f"runtime {seconds:.3f}\n")
    scene.say(f"{folder / scene.name}.ply and .txt ({seconds:.1f} s)")


def pack(folder, scenes):
    """The archive of a submission, of the files of these scenes in its folder."""
    clouds = [folder / SUBMISSION / f"{scene}.ply" for scene in scenes]
    sizes = [(ply.count(cloud, "vertex"), ply.row_size(cloud)) for cloud in clouds]
    if sum(count * size for count, size in sizes) > submission.MAX_BYTES:
        most = submission.points_within(sizes, submission.MAX_BYTES)
        for cloud in clouds:
            thinned = submission.put_into(cloud.parent, cloud, cloud.name, most)
            if thinned:
                print(thinned, flush=True)
    archive = folder / f"{SUBMISSION}.7z"
    print(f"packing {archive}", flush=True)
    submission.pack(archive, folder, [f"{SUBMISSION}/{scene}.{ending}" for scene in scenes
                                      for ending in ("ply", "txt")])
    print(f"{archive}: {len(scenes)} scenes, {archive.stat().st_size / 1e9:.2f} GB; to be uploaded "
          "at eth3d.net", flush=True)


def main():
    parser = make_parser("eth3d", DESCRIPTION, "a scene's folder, or a folder of such folders",
                         SETS, SUBMIT_HELP)

    def run(args, programs):
        scenes = find_scenes(args.scene, is_scene, f"a folder {CALIBRATION}")
        for path in scenes:
            check_scene(path)
        if args.submit:
            names = SETS[args.submit]
            submission.check_set(f"--submit {args.submit}", names, [path.name for path in scenes])
            submission.check_times({name: dense.prior_seconds(args, name) for name in names})
        for path in scenes:
            reconstruct(path, args, programs)
        if args.submit:
            pack(pathlib.Path(args.output_path).resolve() / "submission", names)

    run_main(parser, run)


if __name__ == "__main__":
    main()
