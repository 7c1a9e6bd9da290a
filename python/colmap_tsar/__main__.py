# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""python -m colmap_tsar export: what the program colmap_tsar leaves to Python."""
import argparse
import shlex
import sys

import colmap_tsar

from . import _export

_TRAINING = {
    "nerfstudio": "ns-train depth-nerfacto --data {}",
    "3dgs": "python train.py -s {} -d depths",
}


def _parse(arguments):
    parser = argparse.ArgumentParser(prog="python -m colmap_tsar", allow_abbrev=False)
    commands = parser.add_subparsers(metavar="COMMAND", required=True)
    text = "export depth, normals and more for other programs; docs/export.md tells the formats"
    command = commands.add_parser("export", help=text, description=text, allow_abbrev=False)
    for name, text in (
        ("workspace_path", "the dense workspace"),
        ("output_path", "the folder to write"),
    ):
        command.add_argument(f"--{name}", metavar="PATH", required=True, help=text)
    command.add_argument("--format", choices=_export.FORMATS, required=True, help="what to write")
    text = "if not given: geometric, or photometric where only those were refined or are there"
    command.add_argument("--input_type", choices=("geometric", "photometric"), help=text)
    for name, text in (
        ("mask_path", "no depth where a mask is black; nerfstudio gets the masks as well"),
        ("cloud_path", "nerfstudio: a cloud (PLY) that its methods start from"),
    ):
        command.add_argument(f"--{name}", metavar="PATH", help=text)
    text = "png16: units of the sparse model per step of depth; 0.001: millimeters of meters"
    command.add_argument("--depth_scale", type=float, default=_export.DEPTH_SCALE, help=text)
    text = "replace an earlier export; a folder with anything else in it is never touched"
    command.add_argument("--overwrite", type=int, choices=(0, 1), default=0, help=text)
    return parser.parse_args(arguments)


def main(arguments=None):
    options = vars(_parse(arguments))
    path = options.pop("workspace_path")
    options["overwrite"] = options["overwrite"] == 1
    try:
        workspace = colmap_tsar.Workspace(path, input_type=options.pop("input_type"))
        summary = workspace.export(**options)
    except KeyboardInterrupt:
        print("ERROR: interrupted; nothing was exported", file=sys.stderr)
        return 1
    except (colmap_tsar.Error, ImportError, OSError) as error:
        print("ERROR:", str(error).encode("utf-8", "replace").decode(), file=sys.stderr)
        return 1
    share = 100 * summary.num_depths / summary.num_pixels
    print(f"Exported {summary.num_images} images to {summary.output_path}")
    print(f"  with depth: {summary.num_with_depth} images, {share:.4g} % of all pixels")
    if summary.num_masks is not None:
        print(f"  masks for {summary.num_masks} of {summary.num_images} images")
    if options["format"] in _TRAINING:
        print("Train with:", _TRAINING[options["format"]].format(shlex.quote(str(summary.output_path))))
    return 0


if __name__ == "__main__":
    sys.exit(main())
