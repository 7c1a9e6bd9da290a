// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/base/to_vec3f.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/planes/world_plane.h"
#include "colmap_tsar/scene_planes/scene_model.h"

#include <cmath>

#include <Eigen/Core>

namespace tsar {

// An axis of its Manhattan frame in a plane of the model, as one camera sees
// it.
class PlaneAxis {
 public:
  // axis: the frame's column, another one than the plane's normal.
  PlaneAxis(const ModelPlane& plane,
            const Eigen::Vector3d& axis,
            const Camera& camera)
      : plane_(ToCameraPlane(plane.plane, camera)),
        center_(ToVec3f(camera.rotation * plane.center + camera.translation)),
        axis_(ToVec3f(camera.rotation * axis)) {}

  const Plane& InCamera() const { return plane_; }

  // How far along the axis from the plane's centre the ray meets the plane, in
  // units of the model; NaN where it does not.
  float Place(const Vec3f& ray) const {
    const float depth = plane_.Depth(ray);
    return depth > 0.f ? Dot(axis_, ray * depth - center_) : std::nanf("");
  }

 private:
  Plane plane_;
  Vec3f center_;
  Vec3f axis_;
};

// In the world frame. axis: of the plane's frame.
inline Eigen::Vector3d AxisOf(const SceneModel& model, int plane, int axis) {
  return model
      .frames[static_cast<size_t>(
          model.planes[static_cast<size_t>(plane)].frame)]
      .col(axis);
}

}  // namespace tsar
