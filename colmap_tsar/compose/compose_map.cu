// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/compose/compose_map.h"

#include "colmap_tsar/compose/depth_confidence.h"
#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/device/parallel_for_pixels.h"
#include "colmap_tsar/view/filter/confirmation.h"
#include "colmap_tsar/view/planes/group_planes.h"
#include "colmap_tsar/view/superpixels/weighted_median.h"

#include <cmath>
#include <utility>

namespace tsar {
namespace {

// A depth with its normal; 0 stands for none.
struct Value {
  float depth = 0.f;
  Vec3f normal;
};

struct ComposeKernel {
  ComposeInputs inputs;
  DisparityScale scale;
  ComposedViews map;  // At first the view's hypotheses.

  // Whether a measurement lies on a plane: within the dispersion of good
  // matches, about a pixel of disparity.
  TSAR_HD bool Same(float a, float b) const {
    constexpr PlaneTolerance kOnPlane{0.f, 1.f};
    return fabsf(a - b) < kOnPlane.At(b, scale) * b;
  }

  TSAR_HD void operator()(int x, int y) const {
    const Value region = OnPlane(inputs.region_planes, x, y);
    const Value superpixel = OnPlane(inputs.superpixel_planes, x, y);
    const Value own = {map.depth(x, y), map.normal(x, y)};
    const bool is_confirmed = !inputs.confirmations.Empty() &&
                              static_cast<Confirmation>(inputs.confirmations(
                                  x, y)) != Confirmation::kNone;
    const bool trusted =
        (inputs.trusted(x, y) != 0 || is_confirmed) && own.depth > 0.f;
    Provenance source = Provenance::kNone;
    Value value;
    if (trusted) {
      source = Provenance::kMeasured;
      value = region.depth > 0.f && Same(own.depth, region.depth) ? region
              : superpixel.depth > 0.f && Same(own.depth, superpixel.depth)
                  ? superpixel
                  : own;
    } else if (region.depth > 0.f && !(superpixel.depth > 0.f &&
                                       !Same(superpixel.depth, region.depth))) {
      source = Provenance::kRegionPlane;
      value = region;
    } else if (superpixel.depth > 0.f) {
      source = Provenance::kSuperpixelPlane;
      value = superpixel;
    }
    map.Set(x, y, value.depth, value.normal, source);
  }

  TSAR_HD static Value OnPlane(const PlaneRaster& raster, int x, int y) {
    const Plane plane = raster.At(x, y);
    return plane.Valid()
               ? Value{plane.Depth(raster.intrinsics.Ray(x, y)), plane.normal}
               : Value{};
  }
};

struct FindHolesKernel {
  ImageView<const float> depth;
  TSAR_HD uint8_t operator()(int x, int y) const {
    return depth(x, y) > 0.f ? 0 : 1;
  }
};

struct FillHolesKernel {
  DepthNormalViews filled;
  ComposedViews map;

  TSAR_HD void operator()(int x, int y) const {
    if (!(map.depth(x, y) > 0.f) && filled.depth(x, y) > 0.f) {
      map.Set(x,
              y,
              filled.depth(x, y),
              filled.normal(x, y),
              Provenance::kInterpolated);
    }
  }
};

struct ConfidenceKernel {
  ImageView<const uint8_t> provenance;
  ImageView<const float> score;

  // Of depths that were not measured in their pixel it is about the share that
  // is right to 2 cm on the scenes of docs/method.md.
  TSAR_HD float operator()(int x, int y) const {
    switch (static_cast<Provenance>(provenance(x, y))) {
      case Provenance::kMeasured:
        // Never 0, which stands for no depth, even without a score.
        return fminf(fmaxf(score(x, y), kMinConfidence), 1.f);
      case Provenance::kRegionPlane:
        return 0.5f;
      case Provenance::kSuperpixelPlane:
        return 0.3f;
      case Provenance::kInterpolated:
        return 0.25f;
      default:
        return 0.f;
    }
  }
};

struct FinishKernel {
  // The cosine with the ray of normals that are tilted to the camera: that of a
  // plane that the ray still meets.
  static constexpr float kGrazing = -1e-3f;

  float min_confidence;
  Intrinsics intrinsics;
  ImageView<const float> confidence;
  ComposedViews map;

  TSAR_HD uint8_t operator()(int x, int y) const {
    if (!(confidence(x, y) > 0.f) || confidence(x, y) < min_confidence) {
      map.Set(x, y, 0.f, {}, Provenance::kNone);
      return 0;
    }
    Vec3f& normal = map.normal(x, y);
    const Vec3f ray =
        intrinsics.Ray(static_cast<float>(x), static_cast<float>(y));
    if (Dot(normal, ray) > 0.f) {
      // To negate the normal would turn its surface over.
      const Vec3f direction = Normalized(ray);
      normal =
          Normalized(normal + direction * (kGrazing - Dot(normal, direction)));
    }
    return ToConfidenceLevel(confidence(x, y));
  }
};

}  // namespace

ComposedMap ComposeMap(DepthNormalImages own,
                       const ComposeInputs& inputs,
                       const DisparityScale& scale,
                       Device& device) {
  const int width = own.depth.Width();
  const int height = own.depth.Height();
  ComposedMap composed{std::move(own),
                       DeviceImage<uint8_t>(device, width, height)};
  ParallelFor(
      device, width, height, ComposeKernel{inputs, scale, composed.Views()});
  return composed;
}

DeviceImage<float> ComputeComposedConfidence(const ComposedMap& composed,
                                             ImageView<const float> score,
                                             Device& device) {
  return MapPixels<float>(device,
                          score.width,
                          score.height,
                          ConfidenceKernel{composed.provenance.View(), score});
}

DeviceImage<uint8_t> FinishMap(float min_confidence,
                               const Intrinsics& intrinsics,
                               ImageView<const float> confidence,
                               ComposedMap* composed,
                               Device& device) {
  return MapPixels<uint8_t>(
      device,
      confidence.width,
      confidence.height,
      FinishKernel{min_confidence, intrinsics, confidence, composed->Views()});
}

void FillHoles(ImageView<const Rgb> color,
               const Intrinsics& intrinsics,
               const RefineOptions& options,
               int num_iterations,
               ComposedMap* composed,
               Device& device) {
  if (!options.refine || !options.weighted_median) {
    return;
  }
  const int width = color.width;
  const int height = color.height;
  WeightedMedianOptions filter;
  filter.radius = ScaledRadius(2.f * options.window_radius, width, height);
  filter.spatial_sigma = static_cast<float>(options.spatial_sigma);
  filter.color_sigma = static_cast<float>(options.color_sigma);
  filter.min_support = 1.f / 3.f;
  for (int round = 0; round < num_iterations; ++round) {
    const DeviceImage<uint8_t> holes = MapPixels<uint8_t>(
        device, width, height, FindHolesKernel{composed->map.depth.View()});
    const DepthNormalImages filled = WeightedMedianFilter(
        composed->map.Views(), color, holes.View(), intrinsics, filter, device);
    ParallelFor(device,
                width,
                height,
                FillHolesKernel{filled.Views(), composed->Views()});
    filter.radius *= 2.f;
  }
}

void Download(const ComposedMap& composed,
              const DeviceImage<uint8_t>& levels,
              RefinedMaps* maps) {
  maps->depth = composed.map.depth.ToHost();
  maps->normal = composed.map.normal.ToHost();
  maps->provenance = composed.provenance.ToHost();
  maps->confidence = levels.ToHost();
}

}  // namespace tsar
