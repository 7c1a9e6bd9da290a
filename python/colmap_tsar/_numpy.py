# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""NumPy, which only maps, cameras and planes as arrays need."""


def import_numpy():
    try:
        import numpy
    except ImportError as error:
        raise ImportError(
            "maps, cameras and planes are given as arrays of NumPy, which is not there; "
            "install it (pip install numpy)"
        ) from error
    return numpy
