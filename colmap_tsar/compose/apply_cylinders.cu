// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/compose/apply_cylinders.h"

#include "colmap_tsar/compose/compose_scene.h"
#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/scene/evidence/measurement_flags.h"

#include <cmath>

namespace tsar {
namespace {

struct ApplyKernel {
  const CameraCylinder* cylinders;
  int num_cylinders;
  ImageView<const uint8_t> flags;
  Intrinsics intrinsics;
  DepthResolution resolution;
  ComposedViews map;
  ImageView<float> variances;

  TSAR_HD void operator()(int x, int y) const {
    const Vec3f ray = intrinsics.Ray(x, y);
    CameraCylinder::Intersection nearest;
    const CameraCylinder* cylinder = nullptr;
    for (int k = 0; k < num_cylinders; ++k) {
      CameraCylinder::Intersection intersection;
      if (cylinders[k].Intersect(ray, &intersection) &&
          (cylinder == nullptr || intersection.depth < nearest.depth)) {
        nearest = intersection;
        cylinder = cylinders + k;
      }
    }
    if (cylinder == nullptr || Stands(x, y, ray, nearest)) {
      variances(x, y) = 0.f;
      return;
    }
    variances(x, y) =
        fmaxf(cylinder->DepthVariance(ray, nearest.normal), kLeastVariance);
    map.Set(x, y, nearest.depth, nearest.normal, Provenance::kInterpolated);
  }

  // Whether the depth of the pixel is of another surface and is kept.
  TSAR_HD bool Stands(int x,
                      int y,
                      const Vec3f& ray,
                      const CameraCylinder::Intersection& on_cylinder) const {
    const Provenance source = map.Source(x, y);
    const float gap =
        (map.depth(x, y) - on_cylinder.depth) /
        (on_cylinder.depth * resolution.RelativeDepthError(on_cylinder.depth));
    if (gap < -kOnSurface) {
      return source == Provenance::kMeasured ||
             source == Provenance::kRegionPlane;
    }
    // Close to the outlines, matching finds these, which differ between views.
    return gap > kOnSurface && source == Provenance::kMeasured &&
           CameraCylinder::FacesCamera(on_cylinder.normal, ray) &&
           MeasurementFlags::IsConfirmedDistinctly(flags(x, y));
  }

  static constexpr float kLeastVariance = 1e-30f;
};

}  // namespace

DeviceImage<float> ApplyCylinders(const std::vector<CameraCylinder>& cylinders,
                                  ImageView<const uint8_t> flags,
                                  const Intrinsics& intrinsics,
                                  const DepthResolution& resolution,
                                  ComposedMap* composed,
                                  Device& device) {
  if (cylinders.empty()) {
    return {};
  }
  const Buffer<CameraCylinder> buffer(device, cylinders);
  DeviceImage<float> variances(
      device, composed->map.depth.Width(), composed->map.depth.Height());
  ParallelFor(device,
              variances.Width(),
              variances.Height(),
              ApplyKernel{buffer.Data(),
                          static_cast<int>(cylinders.size()),
                          flags,
                          intrinsics,
                          resolution,
                          composed->Views(),
                          variances.View()});
  return variances;
}

}  // namespace tsar
