# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Options of commands as keywords, made from the lists that the commands have."""
import inspect
import numbers
import os
import textwrap
from typing import Literal, Optional, Sequence, Union

from . import _core

# What the workspace and the methods themselves say.
_NOT_KEYWORDS = {
    "workspace_path",
    "workspace_format",
    "input_type",
    "restore",
    "restore_conflicts",
}


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


def _number_text(name, value, expected, *kinds):
    """kinds: the abstract types that will do; those of NumPy are among them."""
    if isinstance(value, bool) or not isinstance(value, kinds):
        raise TypeError(f"{name}: give {expected}, not {value!r}")
    is_integer = isinstance(value, numbers.Integral)
    return str(int(value)) if is_integer else repr(float(value))


class CommandOptions:
    """The keywords of a method that does what a command does."""

    def __init__(self, method, fields):
        self._method = method
        self._fields = {
            field["name"]: field for field in fields if field["name"] not in _NOT_KEYWORDS
        }

    def to_text(self, options):
        """{name: value as it is written on a command line}. TypeError for a name that
        does not exist and for a value of a wrong type; None stands for the default."""
        return {
            name: self._value_text(name, value)
            for name, value in options.items()
            if value is not None
        }

    def _value_text(self, name, value):
        if name not in self._fields:
            similar = _core.suggest_names(name, list(self._fields))
            advice = (
                f"did you mean {' or '.join(similar)}?" if similar else "see its help()"
            )
            raise TypeError(f"{self._method}() has no option '{name}'; {advice}")
        field = self._fields[name]
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

    def document(self, method):
        """Completes the method's signature, which ends in **options, and its text."""
        signature = inspect.signature(method)
        own = [
            parameter
            for parameter in signature.parameters.values()
            if parameter.kind != inspect.Parameter.VAR_KEYWORD
        ]
        own_names = {parameter.name for parameter in own}
        lines = []
        for name, field in self._fields.items():
            default = field["default"]
            if name not in own_names:
                own.append(
                    inspect.Parameter(
                        name,
                        inspect.Parameter.KEYWORD_ONLY,
                        default=None if default == "" else default,
                        annotation=_annotation(field),
                    )
                )
            lines.append(self._line(name, field))
        own.sort(key=lambda parameter: parameter.kind)
        method.__signature__ = signature.replace(parameters=own)
        text = inspect.cleandoc(method.__doc__)
        method.__doc__ = text + "\n\nOptions:\n" + "\n".join(lines)

    @staticmethod
    def _line(name, field):
        facts = [" | ".join(field["choices"])] if field["choices"] else []
        if field["default"] != "":
            facts.append(f"default {field['default']}")
        text = field["description"].replace("--restore 1", "undo_imports()")
        text = text.replace("--", "")
        return textwrap.fill(
            f"{name}: {text}" + (f" ({', '.join(facts)})" if facts else ""),
            width=80,
            initial_indent=" " * 4,
            subsequent_indent=" " * 8,
        )


STEREO = CommandOptions("stereo", _core.describe_stereo())
IMPORT = CommandOptions("import_maps", _core.describe_import())
REPORT = CommandOptions("report", _core.describe_report())
EXPORT = CommandOptions("export", _core.describe_export())
