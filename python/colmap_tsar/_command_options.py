# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Options of commands as keywords, made from what the commands tell of them."""
import collections.abc
import inspect
import json
import keyword
import numbers
import os
import textwrap
from typing import Literal, Mapping, Optional, Sequence, Union

from . import _core

# What the workspace and the methods themselves say.
_NOT_KEYWORDS = {
    "workspace_path",
    "input_type",
    "project_path",
    "log_to_stderr",
    "random_seed",
    "restore",
}


def _read_fields(described):
    """{keyword: what --help_json tells}, with the default as a value."""
    fields = {}
    for option in described:
        name = option["name"].split(".")[-1]
        default = option["default"]
        if option["value"] == "0|1":
            option["choices"] = []
            option["default"] = default == "1"
        elif option["value"] in ("INT", "NUMBER"):
            option["default"] = int(default) if option["value"] == "INT" else float(default)
        option["settings"] = _read_fields(option.get("settings", []))
        if name not in _NOT_KEYWORDS:
            fields[name + "_" * keyword.iskeyword(name)] = option
    return fields


def _annotation(field):
    default = field["default"]
    if field["choices"]:
        kind = Literal[tuple(field["choices"])]
    elif field["settings"]:
        kind = Union[str, Mapping[str, float]]
    elif field["is_path"]:
        kind = Union[str, "os.PathLike[str]"]
    elif isinstance(default, str):
        kind = Union[str, float, Sequence[float]]
    else:
        kind = type(default)
    return Optional[kind] if default == "" else kind


def _number_text(name, value, expected, *kinds):
    """kinds: the abstract types that will do; those of NumPy are among them."""
    if isinstance(value, bool) or not isinstance(value, kinds):
        raise TypeError(f"{name}: give {expected}, not {value!r}")
    is_integer = isinstance(value, numbers.Integral)
    return str(int(value)) if is_integer else repr(float(value))


def _value_text(name, value, field):
    """As it is written on a command line."""
    default = field["default"]
    if isinstance(default, bool):
        if not isinstance(value, bool):
            raise TypeError(f"{name}: give True or False, not {value!r}")
        return str(int(value))
    if isinstance(default, int):
        return _number_text(name, value, "an integer", numbers.Integral)
    if isinstance(default, float):
        return _number_text(name, value, "a number", numbers.Real)
    if field["is_path"]:
        return os.fsencode(value)
    if field["settings"] and isinstance(value, collections.abc.Mapping):
        texts = _to_text(name, field["settings"], value)
        return ",".join(f"{setting}={text}" for setting, text in texts.items())
    # Lists of numbers: gpu_index, tolerances.
    if not field["choices"] and not isinstance(value, str):
        values = value if isinstance(value, (list, tuple)) else [value]
        return ",".join(
            _number_text(name, number, "numbers", numbers.Real) for number in values
        )
    if not isinstance(value, str):
        choices = ", ".join(field["choices"])
        raise TypeError(f"{name}: give one of {choices}, not {value!r}")
    return os.fsencode(value)


def _to_text(owner, fields, values):
    """{name: text}; None stands for the default."""
    texts = {}
    for name, value in values.items():
        if name not in fields:
            similar = _core.suggest_names(name, list(fields))
            advice = (
                f"did you mean {' or '.join(similar)}?" if similar else "see its help()"
            )
            raise TypeError(f"{owner} has no option '{name}'; {advice}")
        if value is not None:
            texts[name] = _value_text(name, value, fields[name])
    return texts


def _lines(fields, indentation):
    for name, field in fields.items():
        facts = [" | ".join(field["choices"])] if field["choices"] else []
        if field["default"] != "":
            facts.append(f"default {field['default']}")
        for preset, value in field.get("presets", {}).items():
            facts.append(f"{preset} {value}")
        text = field["description"].replace("--restore 1", "undo_imports()")
        text = text.replace("--", "")
        yield textwrap.fill(
            f"{name}: {text}" + (f" ({', '.join(facts)})" if facts else ""),
            width=80,
            initial_indent=indentation,
            subsequent_indent=indentation + " " * 4,
        )
        yield from _lines(field["settings"], indentation + " " * 8)


class CommandOptions:
    """The keywords of what does the work of a command."""

    def __init__(self, method, help_json):
        self._method = method
        self._fields = _read_fields(json.loads(help_json)["options"])

    def to_text(self, options):
        """{name of the option: value as it is written on a command line}. TypeError for
        a name that does not exist and for a value of a wrong type; None stands for the
        default."""
        texts = _to_text(f"{self._method}()", self._fields, options)
        return {name.rstrip("_"): text for name, text in texts.items()}

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


REFINE = CommandOptions("refine", _core.help_json_of_refine())
STEREO = CommandOptions("stereo", _core.help_json_of_stereo())
FUSE = CommandOptions("fuse", _core.help_json_of_fuse())
IMPORT = CommandOptions("import_maps", _core.help_json_of_import())
REPORT = CommandOptions("report", _core.help_json_of_report())
EXPORT = CommandOptions("export", _core.help_json_of_export())
