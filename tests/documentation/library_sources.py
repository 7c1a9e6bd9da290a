# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""The sources of the library, for tests of their text."""
import glob
import os


def library_sources(repository):
    """The name in colmap_tsar/ and the text of each source, in the order of the
    names."""
    root = os.path.join(repository, "colmap_tsar")
    for path in sorted(glob.glob(os.path.join(root, "**", "*.*"), recursive=True)):
        if path.endswith((".cc", ".cu", ".cuh", ".h")):
            with open(path, encoding="utf-8") as file:
                yield os.path.relpath(path, root), file.read()
