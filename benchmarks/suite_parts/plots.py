# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""F1 and HARM by size and by noise, as pictures."""

import statistics

from line_plot import write_line_plot
from suite_parts.tables import group_rows

CURVES = (("cloud F1 at 5 cm", "cloud_0.05", 2),
          ("depth F1 at 5 cm", "depth_all_0.05", 2), ("HARM", "harm", None))
AXES = {"size": ("long side of the maps, pixels", "noise", True),
        "noise": ("noise, gray levels", "size", False)}


def values_along(rows, axis, other, key, index):
    """x -> the mean over scenes, of those that were measured at every x and at
    the same values of the other axis."""
    groups = {}
    for row in rows:
        sample = row.sample(key, index)
        if sample is not None:
            place = (row.identity["scene"], row.identity["maps"],
                     row.identity[other])
            groups.setdefault(place, {})[row.identity[axis]] = sample.median
    longest = max((len(group) for group in groups.values()), default=0)
    if longest < 2:
        return {}
    xs = max((tuple(sorted(group)) for group in groups.values()
              if len(group) == longest))
    whole = [group for group in groups.values() if set(xs) <= set(group)]
    return {x: statistics.fmean(group[x] for group in whole) for x in xs}


def write_plots(runs, folder):
    """Writes suite_by_size.svg and suite_by_noise.svg where there are several
    of these; returns what was written."""
    rows = group_rows(runs)
    variants = list(dict.fromkeys(row.identity["variant"] for row in rows))
    written = []
    for axis, (label, other, logarithmic) in AXES.items():
        curves, xs = [], None
        for title, key, index in CURVES:
            lines = {variant: values_along(
                [row for row in rows if row.identity["variant"] == variant],
                axis, other, key, index) for variant in variants}
            lines = {name: line for name, line in lines.items() if line}
            if not lines:
                continue
            xs = xs or list(next(iter(lines.values())))
            lines = {name: [line[x] for x in xs]
                     for name, line in lines.items() if list(line) == xs}
            if lines:
                curves.append((title, lines))
        if curves:
            path = folder / f"suite_by_{axis}.svg"
            write_line_plot(path, label, xs, curves, logarithmic)
            written.append(path)
    return written
