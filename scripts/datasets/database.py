# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""COLMAP's database of features and matches, as far as it is needed here."""
import contextlib
import sqlite3

import numpy as np

MODEL_IDS = {"SIMPLE_PINHOLE": 0, "PINHOLE": 1, "SIMPLE_RADIAL": 2}
MAX_IMAGE_ID = 2147483647  # A pair's id is first * this + second.


@contextlib.contextmanager
def opened(path):
    connection = sqlite3.connect(path)
    try:
        with connection:
            yield connection
    finally:
        connection.close()


def read_image_ids(path):
    """(image id, camera id) by image name."""
    with opened(path) as connection:
        rows = connection.execute("SELECT name, image_id, camera_id FROM images")
        return {name: (image_id, camera_id) for name, image_id, camera_id in rows}


def set_cameras(path, cameras):
    """Gives cameras, by id, these models and parameters, as known ones."""
    with opened(path) as connection:
        connection.executemany(
            "UPDATE cameras SET model = ?, width = ?, height = ?, params = ?, "
            "prior_focal_length = 1 WHERE camera_id = ?",
            [(MODEL_IDS[c.model], c.width, c.height,
              np.array(c.params, "<f8").tobytes(), camera_id)
             for camera_id, c in cameras.items()])


def clear_matches(path):
    """Takes away what was matched; the features stay."""
    with opened(path) as connection:
        for table in ("matches", "two_view_geometries"):
            connection.execute(f"DELETE FROM {table}")


def read_matches(path):
    """(name, name, points, points) of each pair of images with verified matches;
    points are n x 2, pixels with (0.5, 0.5) in the middle of the first."""
    with opened(path) as connection:
        names = dict(connection.execute("SELECT image_id, name FROM images"))
        keypoints = {
            image_id: np.frombuffer(data, "<f4").reshape(rows, cols)[:, :2]
            for image_id, rows, cols, data in connection.execute(
                "SELECT image_id, rows, cols, data FROM keypoints WHERE rows > 0")}
        pairs = connection.execute(
            "SELECT pair_id, rows, data FROM two_view_geometries WHERE rows > 0 "
            "ORDER BY pair_id").fetchall()
    for pair_id, rows, data in pairs:
        first, second = divmod(pair_id, MAX_IMAGE_ID)
        indices = np.frombuffer(data, "<u4").reshape(rows, 2)
        yield (names[first], names[second], keypoints[first][indices[:, 0]],
               keypoints[second][indices[:, 1]])
