# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Depth priors as arrays, which refine() hands on as files of a folder."""
import collections.abc
import contextlib
import hashlib
import os
import pathlib
import sys
import tempfile
from typing import Any, Callable, Mapping, Optional, Tuple, Union

from . import _core
from ._command_options import advice

# Depth, or depth and normals; arrays of NumPy, or what can become one.
Prior = Union[Any, Tuple[Any, Any]]
Priors = Union[Mapping[str, Optional[Prior]], Callable[[str], Optional[Prior]]]

# From the formats of buffers to the types of NumPy's files.
_TYPES = {"e": "f2", "f": "f4", "d": "f8", "H": "u2"}


def _view(what, array):
    """A buffer of the array; without NumPy, the array must have one itself."""
    try:
        import numpy
    except ImportError:
        view = memoryview(array)
    else:
        view = memoryview(numpy.ascontiguousarray(array, numpy.float32))
    if view.format not in _TYPES:
        raise TypeError(f"{what}: give floats, not values of the format {view.format!r}")
    return view


def _write(path, view):
    """Writes a file of NumPy. The time of its last change tells its content alone, so
    that equal arrays are no changed input of a later run."""
    order = "<" if sys.byteorder == "little" else ">"
    header = (
        f"{{'descr': '{order}{_TYPES[view.format]}', 'fortran_order': False, "
        f"'shape': {view.shape}, }}"
    )
    # With what is before it, the header has a multiple of 64 bytes.
    header += " " * (-(len(header) + 11) % 64) + "\n"
    content = (
        b"\x93NUMPY\x01\x00"
        + len(header).to_bytes(2, "little")
        + header.encode("ascii")
        + view.tobytes()
    )
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content)
    # Nanoseconds of the years from 1970 to 2006.
    time = int.from_bytes(hashlib.sha256(content).digest()[:8], "big") >> 4
    os.utime(path, ns=(time, time))


def _write_prior(folder, name, prior):
    depth, normals = prior if isinstance(prior, tuple) else (prior, None)
    for array, suffix, shape, has_shape in (
        (depth, ".npy", "height x width", lambda view: view.ndim == 2),
        (
            normals,
            ".normal.npy",
            "height x width x 3",
            lambda view: view.ndim == 3 and view.shape[2] == 3,
        ),
    ):
        if array is None:
            continue
        what = f"priors of {name}"
        view = _view(what, array)
        if not has_shape(view):
            raise ValueError(f"{what}: an array of the shape {view.shape}, not {shape}")
        _write(folder / (name + suffix), view)


def _of_images(workspace_path, priors):
    """The name and the prior of each image that has one."""
    names = _core.read_images(pathlib.Path(os.fsdecode(workspace_path)))
    if isinstance(priors, collections.abc.Mapping):
        for name in priors:
            if name not in names:
                raise ValueError(f"priors: there is no image {name!r}{advice(name, names)}")
        ask = priors.get
    elif callable(priors):
        ask = priors
    else:
        raise TypeError(f"priors: give a dict or a function, not {priors!r}")
    for name in names:
        prior = ask(name)
        if prior is not None:
            yield name, prior


@contextlib.contextmanager
def options_with_priors(workspace_path, priors, options):
    """The options of refine() with the folder that holds these priors meanwhile."""
    if priors is None:
        yield options
        return
    if options.get("prior_path") is not None:
        raise TypeError("priors: give these or prior_path, not both")
    with tempfile.TemporaryDirectory(prefix="tsar_priors_") as folder:
        count = 0
        for name, prior in _of_images(workspace_path, priors):
            _write_prior(pathlib.Path(folder), name, prior)
            count += 1
        if count == 0:
            raise ValueError("priors: of none of the images")
        yield {**options, "prior_path": folder}
