#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the types of the keywords that come from the options of the program, so that
type checkers and editors know them. The build runs it:

    write_keywords.py PACKAGE

PACKAGE: the folder of the built package, into which _keywords.py is written."""
import inspect
import pathlib
import re
import sys

HEADER = """\
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
import os
import typing
"""

OF_TYPING = "Literal|Optional|Sequence|Union"

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


def main(package):
    sys.path[0] = str(package.parent)  # Not the sources beside this file.
    from colmap_tsar import _command_options as commands

    lines = []
    for name in ("Refine", "Stereo", "Fuse", "Import", "Report"):
        kind = name + "Keywords"
        lines += ["", f"class {kind}(typing.TypedDict, total=False):"]
        lines += [
            f"    {parameter.name}: {annotation_text(parameter.annotation)}"
            for parameter in getattr(commands, name.upper()).parameters()
            if parameter.name not in OWN.get(kind, ())
        ]
    (package / "_keywords.py").write_text(HEADER + "\n".join(lines) + "\n")


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]))
