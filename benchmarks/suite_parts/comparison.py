# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Whether one variant is better than another, by a rule set beforehand."""

import json
import math
import statistics
from dataclasses import dataclass
from pathlib import Path

from programs import CommandFailed, table_lines
from suite_parts.tables import group_rows
from suite_parts.variants import DEFAULT

GAIN = 2  # Standard errors that the mean of the tuning scenes must gain,
LOSS = 1  # and that no testing scene may lose.
# Name; the score's key and number, and the substitute where no cloud was fused;
# 1 if more is better. The rule judges the first three, the others are reported.
MEASURES = (
    ("F1 2 cm", (("cloud_0.02", 2), ("depth_all_0.02", 2)), 1),
    ("F1 5 cm", (("cloud_0.05", 2), ("depth_all_0.05", 2)), 1),
    ("HARM", (("harm", None),), -1),
    ("sparse right 1 %", (("sparse_right_1", None),), 1),
    ("views disagree", (("view_disagreement", None),), -1))
NUM_JUDGED = 3


@dataclass
class Difference:
    """Between means over seeds, positive where the second variant is better."""
    value: float
    error: float

    def text(self):
        return f"{self.value:+.4f} ± {self.error:.4f}"


def mean_difference(differences):
    """The mean, and its error if those of the parts are independent."""
    return Difference(
        statistics.fmean(part.value for part in differences),
        math.sqrt(sum(part.error ** 2 for part in differences))
        / len(differences))


def difference_of_rows(first, second, keys, sign):
    for key, index in keys:
        pair = [row.sample(key, index) for row in (first, second)]
        if None not in pair:
            return Difference(sign * (pair[1].mean - pair[0].mean),
                              math.hypot(pair[0].error, pair[1].error))
    return None


def differences_by_scene(first, second, keys, sign):
    """(role, scene) -> the mean over the configurations that both have."""
    def place(row):
        return tuple(row.identity[key] for key in ("role", "scene", "size",
                                                   "noise", "maps"))

    others = {place(row): row for row in second}
    found = {}
    for row in first:
        if place(row) in others:
            difference = difference_of_rows(row, others[place(row)], keys,
                                            sign)
            if difference is not None:
                found.setdefault(place(row)[:2], []).append(difference)
    return {scene: mean_difference(parts) for scene, parts in found.items()}


def judge(by_scene):
    """The rule for one measure: (whether it is kept, why)."""
    tuning = [difference for (role, _), difference in by_scene.items()
              if role == "tuning"]
    testing = {scene: difference for (role, scene), difference
               in by_scene.items() if role == "testing"}
    if any(math.isnan(part.error) for part in by_scene.values()):
        return False, "undecided: a standard error needs two seeds or more"
    if not tuning:
        return False, "undecided: no tuning scene has this measure"
    mean = mean_difference(tuning)
    if not mean.value > 0 or mean.value < GAIN * mean.error:
        return False, (f"not kept: the tuning scenes gain {mean.text()}, less "
                       f"than {GAIN} standard errors")
    lost = [scene for scene, part in testing.items()
            if part.value < -LOSS * part.error]
    if lost:
        return False, ("not kept: more than one standard error is lost on "
                       + ", ".join(lost))
    return True, f"kept: the tuning scenes gain {mean.text()}"


def compare(first, second, names):
    """The lines of a comparison of two lists of runs, in Markdown."""
    rows = [group_rows(first), group_rows(second)]
    tables = {name: differences_by_scene(*rows, keys, sign)
              for name, keys, sign in MEASURES}
    places = sorted({place for table in tables.values() for place in table},
                    key=lambda place: (place[0] != "tuning", place[1]))
    if not places:
        raise CommandFailed(f"--compare {' '.join(names)}: they have no scene "
                            "and score in common")
    cells = [[scene, role, *(tables[name][role, scene].text()
                             if (role, scene) in tables[name] else "-"
                             for name in tables)] for role, scene in places]
    for role in dict.fromkeys(role for role, _ in places):
        means = []
        for table in tables.values():
            parts = [part for (other, _), part in table.items()
                     if other == role]
            means.append(mean_difference(parts).text() if parts else "-")
        cells.append([f"**mean, {role}**", role, *means])
    lines = table_lines(f"### {names[1]} against {names[0]}",
                        ["scene", "role", *tables], cells)
    lines += ["", "Positive is better, also of HARM and of views that disagree; "
              "± is the standard error over the seeds.", ""]
    return lines + [f"- {name}: {judge(tables[name])[1]}"
                    for name, *_ in MEASURES[:NUM_JUDGED]]


def runs_of_folder(text):
    """The runs that a folder of results lists: FOLDER or FOLDER:VARIANT."""
    folder, _, variant = text.partition(":")
    path = Path(folder) / "suite.json"
    try:
        runs = json.loads(path.read_text())["runs"]
    except (OSError, ValueError, KeyError) as error:
        raise CommandFailed(f"{path}: no results of benchmarks/suite; --compare "
                            "takes names of variants or folders given as "
                            "--results") from error
    names = {run["variant"] for run in runs}
    if not variant:
        variant = DEFAULT if DEFAULT in names or len(names) > 1 else min(names)
    if variant not in names:
        raise CommandFailed(f"{path}: no variant '{variant}'; name one as "
                            f"FOLDER:VARIANT, of {', '.join(sorted(names))}")
    return [run for run in runs if run["variant"] == variant]


def lines_of_folders(names):
    first, second = map(runs_of_folder, names)
    return compare(first, second, names)


def lines_of_variants(runs, names):
    for name in names:
        if not any(run["variant"] == name for run in runs):
            raise CommandFailed(f"--compare: no runs of the variant '{name}'")
    first, second = ([run for run in runs if run["variant"] == name]
                     for name in names)
    return compare(first, second, names)
