#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Checks a COLMAP that was built with one of patches/: that it has the commands
of the stand-alone program, that they do the same, that it reads its options as
COLMAP's commands do, and that its own fusion takes the result."""
import configparser
import json
import os
import shutil

from sample_testing import call, check, parse_arguments, results, run, score, unpack

args = parse_arguments("program", "colmap", "repository", "folder")


def path(*names):
    return os.path.join(args.folder, *names)


def commands(program):
    """The commands that a program's help lists, and their summaries if any."""
    lines = run(program, "help").splitlines()
    return {line.split()[0] for line in lines if line.startswith("  tsar_")}


def fails_with_one_line(*arguments, text):
    result = call(args.colmap, "tsar_refine", *arguments)
    check(
        result.returncode == 1
        and result.stderr.startswith("ERROR: ")
        and result.stderr.count("\n") == 1
        and text in result.stderr,
        f"{' '.join(arguments)} gives one line with '{text}' and exit code 1",
    )


shutil.rmtree(args.folder, ignore_errors=True)
os.makedirs(args.folder)
sample = path("sample")
unpack(args.repository, sample)

check(
    commands(args.colmap) == commands(args.program) and "tsar_refine" in commands(args.colmap),
    "colmap help lists all commands of the stand-alone program",
)
check("stereo_fusion" in run(args.colmap, "help"), "colmap's own commands are there")
help_text = run(args.colmap, "tsar_refine", "-h")
check(
    help_text.replace("colmap tsar_refine", "colmap_tsar tsar_refine")
    == run(args.program, "tsar_refine", "-h"),
    "the help differs in the program's name alone",
)
check("colmap tsar_refine --workspace_path" in help_text, "and shows that name")

fails_with_one_line("--workspace_path", path("nowhere"), text="nowhere")
fails_with_one_line("--workspace_path", sample, "--TsarRefine.devise", "cpu", text="--TsarRefine.devise")
fails_with_one_line("--workspace_path", sample, "--TsarRefine.num_threads", "9999", text="num_threads")

# A project file of COLMAP's own, with one more section.
project = path("project.ini")
run(args.colmap, "project_generator", "--output_path", project, "--quality", "medium")
configuration = configparser.ConfigParser()
with open(project, encoding="utf-8") as file:
    configuration.read_string("[General]\n" + file.read())
check(
    configuration["PatchMatchStereo"].get("write_cost_maps") in ("0", "false"),
    "colmap's project files have write_cost_maps, off",
)
result = call(args.colmap, "automatic_reconstructor", "-h")
for option in ("--tsar ", "--tsar_stereo "):
    check(option in result.stdout + result.stderr, f"automatic_reconstructor lists {option}")
result = call(args.colmap, "patch_match_stereo", "-h")
stereo_help = result.stdout + result.stderr
if "requires CUDA" not in stereo_help:  # Without it, this command has no help.
    check(
        "PatchMatchStereo.write_cost_maps" in stereo_help,
        "patch_match_stereo lists write_cost_maps",
    )
with open(project, "a", encoding="utf-8") as file:
    file.write("[TsarRefine]\nseed=3\ndevice=cpu\n")
before = score(args.colmap, args.colmap, sample)
by_module, by_program = path("by_module"), path("by_program")
for program, output in ((args.colmap, by_module), (args.program, by_program)):
    run(program, "tsar_refine", "--project_path", project, "--workspace_path", sample,
        "--output_path", output)
with open(os.path.join(by_module, "stereo", "tsar", "manifest.json"), encoding="utf-8") as file:
    check(json.load(file)["options"]["seed"] == "3", "the project's section is read")


check(len(results(by_module)) > 5 * 8, "all maps are written")
check(results(by_module) == results(by_program), "colmap and colmap_tsar write the same bytes")
after = score(args.colmap, args.colmap, by_module, sample)
print("before", before)
print("after ", after)
check(after["f1"] > before["f1"] + 0.15, "F1 at 2 cm of its own fusion rises by over 0.15")

with open(project, "a", encoding="utf-8") as file:
    file.write("num_iteration=3\n")
fails_with_one_line("--project_path", project, "--workspace_path", sample, text="num_iteration")

run(args.colmap, "tsar_report", "--workspace_path", by_module, "--report_path", path("report"))
check(os.path.getsize(path("report/index.html")) > 0, "tsar_report writes a page")
