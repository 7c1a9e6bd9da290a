# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""The two programs that do the work: where they are and what they can."""
import functools
import os
import pathlib
import re
import shutil
import subprocess

from files import DatasetError

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]


def output_of(*command):
    """All that a program prints, whatever its exit code."""
    return subprocess.run(
        [str(part) for part in command], stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace",
        env=dict(os.environ, QT_QPA_PLATFORM="offscreen")).stdout


def as_words(options):
    """Options, name by value, as words of a command line."""
    return [word for name, value in options.items() for word in (f"--{name}", value)]


def files_named_by(options):
    """The files and folders whose contents are inputs of a command with these
    options."""
    return [pathlib.Path(value).resolve() for name, value in options.items()
            if name.endswith(("mask_path", "prior_path", "vocab_tree_path"))
            and os.path.exists(value)]


def find_program(given, candidates, option):
    """The full path of the program named by an option, or of the first candidate
    that is there."""
    for name in [given] if given else candidates:
        found = shutil.which(name)
        if found:
            return os.path.abspath(found)
    if given:
        raise DatasetError(f"{option} {given}: is not a program")
    raise DatasetError(f"no {candidates[-1]} on the path; name one by {option}")


class Programs:
    def __init__(self, colmap, colmap_tsar):
        self.colmap = find_program(colmap, ["colmap"], "--colmap")
        self.tsar = find_program(
            colmap_tsar, [str(REPOSITORY / "build" / "bin" / "colmap_tsar"), "colmap_tsar"],
            "--colmap_tsar")

    @functools.lru_cache(maxsize=None)
    def colmap_help(self, command):
        return output_of(self.colmap, command, "-h")

    @functools.lru_cache(maxsize=None)
    def help_of(self, command):
        """What a command of either program says about its options."""
        if command.startswith("tsar_"):
            return output_of(self.tsar, command, "--help_all")
        return self.colmap_help(command)

    @functools.cached_property
    def versions(self):
        """What tells these programs from other versions of them."""
        # From 3.9 on there are the time and the process before it in the line.
        found = re.search(r"COLMAP [^ ]+.*", self.colmap_help("image_undistorter"))
        return {"colmap": found[0] if found else "",
                "colmap_tsar": output_of(self.tsar, "--version").strip()}

    @functools.cached_property
    def has_gpu(self):
        return bool(shutil.which("nvidia-smi")) and "GPU 0" in output_of("nvidia-smi", "-L")

    @functools.cached_property
    def tsar_uses_gpu(self):
        return self.has_gpu and "with CUDA" in self.versions["colmap_tsar"]

    @functools.cached_property
    def colmap_has_stereo(self):
        """Whether patch_match_stereo can run here."""
        return "PatchMatchStereo.max_image_size" in self.colmap_help("patch_match_stereo") \
            and self.has_gpu

    def colmap_option(self, command, *names):
        """The option of a COLMAP command that has one of these names, which differ
        between versions."""
        for name in names:
            if f"--{name} " in self.colmap_help(command):
                return name
        raise DatasetError(f"{self.colmap}: {command} has no option --{names[0]}; "
                           "COLMAP 3.7 or later is needed")

    def gpu_option(self, command, *names):
        """The option for features by GPU or CPU, name by value."""
        return {self.colmap_option(command, *names): int(self.colmap_has_stereo)}
