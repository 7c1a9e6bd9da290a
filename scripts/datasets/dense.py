# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""From a dense workspace to clouds before and after refinement, and their scores."""
import json
import os
import pathlib
import sys

from command_line import FUSIONS
from files import DatasetError, parse_numbers, read_lines, write_text
from ply import is_whole
from programs import REPOSITORY, as_words, files_named_by, output_of
from steps import Scene, remove
from workspace import (WORKSPACE, image_names, make_map_folders, maps_of,
                       remove_partial_maps)

REFINED = "refined"
# The steps that lead from the workspace to the refined cloud.
TIMED_STEPS = ("stereo", "refinement", "fusion_after")
# Of tsar_stereo, per megapixel of maps on one core; for remarks only.
STEREO_MINUTES = 5


def megapixels(width, height, max_image_size):
    """Of the maps of an image of this size."""
    return width * height * min(1.0, max_image_size / max(width, height))**2 / 1e6


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


def given_maps(args, scene_name):
    """The folder of ACMMP's or ACMM's maps of a scene."""
    return pathlib.Path(args.maps_path).resolve() / scene_name


def prior_seconds(args, scene_name):
    """How long maps took that were not made here, or None where nothing tells."""
    if args.stereo == "none":
        return None
    if args.stereo != "acm":
        return 0.0
    file = given_maps(args, scene_name) / "runtime.txt"
    if not file.exists():
        return None
    words = " ".join(read_lines(file, "the line runtime SECONDS")).split()
    if len(words) != 2 or words[0] != "runtime":
        raise DatasetError(f"{file}: does not hold the line runtime SECONDS")
    (seconds,) = parse_numbers(words[1], 1, file)
    return seconds


def stereo_command(args, scene_name, masks):
    """The command that makes the maps, and its options, name by value."""
    if args.stereo == "acm":
        return "tsar_import", {"format": "acm", "input_path": str(given_maps(args, scene_name))}
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

    command, options = stereo_command(args, scene.name, masks)
    given = [options["input_path"]] if args.stereo == "acm" else []
    for folder in given:
        if not os.path.isdir(folder):
            raise DatasetError(f"{folder}: not found; the maps of the scene should be there")
    program = programs.colmap if args.stereo == "colmap" else programs.tsar

    def action(step):
        if not step.continued or given:
            for folder in ("depth_maps", "normal_maps", "cost_maps", "consistency_graphs", "tsar"):
                remove(dense / "stereo" / folder)
            make_map_folders(dense, image_names(dense))
        elif args.stereo == "colmap":
            remove_partial_maps(dense)
        if args.stereo != "acm":
            step.run(program, command, "--workspace_path", dense, *as_words(options))
            return
        part = scene.folder / "part.import"
        remove(part)
        step.run(program, command, "--workspace_path", dense, "--output_path", part,
                 *as_words(options))
        for folder in ("depth_maps", "normal_maps"):
            remove(dense / "stereo" / folder)
            os.rename(part / "stereo" / folder, dense / "stereo" / folder)
        remove(part)

    scene.step("stereo", action, outputs=[dense / "stereo" / "depth_maps"], removes=False,
               resumes=True, after=["workspace"], inputs=[*given, *files_named_by(options)], options={
                   "stereo": args.stereo, "options": options, **programs.versions})


def fusion_command(args, masks):
    """The command that fuses, and its options, name by value."""
    preset = FUSIONS[args.fusion]
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


def fuse_into(step, program, command, options, workspace, input_type, cloud):
    """Runs a command that fuses; the cloud appears when it is complete."""
    part = cloud.with_name(f"part.{cloud.name}")
    # Of a stopped attempt; tsar_fuse replaces no cloud that is there.
    for left in cloud.parent.glob(f"{part.name}*"):
        remove(left)
    step.run(program, command, "--workspace_path", workspace, "--input_type", input_type,
             "--output_path", part, *as_words(options))
    if not part.exists() or not is_whole(part):
        raise DatasetError(f"{step.scene.name}: {step.name}: {command} wrote no cloud, or half of "
                           f"one; see {step.log}")
    os.replace(f"{part}.vis", f"{cloud}.vis")
    os.replace(part, cloud)


def fuse(scene, args, programs, name, workspace, input_type, cloud, masks, inputs=(), **key):
    command, options = fusion_command(args, masks)
    program, of_program = ((programs.colmap, "colmap") if command == "stereo_fusion"
                           else (programs.tsar, "colmap_tsar"))

    scene.step(name, lambda step: fuse_into(
        step, program, command, options, workspace, input_type, scene.folder / cloud),
               outputs=[cloud], options={
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


def input_type_of(workspace):
    geometric = any(".geometric." in path.name for path in maps_of(workspace))
    return "geometric" if geometric else "photometric"


def reconstruct(scene, args, programs, masks=None, priors=None):
    """Depth maps, refinement and the clouds before.ply and after.ply from the
    scene's workspace. masks: the folder with those of its images; priors: the
    options of tsar_refine for depth priors, name by value."""
    dense = scene.folder / WORKSPACE
    make_maps(scene, args, programs, masks)
    # Maps that were put there by hand are inputs; others belong to their step.
    inputs = [dense / "stereo" / f for f in ("depth_maps", "normal_maps")]
    origin = {"after": ["workspace", "stereo"], "inputs": inputs if args.stereo == "none" else []}
    input_type = input_type_of(dense)
    fuse(scene, args, programs, "fusion_before", dense, input_type, "before.ply", masks, **origin)
    refine(scene, args, programs, input_type, masks, priors, **origin)
    fuse(scene, args, programs, "fusion_after", scene.folder / REFINED, input_type, "after.ply",
         masks, after=["refinement"])


def evaluate(step, programs, cloud, project, output, options):
    """The scores of a cloud against scans as a JSON file."""
    result = scores_of(step, programs, "cloud", {"input_path": cloud, "ground_truth_path": project,
                                                 **options})
    write_text(output, json.dumps(result, indent=1) + "\n")


def scores_of(step, programs, measure, options):
    """What tsar_evaluate prints for a measure, cloud or fused_pixels."""
    step.run(programs.tsar, "tsar_evaluate", measure, "--json", 1, *as_words(options))
    # The log has what the program printed last, which for some is followed by progress.
    text = step.log.read_text(encoding="utf-8")
    return json.JSONDecoder().raw_decode(text, text.rindex("\n{\n") + 1)[0]


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
