// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/scene/evidence/observed_view.h"
#include "colmap_tsar/scene/evidence/scene_model.h"
#include "colmap_tsar/view/planes/world_plane.h"

#include <cmath>
#include <vector>

#include <Eigen/Core>

namespace tsar {

// A plane of the model and an axis of its Manhattan frame in the plane, in the
// frame of one camera.
class PlaneAxis {
 public:
  // axis: a column of the frame other than the plane's normal.
  PlaneAxis(const ModelPlane& plane,
            const Eigen::Vector3d& axis,
            const Camera& camera)
      : plane_(ToCameraPlane(plane.plane, camera)),
        center_(ToVec3f(camera.rotation * plane.center + camera.translation)),
        axis_(ToVec3f(camera.rotation * axis)) {}

  const Plane& InCamera() const { return plane_; }

  // The position along the axis, from the plane's center, of the ray's
  // intersection with the plane, in units of the model; NaN where there is
  // none.
  float Position(const Vec3f& ray) const {
    const float depth = plane_.Depth(ray);
    return depth > 0.f ? Dot(axis_, ray * depth - center_) : std::nanf("");
  }

 private:
  Plane plane_;
  Vec3f center_;
  Vec3f axis_;
};

// A column of the rotation of the plane's frame, in the world frame.
inline Eigen::Vector3d AxisOf(const SceneModel& model, int plane, int axis) {
  return model.frames[model.planes[plane].frame].col(axis);
}

// Part of a line on a plane.
struct LinePiece {
  // Where its middle is along the line, from the plane's center.
  float along = 0.f;
  float rise = 0.f;  // Sum over its pixels, beyond the level around the line.
  float num_pixels = 0.f;
};

// A straight line along an axis of the Manhattan frame, across the whole part
// of a plane that views show.
struct PlaneLine {
  int plane = -1;  // Index in the model.
  // The frame's other axis in the plane, and the line's position on it, from
  // the plane's center in units of the model.
  int axis = -1;
  float position = 0.f;
  float pixel = 0.f;  // Median size of a pixel of the raster on the plane.
  // The step of brightness along the axis, in gray levels, beyond the slope
  // around the line; negative where brightness falls.
  float step = 0.f;
  int num_views = 0;  // That show it.
};

// A point on the line, in the world.
inline Eigen::Vector3d PointOn(const PlaneLine& line, const SceneModel& model) {
  return model.planes[line.plane].center +
         double{line.position} * AxisOf(model, line.plane, line.axis);
}

// The orthogonal plane through the line, at which the line's plane would end on
// that side (0: smaller positions, 1: larger ones); it faces the other side.
WorldPlane PlaneAtLine(const SceneModel& model,
                       const PlaneLine& line,
                       int side);

// The largest distance between copies of a plane, as a share of the distance
// from which they are seen: posters hang in front of a wall, and measurements
// next to them lie between both.
inline constexpr float kCopyTolerance = 0.015f;
// The least cosine between the normals of such planes (3 degrees), where not
// both lie along axes of one frame exactly.
inline constexpr double kMinCopyCosine = 0.9986;

// Groups planes of the model that are one surface within the errors of views:
// for each plane the index of its copy with the largest support, which may be
// itself. Only planes along an axis of a frame have copies: those within
// kCopyTolerance, relative to the median distance to the cameras whose views
// were labeled with the plane. labels: by view, the plane of each superpixel,
// or -1.
std::vector<int> FindPlaneCopies(
    const SceneModel& model,
    const std::vector<Camera>& cameras,
    const std::vector<const std::vector<int>*>& labels);

// The steps of brightness along an axis of a plane's Manhattan frame that one
// view shows, by position on the axis. Noise is averaged out along the lines.
struct PlaneProfile {
  struct Bin {
    float step = 0.f;        // The mean over its pixels, in gray levels.
    float num_pixels = 0.f;  // 0: the view shows too little of it.
    // Only where the step is large enough to be part of a line.
    std::vector<LinePiece> pieces;
  };
  int plane = -1;            // Index in the model.
  int axis = -1;             // Of the frame.
  float pixel = 0.f;         // The width of a bin: a pixel on the plane.
  float first = 0.f;         // Where the first bin begins.
  float piece_length = 0.f;  // 32 pixels along the line.
  std::vector<Bin> bins;
};

// In gray levels: the least step of a line. Walls darken toward their creases
// by one level in ten pixels.
inline constexpr float kMinLineStep = 1.f;

// The profiles of planes that lie along an axis of a frame and cover at least
// 2 % of the raster. labels: the plane of each superpixel, of which copies have
// the index that FindPlaneCopies gives (Renumber), or -1. The evidence must
// have its gray levels.
std::vector<PlaneProfile> MakePlaneProfiles(const ObservedView& view,
                                            const std::vector<int>& labels,
                                            const SceneModel& model);

}  // namespace tsar
