# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Camera trajectories of Tanks and Temples, .log files: for each image a line
'i j k' and the 4 x 4 matrix from camera to world. i is the image's number in the
order of the names, from 0 on; j is the same, or -1 where the pose is not known."""
import numpy as np

from files import DatasetError, parse_numbers, read_lines, write_text
from model import pose_from_camera_to_world


def read_trajectory(path, names):
    """Poses by name, of those images that have one; names are sorted."""
    lines = [(number, line) for number, line in
             enumerate(read_lines(path, "the camera poses of a scene"), 1) if line.strip()]
    if not lines or len(lines) % 5:
        raise DatasetError(f"{path}: {len(lines)} lines, not 5 for each image (numbers, and "
                           "a matrix of 4 lines)")
    poses, seen = {}, set()
    for begin in range(0, len(lines), 5):
        number, header = lines[begin]
        place = f"{path}: line {number}"
        index, other, _ = parse_numbers(header, 3, place, int)
        matrix = np.array([parse_numbers(line, 4, f"{path}: line {number}")
                           for number, line in lines[begin + 1:begin + 5]])
        if not 0 <= index < len(names):
            raise DatasetError(f"{place}: image {index}, but there are {len(names)} images; "
                               "take all images that the poses are of, and no others")
        if index in seen:
            raise DatasetError(f"{place}: image {index} for the second time")
        seen.add(index)
        if other < 0:
            continue
        if np.abs(matrix[3] - (0, 0, 0, 1)).max() > 1e-9:
            raise DatasetError(f"{place}: the last line of its matrix is not 0 0 0 1")
        poses[names[index]] = pose_from_camera_to_world(matrix[:3, :3], matrix[:3, 3], place)
    return poses


def write_trajectory(path, names, poses):
    """An entry for each of the sorted names; those without a pose get -1 and the
    identity, as the benchmark's own tools write it."""
    text = ""
    for index, name in enumerate(names):
        known = name in poses
        matrix = poses[name].world_from_camera() if known else np.eye(4)
        text += f"{index} {index if known else -1} 0\n"
        text += "".join(" ".join(repr(float(v)) for v in row) + "\n" for row in matrix)
    write_text(path, text)
