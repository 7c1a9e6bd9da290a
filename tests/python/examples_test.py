# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Runs the examples of docs/python.md verbatim, one after the other, on the
sample scene: the first begins with its photos and a sparse model.

Needs pycolmap and NumPy, in a virtual environment that is kept in the build
folder. Skipped without them. COLMAP's patch_match_stereo needs a GPU: the
sample's own maps are copied in its place."""
import os
import pathlib
import re
import shutil
import sys
import textwrap

from sample_testing import check, unpack_small
from support import REPOSITORY, WORK_FOLDER, new_folder, read_map
from virtual_environment import IS_INSIDE, run_in_environment

if IS_INSIDE:
    import numpy as np
    import pycolmap

DOCUMENT = REPOSITORY / "docs" / "python.md"


def examples():
    """Line and text of each example, as a program: fenced blocks of Python, and
    what is typed at a prompt, with the error that it raises."""
    lines = DOCUMENT.read_text().splitlines()
    for i, line in enumerate(lines):
        if line == "```python":
            end = lines.index("```", i)
            yield i + 2, "\n".join(lines[i + 1 : end]), None
        typed = re.fullmatch(r"    >>> (.*)", line)
        if typed:
            yield i + 1, typed[1], lines[i + 1].strip()


def prepare(folder):
    """images/, sparse/0, scans/ and depth_images/, as the examples name them."""
    sample = folder / "sample"
    unpack_small(REPOSITORY, sample)
    shutil.copytree(sample / "images", folder / "images")
    shutil.copytree(sample / "sparse", folder / "sparse" / "0")
    shutil.copytree(sample / "scans", folder / "scans")
    (folder / "depth_images").mkdir()
    for path in (sample / "ground_truth" / "depth").iterdir():
        name = path.name.replace(".jpg.bin", ".npy")
        np.save(folder / "depth_images" / name, read_map(path)[::2, ::2, 0])

    def copy_maps(workspace_path):
        for kind in ("depth_maps", "normal_maps"):
            shutil.copytree(sample / "stereo" / kind, pathlib.Path(workspace_path, "stereo", kind),
                            dirs_exist_ok=True)
        # Not of COLMAP's; evaluate_depth() looks for it there.
        shutil.copytree(sample / "ground_truth", pathlib.Path(workspace_path, "ground_truth"))

    pycolmap.patch_match_stereo = copy_maps


def run_example(line, text, expected_error, names):
    # With the lines of the document, for a traceback.
    code = compile("\n" * (line - 1) + text, DOCUMENT, "exec")
    print(f"-- line {line}\n{textwrap.indent(text, '   ')}", flush=True)
    if expected_error is None:
        exec(code, names)
        return
    try:
        exec(code, names)
    except Exception as error:
        said = f"{type(error).__name__}: {error}"
        check(said == expected_error, f"line {line} raises {expected_error}")
        return
    sys.exit(f"FAILED: line {line} raises nothing")


def main():
    folder = new_folder()
    try:
        prepare(folder)
        os.chdir(folder)
        names = {}
        count = 0
        for line, text, expected_error in examples():
            run_example(line, text, expected_error, names)
            count += 1
        check(count >= 10, f"{count} examples")
        # What they say they computed.
        check(names["points"].shape[0] == 3, "depth becomes points")
        check(0.5 < names["share"] <= 1.0, "the share of pixels with depth")
        check(names["cloud"].scores[1].f1 > 0.3, "the fused cloud is scored")
        check(names["on_largest"].any(), "the largest plane has pixels")
    finally:
        os.chdir(WORK_FOLDER)
        shutil.rmtree(folder)


if __name__ == "__main__":
    if not IS_INSIDE:
        run_in_environment(__file__, "pycolmap", "numpy")
    main()
