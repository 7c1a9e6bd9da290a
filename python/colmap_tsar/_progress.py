# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Whom a run tells how far it has come, in the form that _core takes: a function of
text, or None; whether the text goes to a terminal; a function of a pass's name, of how
many of its images are done and of how many it has, or None."""
import sys


def _to_stderr():
    stream = sys.stderr
    if stream is None:
        return None, False, None

    def write(text):
        stream.write(text)
        stream.flush()

    return write, stream.isatty(), None


def tell_lines(progress):
    """True: standard error. A function: takes each line."""
    if progress is True:
        return _to_stderr()
    if not progress:
        return None, False, None

    def call(text):
        for line in text.splitlines():
            progress(line)

    return call, False, None


def tell_steps(progress):
    """True: standard error. A function: takes each step."""
    if progress is True:
        return _to_stderr()
    return None, False, progress or None
