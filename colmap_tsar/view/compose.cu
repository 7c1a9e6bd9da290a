// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/compose.h"

#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/view/depth_confidence.h"
#include "colmap_tsar/view/filter/confirmation.h"

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
  PlaneTolerance on_plane;
  // The view's hypotheses, which the result replaces.
  ImageView<float> depth;
  ImageView<Vec3f> normal;
  ImageView<uint8_t> provenance;

  TSAR_HD bool Same(float a, float b) const {
    return fabsf(a - b) < on_plane.At(b, scale) * b;
  }

  TSAR_HD void operator()(int x, int y) const {
    const Value region = OnPlane(inputs.region_planes, x, y);
    const Value superpixel = OnPlane(inputs.superpixel_planes, x, y);
    const Value own = {depth(x, y), normal(x, y)};
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
    depth(x, y) = value.depth;
    normal(x, y) = value.normal;
    provenance(x, y) = static_cast<uint8_t>(source);
  }

  TSAR_HD static Value OnPlane(const PlaneRaster& raster, int x, int y) {
    const Plane plane = raster.At(x, y);
    return plane.Valid()
               ? Value{plane.Depth(raster.intrinsics.Ray(x, y)), plane.normal}
               : Value{};
  }
};

struct ApplyRegionsKernel {
  PlaneRaster planes;
  DisparityScale scale;
  PlaneTolerance on_plane;
  ImageView<float> depth;
  ImageView<Vec3f> normal;
  ImageView<uint8_t> provenance;

  TSAR_HD void operator()(int x, int y) const {
    const Plane plane = planes.At(x, y);
    if (!plane.Valid()) {
      return;
    }
    const float z = plane.Depth(planes.intrinsics.Ray(x, y));
    const bool is_measured =
        static_cast<Provenance>(provenance(x, y)) == Provenance::kMeasured &&
        fabsf(depth(x, y) - z) < on_plane.At(z, scale) * z;
    depth(x, y) = z;
    normal(x, y) = plane.normal;
    provenance(x, y) = static_cast<uint8_t>(
        is_measured ? Provenance::kMeasured : Provenance::kRegionPlane);
  }
};

struct MarkKernel {
  ImageView<const uint8_t> filled;
  ImageView<uint8_t> provenance;
  TSAR_HD void operator()(int x, int y) const {
    if (filled(x, y) != 0) {
      provenance(x, y) = static_cast<uint8_t>(Provenance::kInterpolated);
    }
  }
};

struct ConfidenceKernel {
  ImageView<const uint8_t> provenance;
  ImageView<const float> score;
  ImageView<float> confidence;

  TSAR_HD void operator()(int x, int y) const {
    const auto source = static_cast<Provenance>(provenance(x, y));
    // The confidence is never 0, which stands for no depth, even without a
    // score.
    confidence(x, y) = source == Provenance::kMeasured
                           ? fminf(fmaxf(score(x, y), kMinConfidence), 1.f)
                           : ConfidenceOfFilled(source);
  }
};

struct DropKernel {
  float min_confidence;
  ImageView<float> depth;
  ImageView<Vec3f> normal;
  ImageView<uint8_t> provenance;
  ImageView<float> confidence;
  TSAR_HD void operator()(int x, int y) const {
    if (!(confidence(x, y) > 0.f) || confidence(x, y) < min_confidence) {
      depth(x, y) = 0.f;
      normal(x, y) = {};
      provenance(x, y) = static_cast<uint8_t>(Provenance::kNone);
      confidence(x, y) = 0.f;
    }
  }
};

}  // namespace

ComposedMap ComposeMap(DepthNormalImages own,
                       const ComposeInputs& inputs,
                       const DisparityScale& scale,
                       const ComposeOptions& options,
                       Device& device) {
  const int width = own.depth.Width();
  const int height = own.depth.Height();
  ComposedMap composed{std::move(own),
                       DeviceImage<uint8_t>(device, width, height)};
  ParallelFor(device,
              width,
              height,
              ComposeKernel{inputs,
                            scale,
                            options.on_plane,
                            composed.map.depth.View(),
                            composed.map.normal.View(),
                            composed.provenance.View()});
  return composed;
}

void ApplyRegionPlanes(const PlaneRaster& region_planes,
                       const DisparityScale& scale,
                       const ComposeOptions& options,
                       ComposedMap* composed,
                       Device& device) {
  ParallelFor(device,
              composed->map.depth.Width(),
              composed->map.depth.Height(),
              ApplyRegionsKernel{region_planes,
                                 scale,
                                 options.on_plane,
                                 composed->map.depth.View(),
                                 composed->map.normal.View(),
                                 composed->provenance.View()});
}

void MarkInterpolated(ImageView<const uint8_t> filled,
                      ComposedMap* composed,
                      Device& device) {
  ParallelFor(device,
              filled.width,
              filled.height,
              MarkKernel{filled, composed->provenance.View()});
}

DeviceImage<float> ComputeComposedConfidence(const ComposedMap& composed,
                                             ImageView<const float> score,
                                             Device& device) {
  DeviceImage<float> confidence(device, score.width, score.height);
  ParallelFor(
      device,
      score.width,
      score.height,
      ConfidenceKernel{composed.provenance.View(), score, confidence.View()});
  return confidence;
}

void DropDoubtful(float min_confidence,
                  ComposedMap* composed,
                  DeviceImage<float>* confidence,
                  Device& device) {
  ParallelFor(device,
              composed->map.depth.Width(),
              composed->map.depth.Height(),
              DropKernel{min_confidence,
                         composed->map.depth.View(),
                         composed->map.normal.View(),
                         composed->provenance.View(),
                         confidence->View()});
}

}  // namespace tsar
