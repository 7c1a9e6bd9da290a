// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/compose/lay_cylinders.h"

#include "colmap_tsar/base/half.h"
#include "colmap_tsar/compose/compose_scene.h"
#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/scene/evidence/measurement_rating.h"
#include "colmap_tsar/view/depth_confidence.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace tsar {
namespace {

constexpr size_t kMaxCylinders = 255;

struct LayKernel {
  const SeenCylinder* cylinders;
  int num_cylinders;
  ImageView<const uint8_t> ratings;
  Intrinsics intrinsics;
  DepthResolution resolution;
  ImageView<float> depth;
  ImageView<Vec3f> normal;
  ImageView<uint8_t> provenance;
  ImageView<uint8_t> numbers;

  TSAR_HD void operator()(int x, int y) const {
    const Vec3f ray =
        intrinsics.Ray(static_cast<float>(x), static_cast<float>(y));
    Cylinder::Intersection nearest;
    int number = 0;
    for (int k = 0; k < num_cylinders; ++k) {
      Cylinder::Intersection intersection;
      if (cylinders[k].cylinder.Intersect(ray, &intersection) &&
          cylinders[k].IsSeenAt(intersection.height) &&
          (number == 0 || intersection.depth < nearest.depth)) {
        nearest = intersection;
        number = k + 1;
      }
    }
    if (number > 0 && Stands(x, y, ray, nearest)) {
      number = 0;
    }
    numbers(x, y) = static_cast<uint8_t>(number);
    if (number > 0) {
      depth(x, y) = nearest.depth;
      normal(x, y) = nearest.normal;
      provenance(x, y) = static_cast<uint8_t>(Provenance::kInterpolated);
    }
  }

  // Whether the measurement of the pixel is of another surface and is kept.
  TSAR_HD bool Stands(int x,
                      int y,
                      const Vec3f& ray,
                      const Cylinder::Intersection& on_cylinder) const {
    if (provenance(x, y) != static_cast<uint8_t>(Provenance::kMeasured)) {
      return false;
    }
    const float gap =
        (depth(x, y) - on_cylinder.depth) /
        (on_cylinder.depth * resolution.RelativeDepthError(on_cylinder.depth));
    // Close to the outlines, matching finds these, which differ between views.
    return gap < -kOnSurface ||
           (gap > kOnSurface &&
            SeenCylinder::FacesCamera(on_cylinder.normal, ray) &&
            MeasurementRating::IsConfirmedDistinctly(ratings(x, y)));
  }
};

struct RateKernel {
  ImageView<const uint8_t> numbers;
  ImageView<float> confidence;

  TSAR_HD void operator()(int x, int y) const {
    if (numbers(x, y) > 0) {
      confidence(x, y) = kConfidenceOfCylinder;
    }
  }
};

struct SigmaOfCylindersKernel {
  const SeenCylinder* cylinders;
  Intrinsics intrinsics;
  DepthResolution resolution;
  ImageView<const uint8_t> numbers;
  ImageView<const float> depth;
  ImageView<const Vec3f> normal;
  ImageView<uint16_t> sigma;
  float on_cylinder;

  TSAR_HD void operator()(int x, int y) const {
    const int number = numbers(x, y);
    const float z = depth(x, y);
    if (number == 0 || !(z > 0.f)) {
      return;
    }
    const Vec3f ray =
        intrinsics.Ray(static_cast<float>(x), static_cast<float>(y));
    const float matching = on_cylinder * z * resolution.RelativeDepthError(z);
    sigma(x, y) = ToPositiveHalf(
        sqrtf(matching * matching +
              cylinders[number - 1].DepthVariance(ray, normal(x, y))));
  }
};

}  // namespace

LaidCylinders LayCylinders(const std::vector<SeenCylinder>& cylinders,
                           ImageView<const uint8_t> ratings,
                           const Intrinsics& intrinsics,
                           const DepthResolution& resolution,
                           ComposedMap* composed,
                           Device& device) {
  LaidCylinders laid;
  if (cylinders.empty()) {
    return laid;
  }
  const size_t count = std::min(cylinders.size(), kMaxCylinders);
  laid.cylinders = Buffer<SeenCylinder>(
      device,
      std::vector<SeenCylinder>(
          cylinders.begin(),
          cylinders.begin() + static_cast<std::ptrdiff_t>(count)));
  const int width = composed->map.depth.Width();
  const int height = composed->map.depth.Height();
  laid.numbers = DeviceImage<uint8_t>(device, width, height);
  ParallelFor(device,
              width,
              height,
              LayKernel{laid.cylinders.Data(),
                        static_cast<int>(count),
                        ratings,
                        intrinsics,
                        resolution,
                        composed->map.depth.View(),
                        composed->map.normal.View(),
                        composed->provenance.View(),
                        laid.numbers.View()});
  return laid;
}

void RateCylinders(const LaidCylinders& laid,
                   DeviceImage<float>* confidence,
                   Device& device) {
  if (!laid.numbers.Empty()) {
    ParallelFor(device,
                laid.numbers.Width(),
                laid.numbers.Height(),
                RateKernel{laid.numbers.View(), confidence->View()});
  }
}

void SetSigmaOfCylinders(const LaidCylinders& laid,
                         const Intrinsics& intrinsics,
                         const DepthResolution& resolution,
                         const DepthNormalImages& map,
                         const SceneSigmaOptions& options,
                         DeviceImage<uint16_t>* sigma,
                         Device& device) {
  if (!laid.numbers.Empty()) {
    ParallelFor(device,
                laid.numbers.Width(),
                laid.numbers.Height(),
                SigmaOfCylindersKernel{laid.cylinders.Data(),
                                       intrinsics,
                                       resolution,
                                       laid.numbers.View(),
                                       map.depth.View(),
                                       map.normal.View(),
                                       sigma->View(),
                                       options.on_cylinder});
  }
}

}  // namespace tsar
