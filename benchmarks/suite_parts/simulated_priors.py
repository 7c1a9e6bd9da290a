# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Priors with the errors of networks and of sensors, made from the true depths of
a scene: depth, or normals."""

import zlib

import numpy as np
from programs import CommandFailed
from suite_parts.maps import read_map
from suite_parts.photographs import load_opencv
from suite_parts.sparse_model import read_model

# Raised where the same scene would get other priors.
VERSION = 2
KINDS = ("network", "lidar", "normals")
WIDTHS = {"network": 518, "lidar": 256, "normals": 518}
# A network's errors: the scale of each surface and of the image from place to
# place, the blur of edges as a share of the width, noise; all relative.
SURFACE_SCALE = 0.06
WARP = 0.05
BLUR = 0.005
NOISE = 0.01
# Normals' errors: the blur of edges, the local tilt in radians, noise.
NORMAL_BLUR = 0.01
TILT = np.radians(8)
NORMAL_NOISE = 0.06
# A sensor's errors: its range and what it misses besides its noise, in meters
# and in gray levels.
REACH = 5.0
FLOOR = 0.005
DARK = 25


def name_of(variant):
    """How options name the folder of priors that a variant takes."""
    return f"{{{variant}_prior}}"


def without_holes(cv2, depth):
    """Pixels without a depth get that of the nearest one that has one."""
    known = depth > 0
    _, labels = cv2.distanceTransformWithLabels(
        (~known).astype(np.uint8), cv2.DIST_L2, 3,
        labelType=cv2.DIST_LABEL_PIXEL)
    values = np.zeros(labels.max() + 1, np.float32)
    values[labels[known]] = depth[known]
    return values[labels]


def steps(cv2, depth, share):
    """Where the depth changes by more than this share from pixel to pixel."""
    span = cv2.morphologyEx(depth, cv2.MORPH_GRADIENT, np.ones((3, 3)))
    return span > share * depth


def as_network(cv2, depth, random):
    """Inverse depth up to an unknown factor and constant: every surface is
    scaled a little by itself, the whole is bent, and edges are soft."""
    height, width = depth.shape
    surfaces = (~steps(cv2, depth, 0.03)).astype(np.uint8)
    count, numbers = cv2.connectedComponents(surfaces)
    scales = 1 + random.uniform(-SURFACE_SCALE, SURFACE_SCALE, count)
    bend = cv2.resize(random.standard_normal((4, 5)), (width, height),
                      interpolation=cv2.INTER_CUBIC).clip(-2, 2) / 2
    inverse = scales[numbers] * (1 + WARP * bend) / depth
    inverse = cv2.GaussianBlur(inverse, (0, 0), BLUR * width)
    inverse *= 1 + NOISE * random.standard_normal(depth.shape)
    return random.uniform(0.5, 20) * inverse + random.uniform(0, 0.2)


def as_sensor(cv2, depth, known, photo, random):
    """Depth in meters, with holes at steps, far away and on what is dark."""
    noise = random.standard_normal((2, *depth.shape))
    measured = depth * (1 + NOISE * noise[0]) + FLOOR * noise[1]
    missed = ~known | steps(cv2, depth, 0.05) | (depth > REACH) | (photo < DARK)
    return np.where(missed, 0, measured)


def unit(vectors):
    lengths = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return vectors / np.maximum(lengths, 1e-9)


def as_normals(cv2, depth, intrinsics, random):
    """Normals in the camera's frame, towards the camera: the image is tilted a
    little from place to place, and edges are soft."""
    height, width = depth.shape
    fx, fy, cx, cy = intrinsics
    y, x = np.mgrid[:height, :width] + 0.5
    points = np.stack([(x - cx) / fx * depth, (y - cy) / fy * depth, depth], -1)
    normals = unit(np.cross(np.gradient(points, axis=1),
                            np.gradient(points, axis=0)))
    normals *= -np.sign((normals * points).sum(-1, keepdims=True))
    normals = unit(cv2.GaussianBlur(normals, (0, 0), NORMAL_BLUR * width))
    tilt = TILT * cv2.resize(random.standard_normal((4, 5, 2)), (width, height),
                             interpolation=cv2.INTER_LINEAR)
    across = unit(np.cross(normals, [0.0, 1.0, 0.0]))
    along = np.cross(normals, across)
    normals = normals + tilt[..., :1] * across + tilt[..., 1:] * along
    return unit(normals + NORMAL_NOISE * random.standard_normal(normals.shape))


def make_priors(scene, kind, folder):
    """Writes NAME.npy, or NAME.normal.npy, for each image with a true depth; the
    same names get the same errors. Returns how many there are."""
    cv2 = load_opencv()
    model = read_model(scene / "sparse")
    cameras = {image.name: model.cameras[image.camera_id]
               for image in model.images}
    truths = sorted((scene / "ground_truth" / "depth").rglob("*.bin"))
    if not truths:
        raise CommandFailed(f"{scene}: priors are simulated from ground truth, "
                            "and ground_truth/depth is missing or empty")
    for path in truths:
        name = str(path.relative_to(scene / "ground_truth" / "depth"))[:-4]
        random = np.random.default_rng(zlib.crc32(f"{kind} {name}".encode()))
        true = read_map(path)[0]
        size = (WIDTHS[kind],
                round(WIDTHS[kind] * true.shape[0] / true.shape[1]))
        depth = cv2.resize(without_holes(cv2, true), size,
                           interpolation=cv2.INTER_NEAREST)
        if kind == "network":
            prior = as_network(cv2, depth, random)
        elif kind == "normals":
            prior = as_normals(cv2, depth, cameras[name].intrinsics(depth.shape),
                               random)
        else:
            known = cv2.resize((true > 0).astype(np.float32), size,
                               interpolation=cv2.INTER_AREA) >= 1
            photo = cv2.imread(str(scene / "images" / name),
                               cv2.IMREAD_GRAYSCALE)
            if photo is None:
                raise CommandFailed(f"{scene / 'images' / name}: cannot be read")
            photo = cv2.resize(photo, size, interpolation=cv2.INTER_AREA)
            prior = as_sensor(cv2, depth, known, photo, random)
        suffix = ".normal.npy" if kind == "normals" else ".npy"
        target = folder / (name + suffix)
        target.parent.mkdir(parents=True, exist_ok=True)
        np.save(target, prior.astype(np.float32))
    return len(truths)
