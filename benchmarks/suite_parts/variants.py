# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""The named sets of options that a suite runs."""

import json
import shlex

from programs import CommandFailed, run
from suite_parts.simulated_priors import KINDS, name_of

# Parts of the method that --help lists, besides those that --help_all does.
OPTIONS = ("TsarRefine.scene_planes",)
DEFAULT = "default"


def ask_options(program):
    """What the program says about the options of tsar_refine."""
    return json.loads(run([program, "tsar_refine", "--help_json"]))["options"]


def read_variant(text):
    name, equals, options = text.partition("=")
    if not name or not equals:
        raise CommandFailed(f"--variant {text}: it is not NAME='OPTIONS'")
    return name, shlex.split(options)


def method_of(options):
    """(name, what is said about it, words that set it to {}) of each part."""
    for option in options:
        name = option["name"]
        if name in OPTIONS or (name.startswith("TsarRefine.") and option["advanced"]):
            yield name.split(".")[-1], option, [f"--{name}", "{}"]


def ablations(options):
    """Each switch toggled, and each preset."""
    for name, told, words in method_of(options):
        if told["value"] != "0|1":
            continue
        if told["default"] == "1":
            yield f"without {name}", [word.format(0) for word in words]
        else:
            yield f"with {name}", [word.format(1) for word in words]
    for option in options:
        if option["name"] == "TsarRefine.preset":
            for preset in option["choices"]:
                if preset != option["default"]:
                    yield f"preset {preset}", [f"--{option['name']}", preset]


def sensitivities(options):
    """Each number halved and doubled, within its range."""
    for name, told, words in method_of(options):
        if told["value"] in ("INT", "NUMBER") and float(told["default"]) > 0:
            default = float(told["default"])
            half = default // 2 if told["value"] == "INT" else default / 2
            for value in (half, min(2 * default, told["max"])):
                yield (f"{name} {value:g}",
                       [word.format(f"{value:g}") for word in words])


def simulated(kind):
    """A depth prior of this kind, whose folder is known once the scene is."""
    return ["--prior_path", name_of(kind)]


def make_variants(given, ablation, sensitivity, priors, extra, options):
    """Name -> options, in the order of the tables.

    given: texts NAME=OPTIONS; priors: whether with simulated depth priors as
    well; extra: options for all runs; options: what ask_options() returns.
    """
    variants = dict(read_variant(text) for text in given)
    if len(variants) < len(given):
        raise CommandFailed("--variant: two have the same name")
    if not variants or ablation or sensitivity or priors:
        variants = {DEFAULT: [], **variants}
    if priors:
        variants.update({f"{kind} prior": simulated(kind) for kind in KINDS})
    if ablation:
        variants.update(ablations(options))
    if sensitivity:
        variants.update(sensitivities(options))
    return {name: shlex.split(extra) + words for name, words in variants.items()}
