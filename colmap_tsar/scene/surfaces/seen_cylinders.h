// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/cylinder.h"
#include "colmap_tsar/base/macros.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/scene/evidence/label_view.h"
#include "colmap_tsar/scene/evidence/observed_view.h"
#include "colmap_tsar/scene/evidence/scene_model.h"

#include <cmath>
#include <cstdint>
#include <vector>

namespace tsar {

// A cylinder of the scene in a view: it is not occluded where the view shows
// its outlines. Kernels read it from a buffer.
struct SeenCylinder {
  // The least cosine between its normal and the direction to the camera where
  // it faces the camera. Below, outlines are close.
  static constexpr float kMinCosine = 0.5f;
  static constexpr int kNumBins = 256;

  // The cylinder in the view's camera frame. Heights begin at the known part.
  Cylinder cylinder;
  float length = 0.f;  // Of the known part.
  // By bin of the length, whether the view shows the outlines.
  uint8_t is_seen[kNumBins] = {};
  // The directions of the shifts in the covariance of its ModelCylinder, in the
  // camera frame, and that covariance: its diagonal, then its elements (0, 1),
  // (0, 2), (1, 2).
  Vec3f across;
  Vec3f third;
  float variances[3] = {};
  float covariances[3] = {};

  TSAR_HD bool IsSeenAt(float height) const {
    const float bin = height / length * kNumBins;
    return bin >= 0.f && bin < kNumBins && is_seen[static_cast<int>(bin)] != 0;
  }

  // Whether the cylinder faces the camera along a ray with z = 1. normal: of
  // the cylinder there.
  TSAR_HD static bool FacesCamera(const Vec3f& normal, const Vec3f& ray) {
    return -Dot(normal, ray) > kMinCosine * Norm(ray);
  }

  // The variance of the depth at which a ray with z = 1 intersects it.
  TSAR_HD float DepthVariance(const Vec3f& ray, const Vec3f& normal) const {
    // At the outline, where rays graze it, the depth is not linear in the
    // parameters.
    const float least = kMinCosineOfVariance * Norm(ray);
    const float cosine = fmaxf(-Dot(normal, ray), least);
    const float a = Dot(normal, across);
    const float b = Dot(normal, third);
    const float mixed =
        a * b * covariances[0] + a * covariances[1] + b * covariances[2];
    const float variance = a * a * variances[0] + b * b * variances[1] +
                           variances[2] + 2.f * mixed;
    return fmaxf(variance, 0.f) / (cosine * cosine);
  }

 private:
  static constexpr float kMinCosineOfVariance = 0.1f;
};

// Finds the cylinders whose outlines a view shows. view: with the colors of its
// evidence.
std::vector<SeenCylinder> FindSeenCylinders(
    const ObservedView& view, const std::vector<ModelCylinder>& cylinders);

// The cylinder in the camera's frame, with no part marked as seen.
SeenCylinder ToCameraCylinder(const ModelCylinder& cylinder,
                              const Camera& camera);

// Evidence of views about the known part of a cylinder, in pixels of rasters.
// Counts are integers, so that sums do not depend on the order of views.
struct CylinderEvidence {
  int64_t area = 0;     // Of its front, without measurements before it.
  int64_t through = 0;  // Of these, with measurements behind it,
  // and of these, with a measured plane of the scene off the cylinder.
  int64_t on_planes = 0;

  CylinderEvidence& operator+=(const CylinderEvidence& other) {
    area += other.area;
    through += other.through;
    on_planes += other.on_planes;
    return *this;
  }
  // Whether measurements behind it, or planes off it, cover more than a quarter
  // of its area; single wrong depths do not.
  bool IsContradicted() const {
    return 4 * through > area || 4 * on_planes > area;
  }
};

// The evidence of one view, which needs superpixels and confident depths, by
// cylinder. planes: of the scene; labels: of the view.
std::vector<CylinderEvidence> TestCylinders(
    const ObservedView& view,
    const std::vector<ModelPlane>& planes,
    const ViewLabels& labels,
    const std::vector<ModelCylinder>& cylinders);

}  // namespace tsar
