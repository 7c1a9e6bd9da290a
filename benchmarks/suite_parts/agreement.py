# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Depths against the sparse model, and views against each other: measures that
need no ground truth."""

import numpy as np

from suite_parts.maps import read_gray_png, read_map

# Triangulated points that the check trusts, as pixels and images.
MAX_POINT_ERROR = 1.5
MIN_TRACK = 3
# Provenances of depths that come from a plane.
PLANE_PROVENANCES = (4, 5, 6)
MAX_SAMPLES = 6000  # Per view.
# Beyond these stereo_fusion does not join two depths, by default.
MAX_DEPTH_GAP = 0.01
MAX_ANGLE = 10.0
# Farther apart are different surfaces.
SAME_SURFACE = 0.1


def project(points, image, camera, shape):
    """Columns, rows, depths and which of the points a map's view contains."""
    inside_camera = points @ image.rotation().T + image.translation
    depth = inside_camera[:, 2]
    ahead = depth > 1e-6
    fx, fy, cx, cy = camera.intrinsics(shape)
    safe = np.where(ahead, depth, 1.0)
    x = np.floor(inside_camera[:, 0] / safe * fx + cx)
    y = np.floor(inside_camera[:, 1] / safe * fy + cy)
    seen = ahead & (x >= 0) & (y >= 0) & (x < shape[1]) & (y < shape[0])
    return (np.where(seen, x, 0).astype(int), np.where(seen, y, 0).astype(int),
            depth, seen)


def lift(x, y, depth, image, camera, shape):
    """World points of pixels of a map, with a last axis of 3."""
    fx, fy, cx, cy = camera.intrinsics(shape)
    inside_camera = np.stack([(x + 0.5 - cx) / fx * depth,
                              (y + 0.5 - cy) / fy * depth, depth], -1)
    return (inside_camera - image.translation) @ image.rotation()


def check_sparse(model, maps):
    """The share of triangulated points' observations with a depth, and among
    those the shares that are right to 1 % and 2 %."""
    seen_by = {image.id: [] for image in model.images}
    for point in model.points:
        if point.error <= MAX_POINT_ERROR and len(point.track) >= MIN_TRACK:
            for image in set(point.track["image"].tolist()):
                seen_by[image].append(point.position)
    names = set(maps.names())
    total = with_depth = right_1 = right_2 = 0
    for image in model.images:
        if image.name not in names or not seen_by[image.id]:
            continue
        depth = maps.depth(image.name)
        x, y, expected, seen = project(
            np.array(seen_by[image.id]), image,
            model.cameras[image.camera_id], depth.shape)
        found, expected = depth[y, x][seen], expected[seen]
        error = np.abs(found - expected) / expected
        total += len(found)
        with_depth += (found > 0).sum()
        right_1 += ((found > 0) & (error < 0.01)).sum()
        right_2 += ((found > 0) & (error < 0.02)).sum()
    if not total:
        return {}
    return {"sparse_observations": total,
            "sparse_with_depth": float(with_depth / total),
            "sparse_right_1": float(right_1 / max(with_depth, 1)),
            "sparse_right_2": float(right_2 / max(with_depth, 1))}


class FilledView:
    """A refined view with its depth where a plane filled it, else 0."""

    def __init__(self, model, image, maps):
        self.image = image
        self.camera = model.cameras[image.camera_id]
        origin = read_gray_png(maps.path("provenance", image.name, "png"))
        self.depth = np.where(np.isin(origin, PLANE_PROVENANCES),
                              maps.depth(image.name), 0)
        self.normals = read_map(maps.path("normal", image.name))

    def sample(self, random):
        """World points and normals of some filled pixels."""
        y, x = np.nonzero(self.depth > 0)
        chosen = random.choice(len(x), min(MAX_SAMPLES, len(x)), replace=False)
        x, y = x[chosen], y[chosen]
        return (lift(x, y, self.depth[y, x].astype(float), self.image,
                     self.camera, self.depth.shape),
                self.normals[:, y, x].T @ self.image.rotation())

    def compare(self, points, normals):
        """Relative gaps in depth and angles in degrees to another view's points
        where this view's planes fill the same surface."""
        x, y, z, seen = project(points, self.image, self.camera,
                                self.depth.shape)
        own = self.depth[y, x]
        same = seen & (own > 0) & (np.abs(own - z) < SAME_SURFACE * z)
        turned = normals[same] @ self.image.rotation().T
        cosine = (turned * self.normals[:, y[same], x[same]].T).sum(1)
        return (np.abs(own - z)[same] / z[same],
                np.degrees(np.arccos(np.clip(cosine, -1, 1))))


def check_view_agreement(model, maps):
    """Shares of plane-filled pixels that differ from another view's."""
    views = [FilledView(model, image, maps) for image in model.images
             if maps.path("provenance", image.name, "png").is_file()]
    random = np.random.default_rng(0)
    gaps, angles = [np.empty(0)], [np.empty(0)]
    for view in views:
        points, normals = view.sample(random)
        for other in views:
            if other is not view:
                gap, angle = other.compare(points, normals)
                gaps.append(gap)
                angles.append(angle)
    gaps, angles = np.concatenate(gaps), np.concatenate(angles)
    if not len(gaps):
        return {}
    return {"view_pairs": len(gaps),
            "view_disagreement": float(np.mean(gaps > MAX_DEPTH_GAP)),
            "view_turned": float(np.mean(angles > MAX_ANGLE))}
