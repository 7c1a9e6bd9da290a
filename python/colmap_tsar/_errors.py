# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""The exceptions of this package."""
import re


class Error(RuntimeError):
    """What goes wrong with a workspace, its files, an option or a GPU.

    The message is one line: it names the file or the option, what is wrong, and
    what to do about it. `code` says the same as the class, as a word. Whatever is
    raised, no map is left half written: images that were done stay done, the
    others keep their maps.
    """

    code = ""


class NotFoundError(Error, FileNotFoundError):
    """A file, folder or named thing does not exist."""

    code = "not_found"


class CorruptError(Error):
    """A file's content breaks its format."""

    code = "corrupt"


class MismatchError(Error):
    """Two inputs contradict each other: sizes, names, numbers of things."""

    code = "mismatch"


class UnsupportedError(Error):
    """Valid, but nothing that can be worked on; or another program is at it."""

    code = "unsupported"


class FileError(Error, OSError):
    """Reading or writing failed: permissions, a full disk."""

    code = "io"


class BadOptionError(Error, ValueError):
    """An option has a value that makes no sense."""

    code = "bad_option"


class DeviceError(Error):
    """A GPU or its driver failed, or there is none."""

    code = "device"


class OutOfMemoryError(Error, MemoryError):
    """The main memory or a GPU's did not suffice."""

    code = "out_of_memory"


# "overwrite 1".
_SWITCH = re.compile(r"\b(overwrite|check_scale|scale_to_sparse) ([01])\b")

_CLASSES = {
    cls.code: cls
    for cls in (
        NotFoundError,
        CorruptError,
        MismatchError,
        UnsupportedError,
        FileError,
        BadOptionError,
        DeviceError,
        OutOfMemoryError,
    )
}


def make_error(code, message):
    """The exception for a tsar::Error, whose options are keywords here."""
    message = message.replace("restore 1", "restore()")
    message = _SWITCH.sub(lambda match: f"{match[1]}={match[2] == '1'}", message)
    return _CLASSES.get(code, Error)(message)
