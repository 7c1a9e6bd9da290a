# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""What the scripts' command lines have in common."""
import argparse
import pathlib
import re
import signal
import sys

from files import DatasetError
from programs import Programs

STEREO_HELP = """\
where the depth maps come from: tsar, tsar_stereo of this project, unless --prior is given;
colmap, its patch_match_stereo (with a COLMAP that has CUDA and an NVIDIA GPU); none,
nowhere: put the maps into {}/dense/stereo yourself"""
PRESETS = ("default", "paper")
# The preset of tsar_fuse; None: stereo_fusion fuses.
FUSIONS = {"tsar": "default", "paper": "paper", "colmap": None}
FUSION_HELP = """\
what fuses the maps, before and after refinement alike: tsar, tsar_fuse,
which weights depths by their precision and confidence; paper, tsar_fuse as the paper
fuses: depths within 1 %%, normals within 30 degrees, pixels within 2, the mean of
what agrees; colmap, stereo_fusion (default: %(default)s)"""

PRIORS = {"gp": "tsar", "mp": "acm", "acmm": "acm", "colmap": "colmap"}  # Where the maps come from.
GP_OPTIONS = {"TsarStereo.geom_consistency": 0}
PRIOR_HELP = """\
the maps to refine by the names of the paper's tables, in place of --stereo: gp, of
tsar_stereo without its geometric passes, the nearest to the paper's Gipuma; mp and
acmm, ACMMP's and ACMM's from --maps_path; colmap, of patch_match_stereo"""
MAPS_HELP = """\
of --prior mp and acmm: the results of ACMMP or ACMM, MAPS/SCENE/ as tsar_import
--format acm takes them, and MAPS/SCENE/runtime.txt with the line "runtime SECONDS",
how long they took, which a submission needs"""


def new_parser(script, description, epilog=None):
    return argparse.ArgumentParser(
        prog=f"scripts/{script}.sh", description=description, epilog=epilog, allow_abbrev=False,
        formatter_class=argparse.RawDescriptionHelpFormatter)


EPILOG = """\
Options with a dot go to the command that has them, such as --TsarRefine.min_confidence
0.3, --TsarRefine.filter 0 or --TsarStereo.num_levels 3 (colmap COMMAND -h,
colmap_tsar COMMAND --help)."""


def make_parser(script, description, scene_help, sets, submit_help):
    """The command line of a data set's script. sets: names of the scenes that are
    submitted together, by the name of the set."""
    parser = new_parser(script, description, EPILOG)
    parser.add_argument("scene", metavar="SCENE", help=scene_help)
    parser.add_argument("--output_path", required=True, metavar="OUTPUT",
                        help="folder for all that is made; run again with the same one, "
                        "it goes on where it stopped")
    parser.add_argument("--submit", choices=tuple(sets), help=submit_help)
    parser.add_argument("--paper_size", action="store_true", help="maps of the paper's size "
                        "(half the images' for ETH3D and Strecha, all of it for Tanks and "
                        "Temples) instead of --max_image_size")
    add_prior_options(parser)
    add_options(parser, "OUTPUT/SCENE")
    return parser


def add_prior_options(parser):
    parser.add_argument("--prior", choices=tuple(PRIORS), help=PRIOR_HELP)
    parser.add_argument("--maps_path", metavar="MAPS", help=MAPS_HELP)


def at_paper_size(args, longer_side, fraction):
    """The options for a scene whose images have this longer side, of which the paper
    takes a fraction."""
    if not args.paper_size:
        return args
    return argparse.Namespace(**{**vars(args), "max_image_size": round(longer_side * fraction)})


def add_options(parser, scene_folder):
    """The options from the workspace to the clouds."""
    parser.add_argument("--stereo", choices=("tsar", "colmap", "none"),
                        help=STEREO_HELP.format(scene_folder))
    parser.add_argument("--max_image_size", type=int, default=3200, metavar="PIXELS",
                        help="longer side of the depth maps; larger images are reduced "
                        "(default: 3200)")
    parser.add_argument("--preset", choices=PRESETS, default=PRESETS[0],
                        help="preset of tsar_refine (default: %(default)s)")
    parser.add_argument("--fusion", choices=tuple(FUSIONS), default="tsar", help=FUSION_HELP)
    parser.add_argument("--min_num_pixels", type=int, metavar="N",
                        help="views that must see a point of either cloud, the reference view "
                        "among them (default: 2 for tsar_fuse, 3 with --fusion paper, 5 for "
                        "stereo_fusion)")
    parser.add_argument("--colmap", metavar="PATH", help="COLMAP (default: the one on the path)")
    parser.add_argument("--colmap_tsar", metavar="PATH", help="this project's program "
                        "(default: build/bin/colmap_tsar, or the one on the path)")


def take_passed(words):
    """Takes options of the programs, --Group.name VALUE, out of a command line.
    Returns the other words, and those options, name by value."""
    others, passed, words = [], {}, list(words)
    while words:
        word = words.pop(0)
        found = re.fullmatch(r"--([A-Z]\w*\.\w+)(?:=(.*))?", word, re.DOTALL)
        if not found:
            others.append(word)
            continue
        name, value = found.groups()
        if value is None:
            if not words or words[0].startswith("--"):
                raise DatasetError(f"--{name}: has no value")
            value = words.pop(0)
        passed[name] = value
    return others, passed


def hand_out(passed, programs, commands):
    """The options of each of these commands: an option is of the first one whose
    help names it."""
    given = {command: {} for command in commands}
    for name, value in passed.items():
        known = re.compile(rf"^\s*--{re.escape(name)}(\s|$)", re.MULTILINE)
        command = next((c for c in commands if known.search(programs.help_of(c))), None)
        if command is None:
            raise DatasetError(f"--{name}: none of the commands of this run has this option; "
                               f"they are {', '.join(commands)}")
        given[command][name] = value
    return given


def dense_commands(args):
    """The commands from the workspace to the clouds that take options from the
    command line."""
    stereo = {"colmap": ["patch_match_stereo"], "tsar": ["tsar_stereo"]}.get(args.stereo, [])
    fusion = "tsar_fuse" if FUSIONS[args.fusion] else "stereo_fusion"
    return [*stereo, "tsar_refine", fusion]


def choose_stereo(args, programs):
    """Where the maps come from, by --stereo or --prior."""
    prior = getattr(args, "prior", None)
    if prior and args.stereo:
        raise DatasetError(f"--prior {prior} and --stereo {args.stereo}: both say where the maps "
                           "come from; give one of them")
    if getattr(args, "maps_path", None) and PRIORS.get(prior) != "acm":
        raise DatasetError("--maps_path: is for --prior mp and acmm")
    args.stereo = PRIORS[prior] if prior else args.stereo or "tsar"
    if args.stereo == "colmap" and not programs.colmap_has_stereo:
        raise DatasetError(f"{f'--prior {prior}' if prior else '--stereo colmap'}: "
                           f"{programs.colmap} has no CUDA, or there is no NVIDIA GPU; use "
                           f"{'--prior gp' if prior else '--stereo tsar'} or name another by "
                           "--colmap")
    if args.stereo == "acm" and not args.maps_path:
        raise DatasetError(f"--prior {prior}: needs --maps_path, the folder with the maps")
    if args.stereo == "acm" and not pathlib.Path(args.maps_path).is_dir():
        raise DatasetError(f"--maps_path {args.maps_path}: no such folder")


def run_main(parser, run, commands_of=dense_commands):
    """Calls run(args, programs) and turns what goes wrong into one line.
    commands_of(args): the programs' commands that take options from the command
    line."""
    # So that a program at work is ended too; with nohup, it outlives its terminal.
    signal.signal(signal.SIGTERM, lambda number, _: sys.exit(128 + number))
    if signal.getsignal(signal.SIGHUP) != signal.SIG_IGN:
        signal.signal(signal.SIGHUP, lambda number, _: sys.exit(128 + number))
    try:
        words, passed = take_passed(sys.argv[1:])
        args = parser.parse_args(words)
        for name in ("photos", "scene", "output", "output_path"):
            if getattr(args, name, None) == "":  # That would be the current folder.
                raise DatasetError(f"{name}: is empty; name a folder")
        if args.max_image_size is not None and args.max_image_size < 16:
            raise DatasetError(f"--max_image_size {args.max_image_size}: is below 16")
        if args.min_num_pixels is not None and args.min_num_pixels < 1:
            raise DatasetError(f"--min_num_pixels {args.min_num_pixels}: is below 1")
        programs = Programs(args.colmap, args.colmap_tsar)
        choose_stereo(args, programs)
        args.passed = hand_out(passed, programs, commands_of(args)) if passed else {}
        if getattr(args, "prior", None) == "gp":
            args.passed["tsar_stereo"] = {**GP_OPTIONS, **args.passed.get("tsar_stereo", {})}
        run(args, programs)
    except DatasetError as error:
        sys.exit(f"ERROR: {error}")
    except OSError as error:
        sys.exit(f"ERROR: {error.filename}: {error.strerror}" if error.filename
                 else f"ERROR: {error.strerror or error}")
    except KeyboardInterrupt:
        sys.exit("stopped; the same command goes on from here")
