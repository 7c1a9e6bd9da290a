// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/cylinder_evidence.h"

#include "colmap_tsar/base/cylinder.h"
#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/scene_planes/seen_cylinders.h"

#include <cmath>
#include <cstddef>

namespace tsar {
namespace {

// How far off the cylinder a depth is another surface's, in relative depths of
// one pixel of disparity.
constexpr float kMinGap = 3.f;

}  // namespace

std::vector<CylinderEvidence> TestCylinders(
    const ObservedView& view,
    const std::vector<ModelPlane>& planes,
    const ViewLabels& labels,
    const std::vector<ModelCylinder>& cylinders) {
  const ViewEvidence& evidence = *view.evidence;
  const Intrinsics intrinsics = view.camera.GetIntrinsics();
  std::vector<CylinderEvidence> result(cylinders.size());
  std::vector<Plane> camera_planes;
  for (const ModelPlane& plane : planes) {
    camera_planes.push_back(ToCameraPlane(plane.plane, view.camera));
  }
  for (size_t k = 0; k < cylinders.size(); ++k) {
    const SeenCylinder seen = ToCameraCylinder(cylinders[k], view.camera);
    for (int y = 0; y < evidence.height; ++y) {
      for (int x = 0; x < evidence.width; ++x) {
        const Vec3f ray =
            intrinsics.Ray(static_cast<float>(x), static_cast<float>(y));
        Cylinder::Intersection intersection;
        if (!seen.cylinder.Intersect(ray, &intersection) ||
            intersection.height < 0.f || intersection.height > seen.length ||
            !seen.FacesCamera(intersection.normal, ray)) {
          continue;
        }
        const float gap =
            kMinGap * intersection.depth *
            evidence.resolution.RelativeDepthError(intersection.depth);
        const float measured = evidence.confident_depth(x, y);
        if (measured > 0.f && measured < intersection.depth - gap) {
          continue;
        }
        ++result[k].area;
        result[k].through += measured > intersection.depth + gap ? 1 : 0;
        const size_t superpixel = evidence.superpixels(x, y);
        const int label = labels.planes[superpixel];
        if (label >= 0 &&
            labels.evidence[superpixel] == LabelEvidence::kMeasured) {
          const float depth =
              camera_planes[static_cast<size_t>(label)].Depth(ray);
          result[k].on_planes +=
              std::abs(depth - intersection.depth) > gap ? 1 : 0;
        }
      }
    }
  }
  return result;
}

}  // namespace tsar
