// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/compose/depth_sigma.h"

#include "colmap_tsar/base/arithmetic.h"
#include "colmap_tsar/compose/compose_scene.h"
#include "colmap_tsar/device/parallel_for_pixels.h"

#include <cmath>

namespace tsar {
namespace {

// Lower bound of a view's noise, which is 0 where no superpixel has a plane.
constexpr float kMinNoise = 0.1f;

struct SigmaKernel {
  DepthResolution resolution;
  ViewSigmaOptions options;
  ImageView<const float> depth;
  ImageView<const uint8_t> provenance;

  TSAR_HD uint16_t operator()(int x, int y) const {
    const float z = depth(x, y);
    const auto source = static_cast<Provenance>(provenance(x, y));
    return z > 0.f ? ToPositiveHalf(z * resolution.RelativeDepthError(z) *
                                    Matching(source))
                   : uint16_t{0};
  }

  // The error of matching, in relative depths of one pixel of disparity.
  TSAR_HD float Matching(Provenance source) const {
    switch (source) {
      case Provenance::kMeasured:
        return options.measured;
      case Provenance::kSuperpixelPlane:
        return options.superpixel_plane;
      case Provenance::kInterpolated:
        return options.interpolated;
      default:
        return options.region_plane;
    }
  }
};

struct SceneSigmaKernel {
  ComposeSceneInputs inputs;
  DepthResolution resolution;
  ImageView<const float> variances_on_cylinders;
  float noise;
  SceneSigmaOptions options;
  ImageView<const float> depth;
  ImageView<const uint8_t> provenance;

  TSAR_HD uint16_t operator()(int x, int y) const {
    const float z = depth(x, y);
    if (!(z > 0.f)) {
      return 0;
    }
    if (!variances_on_cylinders.Empty() && variances_on_cylinders(x, y) > 0.f) {
      const float matching =
          options.on_cylinder * z * resolution.RelativeDepthError(z);
      return ToPositiveHalf(
          sqrtf(matching * matching + variances_on_cylinders(x, y)));
    }
    const auto source = static_cast<Provenance>(provenance(x, y));
    if (source == Provenance::kPrior) {
      return ToPositiveHalf(z * inputs.prior.At(x, y).sigma);
    }
    const ComposedSuperpixel& superpixel = SuperpixelAt(inputs, x, y);
    const bool is_on_plane = IsOnPlane(inputs.scene_planes, x, y, z);
    const float matching =
        Matching(source, is_on_plane) * resolution.RelativeDepthError(z);
    // The plane's variance relative to the squared depth, which is the same for
    // 1/z.
    const float of_plane =
        is_on_plane ? z * z *
                          superpixel.error.Variance(
                              inputs.scene_planes.intrinsics.Ray(x, y))
                    : 0.f;
    return ToPositiveHalf(z * sqrtf(matching * matching + of_plane));
  }

  // The error of matching, in addition to that of the plane, in relative depths
  // of one pixel of disparity.
  TSAR_HD float Matching(Provenance source, bool is_on_plane) const {
    switch (source) {
      case Provenance::kInterpolated:
        return options.interpolated;
      case Provenance::kMeasured:
        return is_on_plane ? options.moved : noise * options.standing;
      case Provenance::kRegionPlane:
        return options.filled_measured;
      case Provenance::kOtherViews:
        return options.filled_carried;
      default:
        return options.filled_guessed;
    }
  }
};

}  // namespace

DeviceImage<uint16_t> ComputeSceneSigma(
    const ComposedMap& composed,
    const ComposeSceneInputs& inputs,
    const DepthResolution& resolution,
    ImageView<const float> variances_on_cylinders,
    float noise,
    const SceneSigmaOptions& options,
    Device& device) {
  return MapPixels<uint16_t>(device,
                             inputs.flags.width,
                             inputs.flags.height,
                             SceneSigmaKernel{inputs,
                                              resolution,
                                              variances_on_cylinders,
                                              fmaxf(noise, kMinNoise),
                                              options,
                                              composed.map.depth.View(),
                                              composed.provenance.View()});
}

DeviceImage<uint16_t> ComputeSigma(const ComposedMap& composed,
                                   const DepthResolution& resolution,
                                   const ViewSigmaOptions& options,
                                   Device& device) {
  return MapPixels<uint16_t>(device,
                             composed.map.depth.Width(),
                             composed.map.depth.Height(),
                             SigmaKernel{resolution,
                                         options,
                                         composed.map.depth.View(),
                                         composed.provenance.View()});
}

}  // namespace tsar
