# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Medians and standard errors over seeds, and the tables made of them."""

import math
import statistics

from programs import table_lines

# What the tables show: title, key of the score, number in its list, digits.
COLUMNS = (
    ("cloud F1 2 cm", "cloud_0.02", 2, 3), ("cloud F1 5 cm", "cloud_0.05", 2, 3),
    ("cloud F1 10 cm", "cloud_0.1", 2, 3),
    ("completeness 2 cm", "cloud_0.02", 0, 3),
    ("accuracy 2 cm", "cloud_0.02", 1, 3),
    ("accuracy 5 cm", "cloud_0.05", 1, 3),
    ("worst surface", "worst_surface", None, 3),
    ("worst surface tsar_fuse", "tsar_fuse_worst_surface", None, 3),
    ("depth F1 2 cm", "depth_all_0.02", 2, 3),
    ("depth F1 5 cm", "depth_all_0.05", 2, 3),
    ("precision 2 cm", "depth_all_0.02", 0, 3),
    ("recall 2 cm", "depth_all_0.02", 1, 3),
    ("textureless F1 2 cm", "depth_textureless_0.02", 2, 3),
    ("HARM", "harm", None, 4), ("by over 5 %", "harm_far", None, 4),
    ("lost", "lost", None, 4),
    ("OUTLIERS", "outliers", None, 3),
    ("measured", "outliers_measured", None, 3),
    ("filled", "outliers_filled", None, 3),
    ("guessed", "outliers_guessed", None, 3),
    ("prior", "outliers_prior", None, 3),
    ("SPECKS", "specks", None, 4),
    ("views disagree", "view_disagreement", None, 3),
    ("planes off", "plane_offset", None, 4),
    ("planes", "num_planes", None, 1), ("copies", "plane_copies", None, 1),
    ("copies off (cm)", "copy_offset_cm", None, 1),
    ("sparse with depth", "sparse_with_depth", None, 3),
    ("sparse right 1 %", "sparse_right_1", None, 3),
    ("sparse right 2 %", "sparse_right_2", None, 3),
    ("calibration error", "calibration_error", None, 3),
    ("largest gap", "calibration_gap", None, 3),
    ("seconds", "seconds", None, 1))
# Those of clouds; the keys of tsar_fuse's begin with its name.
CLOUD_COLUMNS = (("points", "points", None, 0), *(
    (f"{name} {centimeters} cm", f"cloud_{centimeters / 100:g}", index, 3)
    for centimeters in (2, 5, 10)
    for name, index in (("F1", 2), ("completeness", 0), ("accuracy", 1))))
FUSIONS = (("stereo_fusion", ""), ("tsar_fuse", "tsar_fuse_"))
IDENTITY = ("role", "scene", "size", "noise", "maps", "variant")
# Those by which variants are compared.
VARIANT_COLUMNS = (*(column for column in COLUMNS if column[0] in (
    "cloud F1 2 cm", "cloud F1 5 cm", "depth F1 2 cm", "depth F1 5 cm",
    "accuracy 2 cm", "accuracy 5 cm", "worst surface",
    "worst surface tsar_fuse", "HARM", "OUTLIERS", "SPECKS", "planes",
    "copies")), *(
    (f"tsar_fuse {name} {centimeters} cm",
     f"tsar_fuse_cloud_{centimeters / 100:g}", index, 3)
    for name, index in (("F1", 2), ("accuracy", 1)) for centimeters in (2, 5)))


def value_of(scores, key, index):
    value = scores.get(key)
    return value if index is None or value is None else value[index]


class Sample:
    """A score over the seeds."""

    def __init__(self, values):
        self.median = statistics.median(values)
        self.mean = statistics.fmean(values)
        # The error of the mean; unknown from a single value.
        self.error = (statistics.stdev(values) / math.sqrt(len(values))
                      if len(values) > 1 else math.nan)


class Row:
    """All runs of one variant on one configuration."""

    def __init__(self, identity, runs):
        self.identity = identity
        self.name = ", ".join((identity["scene"], f"{identity['size']} px",
                               f"noise {identity['noise']:g}",
                               identity["maps"]))
        self.before = runs[0]["before"]
        self.scores = [{**run["scores"], "seconds": run["seconds"]}
                       for run in sorted(runs, key=lambda run: run["seed"])]

    def sample(self, key, index=None):
        values = [value_of(scores, key, index) for scores in self.scores]
        return Sample(values) if None not in values else None


def group_rows(runs):
    """Rows of runs of the same configuration and variant, in their order."""
    groups = {}
    for one in runs:
        groups.setdefault(tuple(one[key] for key in IDENTITY), []).append(one)
    return [Row(dict(zip(IDENTITY, identity)), group)
            for identity, group in groups.items()]


def error_text(error, digits):
    return "" if math.isnan(error) else f" ± {error:.{digits}f}"


def cell(before, median, error, digits):
    text = f"{median:.{digits}f}{error_text(error, digits)}"
    return text if before is None else f"{before:.{digits}f} → {text}"


def mean_of_samples(rows, key, index):
    """Before, median and standard error averaged over rows; None unless all
    rows have the score."""
    samples = [row.sample(key, index) for row in rows]
    if None in samples or not samples:
        return None
    befores = [value_of(row.before, key, index) for row in rows]
    return (None if None in befores else statistics.fmean(befores),
            statistics.fmean(sample.median for sample in samples),
            math.sqrt(sum(sample.error ** 2 for sample in samples))
            / len(samples))


def true_text(rows, key):
    """The score of the true surfaces, for the scores that have one."""
    values = [row.before.get(f"true_{key}") for row in rows]
    return (f" / {statistics.fmean(values):.3g}"
            if values and None not in values else "")


def role_table(role, rows):
    columns = [column for column in COLUMNS
               if any(row.sample(*column[1:3]) for row in rows)]
    lines = []
    for row in rows:
        cells = []
        for _, key, index, digits in columns:
            sample = row.sample(key, index)
            cells.append("-" if sample is None else cell(
                value_of(row.before, key, index), sample.median, sample.error,
                digits) + true_text([row], key))
        lines.append([row.name, row.identity["variant"], *cells])
    for variant in dict.fromkeys(row.identity["variant"] for row in rows):
        own = [row for row in rows if row.identity["variant"] == variant]
        cells = []
        for _, key, index, digits in columns:
            # Over the scenes that have the score at all.
            having = [row for row in own if row.sample(key, index)]
            mean = mean_of_samples(having, key, index)
            cells.append("-" if mean is None else cell(*mean, digits)
                         + true_text(having, key))
        lines.append([f"**mean of {len(own)}**", variant, *cells])
    head = ["scene", "variant", *(column[0] for column in columns)]
    return table_lines(f"### {role.capitalize()} scenes", head, lines)


def cloud_table(rows):
    """The refined maps' clouds by both fusions, one under the other; nothing
    without any by tsar_fuse."""
    def cells_of(fused, prefix):
        means = [mean_of_samples(fused, prefix + key, index)
                 for _, key, index, _ in CLOUD_COLUMNS]
        return ["-" if mean is None else cell(None, *mean[1:], digits)
                for mean, (*_, digits) in zip(means, CLOUD_COLUMNS)]

    rows = [row for row in rows if row.sample("tsar_fuse_points")]
    if not rows:
        return []
    groups = [(row.name, row.identity["variant"], [row]) for row in rows]
    for variant in dict.fromkeys(row.identity["variant"] for row in rows):
        own = [row for row in rows if row.identity["variant"] == variant]
        groups.append((f"**mean of {len(own)}**", variant, own))
    return table_lines("### Clouds of the refined maps by stereo_fusion and by "
                       "tsar_fuse",
                       ["scene", "variant", "fusion",
                        *(column[0] for column in CLOUD_COLUMNS)],
                       [[name, variant, fusion, *cells_of(own, prefix)]
                        for name, variant, own in groups
                        for fusion, prefix in FUSIONS])


def variant_table(title, key, index, digits, rows):
    """A row per variant and a column per scene, with the mean change against
    the first variant; nothing where there is no such score."""
    medians = {}
    for row in rows:
        sample = row.sample(key, index)
        if sample is not None:
            medians.setdefault(row.identity["variant"], {})[
                row.name] = sample.median
    if not medians:
        return []
    base = next(iter(medians.values()))
    lines = []
    for variant, values in medians.items():
        changes = [values[name] - base[name] for name in base
                   if name in values]
        lines.append([variant, *(f"{values[name]:.{digits}f}"
                                 if name in values else "-" for name in base),
                      f"{statistics.fmean(changes):+.{digits}f}"
                      if changes else "-"])
    return table_lines(f"### Variants: {title}",
                       ["variant", *base, "mean change"], lines)


def surface_table(rows):
    """How much of each large surface the refined maps' clouds hold; nothing
    without clouds."""
    lines = []
    for row in rows:
        # For each fusion the planes in turn, for each plane the seeds'.
        planes = [zip(*(scores[f"{prefix}surfaces"] for scores in row.scores
                        if f"{prefix}surfaces" in scores))
                  for _, prefix in FUSIONS]
        for seeds_of_fusions in zip(*planes):
            *normal, offset, share = seeds_of_fusions[0][0][:5]
            medians = [statistics.median(plane[index] for plane in seeds)
                       for seeds in seeds_of_fusions for index in (5, 6)]
            lines.append([row.name, row.identity["variant"],
                          " ".join(f"{round(value, 2) + 0.0:.2f}"
                                   for value in (*normal, offset)),
                          *(f"{value:.3f}" for value in (share, *medians))])
    if not lines:
        return []
    return table_lines("### Large surfaces: normal and offset, share of the "
                       "scans, and the shares of them that the clouds hold "
                       "within 2 and 5 cm (medians)",
                       ["scene", "variant", "surface", "share",
                        *(f"{fusion} {centimeters} cm" for fusion, _ in FUSIONS
                          for centimeters in (2, 5))], lines)


def plane_table(rows):
    """The large planes of each row's first seed; nothing without any."""
    lines = [[row.name, row.identity["variant"],
              *(f"{value:.{digits}f}"
                for value, digits in zip(plane, (3, 4, 4, 4)))]
             for row in rows for plane in row.scores[0].get("planes", ())]
    if not lines:
        return []
    return table_lines("### Large planes (first seed): share of the pixels on "
                       "planes, and distance behind the true surface in "
                       "units of the scene (quartiles)",
                       ["scene", "variant", "share", "25 %", "50 %", "75 %"],
                       lines)


def report_lines(runs, commit):
    """The whole report in Markdown."""
    rows = group_rows(runs)
    seeds = sorted({run["seed"] for run in runs})
    lines = ["## Accuracy suite", "",
             f"Commit {commit}; {len(seeds)} seeds. Cells: before → median "
             "after ± standard error over the seeds; before is that of the "
             "maps that refinement began with. A mean is over the rows that "
             "have the score. Planes and copies: / those among the true "
             "surfaces."]
    for role in dict.fromkeys(row.identity["role"] for row in rows):
        lines += role_table(role, [row for row in rows
                                   if row.identity["role"] == role])
    lines += cloud_table(rows)
    if len({row.identity["variant"] for row in rows}) > 1:
        for column in VARIANT_COLUMNS:
            lines += variant_table(*column, rows)
    return lines + surface_table(rows) + plane_table(rows)
