// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/planes/world_plane.h"

namespace tsar {

WorldPlane ToWorldPlane(const Plane& plane, const Camera& camera) {
  const Eigen::Vector3d normal(plane.normal.x, plane.normal.y, plane.normal.z);
  // A normal in single precision has unit length only nearly.
  const double scale = 1.0 / normal.norm();
  return {scale * (camera.rotation.transpose() * normal),
          scale * (plane.offset + normal.dot(camera.translation))};
}

Plane ToCameraPlane(const WorldPlane& plane, const Camera& camera) {
  Eigen::Vector3d normal = camera.rotation * plane.normal;
  double offset = plane.offset - normal.dot(camera.translation);
  if (offset < 0.0) {
    normal = -normal;
    offset = -offset;
  }
  return {{static_cast<float>(normal.x()),
           static_cast<float>(normal.y()),
           static_cast<float>(normal.z())},
          static_cast<float>(offset)};
}

}  // namespace tsar
