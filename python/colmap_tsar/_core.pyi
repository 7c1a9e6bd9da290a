# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
import typing

__version__: str
has_cuda: bool

# Only what the package shows of it has types.
def __getattr__(name: str) -> typing.Any: ...
