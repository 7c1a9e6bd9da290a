# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""RefineOptions, made from the one list that the program's options come from."""
import inspect
import textwrap
import warnings

from . import _core

_FIELDS = {field["name"]: field for field in _core.describe_fields()}
_FORMER_NAMES = _core.describe_renamed()


def _present_name(name):
    """The option's name, also where it is given by a former one."""
    if name in _FORMER_NAMES:
        warnings.warn(
            f"{name} is called {_FORMER_NAMES[name]} now", FutureWarning, stacklevel=3
        )
        return _FORMER_NAMES[name]
    return name


def _unknown(name):
    """What to say of a name that is none of an option."""
    similar = _core.suggest_names(name, list(_FIELDS))
    advice = (
        f"did you mean {' or '.join(similar)}?"
        if similar
        else "help(colmap_tsar.RefineOptions) lists all"
    )
    return f"RefineOptions has no option '{name}'; {advice}"


def _description(field):
    kind = type(field["default"]).__name__
    facts = [f"{kind}, default {field['default']}"]
    if field["paper"] != field["default"]:
        facts.append(f"paper {field['paper']}")
    if field["range"] is not None:
        low, high = (f"{bound:.10g}" for bound in field["range"])
        facts.append(f"from {low} to {high}")
    return f"{field['description']} ({', '.join(facts)})"


class RefineOptions:
    """What refine() does; the defaults are what measures best.

    Every option is a keyword of the constructor and an attribute, with the name
    that it has on the command line (without the group TsarRefine):

        options = RefineOptions(segment=False)
        options.num_iterations = 3

    Names that do not exist, values of a wrong type and values outside an option's
    range are errors at once; check() also finds options that contradict each
    other, and so does refine(). Options can be compared, copied and pickled;
    todict() gives them as a dict, and RefineOptions(**d) takes one.

    Pixel numbers hold at the paper's sizes and are scaled to the maps at hand.

    Options:

    """

    __slots__ = ("_values",)
    __hash__ = None

    def __init__(self, **options):
        defaults = {name: field["default"] for name, field in _FIELDS.items()}
        object.__setattr__(self, "_values", defaults)
        self.update(**options)

    @classmethod
    def paper(cls, **options):
        """The published method in its best readings, with the options given on top."""
        values = {name: field["paper"] for name, field in _FIELDS.items()}
        return cls(**values).update(**options)

    @classmethod
    def paper_strict(cls, **options):
        """The published equations as printed, with the options given on top."""
        values = {name: field["paper_strict"] for name, field in _FIELDS.items()}
        return cls(**values).update(**options)

    def update(self, **options):
        """Sets several options, or none where one is wrong; returns this object."""
        checked = {}
        for written, value in options.items():
            name = _present_name(written)
            if name not in _FIELDS:
                raise TypeError(_unknown(name))
            if name in checked:
                raise TypeError(f"{name} is given twice")
            checked[name] = _core.check_field(name, value)
        self._values.update(checked)
        return self

    def check(self):
        """Raises BadOptionError where the options contradict each other."""
        _core.check_options(self._values)

    def todict(self):
        """Names and values of all options, in the order of the help."""
        return dict(self._values)

    def copy(self):
        """Options with the same values, which can be changed for themselves."""
        return type(self)(**self._values)

    def __copy__(self):
        return self.copy()

    def __deepcopy__(self, memo):
        return self.copy()

    def __reduce__(self):
        return _unpickle, (self._values,)

    def __eq__(self, other):
        if not isinstance(other, RefineOptions):
            return NotImplemented
        return self._values == other._values

    def __repr__(self):
        """Only what differs from the defaults, which is what matters."""
        changed = (
            f"{name}={value!r}"
            for name, value in self._values.items()
            if value != _FIELDS[name]["default"]
        )
        return f"RefineOptions({', '.join(changed)})"

    def __dir__(self):
        return sorted({*super().__dir__(), *_FIELDS})

    def __getattr__(self, name):
        if name in _FORMER_NAMES:
            return self._values[_present_name(name)]
        raise AttributeError(_unknown(name))

    def __setattr__(self, name, value):
        name = _present_name(name)
        if name not in _FIELDS:
            raise AttributeError(_unknown(name))
        object.__setattr__(self, name, value)

    def __delattr__(self, name):
        raise AttributeError("an option of RefineOptions can be set, not deleted")


def _unpickle(values):
    return RefineOptions(**values)


def _property(name):
    def get(self):
        return self._values[name]

    def set_checked(self, value):
        self._values[name] = _core.check_field(name, value)

    return property(get, set_checked, doc=_description(_FIELDS[name]))


def _complete_class():
    """Adds the properties, the documentation and the constructor's signature."""
    lines = []
    parameters = [inspect.Parameter("self", inspect.Parameter.POSITIONAL_ONLY)]
    for name, field in _FIELDS.items():
        setattr(RefineOptions, name, _property(name))
        lines.append(
            textwrap.fill(
                f"{name}: {_description(field)}",
                width=80,
                initial_indent=" " * 4,
                subsequent_indent=" " * 8,
            )
        )
        parameters.append(
            inspect.Parameter(
                name,
                inspect.Parameter.KEYWORD_ONLY,
                default=field["default"],
                annotation=type(field["default"]),
            )
        )
    RefineOptions.__doc__ = (
        RefineOptions.__doc__.rstrip() + "\n\n" + "\n".join(lines) + "\n"
    )
    RefineOptions.__init__.__signature__ = inspect.Signature(parameters)


_complete_class()
