# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""From a dense workspace to clouds before and after refinement, and their scores."""
import json
import os
import pathlib
import shutil
import sys

from command_line import FUSIONS
from files import DatasetError, write_text
from ply import is_whole
from programs import REPOSITORY, as_words, files_named_by, output_of
from steps import Scene, remove
from workspace import (WORKSPACE, image_names, make_map_folders, maps_of,
                       remove_partial_maps)

REFINED = "refined"
# The steps that lead from the workspace to the refined cloud.
TIMED_STEPS = ("stereo", "refinement", "fusion_after")

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
                               "of its own; remove it or name another output folder")
        remove(dense)
        action(step)

    scene.step("workspace", guarded, outputs=[WORKSPACE], removes=False, **key)


def mask_options(masks):
    """The option of this project's commands for a folder of masks, or None."""
    return {"mask_path": str(masks)} if masks else {}


def stereo_command(args, masks):
    """The command that makes the maps, and its options, name by value."""
    command, group = (("patch_match_stereo", "PatchMatchStereo") if args.stereo == "colmap"
                      else ("tsar_stereo", "TsarStereo"))
    options = {f"{group}.max_image_size": args.max_image_size, **args.passed.get(command, {})}
    # patch_match_stereo knows no masks.
    return command, {**options, **(mask_options(masks) if command == "tsar_stereo" else {})}


def make_maps(scene, args, programs, masks):
    dense = scene.folder / WORKSPACE
    made_here = scene.record("stereo")["state"] != ""
    if args.stereo == "none":
        if made_here:
            raise DatasetError(f"{dense}: has depth maps that were made by this script; "
                               "name another output folder for --stereo none")
        if not maps_of(dense):
            raise DatasetError(f"{dense}/stereo: has no depth maps; put depth_maps/ and "
                               "normal_maps/ there, or do without --stereo none")
        return
    if not made_here and maps_of(dense):
        raise DatasetError(f"{dense}: has depth maps that were not made by this script; "
                           "--stereo none takes them, or remove them")

    command, options = stereo_command(args, masks)
    program = programs.colmap if args.stereo == "colmap" else programs.tsar

    def action(step):
        if not step.continued:
            for folder in ("depth_maps", "normal_maps", "cost_maps", "consistency_graphs", "tsar"):
                remove(dense / "stereo" / folder)
            make_map_folders(dense, image_names(dense))
        elif args.stereo == "colmap":
            remove_partial_maps(dense)
        step.run(program, command, "--workspace_path", dense, *as_words(options))

    scene.step("stereo", action, outputs=[dense / "stereo" / "depth_maps"], removes=False,
               resumes=True, after=["workspace"], inputs=files_named_by(options), options={
                   "stereo": args.stereo, "options": options, **programs.versions})


def fusion_command(args, masks, preset):
    """The command that fuses, and its options, name by value. preset: that of
    tsar_fuse; None: COLMAP fuses."""
    if preset is None:
        command, options = "stereo_fusion", {}
        if args.min_num_pixels is not None:
            options["StereoFusion.min_num_pixels"] = args.min_num_pixels
        if masks:
            options["StereoFusion.mask_path"] = str(masks)
    else:
        command, options = "tsar_fuse", {"TsarFuse.preset": preset, **mask_options(masks)}
        if args.min_num_pixels is not None:
            options["TsarFuse.min_num_views"] = args.min_num_pixels
    return command, {**options, **args.passed.get(command, {})}


def fuse(scene, args, programs, name, workspace, input_type, cloud, masks, preset=None, inputs=(),
         **key):
    command, options = fusion_command(args, masks, preset)
    program, of_program = ((programs.colmap, "colmap") if preset is None
                           else (programs.tsar, "colmap_tsar"))

    def action(step):
        part = scene.folder / f"part.{cloud}"
        # Of a stopped attempt; tsar_fuse replaces no cloud that is there.
        for left in scene.folder.glob(f"{part.name}*"):
            remove(left)
        step.run(program, command, "--workspace_path", workspace, "--input_type", input_type,
                 "--output_path", part, *as_words(options))
        if not part.exists() or not is_whole(part):
            raise DatasetError(f"{scene.name}: {name}: {command} wrote no cloud, or half of one; "
                               f"see {step.log}")
        os.replace(f"{part}.vis", f"{scene.folder / cloud}.vis")
        os.replace(part, scene.folder / cloud)

    scene.step(name, action, outputs=[cloud], options={
        "type": input_type, of_program: programs.versions[of_program], **options},
               inputs=[*inputs, *files_named_by(options)], **key)


def refine(scene, args, programs, input_type, masks, priors=None, inputs=(), **key):
    options = {"TsarRefine.preset": args.preset, **args.passed.get("tsar_refine", {}),
               **mask_options(masks), **(priors or {})}
    scene.step(
        "refinement", lambda step: step.run(
            programs.tsar, "tsar_refine", "--workspace_path", scene.folder / WORKSPACE,
            "--output_path", scene.folder / REFINED, "--input_type", input_type,
            *as_words(options)),
        outputs=[REFINED], resumes=True, inputs=[*inputs, *files_named_by(options)],
        options={"type": input_type, "options": options,
                 "colmap_tsar": programs.versions["colmap_tsar"]}, **key)


def reconstruct(scene, args, programs, masks=None, priors=None):
    """Depth maps, refinement and the clouds before.ply and after.ply from the
    scene's workspace. masks: the folder with those of its images; priors: the
    options of tsar_refine for depth priors, name by value."""
    dense = scene.folder / WORKSPACE
    make_maps(scene, args, programs, masks)
    # Maps that were put there by hand are inputs; others belong to their step.
    inputs = [dense / "stereo" / f for f in ("depth_maps", "normal_maps")]
    origin = {"after": ["workspace", "stereo"], "inputs": inputs if args.stereo == "none" else []}
    geometric = any(".geometric." in path.name for path in maps_of(dense))
    input_type = "geometric" if geometric else "photometric"
    fuse(scene, args, programs, "fusion_before", dense, input_type, "before.ply", masks, **origin)
    refine(scene, args, programs, input_type, masks, priors, **origin)
    fuse(scene, args, programs, "fusion_after", scene.folder / REFINED, input_type, "after.ply",
         masks, FUSIONS[args.fusion], after=["refinement"])


def evaluate(step, programs, cloud, project, output, options):
    """The scores of a cloud against scans as a JSON file."""
    step.run(programs.tsar, "tsar_evaluate", "cloud", "--input_path", cloud,
             "--ground_truth_path", project, "--json", 1, *as_words(options))
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
