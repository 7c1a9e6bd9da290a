#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""The measures of suite on maps with known answers."""

import argparse
import math
import shutil
import struct
import sys
import xml.etree.ElementTree
import zlib
from pathlib import Path

import numpy as np

from copied_scene import KEYPOINT, Scene, make_copies
from programs import CommandFailed, run
from suite_parts.agreement import check_sparse, check_view_agreement
from suite_parts.comparison import compare, judge, Difference
from suite_parts.harm import Calibration, measure_truth
from suite_parts.maps import Maps, read_gray_png, write_map
from suite_parts.outliers import measure_outliers
from suite_parts.photographs import with_noise
from suite_parts.plots import write_plots
from suite_parts.sparse_model import (TRACK_ELEMENT, Camera, Point, PosedImage,
                                      SparseModel, read_model, write_text)
from suite_parts.plane_copies import (check_true_planes, count_surfaces,
                                      find_true_surfaces, surface_of_labels)
from suite_parts.planes import check_planes
from suite_parts.surfaces import check_surfaces, read_points, within
from suite_parts.tables import Sample, report_lines
from suite_parts.texture import count_right, f1_scores, is_textured
from suite_parts.variants import make_variants
from testing import check

NAME = "a.png"


def filtered(row, above, kind, step):
    """A row of bytes as PNG stores it; step: bytes of a pixel."""
    stored = [kind]
    before = [0] * step
    for value, up, left, corner in zip(row, above, before + row,
                                       before + above):
        estimate = left + up - corner
        nearest = min((left, up, corner), key=lambda near: abs(estimate - near))
        guess = (0, left, up, (left + up) // 2, nearest)[kind]
        stored.append((value - guess) % 256)
    return bytes(stored)


def write_gray_png(path, pixels, depth=8):
    def chunk(kind, body):
        return (struct.pack(">I", len(body)) + kind + body
                + struct.pack(">I", zlib.crc32(kind + body)))

    width, step = pixels.shape[1], max(depth // 8, 1)
    stored = np.ascontiguousarray(pixels.astype(f">u{step}")).view(np.uint8)
    rows, above = b"", [0] * stored.shape[1]
    for y, row in enumerate(stored.tolist()):
        rows += filtered(row, above, y % 5, step)
        above = row
    packed = zlib.compress(rows)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", struct.pack(">IIBBBBB", width, len(pixels),
                                     depth, 0, 0, 0, 0))
        + chunk(b"IDAT", packed[:9]) + chunk(b"IDAT", packed[9:])
        + chunk(b"IEND", b""))


def check_png(folder):
    pixels = np.random.default_rng(1).integers(0, 256, (25, 31))
    write_gray_png(folder / "gray.png", pixels)
    check((read_gray_png(folder / "gray.png") == pixels).all(),
          "a PNG is read, whatever its filters")
    deep = np.random.default_rng(1).integers(0, 65536, (25, 31))
    write_gray_png(folder / "deep.png", deep, 16)
    check((read_gray_png(folder / "deep.png") == deep).all(),
          "a PNG of 16 bits is read")
    write_gray_png(folder / "packed.png", pixels, 4)
    try:
        read_gray_png(folder / "packed.png")
        check(False, "a PNG of 4 bits is refused")
    except CommandFailed as failure:
        check("packed.png" in str(failure), "a PNG of 4 bits is refused")


def put(workspace, kind, name, values, map_type="geometric"):
    write_map(workspace / "stereo" / f"{kind}_maps" / f"{name}.{map_type}.bin",
              values)


def check_harm(folder):
    """Of 100 pixels, 80 were right: 8 are off by 4 %, 4 by 8 %, 2 are gone."""
    scene, refined = folder / "before", folder / "after"
    truth = np.full((10, 10), 2.0)
    truth[0] = 0  # Unknown, whatever the maps say.
    old = truth.copy()
    old[0] = 5
    old[1, :] *= 1.02  # Was not right.
    new = old.copy()
    new[0] = 0
    new[1, :] = 0
    new[2, :8] *= 1.04
    new[3, :4] *= 1.08
    new[4, :2] = 0
    new[5] *= 1.02  # No longer right, yet no harm.
    write_map(scene / "ground_truth" / "depth" / f"{NAME}.bin",
              np.kron(truth, np.ones((3, 3))))
    put(scene, "depth", NAME, old)
    put(refined, "depth", NAME, new)
    confidence = np.full((10, 10), 238)
    confidence[2:4] = 51
    path = Maps(refined).path("confidence", NAME, "png")
    path.parent.mkdir(parents=True)
    write_gray_png(path, confidence)
    scores = measure_truth(scene, Maps(scene), Maps(refined))
    close = {"harm": 14 / 80, "harm_far": 6 / 80, "lost": 2 / 80,
             # 8 of 20 are right at 51 of 255, and 48 of 58 at 238.
             "calibration_error": (20 * 0.2 + 58 * (238 / 255 - 48 / 58)) / 78,
             "calibration_gap": 0.2}
    for key, value in close.items():
        check(abs(scores[key] - value) < 1e-6, f"{key} is {value:.4f}")
    check(scores["calibration_pixels"] == [0, 0, 20, 0, 0, 0, 0, 0, 0, 58],
          "pixels are counted in tenths")


def check_outliers(folder):
    """A plane at depth 2 in front of a far corner: of 840 depths that are there
    and known, 34 are off, 8 of them at the corner, where nothing is smooth."""
    scene = folder / "outliers"
    truth = np.full((30, 30), 2.0)
    truth[0] = 0  # Unknown.
    truth[20:, 20:] = 3.0
    depth = truth.copy()
    depth[0] = 7
    depth[1] = 0  # No depth.
    depth[5, :8] = 2.2  # Measured.
    depth[6, :6] = 1.8  # Filled.
    depth[7, :8] = 2.11  # Guessed.
    depth[4, :4] = 2.2  # Of a prior.
    depth[8, :8] = 2.09  # Not enough to be plainly wrong.
    depth[18, 20:28] = 4  # Measured, close to the corner.
    origin = np.full((30, 30), 1)
    origin[:, 9:] = 2
    origin[6, :6] = 4
    origin[7, :8] = 6
    origin[4, :4] = 7
    write_map(scene / "ground_truth" / "depth" / f"{NAME}.bin", truth)
    put(scene, "depth", NAME, depth)
    before = measure_outliers(scene, Maps(scene))
    write_gray_png(Maps(scene).path("provenance", NAME, "png"), origin)
    after = measure_outliers(scene, Maps(scene))
    for key, value in {"outliers": 34 / 840, "outliers_measured": 16 / 822,
                       "outliers_filled": 1, "outliers_guessed": 1,
                       "outliers_prior": 1,
                       "specks": 8 / 870}.items():
        check(abs(after[key] - value) < 1e-9, f"{key} is {value:.4f}")
    check(before["outliers"] == before["outliers_measured"] == 34 / 840
          and before["outliers_filled"] is None
          and abs(before["specks"] - 26 / 870) < 1e-9,
          "all depths of maps without an origin are measured")
    (scene / "ground_truth" / "depth" / f"{NAME}.bin").unlink()
    check(not measure_outliers(scene, Maps(scene)),
          "without true depth there are no outliers to count")


def check_planes_off(folder):
    """A slanted wall 2 m away that lies .03 in front of the truth along its
    normal, one far off its surface, and a speck."""
    model, scene = two_views(0.1), folder / "planes"
    height, width = 30, 40
    y, x = np.mgrid[:height, :width] + 0.5
    slant = np.array([0.6, 0, -0.8])
    rays = np.stack([(x - 20) / 40, (y - 15) / 40, np.ones_like(x)])
    depth = -1.6 / np.tensordot(slant, rays, 1)
    truth = -1.63 / np.tensordot(slant, rays, 1)
    plane = np.ones((height, width), int)
    plane[20:] = 300
    truth[20:] = depth[20:] * 0.5
    plane[0] = 0
    plane[1, :5] = 2
    truth[2] = 0
    name = model.images[0].name
    write_map(scene / "ground_truth" / "depth" / f"{name}.bin", truth)
    put(scene, "depth", name, depth)
    put(scene, "normal", name, np.broadcast_to(slant[:, None, None],
                                               (3, height, width)))
    maps = Maps(scene)
    check(check_planes(scene, model, maps) == {}, "no plane maps, no planes")
    write_gray_png(maps.path("plane", name, "png"), plane, 16)
    scores = check_planes(scene, model, maps)
    first, second = scores["planes"]
    on_planes = 29 * 40 - 40
    check(abs(first[0] - (18 * 40 - 5) / on_planes) < 1e-9
          and np.allclose(first[1:], -0.03, atol=1e-5),
          "a plane lies before the truth by its distance along the normal")
    check(abs(second[0] - 400 / on_planes) < 1e-9
          and np.allclose(second[1:], 0.8, atol=1e-5),
          "another lies behind it; one of five pixels is left out")
    expected = (first[0] * 0.03 + second[0] * 0.8) / (first[0] + second[0])
    check(abs(scores["plane_offset"] - expected) < 1e-5,
          "the mean is weighed by pixels")


def rectangle(corner, along, across, width, height, spacing=0.02):
    """Points of a rectangle, each inside a cell of the scans' grid if corner
    and axes are those of a cell."""
    u, v = np.indices((round(width / spacing), round(height / spacing)))
    return (np.array(corner, float)
            + spacing * (u.reshape(-1, 1) * np.array(along, float)
                         + v.reshape(-1, 1) * np.array(across, float)) + 0.005)


def write_ply(path, points, form="binary_little_endian"):
    rows = np.zeros(len(points), [("red", "u1"), *((axis, "<f4")
                                                   for axis in "xyz")])
    for axis, values in zip("xyz", points.T):
        rows[axis] = values
    path.write_bytes(f"ply\nformat {form} 1.0\ncomment scan\nelement vertex "
                     f"{len(points)}\nproperty uchar red\nproperty float x\n"
                     "property float y\nproperty float z\nelement camera 1\n"
                     "property float view\nend_header\n".encode()
                     + rows.tobytes() + bytes(4))


def check_distances():
    """Against all distances, of a cloud in which some points are far off."""
    random = np.random.default_rng(4)
    points = random.uniform(-0.3, 0.3, (400, 3))
    cloud = np.concatenate([random.uniform(-0.2, 0.4, (900, 3)),
                            [[1e30, 0, 0], [0, -1e9, 0], [np.nan, 0, 0]]])
    for distance in (0.02, 0.05):
        expected = (np.linalg.norm(points[:, None] - cloud[:900], axis=2)
                    <= distance).any(1)
        check(0 < expected.mean() < 0.9
              and (within(points, cloud, distance) == expected).all(),
              f"points within {distance:g} are found")
    check(not within(points, cloud[:0], 1).any()
          and not len(within(points[:0], cloud, 1)), "nothing is near nothing")


def check_surfaces_of_scans(folder):
    """A floor of 2,000 points, a wall of 1,000, a shelf of 160 and clutter."""
    folder = folder / "scans"
    folder.mkdir()
    floor = rectangle((-0.4, -0.5, 0), (1, 0, 0), (0, 1, 0), 0.8, 1)
    wall = rectangle((-0.4, 1, 0.2), (1, 0, 0), (0, 0, 1), 0.8, 0.5)
    shelf = rectangle((-0.2, 0.6, 0.4), (1, 0, 0), (0, 1, 0), 0.32, 0.2)
    clutter = np.random.default_rng(5).uniform(2, 4, (20, 3))
    turn = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1.0]])
    place = np.array([0.3, -0.2, 0.7])
    # What is scanned more densely has no larger share.
    write_ply(folder / "a.ply", np.concatenate([floor, floor[:500] + 0.001]))
    write_ply(folder / "b.ply", (np.concatenate([wall, shelf, clutter]) - place)
              @ turn)
    matrix = np.eye(4)
    matrix[:3] = np.column_stack([turn, place])
    project = folder / "scan_alignment.mlp"
    project.write_text("<MeshLabProject><MeshGroup>" + "".join(
        f'<MLMesh filename="{name}.ply"><MLMatrix44>'
        f"{' '.join(map(str, values.ravel()))}</MLMatrix44></MLMesh>"
        for name, values in (("a", np.eye(4)), ("b", matrix)))
        + "</MeshGroup></MeshLabProject>")
    # Of the floor's 40 rows, 20 are 1 cm off, and 10 are 4 cm off, which are
    # within 5 cm of the next row.
    row = np.round((floor[:, 0] + 0.395) / 0.02)
    cloud = folder / "cloud.ply"
    write_ply(cloud, np.concatenate([
        floor[row < 20] + [0, 0, 0.01],
        floor[(row >= 20) & (row < 30)] + [0, 0, 0.04],
        wall[wall[:, 2] > 0.6], clutter]))
    scores = check_surfaces(project, cloud)
    first, second, third = scores["surfaces"]
    check(np.allclose(first, [0, 0, 1, 0.005, 2000 / 3180, 0.5, 31 / 40],
                      atol=1e-5), f"the floor is {first}")
    # Two rows of the wall are within 5 cm of the last one that is there.
    check(np.allclose(second, [0, 1, 0, 1.005, 1000 / 3180, 5 / 25, 7 / 25],
                      atol=1e-5), f"the wall is {second}")
    check(np.allclose(third, [0, 0, 1, 0.405, 160 / 3180, 0, 0], atol=1e-5),
          f"the shelf is {third}")
    check(scores["worst_surface"] == second[6],
          "the worst surface has a tenth of the scans")
    write_ply(folder / "ascii.ply", floor, "ascii")
    try:
        read_points(folder / "ascii.ply")
        check(False, "another format is refused")
    except CommandFailed as failure:
        check("ascii.ply" in str(failure), "another format is refused")


def check_plane_counts(folder):
    """What a view sees at 1 m, with pixels of 1.25 cm: a wall with two labels,
    2 cm apart, a cupboard in front and a speck; the floor has no label."""
    model, scene = two_views(0.1), folder / "counts"
    depth, plane = np.full((60, 80), 1.0), np.full((60, 80), 7)
    plane[:, 30:] = 4
    depth[:, 30:] = 1.02
    plane[:, 55:] = 300
    depth[:, 55:] = 0.8
    plane[:9, :9] = 5
    depth[:9, :9] = 0.98
    plane[50:] = 0
    depth[50:] = 3
    name = model.images[0].name
    put(scene, "depth", name, depth)
    maps = Maps(scene)
    write_gray_png(maps.path("plane", name, "png"), plane, 16)
    scores = check_planes(scene, model, maps)
    check(scores["num_planes"] == 3, "planes are counted without a true depth")
    check(scores["plane_copies"] == 1
          and abs(scores["copy_offset_cm"] - 2) < 1e-3,
          "two labels of a wall are copies")
    check(check_true_planes(scene, model, maps) == {},
          "without true depth there are no true planes")
    # In truth the wall is one, and a picture hangs 3 cm in front.
    truth = np.full((60, 80), 1.0)
    truth[:, 60:] = 0.8
    truth[10:50, 10:50] = 0.97
    truth[0] = 0
    write_map(scene / "ground_truth" / "depth" / f"{name}.bin", truth)
    true = check_true_planes(scene, model, maps)
    check(true["true_num_planes"] == 3 and true["true_plane_copies"] == 1
          and abs(true["true_copy_offset_cm"] - 3) < 1e-3,
          "true planes and copies are counted")


def copies_of(second):
    """Copies among a rectangle at z = 0 and another."""
    return count_surfaces([surface_of_labels(points) for points in (rectangle(
        (0, 0, 0), (1, 0, 0), (0, 1, 0), 1, 1, 0.01), second)])["plane_copies"]


def check_copies():
    for words, count, corner, angle in (
            ("over it", 1, (0.2, 0.2, 0.05), 0),
            ("slanting by 4 degrees", 1, (0.2, 0.2, 0.01), 4),
            ("slanting by 6 degrees", 0, (0.2, 0.2, 0.01), 6),
            ("8 cm off", 0, (0.2, 0.2, 0.08), 0),
            ("8 cm beside it", 1, (1.08, 0, 0.02), 0),
            ("15 cm beside it", 0, (1.15, 0, 0.02), 0)):
        slope = math.radians(angle)
        across = (0, math.cos(slope), math.sin(slope))
        check(copies_of(rectangle(corner, (1, 0, 0), across, 0.4, 0.4, 0.01))
              == count, f"a plane {words} is {'a' if count else 'no'} copy")
    check(copies_of(rectangle((0.2, 0.2, 0.05), (1, 0, 0), (0, 1, 0), 0.3, 0.2,
                              0.01)) == 0, "a small one is no plane")
    wall = rectangle((0, 0, 0), (1, 0, 0), (0, 1, 0), 1, 1, 0.01)
    off = wall[::10] + [1.5, 0, 0.5]
    surface = surface_of_labels(np.concatenate([wall, off]))
    check(abs(abs(surface.offset) - 0.005) < 1e-9
          and abs(surface.area - 1) < 0.05, "pixels off a plane are no part")


def check_true_surfaces():
    """A floor in two parts, two small tiles in another plane, a column and
    leaves."""
    random, up = np.random.default_rng(6), np.array([0, 0, 1.0])

    def flat(x, y, z, width, height):
        points = rectangle((x, y, z), (1, 0, 0), (0, 1, 0), width, height, 0.01)
        return points, np.broadcast_to(up, points.shape)

    angle, height = np.meshgrid(np.arange(0, 2 * np.pi, 0.03),
                                np.arange(0, 2, 0.01))
    around = np.stack([np.cos(angle), np.sin(angle), 0 * angle],
                      -1).reshape(-1, 3)
    leaves = random.uniform(5, 6, (2000, 3))
    directions = random.normal(size=leaves.shape)
    points, normals = map(np.concatenate, zip(
        flat(-2, -2, 0, 1, 1), flat(3, 3, 0, 0.5, 0.5),
        flat(1, 1, 0.2, 0.25, 0.25), flat(4, 1, 0.2, 0.25, 0.25),
        (0.3 * around + height.reshape(-1, 1) * up, around),
        (leaves, directions / np.linalg.norm(directions, axis=1)[:, None])))
    found = find_true_surfaces(points, normals)
    check(count_surfaces(found)["num_planes"] == 1
          and abs(found[0].area - 1.25) < 0.06
          and abs(found[0].piece.mean() - 0.8) < 0.02,
          "the floor is the only plane")
    under = find_true_surfaces(
        *map(np.concatenate, zip(flat(0, 0, 0, 1, 1), flat(0, 0, 0.015, 1, 1))))
    check(len(under) == 2, "1.5 cm apart are two planes")


def check_calibration():
    calibration = Calibration()
    # One pixel in a hundred and fifty is too few for the largest gap.
    confidence = np.append(np.full(150, 0.5), 1.0)
    depth = np.append(np.tile([1.0, 2.0], 75), 2.0)
    calibration.add(confidence, depth, np.ones(151))
    scores = calibration.scores()
    check(abs(scores["calibration_error"] - 1 / 151) < 1e-9
          and scores["calibration_gap"] == 0, "a confidence that is right")
    check(scores["calibration_pixels"][9] == 1, "1 is in the last tenth")
    check(not Calibration().scores(), "nothing known gives no score")


def two_views(shift):
    """Two cameras side by side, and points at depth 2."""
    random = np.random.default_rng(2)
    points = [Point(i, np.array([*random.uniform(-0.3, 0.3, 2), 2.0]),
                    (0, 0, 0), 0.5,
                    np.array([(1, i), (2, i), (1, i)], TRACK_ELEMENT))
              for i in range(20)]
    points.append(Point(99, np.array([0, 0, 1.0]), (0, 0, 0), 3.0,
                        points[0].track))
    images = [PosedImage(i + 1, np.array([1.0, 0, 0, 0]),
                         np.array([-shift * i, 0, 0]), 7, f"{name}/1.png",
                         np.zeros(0, KEYPOINT))
              for i, name in enumerate("ab")]
    return SparseModel({7: Camera(7, "SIMPLE_PINHOLE", 80, 60,
                                  [80.0, 40.0, 30.0])}, images, points)


def check_views(folder):
    """The second view's depths are off by a factor."""
    for factor, disagreement in ((1.005, 0), (1.03, 1)):
        for width in (40, 160):
            model, workspace = two_views(0.1), folder / f"{factor}-{width}"
            for image, depth in zip(model.images, (2.0, 2.0 * factor)):
                shape = (width * 3 // 4, width)
                put(workspace, "depth", image.name, np.full(shape, depth))
                normals = np.zeros((3, *shape))
                normals[2] = -1
                put(workspace, "normal", image.name, normals)
                origin = np.full(shape, 4)
                origin[:, :3] = 1
                write_gray_png(Maps(workspace).path(
                    "provenance", image.name, "png"), origin)
            maps = Maps(workspace)
            found = check_view_agreement(model, maps)
            check(found["view_disagreement"] == disagreement
                  and found["view_turned"] == 0,
                  f"views differ by {factor} at {width} px")
            sparse = check_sparse(model, maps)
            right = 0.5 if factor > 1.01 else 1
            check(sparse["sparse_observations"] == 40
                  and sparse["sparse_with_depth"] == 1
                  and sparse["sparse_right_1"] == right
                  and sparse["sparse_right_2"] == right,
                  "observations of points are checked")
    empty = Maps(folder, "geometric")
    check(check_view_agreement(model, empty) == {}
          and check_sparse(model, empty) == {}, "no maps give no scores")


def check_model(folder):
    sample = folder / "sample"
    root = Path(__file__).resolve().parent.parent
    run([sys.executable, root / "scripts" / "sample_scene.py", "unpack",
         root / "data" / "sample", sample])
    make_copies(Scene(sample, folder / "reduced", 8), folder / "copy", 1,
                "auto")
    text = read_model(sample / "sparse")
    binary = read_model(folder / "copy" / "sparse")
    write_text(binary, folder / "written")
    for other in (binary, read_model(folder / "written")):
        check(text.cameras == other.cameras, "cameras are the same")
        check(all(np.allclose(a.keypoints["xy"], b.keypoints["xy"], atol=1e-3)
                  and (a.keypoints["point"] == b.keypoints["point"]).all()
                  and (a.translation == b.translation).all()
                  and b.name == f"0000_{a.name}"
                  for a, b in zip(text.images, other.images)),
              "images are the same")
        check(all((a.position == b.position).all() and a.color == b.color
                  and a.error == b.error and (a.track == b.track).all()
                  for a, b in zip(text.points, other.points)),
              "points are the same")
    camera, scaled = text.cameras[1], text.scaled(1600)
    larger = scaled.cameras[1]
    check((larger.width, larger.height) == (1600, 1200), "sizes are scaled")
    check(np.allclose(larger.params, np.array(
        camera.intrinsics((480, 640))) * 2.5), "intrinsics are scaled")
    check(np.allclose(scaled.images[0].keypoints["xy"],
                      text.images[0].keypoints["xy"] * 2.5),
          "keypoints are scaled")


def check_noise():
    random = np.random.default_rng(3)
    gray = with_noise(np.full((200, 300, 3), 128.0), 4, random)
    middle, corner = gray[90:110, 140:160].mean(), gray[:9, :9].mean()
    check(0.91 < middle / 128 < 1.09, "the exposure varies by up to 8 %")
    check(0.75 < corner / middle < 0.79, "corners are a quarter darker")
    spread = gray[90:110, 140:160].std() / math.sqrt(middle / 128)
    check(3.7 < spread < 4.3, "the noise is 4 levels at mid-gray")


def make_runs(scene, role, values, size=640, noise=0):
    """Runs of one variant; F1 is each value and HARM a tenth of it."""
    return [{"role": role, "scene": scene, "size": size, "noise": noise,
             "maps": "own", "variant": "v", "seed": seed, "seconds": 1.0,
             "before": {"cloud_0.05": [0.1, 0.1, 0.1]},
             "scores": {"cloud_0.05": [0.5, 0.5, value], "harm": value / 10}}
            for seed, value in enumerate(values)]


def check_rule(folder):
    sample = Sample([1.0, 2.0, 6.0])
    check(sample.median == 2 and sample.mean == 3
          and abs(sample.error - math.sqrt(7 / 3)) < 1e-9,
          "median and standard error")
    tuning, testing = ("tuning", "a"), ("testing", "b")
    for gain, loss, words in (
            (0.021, 0.009, "kept: "), (0.019, 0.009, "less than 2"),
            (0.021, 0.011, "lost on b"), (-0.5, 0, "less than 2")):
        kept, why = judge({tuning: Difference(gain, 0.01),
                           testing: Difference(-loss, 0.01)})
        check(words in why and kept == (words == "kept: "),
              f"the rule: {gain:g}, {loss:g}: {why}")
    # Two scenes halve the variance of their mean.
    check(judge({tuning: Difference(0.015, 0.01),
                 ("tuning", "c"): Difference(0.015, 0.01)})[0],
          "the rule looks at the mean")
    check("undecided" in judge({tuning: Difference(1, math.nan)})[1],
          "one seed decides nothing")
    old = (make_runs("a", "tuning", [0.50, 0.52])
           + make_runs("b", "testing", [0.70, 0.72]))
    new = (make_runs("a", "tuning", [0.60, 0.62])
           + make_runs("b", "testing", [0.70, 0.72]))
    lines = compare(old, new, ("old", "new"))
    check("- F1 5 cm: kept: the tuning scenes gain +0.1000 ± 0.0141" in lines,
          "more F1 is kept")
    check(any(line.startswith("- HARM: not kept") for line in lines),
          "more harm is not kept")
    check(any("HARM: kept" in line
              for line in compare(new, old, ("new", "old"))),
          "less harm is kept")
    report = "\n".join(report_lines(old, "unknown"))
    check("0.100 → 0.510 ± 0.010" in report and "### Testing scenes" in report,
          "a table for each role")
    check("Clouds of" not in report, "no clouds by tsar_fuse, no table of them")
    for one in old:
        one["scores"].update({
            "points": 100, "tsar_fuse_points": 300,
            "tsar_fuse_cloud_0.05": [0.5, 0.5, one["scores"]["harm"] * 11]})
    check_cloud_table(report_lines(old, "unknown"))
    check_surface_table(old)
    runs = [one for size in (640, 1280) for noise in (0, 4)
            for one in make_runs("a", "tuning", [0.5], size, noise)]
    pictures = write_plots(runs, folder)
    check(len(pictures) == 2, "pictures by size and noise")
    space = "{http://www.w3.org/2000/svg}"
    for path in pictures:
        curves = list(xml.etree.ElementTree.parse(path).iter(
            space + "polyline"))
        check(len(curves) == 2, f"{path.name} shows F1 and HARM")


def check_cloud_table(report):
    at = next(i for i, line in enumerate(report)
              if line.startswith("### Clouds of the refined maps"))
    head, _, *rows = ([word.strip() for word in line.split("|")[1:-1]]
                      for line in report[at + 2:at + 10])
    column = head.index("F1 5 cm")
    check([(row[0].split(",")[0], row[2], row[column]) for row in rows] == [
        ("a", "stereo_fusion", "0.510 ± 0.010"),
        ("a", "tsar_fuse", "0.561 ± 0.011"),
        ("b", "stereo_fusion", "0.710 ± 0.010"),
        ("b", "tsar_fuse", "0.781 ± 0.011"),
        ("**mean of 2**", "stereo_fusion", "0.610 ± 0.007"),
        ("**mean of 2**", "tsar_fuse", "0.671 ± 0.008")],
        "clouds by both fusions, one under the other")
    check([row[head.index("points")] for row in rows[:2]]
          == ["100 ± 0", "300 ± 0"] and rows[0][head.index("F1 2 cm")] == "-",
          "points, and scores that are missing")


def check_surface_table(runs):
    """Runs of scene a with two seeds, and of b without clouds."""
    for one, held in zip(runs, (0.1, 0.2)):
        one["scores"].update({
            "surfaces": [[-0.001, 0, 1.0, 2.5, 0.3, held, 0.4]],
            "tsar_fuse_surfaces": [[0, 0, 1.0, 2.5, 0.3, 2 * held, 0.9]],
            "worst_surface": 0.4, "tsar_fuse_worst_surface": 0.9,
            "num_planes": 14, "plane_copies": 2, "copy_offset_cm": None})
        one["before"].update({"worst_surface": None, "true_num_planes": 12})
    report = report_lines(runs + [{**one, "variant": "w"} for one in runs],
                          "unknown")
    title = next(line for line in report if line.startswith("### Large surf"))
    check([word.strip() for word in report[report.index(title) + 4].split("|")
           ][2:-1] == ["v", "0.00 0.00 1.00 2.50", "0.300", "0.150", "0.400",
                       "0.300", "0.900"],
          "medians of a surface by both fusions")
    head, row = ([word.strip() for word in line.split("|")] for line in (
        next(line for line in report if "worst surface" in line),
        next(line for line in report if line.startswith("| a, "))))
    check([row[head.index(name)] for name in ("worst surface", "planes",
                                              "copies")]
          == ["0.400 ± 0.000", "14.0 ± 0.0 / 12", "2.0 ± 0.0"]
          and "copies off (cm)" not in head,
          "planes are set beside the true ones")
    check("### Variants: tsar_fuse F1 5 cm" in report
          and "### Variants: worst surface" in report
          and "### Variants: worst surface tsar_fuse" in report,
          "variants are compared by tsar_fuse and the worst surface")


def check_texture():
    gray = np.full((20, 40), 100, np.uint8)
    gray[:, 20::2] = 140  # Stripes on the right.
    textured = is_textured(gray)
    check(not textured[:, :17].any() and textured[:, 23:].all(),
          "texture is where the gray levels vary")
    truth = np.full((20, 40), 2.0)
    truth[:, 39] = 0  # Unknown.
    depth = truth.copy()
    depth[:10] += 0.015
    depth[15:, :] = 0
    right_half = np.zeros_like(textured)
    right_half[:, 20:] = True
    counts = count_right(depth, truth, right_half)
    check(list(counts) == [20 * 19, 15 * 19, 5 * 19, 15 * 19],
          "textured pixels right within 1 and 2 cm")
    check(np.allclose(f1_scores(counts), [10 / 35, 30 / 35]),
          "F1 of textured pixels")
    check(f1_scores([0, 0, 0, 0]) == [None, None], "no texture, no score")


def check_variants():
    def told(name, value, default, advanced=True, **more):
        return {"name": f"TsarRefine.{name}", "value": value, "default": default,
                "advanced": advanced, **more}

    options = [
        told("preset", "default|paper", "default", False, choices=["default", "paper"]),
        told("scene_planes", "0|1", "1", False),
        told("sigma_maps", "0|1", "1", False),
        told("filter", "0|1", "1"),
        told("unused", "0|1", "0"),
        told("weight", "NUMBER", "0.7", max=1.0),
        told("rounds", "INT", "5", max=10.0),
        told("gap", "NUMBER", "0", max=9.0)]
    variants = make_variants(["a=--x 1 --y 'b c'"], False, False, False, "--z 2",
                             options)
    check(variants == {"a": ["--z", "2", "--x", "1", "--y", "b c"]},
          "options of a variant")
    variants = make_variants([], True, True, False, "", options)
    check(list(variants.items()) == [
        (name, [] if name == "default" else [f"--TsarRefine.{option}", value])
        for name, option, value in (
            ("default", "", ""),
            ("without scene_planes", "scene_planes", "0"),
            ("without filter", "filter", "0"),
            ("with unused", "unused", "1"),
            ("preset paper", "preset", "paper"),
            ("weight 0.35", "weight", "0.35"),
            ("weight 1", "weight", "1"),
            ("rounds 2", "rounds", "2"),
            ("rounds 10", "rounds", "10"))],
          "ablation and sensitivity")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--folder", required=True)
    folder = Path(parser.parse_args().folder)
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    check_png(folder)
    check_harm(folder)
    check_outliers(folder)
    check_calibration()
    check_planes_off(folder)
    check_distances()
    check_surfaces_of_scans(folder)
    check_plane_counts(folder)
    check_copies()
    check_true_surfaces()
    check_views(folder)
    check_model(folder)
    check_noise()
    check_rule(folder)
    check_texture()
    check_variants()
    shutil.rmtree(folder)


if __name__ == "__main__":
    main()
