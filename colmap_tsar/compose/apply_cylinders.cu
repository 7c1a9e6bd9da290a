// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/compose/apply_cylinders.h"

#include "colmap_tsar/base/arithmetic.h"
#include "colmap_tsar/compose/compose_scene.h"
#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/scene/evidence/measurement_flags.h"
#include "colmap_tsar/view/depth_confidence.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace tsar {
namespace {

constexpr size_t kMaxCylinders = 255;

struct ApplyKernel {
  const SeenCylinder* cylinders;
  int num_cylinders;
  ImageView<const uint8_t> flags;
  Intrinsics intrinsics;
  DepthResolution resolution;
  ComposedViews map;
  ImageView<uint8_t> labels;

  TSAR_HD void operator()(int x, int y) const {
    const Vec3f ray = intrinsics.Ray(x, y);
    Cylinder::Intersection nearest;
    int label = 0;
    for (int k = 0; k < num_cylinders; ++k) {
      Cylinder::Intersection intersection;
      if (cylinders[k].cylinder.Intersect(ray, &intersection) &&
          cylinders[k].IsSeenAt(intersection.height) &&
          (label == 0 || intersection.depth < nearest.depth)) {
        nearest = intersection;
        label = k + 1;
      }
    }
    if (label > 0 && Stands(x, y, ray, nearest)) {
      label = 0;
    }
    labels(x, y) = static_cast<uint8_t>(label);
    if (label > 0) {
      map.Set(x, y, nearest.depth, nearest.normal, Provenance::kInterpolated);
    }
  }

  // Whether the measurement of the pixel is of another surface and is kept.
  TSAR_HD bool Stands(int x,
                      int y,
                      const Vec3f& ray,
                      const Cylinder::Intersection& on_cylinder) const {
    if (map.Source(x, y) != Provenance::kMeasured) {
      return false;
    }
    const float gap =
        (map.depth(x, y) - on_cylinder.depth) /
        (on_cylinder.depth * resolution.RelativeDepthError(on_cylinder.depth));
    // Close to the outlines, matching finds these, which differ between views.
    return gap < -kOnSurface ||
           (gap > kOnSurface &&
            SeenCylinder::FacesCamera(on_cylinder.normal, ray) &&
            MeasurementFlags::IsConfirmedDistinctly(flags(x, y)));
  }
};

struct ConfidenceKernel {
  ImageView<const uint8_t> labels;
  ImageView<float> confidence;

  TSAR_HD void operator()(int x, int y) const {
    if (labels(x, y) > 0) {
      confidence(x, y) = kConfidenceOfCylinder;
    }
  }
};

struct SigmaOfCylindersKernel {
  const SeenCylinder* cylinders;
  Intrinsics intrinsics;
  DepthResolution resolution;
  ImageView<const uint8_t> labels;
  ImageView<const float> depth;
  ImageView<const Vec3f> normal;
  ImageView<uint16_t> sigma;
  float on_cylinder;

  TSAR_HD void operator()(int x, int y) const {
    const int label = labels(x, y);
    const float z = depth(x, y);
    if (label == 0 || !(z > 0.f)) {
      return;
    }
    const Vec3f ray = intrinsics.Ray(x, y);
    const float matching = on_cylinder * z * resolution.RelativeDepthError(z);
    sigma(x, y) = ToPositiveHalf(
        sqrtf(matching * matching +
              cylinders[label - 1].DepthVariance(ray, normal(x, y))));
  }
};

}  // namespace

AppliedCylinders ApplyCylinders(const std::vector<SeenCylinder>& cylinders,
                                ImageView<const uint8_t> flags,
                                const Intrinsics& intrinsics,
                                const DepthResolution& resolution,
                                ComposedMap* composed,
                                Device& device) {
  AppliedCylinders applied;
  if (cylinders.empty()) {
    return applied;
  }
  const size_t count = std::min(cylinders.size(), kMaxCylinders);
  applied.cylinders = Buffer<SeenCylinder>(
      device,
      std::vector<SeenCylinder>(
          cylinders.begin(),
          cylinders.begin() + static_cast<std::ptrdiff_t>(count)));
  const int width = composed->map.depth.Width();
  const int height = composed->map.depth.Height();
  applied.labels = DeviceImage<uint8_t>(device, width, height);
  ParallelFor(device,
              width,
              height,
              ApplyKernel{applied.cylinders.Data(),
                          static_cast<int>(count),
                          flags,
                          intrinsics,
                          resolution,
                          composed->Views(),
                          applied.labels.View()});
  return applied;
}

void SetConfidenceOfCylinders(const AppliedCylinders& applied,
                              DeviceImage<float>* confidence,
                              Device& device) {
  if (!applied.labels.Empty()) {
    ParallelFor(device,
                applied.labels.Width(),
                applied.labels.Height(),
                ConfidenceKernel{applied.labels.View(), confidence->View()});
  }
}

void SetSigmaOfCylinders(const AppliedCylinders& applied,
                         const Intrinsics& intrinsics,
                         const DepthResolution& resolution,
                         const DepthNormalImages& map,
                         const SceneSigmaOptions& options,
                         DeviceImage<uint16_t>* sigma,
                         Device& device) {
  if (!applied.labels.Empty()) {
    ParallelFor(device,
                applied.labels.Width(),
                applied.labels.Height(),
                SigmaOfCylindersKernel{applied.cylinders.Data(),
                                       intrinsics,
                                       resolution,
                                       applied.labels.View(),
                                       map.depth.View(),
                                       map.normal.View(),
                                       sigma->View(),
                                       options.on_cylinder});
  }
}

}  // namespace tsar
