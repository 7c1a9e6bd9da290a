# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Precision, recall and F-score as Tanks and Temples defines them, by
tsar_evaluate.

The benchmark brings the cloud into the frame of the ground truth, cuts both to a
given volume, thins both to a grid of half the threshold, and counts the points of
each that have one of the other within the threshold. That share is what
tsar_evaluate calls completeness, of the one as the scan by the other as the
reconstruction; both ways give recall and precision. The benchmark's own toolbox
also refines the alignment by ICP, which is not done here.
"""
import dataclasses
import json
import pathlib

import numpy as np

import dense
from files import DatasetError, parse_numbers, read_lines, write_text
from ply import read_ply, write_points, write_project

# Meters, from the benchmark's toolbox.
THRESHOLDS = {"Barn": 0.01, "Caterpillar": 0.005, "Church": 0.025, "Courthouse": 0.025,
              "Ignatius": 0.003, "Meetingroom": 0.01, "Truck": 0.005}


@dataclasses.dataclass
class Crop:
    """A prism: a polygon in the plane of two axes, between two values of a third."""
    axis: int            # 0, 1, 2: along which it extends.
    low: float
    high: float
    polygon: np.ndarray  # n x 2, in the other axes in their order.

    def contains(self, points):
        along = points[:, self.axis]
        x, y = np.delete(points, self.axis, axis=1).T
        inside = np.zeros(len(points), bool)
        for (ax, ay), (bx, by) in zip(self.polygon, np.roll(self.polygon, -1, axis=0)):
            # Each edge that a ray towards growing x crosses turns the answer.
            crosses = (ay > y) != (by > y)
            with np.errstate(divide="ignore", invalid="ignore"):
                inside ^= crosses & (x < ax + (y - ay) / (by - ay) * (bx - ax))
        return inside & (along >= self.low) & (along <= self.high)


@dataclasses.dataclass
class Truth:
    cloud: pathlib.Path
    files: list              # All files of the ground truth.
    transform: np.ndarray    # 4 x 4, from the frame of the given poses.
    crop: Crop


def read_crop(path):
    try:
        crop = json.loads("\n".join(read_lines(path, "the volume that is scored")))
        axis = "XYZ".index(crop["orthogonal_axis"].upper())
        polygon = np.delete(np.array(crop["bounding_polygon"], float), axis, axis=1)
        if len(polygon) < 3 or polygon.shape[1] != 2 or not np.isfinite(polygon).all():
            raise ValueError
        return Crop(axis, float(crop["axis_min"]), float(crop["axis_max"]), polygon)
    except (ValueError, KeyError, TypeError, AttributeError, IndexError):
        raise DatasetError(f"{path}: is not a volume as Open3D writes it (axis_min, "
                           "axis_max, orthogonal_axis, bounding_polygon)") from None


def read_transform(path):
    lines = [line for line in read_lines(path, "a 4 x 4 matrix") if line.strip()]
    if len(lines) != 4:
        raise DatasetError(f"{path}: {len(lines)} lines instead of the 4 of a matrix")
    return np.array([parse_numbers(line, 4, f"{path}: line {number}")
                     for number, line in enumerate(lines, 1)])


def read_truth(path):
    """The ground truth of a scene's folder, or None."""
    names = [f"{path.name}{ending}" for ending in (".ply", "_trans.txt", ".json")]
    files = [path / name for name in names]
    there = [file.is_file() for file in files]
    if not any(there):
        return None
    if not all(there):
        raise DatasetError(f"{files[there.index(False)]}: not found beside "
                           f"{files[there.index(True)].name}; ground truth has all of "
                           f"{', '.join(names)}")
    return Truth(files[0], files, read_transform(files[1]), read_crop(files[2]))


def thin_out(points, size):
    """The mean of the points in each cell of a grid."""
    cells = np.floor(points / size).astype(np.int64)
    cells -= cells.min(0)
    # One number per cell, which is much faster to sort than three.
    cells = np.ravel_multi_index(tuple(cells.T), tuple(cells.max(0) + 1))
    _, index, count = np.unique(cells, return_inverse=True, return_counts=True)
    means = np.stack([np.bincount(index, points[:, a]) for a in range(3)], 1)
    return means / count[:, None]


def prepare(path, transform, crop, size, output):
    """Writes a cloud as it is scored, and a project that lists it as a scan."""
    points = read_ply(path).points
    points = points @ transform[:3, :3].T + transform[:3, 3]
    points = points[crop.contains(points)]
    if not len(points):
        raise DatasetError(f"{path}: has no points in the volume that is scored; are the "
                           "poses and the ground truth of one scene?")
    write_points(output, thin_out(points, size))
    write_project(output.with_suffix(".mlp"), [(output.name, np.eye(4))])


def score(scene, programs, truth, threshold):
    folder = scene.folder / "scores"
    options = {"tolerances": threshold, "voxel_size": threshold / 2}

    def action(step):
        folder.mkdir()
        prepare(truth.cloud, np.eye(4), truth.crop, threshold / 2, folder / "truth.ply")
        for name in ("before", "after"):
            cloud = folder / f"{name}.ply"
            prepare(scene.folder / f"{name}.ply", truth.transform, truth.crop,
                    threshold / 2, cloud)
            shares = {}
            for share, points, scan in (("recall", cloud, folder / "truth.mlp"),
                                        ("precision", folder / "truth.ply",
                                         cloud.with_suffix(".mlp"))):
                output = folder / f"{name}.{share}.json"
                dense.evaluate(step, programs, points, scan, output, options)
                result = json.loads(output.read_text(encoding="utf-8"))
                shares[share] = result["scores"][0]["completeness"]
                output.unlink()
            total = shares["recall"] + shares["precision"]
            f = 2 * shares["recall"] * shares["precision"] / total if total else 0.0
            write_text(folder / f"{name}.json",
                       json.dumps({"threshold": threshold, **shares, "f_score": f}) + "\n")

    scene.step("scores", action, outputs=["scores"], inputs=truth.files,
               after=["fusion_before", "fusion_after"],
               options={**options, "colmap_tsar": programs.versions["colmap_tsar"]})
    before, after = (json.loads((folder / f"{name}.json").read_text(encoding="utf-8"))
                     for name in ("before", "after"))
    print(f"{f'at {1000 * threshold:g} mm':<24}{'before':>10}{'after':>10}")
    for name in ("precision", "recall", "f_score"):
        print(f"{name:<24}{before[name]:>10.3f}{after[name]:>10.3f}", flush=True)
