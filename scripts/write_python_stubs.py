#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the stubs of the modules whose options come from the lists of the program, so
that type checkers and editors know them. To be run after an option has changed, with
the built package on the path:

    PYTHONPATH=build/python python3 scripts/write_python_stubs.py [FOLDER]

FOLDER: where to, by default the package in python/."""
import inspect
import pathlib
import re
import sys

import colmap_tsar
from colmap_tsar import _core, _options, _workspace

HEADER = """\
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
# Written by scripts/write_python_stubs.py.
import collections.abc
import os
import pathlib
import typing

import colmap_tsar
"""

OF_TYPING = "Any|Callable|Dict|Iterator|Literal|Mapping|Optional|Sequence|Tuple|Union"


def annotation_text(annotation):
    if annotation is inspect.Parameter.empty:
        return "typing.Any"
    text = annotation if isinstance(annotation, str) else inspect.formatannotation(annotation)
    text = re.sub(r"ForwardRef\('([^']*)'\)", r"\1", text)
    # Versions of Python differ in whether they write the module, and where.
    text = re.sub(r"\b(typing|collections\.abc)\.", "", text)
    text = re.sub(rf"(?<![.\w'])({OF_TYPING})\b(?!')", r"typing.\1", text)
    text = text.replace("NoneType", "None")
    return re.sub(r"\bpathlib\._local\.", "pathlib.", text)


def parameter_text(parameter):
    name = parameter.name
    if name in ("self", "cls"):
        return name
    text = f"{name}: {annotation_text(parameter.annotation)}"
    if parameter.default is not inspect.Parameter.empty:
        text += f" = {parameter.default!r}"
    return text


def function_lines(name, parameters, returns):
    lines = [f"    def {name}("]
    has_star = False
    for parameter in parameters:
        if parameter.kind == inspect.Parameter.KEYWORD_ONLY and not has_star:
            lines.append("        *,")
            has_star = True
        lines.append(f"        {parameter_text(parameter)},")
    return [*lines, f"    ) -> {returns}: ..."]


def option_parameters():
    return list(inspect.signature(colmap_tsar.RefineOptions).parameters.values())


def options_stub():
    self = inspect.Parameter("self", inspect.Parameter.POSITIONAL_OR_KEYWORD)
    cls = self.replace(name="cls")
    options = option_parameters()
    lines = ["class RefineOptions:"]
    lines += [f"    {p.name}: {annotation_text(p.annotation)}" for p in options]
    lines += ["    __hash__: typing.ClassVar[None]  # type: ignore[assignment]"]
    lines += function_lines("__init__", [self, *options], "None")
    for name in ("paper", "paper_strict"):
        lines += ["    @classmethod"]
        lines += function_lines(name, [cls, *options], "RefineOptions")
    lines += function_lines("update", [self, *options], "RefineOptions")
    lines += [
        "    def check(self) -> None: ...",
        "    def todict(self) -> typing.Dict[str, typing.Any]: ...",
        "    def copy(self) -> RefineOptions: ...",
        "    def __copy__(self) -> RefineOptions: ...",
        "    def __deepcopy__(self, memo: typing.Any) -> RefineOptions: ...",
    ]
    return lines


def workspace_stub():
    kind = colmap_tsar.Workspace
    base = "collections.abc.Mapping[str, colmap_tsar.WorkspaceImage]"
    lines = [f"class Workspace({base}):"]
    for name, member in vars(kind).items():
        if isinstance(member, property):
            returns = inspect.signature(member.fget).return_annotation
            lines += ["    @property"]
            lines += [f"    def {name}(self) -> {annotation_text(returns)}: ..."]
        elif inspect.isfunction(member) and (
            not name.startswith("_")
            or name in ("__init__", "__len__", "__iter__", "__contains__", "__getitem__")
        ):
            signature = inspect.signature(member)
            returns = (
                "None"
                if name == "__init__"
                else annotation_text(signature.return_annotation)
            )
            lines += function_lines(name, signature.parameters.values(), returns)
    return lines


def core_stub():
    """Only what the package shows of it has types."""
    lines = ["__version__: str", "has_cuda: bool", ""]
    return lines + [
        f"def {name}(*arguments: typing.Any, **keywords: typing.Any) -> typing.Any: ..."
        for name, member in sorted(vars(_core).items())
        if callable(member) and not name.startswith("_")
    ]


def main(folder):
    stubs = {_core: core_stub(), _options: options_stub(), _workspace: workspace_stub()}
    for module, lines in stubs.items():
        name = module.__name__.split(".")[-1] + ".pyi"
        (folder / name).write_text(HEADER + "\n" + "\n".join(lines) + "\n")


if __name__ == "__main__":
    package = pathlib.Path(__file__).parents[1] / "python" / "colmap_tsar"
    main(pathlib.Path(sys.argv[1]) if sys.argv[1:] else package)
