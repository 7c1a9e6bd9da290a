# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of the benchmarks share."""

import sys


def check(condition, message):
    if not condition:
        sys.exit("FAILED: " + message)
    print("ok:", message)
