// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/arithmetic.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/macros.h"
#include "colmap_tsar/base/random.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/matching/bilateral_ncc.cuh"
#include "colmap_tsar/matching/patch_match.h"
#include "colmap_tsar/matching/reprojection.cuh"
#include "colmap_tsar/matching/views.h"

#include <cmath>

namespace tsar {

// Bounds of depth, sampled uniformly in inverse depth, hence in image position.
struct DepthBounds {
  float min;
  float max;

  TSAR_HD bool Contains(float depth) const {
    return depth >= min && depth <= max;
  }

  TSAR_HD float Draw(Philox* random) const {
    const float t = random->NextFloat();
    return 1.f / ((1.f - t) / min + t / max);
  }

  // Draws a depth within `share` of the full range of the given depth.
  TSAR_HD float DrawAround(float depth, float share, Philox* random) const {
    const float range = 1.f / min - 1.f / max;
    const float inverse =
        1.f / depth + (2.f * random->NextFloat() - 1.f) * share * range;
    return 1.f / fminf(fmaxf(inverse, 1.f / max), 1.f / min);
  }
};

// A random normal, uniform among those that face the camera on the ray.
TSAR_HD inline Vec3f DrawNormal(const Vec3f& ray, Philox* random) {
  // A point of the disc is mapped to the sphere (Marsaglia, 1972): unlike sines
  // and cosines, this is bit-identical on CPU and GPU.
  float x = 0.f;
  float y = 0.f;
  float squared = 0.f;
  do {
    x = 2.f * random->NextFloat() - 1.f;
    y = 2.f * random->NextFloat() - 1.f;
    squared = x * x + y * y;
  } while (squared >= 1.f);
  const float scale = 2.f * sqrtf(1.f - squared);
  const Vec3f normal = {scale * x, scale * y, 1.f - 2.f * squared};
  return Dot(normal, ray) > 0.f ? -normal : normal;
}

// The normal perturbed by up to `turn` along each axis; unchanged if the result
// would face away from the camera.
TSAR_HD inline Vec3f DrawNormalAround(const Vec3f& normal,
                                      float turn,
                                      const Vec3f& ray,
                                      Philox* random) {
  const Vec3f step = {(2.f * random->NextFloat() - 1.f) * turn,
                      (2.f * random->NextFloat() - 1.f) * turn,
                      (2.f * random->NextFloat() - 1.f) * turn};
  const Vec3f turned = Normalized(normal + step);
  return Dot(turned, ray) < 0.f ? turned : normal;
}

// The eight areas from which a pixel may adopt a plane: in each of the four
// directions a near one, V-shaped, and a far one, a strip. All of their pixels
// have the other color of the checkerboard, so that none changes meanwhile.
constexpr int kNumPropagationAreas = 8;
constexpr int kNearAreaSize = 7;
constexpr int kFarAreaSize = 11;

struct PixelOffset {
  int x;
  int y;
};

// Member i of the near area that opens upwards: (0, -1), (-1, -2), (1, -2), ...
TSAR_HD inline PixelOffset NearAreaOffset(int i) {
  const int step = (i + 1) / 2;
  return {i % 2 == 0 ? step : -step, -1 - step};
}

// Member i of the far area upwards: (0, -3), (0, -5), ... (0, -23).
TSAR_HD inline PixelOffset FarAreaOffset(int i) { return {0, -3 - 2 * i}; }

// The offset rotated by quarter turns.
TSAR_HD inline PixelOffset Turned(const PixelOffset& offset, int turns) {
  switch (turns) {
    case 0:
      return offset;
    case 1:
      return {-offset.y, offset.x};
    case 2:
      return {-offset.x, -offset.y};
    default:
      return {offset.y, -offset.x};
  }
}

// The pixel of lowest cost in the area, the first of several; false if the area
// lies outside of the image.
TSAR_HD inline bool BestOfArea(const ImageView<const float>& costs,
                               int x,
                               int y,
                               int area,
                               PixelOffset* best) {
  const bool near = area < 4;
  const int size = near ? kNearAreaSize : kFarAreaSize;
  bool found = false;
  float lowest = 0.f;
  for (int i = 0; i < size; ++i) {
    const PixelOffset offset =
        Turned(near ? NearAreaOffset(i) : FarAreaOffset(i), area % 4);
    const int u = x + offset.x;
    const int v = y + offset.y;
    if (costs.Contains(u, v) && (!found || costs(u, v) < lowest)) {
      found = true;
      lowest = costs(u, v);
      *best = {u, v};
    }
  }
  return found;
}

// The weight of a source view at a pixel: joint view selection by the costs of
// the pixel's candidate planes in that view (Xu and Tao, CVPR 2019, section
// 3.3). A view that sees the surface has some low costs and few high ones.
class ViewWeight {
 public:
  // iteration counts from 0; the threshold of low costs decreases with it.
  TSAR_HD explicit ViewWeight(int iteration)
      : low_cost_(
            0.8f *
            ExpOfNegative(-static_cast<float>(iteration * iteration) / 90.f)) {}

  // Adds a cost of this view, in [0, 2].
  TSAR_HD void Add(float cost) {
    if (cost < low_cost_) {
      ++num_low_;
      sum_ += ExpOfNegative(-cost * cost / (2.f * 0.3f * 0.3f));
    } else if (cost > 1.2f) {
      ++num_high_;
    }
  }

  // The weight in [0, 255], stored for each pixel and view; 0: not selected.
  TSAR_HD int Get() const {
    return num_low_ > 2 && num_high_ < 3
               ? static_cast<int>(255.f * sum_ / num_low_ + 0.5f)
               : 0;
  }

 private:
  float low_cost_;
  float sum_ = 0.f;
  int num_low_ = 0;
  int num_high_ = 0;
};

// The cost of a window that a view does not see, or sees without texture.
constexpr float kMaxCost = 2.f;

// The costs of planes at one pixel.
struct PixelCosts {
  const ReferenceView& reference;
  const PatchMatchOptions& options;
  const ReferencePatch& patch;
  Vec3f ray;

  // 1 - NCC in one view. gray: that of the source.
  TSAR_HD float Photometric(const SourceView& source,
                            const GrayView& gray,
                            const Plane& plane) const {
    if (!patch.HasTexture()) {
      return kMaxCost;
    }
    const PlaneHomography homography(
        reference.intrinsics, source.intrinsics, source.from_reference, plane);
    const float cost = PatchCost(patch, homography, gray);
    return cost == kUndefinedCost ? kMaxCost : cost;
  }

  // The geometric term of the view's depth map.
  TSAR_HD float Geometric(const SourceView& source, const Plane& plane) const {
    if (source.depth.width == 0) {
      return 0.f;
    }
    float error = options.max_geometric_error;
    SeenThroughSource seen;
    if (LookThroughSource(
            reference.intrinsics, source, ray * plane.Depth(ray), &seen)) {
      const float dx = seen.x - patch.center_x;
      const float dy = seen.y - patch.center_y;
      error = fminf(error, sqrtf(dx * dx + dy * dy));
    }
    return options.geometric_weight * error;
  }
};

// Whether the plane's depth at the pixel lies between the bounds.
TSAR_HD inline bool IsUsable(const Plane& plane,
                             const Vec3f& ray,
                             const PatchMatchOptions& options) {
  const DepthBounds bounds{options.depth_min, options.depth_max};
  return plane.Valid() && bounds.Contains(plane.Depth(ray));
}

}  // namespace tsar
