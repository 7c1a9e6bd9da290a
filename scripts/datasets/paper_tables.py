# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""The tables of the paper, with ours beside them; see scripts/paper_tables.sh."""
import json
import os
import pathlib
import statistics

import dense
import eth3d
import eth3d_depth
import paper_results as paper
import strecha
from command_line import EPILOG, add_options, add_prior_options, new_parser, run_main
from files import DatasetError, find_scenes, write_text
from programs import as_words
from steps import remove
from model import read_cameras, read_images
from workspace import map_size, maps_of

TOLERANCES = "0.02,0.1"
FULL, BEFORE = "TSAR-MVS", "prior"
ABLATION = {"w/o JHF": "filter=0", "w/o DD": "filter_discontinuity=0",
            "w/o CE": "filter_confidence=0", "w/o ICR": "refine=0",
            "w/o SP": "superpixel_planes=0", "w/o WMF": "weighted_median=0",
            "w/o TS": "segment=0"}
TABLES = ("clouds", "ablation", "parameters")
# For an estimate only, per megapixel of maps: seconds of a GPU or of one core, and
# megabytes of the maps of an image and of one refinement.
STEREO_SECONDS = {True: 0.2, False: 60 * dense.STEREO_MINUTES}
REFINE_SECONDS = {True: 0.03, False: 12}
MEGABYTES = 115

DESCRIPTION = """\
Runs what the tables of the TSAR-MVS paper show, on data that you have, and prints
each of them with our numbers below the paper's, in per cent:

  clouds       accuracy, completeness and F1 of the clouds of ETH3D's training set and of
               Strecha's fountain-P11 and Herz-Jesu-P8, before and after refinement
  ablation     ETH3D's training set without the joint filter (JHF), its discontinuity
               (DD) or confidence (CE), the refinement (ICR), its planes of superpixels
               (SP) or weighted medians (WMF), the segmentation (TS): the pixels that
               became a point and are right, as a share of those with ground truth,
               which the paper's most likely are, and of those that became a point
               ("of fused"). It needs the depth maps
               SCENE/ground_truth_depth and SCENE/dslr_calibration_jpg (the archives
               SCENE_dslr_depth.7z and SCENE_dslr_jpg.7z)
  parameters   F1 of ETH3D's training set by the values of the paper's parameters

The layout of scenes is that of scripts/eth3d.sh and scripts/strecha.sh. Scenes that are
missing are named, and the means are then over fewer scenes than the paper's. The table of
Tanks and Temples is the server's: scripts/tanks_and_temples.sh --submit.

Each scene's maps are made once; OUTPUT/PRIOR/SCENE/variants/*.json keeps what was
measured, and the same command goes on where it stopped. The tables are also written to
OUTPUT/PRIOR/tables.json. By default everything is as in
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


def measure_seeds(scene, args, programs, name, experiment, measures, truth):
    """The scores of a variant by measure, for each seed of the refinement."""
    seeds = range(args.seeds) if experiment is not None else [0]
    scores = [measure_variant(scene, args, programs, name, experiment, measures, truth, seed)
              for seed in seeds]
    return scores if experiment is not None else scores * args.seeds


def measure_variant(scene, args, programs, name, experiment, measures, truth, seed):
    """Refines, fuses and scores one variant; returns its scores by measure. truth:
    measure -> options of tsar_evaluate with the ground truth."""
    input_type = dense.input_type_of(scene.folder / dense.WORKSPACE)
    plain = "".join(c if c.isalnum() or c in "=._-" else "_" for c in name)
    plain += f".seed{seed}" if seed else ""
    folder = scene.folder / "variants"
    refine = {"TsarRefine.preset": args.preset, **args.passed.get("tsar_refine", {})}
    if seed:
        refine["TsarRefine.seed"] = seed
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


def check_sizes(scene, args, cameras):
    """That imported maps have the size that is asked for."""
    if args.stereo != "acm":
        return
    wanted = min(args.max_image_size, max(max(c.width, c.height) for c in cameras.values()))
    size = max(max(map_size(path)) for path in maps_of(scene.folder / dense.WORKSPACE))
    if abs(size - wanted) > 1:
        raise DatasetError(f"{dense.given_maps(args, scene.name)}: has maps of {size} pixels, and "
                           f"those of this table have {wanted}; make them of that size, or give "
                           f"--max_image_size {size}")


def run_eth3d(path, args, programs):
    """Variant -> scores of a scene by seed."""
    wanted = variants(args.tables)
    scene = eth3d.open_workspace(path, args)
    options = eth3d.scene_options(path, args)
    dense.make_maps(scene, options, programs, None)
    check_sizes(scene, options, read_cameras(path / eth3d.CALIBRATION / "cameras.txt"))
    truth = {"cloud": {"ground_truth_path": path / eth3d.SCANS, "tolerances": TOLERANCES}}
    if "ablation" in args.tables:
        truth["fused_pixels"] = {"ground_truth_path": depth_truth(scene, path),
                                 "tolerances": TOLERANCES}
    return {name: measure_seeds(scene, args, programs, name, experiment, measures, truth)
            for name, (experiment, measures) in wanted.items()}


def run_strecha(path, args, programs, truth):
    scene, cameras, poses = strecha.open_workspace(path, args, programs)
    options = strecha.scene_options(cameras, args)
    dense.make_maps(scene, options, programs, None)
    check_sizes(scene, options, cameras)
    project, options = strecha.prepare_truth(scene, truth, cameras, poses)
    truth = {"cloud": {"ground_truth_path": project, **options, "tolerances": TOLERANCES}}
    return {name: measure_seeds(scene, args, programs, name, experiment, {"cloud"}, truth)
            for name, experiment in ((BEFORE, None), (FULL, ""))}


def cloud_row(scores):
    """Accuracy, completeness and F1 at 2 and at 10 cm."""
    return [100 * score[key] for score in scores["cloud"]["scores"]
            for key in ("accuracy", "completeness", "f1")]


def mean_rows(rows):
    rows = list(rows)
    return [sum(column) / len(rows) for column in zip(*rows)] if rows else None


def rows_of_seeds(label, rows):
    """The median of the rows of the seeds and, of several, half their range."""
    columns = list(zip(*rows))
    result = [(label, [None if None in column else statistics.median(column) for column in columns])]
    if len(rows) > 1:
        result.append((f"{label}, ±", [None if None in column else (max(column) - min(column)) / 2
                                       for column in columns]))
    return result


class Tables:
    """Prints tables and keeps their numbers."""

    def __init__(self):
        self.tables = {}

    def show(self, title, columns, rows):
        """rows: label and numbers; None: there are none."""
        rows = [(label, [None] * len(columns) if values is None else list(values))
                for label, values in rows]
        self.tables[title] = {label: dict(zip(columns, values)) for label, values in rows}
        widths = [max(7, len(column) + 1) for column in columns]
        print(f"\n{title}\n{'':<30}" + "".join(f"{c:>{w}}" for c, w in zip(columns, widths)))
        for label, values in rows:
            print(f"{label:<30}" + "".join(f"{'-' if v is None else format(v, '.2f'):>{w}}"
                                           for v, w in zip(values, widths)), flush=True)


def show_clouds(tables, title, prior, printed, ours):
    """ours: for each scene, the scores of each seed by variant."""
    columns = [f"{name}@{size}" for size in ("2cm", "10cm") for name in ("Acc", "Comp", "F1")]
    rows = []
    for (name, values), variant in zip(zip(("before", "after"), printed), (BEFORE, FULL)):
        rows.append((f"{prior} {name}, paper", values))
        rows += rows_of_seeds(f"{prior} {name}, ours", [
            mean_rows(map(cloud_row, scores)) for scores in zip(*(s[variant] for s in ours))])
    tables.show(title, columns, rows)


def ablation_rows(ours, name, index, share):
    """For each seed, the mean of a variant over the scenes, and each of the paper's scenes."""
    right = {scene: [100 * scores["fused_pixels"]["scores"][index][share]
                     for scores in of_scene[name]] for scene, of_scene in ours.items()}
    return [[sum(values) / len(values), *(right[scene][seed] if scene in right else None
                                          for scene in paper.ABLATION_SCENES)]
            for seed, values in enumerate(zip(*right.values()))]


def show_eth3d(tables, args, ours):
    """ours: scene -> variant -> scores of each seed."""
    missing = [name for name in eth3d.TRAINING if name not in ours]
    if missing:
        print(f"\nETH3D: {len(missing)} of {len(eth3d.TRAINING)} scenes are missing, so that means "
              f"are not the paper's: {', '.join(missing)}")
    if "clouds" in args.tables:
        show_clouds(tables, "ETH3D, training set, mean of the scenes", args.prior,
                    paper.ETH3D[args.prior], ours.values())
    if "ablation" in args.tables:
        for index, tolerance in enumerate((0.02, 0.1)):
            rows = []
            for name, printed in paper.ABLATION[tolerance].items():
                rows.append((f"{name}, paper", printed))
                for share, label in (("of_known", "ours"), ("of_fused", "ours of fused")):
                    rows += rows_of_seeds(f"{name}, {label}", ablation_rows(ours, name, index, share))
            tables.show(f"Fused pixels right to {100 * tolerance:g} cm (the paper's with the prior gp)",
                        ["mean", *paper.ABLATION_SCENES], rows)
    if "parameters" in args.tables:
        def f1(*parameter):
            return [mean_rows([cloud_row(score)[2]] for score in scores)[0] for scores in zip(
                *(of_scene[parameter_variant(*parameter)] for of_scene in ours.values()))]

        for symbol, option, factor, printed in paper.PARAMETERS:
            by_seed = option and list(zip(*(f1(option, factor, *pair) for pair in printed.items())))
            tables.show(
                f"F1 at 2 cm by {symbol}" + (f" ({option})" if option else ", which is no option here"),
                list(map(str, printed)),
                [("paper", printed.values()),
                 *(rows_of_seeds("ours", by_seed) if option else [("ours", None)])])


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
    if args.seeds < 1:
        raise DatasetError(f"--seeds {args.seeds}: is below 1")
    if args.seeds > 1 and "TsarRefine.seed" in args.passed.get("tsar_refine", {}):
        raise DatasetError("--seeds and --TsarRefine.seed: both name seeds; give one of them")
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
    tell_effort(args, programs, eth3d_scenes)
    results = {path.name: run_eth3d(path, args, programs) for path in eth3d_scenes}
    clouds = [(path.name, run_strecha(path, args, programs, truth)) for path, truth in strecha_scenes]
    tables = Tables()
    print(f"\n{programs.versions['colmap_tsar']}, preset {args.preset}, fusion {args.fusion}, "
          f"{args.seeds} seed{'s' if args.seeds > 1 else ''}")
    if results:
        show_eth3d(tables, args, results)
    for name, scores in clouds:
        show_clouds(tables, f"Strecha, {name}", args.prior,
                    paper.STRECHA[strecha.kind(name)].get(args.prior, (None, None)), [scores])
    write_text(args.output_path / "tables.json", json.dumps(
        {**programs.versions, "preset": args.preset, "fusion": args.fusion, "seeds": args.seeds,
         "tables": tables.tables}, indent=1) + "\n")


def tell_effort(args, programs, scenes):
    """How long the scenes of ETH3D will take, and the disk that they need, roughly."""
    megapixels = []
    for path in scenes:
        size = eth3d.scene_options(path, args).max_image_size
        cameras = read_cameras(path / eth3d.CALIBRATION / "cameras.txt")
        megapixels.append(sum(
            dense.megapixels(camera.width, camera.height, size)
            for camera in (cameras[image.camera_id]
                           for image in read_images(path / eth3d.CALIBRATION / "images.txt"))))
    if not megapixels:
        return
    experiments = [experiment for experiment, _ in variants(args.tables).values()]
    num_runs = args.seeds * sum(experiment is not None for experiment in experiments)
    on_gpu = programs.tsar_uses_gpu
    seconds = num_runs * REFINE_SECONDS[on_gpu] + (STEREO_SECONDS[on_gpu] if args.stereo == "tsar" else 0)
    hours = sum(megapixels) * seconds / 3600 / (1 if on_gpu else os.cpu_count() or 1)
    print(f"ETH3D: {num_runs} refinements of each scene, {sum(megapixels):.0f} megapixels of maps: some "
          f"{hours:.1f} hours without fusion and scores, and {sum(megapixels) * MEGABYTES / 1e3:.0f} GB of disk",
          flush=True)


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
    parser.add_argument("--seeds", type=int, default=1, metavar="N", help="refine with "
                        "--TsarRefine.seed 0 to N - 1, and print medians and half the range (default: 1)")
    add_prior_options(parser)
    add_options(parser, "OUTPUT/PRIOR/SCENE")
    parser.set_defaults(prior="gp", preset="paper", fusion="paper", max_image_size=None)
    run_main(parser, run)


if __name__ == "__main__":
    main()
