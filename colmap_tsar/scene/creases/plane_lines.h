// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/base/to_vec3f.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/scene/evidence/observed_view.h"
#include "colmap_tsar/scene/evidence/scene_model.h"
#include "colmap_tsar/view/planes/world_plane.h"

#include <cmath>
#include <vector>

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

// A straight line in an image that runs along an axis of the Manhattan frame
// across all that the view shows of a plane.
struct PlaneLine {
  int plane = -1;  // Of the model.
  // The frame's other axis in the plane, and the line's place on it: how far
  // from the plane's centre, in units of the model.
  int axis = -1;
  float place = 0.f;
  float pixel = 0.f;  // What one pixel of the raster spans there.
  // By how many grey levels the image rises there along the axis, beyond what
  // it does around the line; negative where it falls.
  float step = 0.f;
};

// Where the line's plane ends if it does not go on to that side of the line (0:
// below its place, 1: above): the plane at right angles through it, which faces
// the other side.
WorldPlane PlaneAtLine(const SceneModel& model,
                       const PlaneLine& line,
                       int side);

// Lengths are in pixels of the raster.
struct PlaneLineOptions {
  // Only planes that cover this share of the raster,
  float min_area = 0.02f;
  // and lines that are at least this long, as a share of the raster's width.
  float min_length = 0.1f;
  // Brightness is compared this far on either side of a pixel.
  float reach = 1.5f;
  // A line lies on the plane: within this distance on either side there is a
  // pixel that was labelled with it.
  float max_distance = 6.f;
  // Grey levels. Walls get darker toward their creases by one level in ten
  // pixels, and noise is less than one along a line of sixty.
  float min_step = 1.f;
  // Differences of more grey levels count as this: one lamp is no line.
  float max_difference = 15.f;
  // At this share of the line's pixels the image must rise by half of its step
  // or more. A poster's edge is one at few of the pixels beside it.
  float min_share = 0.5f;
};

// Planes of which one is a copy of the other are this close to each other, as a
// share of the distance from which they are seen: posters hang on a wall, and
// measurements next to them lie between both.
inline constexpr float kCopyTolerance = 0.015f;
// The least cosine between the normals of such planes (3 degrees), where not
// both lie along axes of one frame exactly.
inline constexpr double kMinCopyCosine = 0.9986;

// Planes of the model that are one surface within the errors of views: for each
// plane the number of the best measured one of its copies, which may be itself.
// Only planes along an axis of a frame have copies: those that lie within
// tolerance, as a share of the median distance from the plane of the cameras
// whose views were labelled with it. labels: by view, of each superpixel the
// plane, or -1.
std::vector<int> FindPlaneCopies(
    const SceneModel& model,
    const std::vector<Camera>& cameras,
    const std::vector<const std::vector<int>*>& labels,
    float tolerance);

// The lines in one view, on those planes that lie along an axis of a frame and
// are no copies. labels: of each superpixel the plane, or -1; copies: see
// FindPlaneCopies. The evidence has its colours.
std::vector<PlaneLine> FindPlaneLines(const ObservedView& view,
                                      const std::vector<int>& labels,
                                      const std::vector<int>& copies,
                                      const SceneModel& model,
                                      const PlaneLineOptions& options);

}  // namespace tsar
