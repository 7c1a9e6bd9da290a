# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""The tables of the paper, with ours beside them; see scripts/paper_tables.sh."""
import json
import pathlib

import dense
import eth3d
import eth3d_depth
import paper_results as paper
import strecha
from command_line import EPILOG, add_options, add_prior_options, new_parser, run_main
from files import DatasetError, find_scenes, write_text
from programs import as_words
from steps import remove
from workspace import map_size, maps_of

TOLERANCES = "0.02,0.1"
FULL, BEFORE = "TSAR-MVS", "prior"
ABLATION = {"w/o JHF": "filter=0", "w/o DD": "filter_discontinuity=0",
            "w/o CE": "filter_confidence=0", "w/o ICR": "refine=0",
            "w/o SP": "superpixel_planes=0", "w/o WMF": "weighted_median=0",
            "w/o TS": "segment=0"}
TABLES = ("clouds", "ablation", "parameters")

DESCRIPTION = """\
Runs what the tables of the TSAR-MVS paper show, on data that you have, and prints
each of them with our numbers below the paper's, in per cent:

  clouds       accuracy, completeness and F1 of the clouds of ETH3D's training set and of
               Strecha's fountain-P11 and Herz-Jesu-P8, before and after refinement
  ablation     ETH3D's training set without the joint filter (JHF), its discontinuity
               (DD) or confidence (CE), the refinement (ICR), its planes of superpixels
               (SP) or weighted medians (WMF), the segmentation (TS): the share of fused
               pixels, each surface once, that are right. It needs the depth maps
               SCENE/ground_truth_depth and SCENE/dslr_calibration_jpg (the archives
               SCENE_dslr_depth.7z and SCENE_dslr_jpg.7z)
  parameters   F1 of ETH3D's training set by the values of the paper's parameters

The layout of scenes is that of scripts/eth3d.sh and scripts/strecha.sh. Scenes that are
missing are named, and the means are then over fewer scenes than the paper's. The table of
Tanks and Temples is the server's: scripts/tanks_and_temples.sh --submit.

Each scene's maps are made once; OUTPUT/PRIOR/SCENE/variants/*.json keeps what was
measured, and the same command goes on where it stopped. By default everything is as in
the paper: --prior gp --preset paper --fusion paper, and maps of half the images'
size; --max_image_size sets another."""


def parameter_variant(option, factor, value, printed):
    """The variant for a value of a parameter. The paper's own choice, whose F1 is the same
    for all parameters, is that of both presets."""
    chosen = printed == paper.ETH3D["gp"][1][2]
    return FULL if chosen else f"{option}={value * factor:g}"


def variants(tables):
    """Name -> (an option of tsar_refine with its value, empty, or None for the maps before
    refinement; what is measured), for the scenes of ETH3D."""
    result = {}

    def add(name, experiment, measure):
        result.setdefault(name, (experiment, set()))[1].add(measure)

    for measure, wanted in (("cloud", "clouds"), ("fused_pixels", "ablation")):
        if wanted in tables:
            add(BEFORE, None, measure)
            add(FULL, "", measure)
    if "ablation" in tables:
        for name, experiment in ABLATION.items():
            add(name, experiment, "fused_pixels")
    if "parameters" in tables:
        for _, option, factor, values in paper.PARAMETERS:
            for value, printed in values.items() if option else ():
                name = parameter_variant(option, factor, value, printed)
                add(name, "" if name == FULL else name, "cloud")
    return result


def measure_variant(scene, args, programs, name, experiment, measures, truth):
    """Refines, fuses and scores one variant; returns its scores by measure. truth:
    measure -> options of tsar_evaluate with the ground truth."""
    input_type = dense.input_type_of(scene.folder / dense.WORKSPACE)
    plain = "".join(c if c.isalnum() or c in "=._-" else "_" for c in name)
    folder = scene.folder / "variants"
    refine = {"TsarRefine.preset": args.preset, **args.passed.get("tsar_refine", {})}
    if experiment:
        option, value = experiment.split("=")
        refine[f"TsarRefine.{option}"] = value
    command, fusion = dense.fusion_command(args, None)
    fuser = programs.tsar if command == "tsar_fuse" else programs.colmap

    def action(step):
        workspace, cloud = scene.folder / dense.WORKSPACE, folder / f"{plain}.ply"
        folder.mkdir(exist_ok=True)
        if experiment is not None:
            workspace = folder / plain
            step.run(programs.tsar, "tsar_refine", "--workspace_path", scene.folder / dense.WORKSPACE,
                     "--output_path", workspace, "--input_type", input_type, *as_words(refine))
        scores = {}
        if "cloud" in measures:
            dense.fuse_into(step, fuser, command, fusion, workspace, input_type, cloud)
            scores["cloud"] = dense.scores_of(step, programs, "cloud",
                                              {"input_path": cloud, **truth["cloud"]})
        if "fused_pixels" in measures:
            scores["fused_pixels"] = dense.scores_of(
                step, programs, "fused_pixels",
                {"workspace_path": workspace, "input_type": input_type, **truth["fused_pixels"]})
        write_text(folder / f"{plain}.json", json.dumps(scores, indent=1) + "\n")
        for left in (folder / plain, cloud, folder / f"{cloud.name}.vis"):
            remove(left)

    output = f"variants/{plain}.json"
    scene.step(f"variant_{plain}", action, outputs=[output], resumes=True, removes=False,
               after=["workspace", "stereo"], options={
                   "type": input_type, "refine": refine if experiment is not None else None,
                   "fusion": [command, fusion], "measures": sorted(measures),
                   "truth": {key: {k: str(v) for k, v in truth[key].items()} for key in measures},
                   **programs.versions})
    return json.loads((scene.folder / output).read_text(encoding="utf-8"))


def depth_truth(scene, path):
    """The folder of ground truth depth of a scene of ETH3D."""
    sizes = {}
    maps = scene.folder / dense.WORKSPACE / "stereo" / "depth_maps"
    for file in maps_of(scene.folder / dense.WORKSPACE):
        name = file.relative_to(maps).as_posix().rsplit(".", 2)[0]
        sizes[name] = map_size(file)
    folder = scene.folder / "ground_truth"
    scene.step("ground_truth", lambda step: eth3d_depth.write_depth(
        path, path / eth3d.CALIBRATION, sizes, folder), outputs=["ground_truth"],
        inputs=[path / eth3d_depth.DEPTH, path / eth3d_depth.CALIBRATION],
        after=["workspace", "stereo"])
    return folder


def run_eth3d(path, args, programs):
    """Variant -> scores of a scene."""
    wanted = variants(args.tables)
    scene = eth3d.open_workspace(path, args)
    dense.make_maps(scene, eth3d.scene_options(path, args), programs, None)
    truth = {"cloud": {"ground_truth_path": path / eth3d.SCANS, "tolerances": TOLERANCES}}
    if "ablation" in args.tables:
        truth["fused_pixels"] = {"ground_truth_path": depth_truth(scene, path),
                                 "tolerances": TOLERANCES}
    return {name: measure_variant(scene, args, programs, name, experiment, measures, truth)
            for name, (experiment, measures) in wanted.items()}


def run_strecha(path, args, programs, truth):
    scene, cameras, poses = strecha.open_workspace(path, args, programs)
    dense.make_maps(scene, strecha.scene_options(cameras, args), programs, None)
    project, options = strecha.prepare_truth(scene, truth, cameras, poses)
    truth = {"cloud": {"ground_truth_path": project, **options, "tolerances": TOLERANCES}}
    return {name: measure_variant(scene, args, programs, name, experiment, {"cloud"}, truth)
            for name, experiment in ((BEFORE, None), (FULL, ""))}


def cloud_row(scores):
    """Accuracy, completeness and F1 at 2 and at 10 cm."""
    return [100 * score[key] for score in scores["cloud"]["scores"]
            for key in ("accuracy", "completeness", "f1")]


def mean_rows(rows):
    rows = list(rows)
    return [sum(column) / len(rows) for column in zip(*rows)] if rows else None


def show(title, columns, rows):
    """Prints a table. rows: label and numbers; None: there are none."""
    widths = [max(7, len(column) + 1) for column in columns]
    print(f"\n{title}\n{'':<26}" + "".join(f"{c:>{w}}" for c, w in zip(columns, widths)))
    for label, values in rows:
        cells = [None] * len(columns) if values is None else values
        print(f"{label:<26}" + "".join(f"{'-' if v is None else format(v, '.2f'):>{w}}"
                                       for v, w in zip(cells, widths)), flush=True)


def show_clouds(title, prior, printed, ours):
    """ours: scores by variant, one entry per scene."""
    columns = [f"{name}@{size}" for size in ("2cm", "10cm") for name in ("Acc", "Comp", "F1")]
    rows = []
    for (name, values), variant in zip(zip(("before", "after"), printed), (BEFORE, FULL)):
        rows += [(f"{prior} {name}, paper", values),
                 (f"{prior} {name}, ours", mean_rows(cloud_row(s[variant]) for s in ours))]
    show(title, columns, rows)


def show_eth3d(args, ours):
    """ours: scene -> variant -> scores."""
    missing = [name for name in eth3d.TRAINING if name not in ours]
    if missing:
        print(f"\nETH3D: {len(missing)} of {len(eth3d.TRAINING)} scenes are missing, so that means "
              f"are not the paper's: {', '.join(missing)}")
    if "clouds" in args.tables:
        show_clouds("ETH3D, training set, mean of the scenes", args.prior, paper.ETH3D[args.prior],
                    ours.values())
    if "ablation" in args.tables:
        for index, tolerance in enumerate((0.02, 0.1)):
            right = lambda scene, name: 100 * ours[scene][name]["fused_pixels"]["scores"][index]["right"]
            rows = []
            for name, printed in paper.ABLATION[tolerance].items():
                there = [right(scene, name) for scene in ours]
                mean = sum(there) / len(there)
                rows += [(f"{name}, paper", printed), (f"{name}, ours", [mean, *(
                    right(scene, name) if scene in ours else None
                    for scene in paper.ABLATION_SCENES)])]
            show(f"Fused pixels right to {100 * tolerance:g} cm (the paper's with the prior gp)",
                 ["mean", *paper.ABLATION_SCENES], rows)
    if "parameters" in args.tables:
        f1 = lambda *parameter: mean_rows([cloud_row(s[parameter_variant(*parameter)])[2]]
                                          for s in ours.values())[0]
        for symbol, option, factor, printed in paper.PARAMETERS:
            show(f"F1 at 2 cm by {symbol}" + (f" ({option})" if option else ", which is no option here"),
                 list(map(str, printed)),
                 [("paper", printed.values()), ("ours", option and [
                     f1(option, factor, *pair) for pair in printed.items()])])


def truth_of(folder, path):
    """The ground truth of a scene of Strecha's, among those of all scenes."""
    found = [file for ending in (".mlp", ".ply") for file in
             (folder / f"{path.name}{ending}", folder / path.name / f"scan_alignment{ending}")
             if file.is_file()]
    if not found:
        raise DatasetError(f"{folder}: has neither {path.name}.ply nor {path.name}.mlp, to score "
                           f"{path.name} against")
    return found[0]


def read_eth3d(args):
    scenes = [path for path in find_scenes(args.eth3d, eth3d.is_scene, eth3d.CALIBRATION)
              if (path / eth3d.SCANS).is_file()]
    if not scenes:
        raise DatasetError(f"{args.eth3d}: has no scene with scans ({eth3d.SCANS})")
    for path in scenes:
        eth3d.check_scene(path)
        if "ablation" in args.tables and not eth3d_depth.has_depth(path):
            raise DatasetError(f"{path / eth3d_depth.DEPTH}: not found; --tables ablation needs it "
                               f"and {eth3d_depth.CALIBRATION}")
    return scenes


def run(args, programs):
    if not args.eth3d and not args.strecha:
        raise DatasetError("nothing to do: give --eth3d or --strecha")
    if args.strecha and not args.ground_truth:
        raise DatasetError("--strecha: needs --ground_truth")
    args.paper_size = args.max_image_size is None
    args.output_path = pathlib.Path(args.output_path) / args.prior
    eth3d_scenes = read_eth3d(args) if args.eth3d else []
    strecha_scenes = []
    if args.strecha and "clouds" in args.tables:
        for path in find_scenes(args.strecha, lambda p: bool(strecha.camera_files(p)),
                                f"{strecha.ENDING} files"):
            strecha.read_scene(path)
            if strecha.kind(path.name) in paper.STRECHA:
                strecha_scenes.append((path, truth_of(pathlib.Path(args.ground_truth).resolve(), path)))
    results = {path.name: run_eth3d(path, args, programs) for path in eth3d_scenes}
    clouds = [(path.name, run_strecha(path, args, programs, truth)) for path, truth in strecha_scenes]
    print(f"\n{programs.versions['colmap_tsar']}, preset {args.preset}, fusion {args.fusion}")
    if results:
        show_eth3d(args, results)
    for name, scores in clouds:
        show_clouds(f"Strecha, {name}", args.prior, paper.STRECHA[strecha.kind(name)][args.prior],
                    [scores])


def main():
    parser = new_parser("paper_tables", DESCRIPTION, EPILOG)
    parser.add_argument("--output_path", required=True, metavar="OUTPUT",
                        help="folder for all that is made")
    parser.add_argument("--eth3d", metavar="SCENES", help="scenes of ETH3D's training set, with scans")
    parser.add_argument("--strecha", metavar="SCENES", help="scenes of Strecha's data")
    parser.add_argument("--ground_truth", metavar="FOLDER", help="of --strecha: SCENE.ply, a mesh, or "
                        "SCENE.mlp, a MeshLab project of scans")
    parser.add_argument("--tables", choices=TABLES, nargs="+", default=list(TABLES),
                        help="which tables (default: all)")
    add_prior_options(parser)
    add_options(parser, "OUTPUT/PRIOR/SCENE")
    parser.set_defaults(prior="gp", preset="paper", fusion="paper", max_image_size=None)
    run_main(parser, run)


if __name__ == "__main__":
    main()
