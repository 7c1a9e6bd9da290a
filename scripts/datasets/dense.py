# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""From a dense workspace to clouds before and after refinement, and what the
scripts' command lines have in common."""
import argparse
import json
import os
import pathlib
import shutil
import signal
import sys

from files import DatasetError, write_text
from programs import REPOSITORY, Programs, output_of
from steps import Scene, remove
from workspace import image_names, make_map_folders, maps_of, remove_partial_maps

WORKSPACE = "dense"
REFINED = "refined"
# The steps that lead from the workspace to the refined cloud.
TIMED_STEPS = ("stereo", "refinement", "fusion_after")

STEREO_HELP = """\
where the depth maps come from: colmap, its patch_match_stereo (with a COLMAP that
has CUDA and an NVIDIA GPU); tsar, tsar_stereo of this project; none, nowhere: put
the maps into OUTPUT/SCENE/dense/stereo yourself. auto (the default): colmap where
it can run, else tsar"""
PRESETS = ("default", "paper", "paper_strict")
# The paper counts matches beside the reference view and asks for more than one;
# COLMAP counts the reference view as well.
FUSIONS = {"colmap": {},
           "paper": {"max_depth_error": 0.01, "max_normal_error": 30,
                     "max_reproj_error": 2, "min_num_pixels": 3}}
FUSION_HELP = """\
what makes a point of the clouds: colmap (the default), what stereo_fusion does by
default; paper, what the paper does: depths within 1 %%, normals within 30 degrees,
pixels within 2, in the reference view and two others"""


def make_parser(script, description, scene_help):
    parser = argparse.ArgumentParser(
        prog=f"scripts/{script}.sh", description=description, allow_abbrev=False,
        formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", metavar="SCENE", help=scene_help)
    parser.add_argument("--output_path", required=True, metavar="OUTPUT",
                        help="folder for all that is made; run again with the same one, "
                        "it goes on where it stopped")
    parser.add_argument("--stereo", choices=("auto", "colmap", "tsar", "none"),
                        default="auto", help=STEREO_HELP)
    parser.add_argument("--max_image_size", type=int, default=3200, metavar="PIXELS",
                        help="longer side of the depth maps; larger images are reduced "
                        "(default: 3200, for all scenes)")
    parser.add_argument("--preset", choices=PRESETS, default=PRESETS[0],
                        help="preset of tsar_refine (default: default)")
    parser.add_argument("--fusion", choices=tuple(FUSIONS), default="colmap", help=FUSION_HELP)
    parser.add_argument("--min_num_pixels", type=int, metavar="N",
                        help="views that must see a point, the reference view among them "
                        "(default: 5, or 3 with --fusion paper)")
    parser.add_argument("--colmap", metavar="PATH", help="COLMAP (default: the one on the path)")
    parser.add_argument("--colmap_tsar", metavar="PATH", help="this project's program "
                        "(default: build/bin/colmap_tsar, or the one on the path)")
    return parser


def run_main(parser, run):
    """Calls run(args, programs) and turns what goes wrong into one line."""
    args = parser.parse_args()
    # So that a program at work is ended too.
    signal.signal(signal.SIGTERM, lambda number, _: sys.exit(128 + number))
    try:
        if args.max_image_size < 16:
            raise DatasetError(f"--max_image_size {args.max_image_size}: is below 16")
        if args.min_num_pixels is not None and args.min_num_pixels < 1:
            raise DatasetError(f"--min_num_pixels {args.min_num_pixels}: is below 1")
        programs = Programs(args.colmap, args.colmap_tsar)
        if args.stereo == "auto":
            args.stereo = "colmap" if programs.colmap_has_stereo else "tsar"
        elif args.stereo == "colmap" and not programs.colmap_has_stereo:
            raise DatasetError(f"--stereo colmap: {programs.colmap} has no CUDA, or there is "
                               "no NVIDIA GPU; use --stereo tsar or name another by --colmap")
        run(args, programs)
    except DatasetError as error:
        sys.exit(f"ERROR: {error}")
    except OSError as error:
        sys.exit(f"ERROR: {error.filename}: {error.strerror}" if error.filename
                 else f"ERROR: {error}")
    except KeyboardInterrupt:
        sys.exit("stopped; the same command goes on from here")


def open_scene(args, name):
    """The outputs of a scene; nothing else may be at work there."""
    return Scene(name, pathlib.Path(args.output_path).resolve() / name)


def make_workspace(scene, action, **key):
    """The step that makes the workspace, unless that would take maps with it that
    were put there by hand."""
    dense = scene.folder / WORKSPACE

    def guarded(step):
        if scene.record("stereo")["state"] == "" and dense.exists() and maps_of(dense):
            raise DatasetError(f"{dense}: was made from other inputs and has depth maps "
                               "of its own; remove it or name another --output_path")
        remove(dense)
        action(step)

    scene.step("workspace", guarded, outputs=[WORKSPACE], removes=False, **key)


def stereo_command(args, programs, dense):
    if args.stereo == "colmap":
        return [programs.colmap, "patch_match_stereo", "--workspace_path", dense,
                "--PatchMatchStereo.max_image_size", args.max_image_size]
    return [programs.tsar, "tsar_stereo", "--workspace_path", dense,
            "--TsarStereo.max_image_size", args.max_image_size]


def make_maps(scene, args, programs):
    dense = scene.folder / WORKSPACE
    made_here = scene.record("stereo")["state"] != ""
    if args.stereo == "none":
        if made_here:
            raise DatasetError(f"{dense}: has depth maps that were made by this script; "
                               "name another --output_path for --stereo none")
        if not maps_of(dense):
            raise DatasetError(f"{dense}/stereo: has no depth maps; put depth_maps/ and "
                               "normal_maps/ there, or do without --stereo none")
        return
    if not made_here and maps_of(dense):
        raise DatasetError(f"{dense}: has depth maps that were not made by this script; "
                           "--stereo none takes them, or remove them")

    def action(step):
        if not step.continued:
            for folder in ("depth_maps", "normal_maps", "cost_maps", "consistency_graphs", "tsar"):
                remove(dense / "stereo" / folder)
            make_map_folders(dense, image_names(dense))
        elif args.stereo == "colmap":
            remove_partial_maps(dense)
        step.run(*stereo_command(args, programs, dense))

    scene.step("stereo", action, outputs=[dense / "stereo" / "depth_maps"], removes=False,
               resumes=True, after=["workspace"], options={
                   "stereo": args.stereo, "max_image_size": args.max_image_size,
                   **programs.versions})


def fusion_options(args):
    """What differs from COLMAP's defaults, name by value."""
    options = dict(FUSIONS[args.fusion])
    if args.min_num_pixels is not None:
        options["min_num_pixels"] = args.min_num_pixels
    return options


def fuse(scene, args, programs, name, workspace, input_type, cloud, **key):
    options = fusion_options(args)

    def action(step):
        part = scene.folder / f"part.{cloud}"
        extra = [text for option, value in options.items()
                 for text in (f"--StereoFusion.{option}", value)]
        step.run(programs.colmap, "stereo_fusion", "--workspace_path", workspace,
                 "--input_type", input_type, "--output_path", part, *extra)
        if not part.exists():
            raise DatasetError(f"{scene.name}: {name}: COLMAP wrote no cloud; see {step.log}")
        os.replace(f"{part}.vis", f"{scene.folder / cloud}.vis")
        os.replace(part, scene.folder / cloud)

    scene.step(name, action, outputs=[cloud], options={
        "type": input_type, "colmap": programs.versions["colmap"], **options}, **key)


def reconstruct(scene, args, programs):
    """Depth maps, refinement and the clouds before.ply and after.ply from the
    scene's workspace."""
    dense = scene.folder / WORKSPACE
    refined = scene.folder / REFINED
    make_maps(scene, args, programs)
    # Maps that were put there by hand are inputs; others belong to their step.
    inputs = [dense / "stereo" / f for f in ("depth_maps", "normal_maps")]
    origin = {"after": ["workspace", "stereo"], "inputs": inputs if args.stereo == "none" else []}
    geometric = any(".geometric." in path.name for path in maps_of(dense))
    input_type = "geometric" if geometric else "photometric"
    fuse(scene, args, programs, "fusion_before", dense, input_type, "before.ply", **origin)

    scene.step(
        "refinement", lambda step: step.run(
            programs.tsar, "tsar_refine", "--workspace_path", dense,
            "--output_path", refined, "--input_type", input_type,
            "--TsarRefine.preset", args.preset),
        outputs=[REFINED], resumes=True,
        options={"type": input_type, "preset": args.preset,
                 "colmap_tsar": programs.versions["colmap_tsar"]}, **origin)
    fuse(scene, args, programs, "fusion_after", refined, input_type, "after.ply",
         after=["refinement"])


def evaluate(step, programs, cloud, project, output, options):
    """The scores of a cloud against scans as a JSON file."""
    command = [programs.tsar, "tsar_evaluate", "cloud", "--input_path", cloud,
               "--ground_truth_path", project, "--json", 1]
    for name, value in options.items():
        command += [f"--{name}", value]
    step.run(*command)
    # The log has what the program printed last.
    text = step.log.read_text(encoding="utf-8")
    result, _ = json.JSONDecoder().raw_decode(text, text.rindex("\n{") + 1)
    write_text(output, json.dumps(result, indent=1) + "\n")


def score(scene, programs, project, options, inputs=(), after=()):
    """Scores both clouds by the measure of ETH3D, and prints the scores."""
    folder = scene.folder / "scores"

    def action(step):
        for name in ("before", "after"):
            evaluate(step, programs, scene.folder / f"{name}.ply", project,
                     folder / f"{name}.json", options)

    scene.step("scores", action, outputs=["scores"], inputs=[project, *inputs],
               after=["fusion_before", "fusion_after", *after],
               options={**options, "colmap_tsar": programs.versions["colmap_tsar"]})
    print(output_of(sys.executable, REPOSITORY / "scripts" / "compare_scores.py",
                    folder / "before.json", folder / "after.json"), end="", flush=True)


def put_into(folder, source, name):
    """Copies a file into a submission, whole or not at all."""
    folder.mkdir(parents=True, exist_ok=True)
    part = folder / f"{name}.part"
    shutil.copyfile(source, part)
    os.replace(part, folder / name)
