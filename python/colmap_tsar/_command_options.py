# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Options of commands as keywords, made from what the commands tell of them."""
import difflib
import inspect
import json
import keyword
import numbers
import os
import textwrap
from typing import Literal, Optional, Sequence, Union

from . import _core

# What the workspace and the methods themselves say.
_NOT_KEYWORDS = {"workspace_path", "input_type", "restore"}
# By the kind of value: its type, with those of NumPy, how it is called, and how it is
# read from and written to a command line.
_KINDS = {
    "0|1": (bool, "True or False", lambda text: text == "1", lambda value: str(int(value))),
    "INT": (numbers.Integral, "an integer", int, lambda value: str(int(value))),
    "NUMBER": (numbers.Real, "a number", float, lambda value: repr(float(value))),
}


def advice(name, names):
    """"; did you mean ...?", or nothing."""
    similar = difflib.get_close_matches(str(name), names)
    return f"; did you mean {' or '.join(similar)}?" if similar else ""


def _read_fields(described):
    """{keyword: what --help_json tells}, with the default as a value."""
    fields = {}
    for option in described:
        name = option["name"].split(".")[-1]
        if option["value"] in _KINDS:
            option["default"] = _KINDS[option["value"]][2](option["default"])
            option["choices"] = []
        if name not in _NOT_KEYWORDS:
            fields[name + "_" * keyword.iskeyword(name)] = option
    return fields


def _annotation(field):
    default = field["default"]
    if field["choices"]:
        kind = Literal[tuple(field["choices"])]
    elif field["is_path"]:
        kind = Union[str, "os.PathLike[str]"]
    elif isinstance(default, str):
        kind = Union[str, float, Sequence[float]]
    else:
        kind = type(default)
    return Optional[kind] if default == "" else kind


def _value_text(name, value, field):
    """As it is written on a command line."""
    if field["value"] in _KINDS:
        kind, expected, _, write = _KINDS[field["value"]]
        if not isinstance(value, kind) or isinstance(value, bool) != (kind is bool):
            raise TypeError(f"{name}: give {expected}, not {value!r}")
        return write(value)
    # Lists of numbers: gpu_index, tolerances.
    is_list = not field["choices"] and not field["is_path"]
    if is_list and isinstance(value, (list, tuple, numbers.Real)):
        return ",".join(map(str, value if isinstance(value, (list, tuple)) else [value]))
    try:
        return os.fsencode(value)
    except TypeError:
        raise TypeError(f"{name}: give a text, not {value!r}") from None


def _lines(fields, indentation):
    for name, field in fields.items():
        facts = [" | ".join(field["choices"])] if field["choices"] else []
        if field["default"] != "":
            facts.append(f"default {field['default']}")
        text = field["description"].replace("--", "")
        yield textwrap.fill(
            f"{name}: {text}" + (f" ({', '.join(facts)})" if facts else ""),
            width=80,
            initial_indent=indentation,
            subsequent_indent=indentation + " " * 4,
        )


class CommandOptions:
    """The keywords of what does the work of a command."""

    def __init__(self, method, help_json):
        self._method = method
        self._fields = _read_fields(json.loads(help_json)["options"])

    def to_text(self, options):
        """{name of the option: value as it is written on a command line}. TypeError for
        a name that does not exist and for a value of a wrong type; None stands for the
        default."""
        texts = {}
        for name, value in options.items():
            if name not in self._fields:
                raise TypeError(
                    f"{self._method}() has no option '{name}'{advice(name, self._fields)}"
                )
            if value is not None:
                texts[name.rstrip("_")] = _value_text(name, value, self._fields[name])
        return texts

    def parameters(self):
        """The keywords, for signatures and type checkers."""
        return [
            inspect.Parameter(
                name,
                inspect.Parameter.KEYWORD_ONLY,
                default=None if field["default"] == "" else field["default"],
                annotation=_annotation(field),
            )
            for name, field in self._fields.items()
        ]

    def document(self, method):
        """Completes the method's signature, which ends in **options, and its text."""
        signature = inspect.signature(method)
        own = list(signature.parameters.values())[:-1]
        names = {parameter.name for parameter in own}
        own += [other for other in self.parameters() if other.name not in names]
        own.sort(key=lambda parameter: parameter.kind)
        method.__signature__ = signature.replace(parameters=own)
        text = inspect.cleandoc(method.__doc__)
        lines = _lines(self._fields, " " * 4)
        method.__doc__ = text + "\n\nOptions:\n" + "\n".join(lines)


REFINE = CommandOptions("refine", _core.help_json("refine"))
STEREO = CommandOptions("stereo", _core.help_json("stereo"))
FUSE = CommandOptions("fuse", _core.help_json("fuse"))
IMPORT = CommandOptions("import_maps", _core.help_json("import"))
REPORT = CommandOptions("report", _core.help_json("report"))
