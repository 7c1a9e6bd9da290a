#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the types of the keywords that come from the options of the program, so that
type checkers and editors know them. To be run after an option has changed, with the
built package on the path:

    PYTHONPATH=build/python python3 scripts/write_python_stubs.py [FILE]

FILE: where to, by default the package's _keywords.py in python/."""
import inspect
import pathlib
import re
import sys

from colmap_tsar import _command_options as commands

HEADER = """\
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
# Written by scripts/write_python_stubs.py.
import os
import typing
"""

OF_TYPING = "Literal|Mapping|Optional|Sequence|Union"

# What the methods have as parameters of their own.
OWN = {
    "FuseKeywords": {"output_path"},
    "ImportKeywords": {"input_path", "format", "output_path"},
}


def annotation_text(annotation):
    text = inspect.formatannotation(annotation)
    text = re.sub(r"ForwardRef\('([^']*)'\)", r"\1", text)
    # Versions of Python differ in whether they write the module, and where.
    text = re.sub(r"\b(typing|collections\.abc)\.", "", text)
    return re.sub(rf"(?<![.\w'])({OF_TYPING})\b(?!')", r"typing.\1", text).replace("NoneType", "None")


def main(path):
    lines = []
    for name in ("Refine", "Stereo", "Fuse", "Import", "Report"):
        kind = name + "Keywords"
        lines += ["", f"class {kind}(typing.TypedDict, total=False):"]
        lines += [
            f"    {parameter.name}: {annotation_text(parameter.annotation)}"
            for parameter in getattr(commands, name.upper()).parameters()
            if parameter.name not in OWN.get(kind, ())
        ]
    path.write_text(HEADER + "\n".join(lines) + "\n")


if __name__ == "__main__":
    package = pathlib.Path(__file__).parents[1] / "python" / "colmap_tsar"
    main(pathlib.Path(sys.argv[1]) if sys.argv[1:] else package / "_keywords.py")
