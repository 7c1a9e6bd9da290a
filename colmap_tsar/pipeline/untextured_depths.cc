// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/untextured_depths.h"

#include "colmap_tsar/device/device.h"
#include "colmap_tsar/device/working_bytes.h"
#include "colmap_tsar/matching/matching_cost.h"
#include "colmap_tsar/noise/estimate_noise.h"
#include "colmap_tsar/noise/window_variance.cuh"
#include "colmap_tsar/pipeline/gray.h"

#include <algorithm>
#include <memory>

namespace tsar {
namespace {

// Of the pixels of a map. Programs that filter nothing leave out little more
// than the margins; filters remove a tenth to a half.
constexpr double kMinUnfiltered = 0.98;
// As filtering/confirmation.h judges texture.
constexpr float kMinNoiseVariances = 2.f;
// In squared grey levels: what shading and compression leave on bare walls,
// where there is no other noise.
constexpr float kMinVariance = 3.f;
// Twice the variance of noise of eight levels. Where no block of an image is
// flat, as on gravel, its texture is taken for noise, and is far above this.
constexpr float kMaxVariance = 128.f;

bool IsUnfiltered(const ViewData& view) {
  return view.num_depths_to_refine > 0 &&
         static_cast<double>(view.num_depths_to_refine) >=
             kMinUnfiltered * static_cast<double>(view.depth.NumPixels());
}

void DropDepth(int x, int y, ViewData* view) {
  view->depth(x, y) = 0.f;
  view->normal(x, y) = {};
  view->is_to_refine(x, y) = 0;
  --view->num_depths_to_refine;
  if (!view->min_cost.Empty()) {
    view->min_cost(x, y) = kUndefinedCost;
    view->second_cost(x, y) = kUndefinedCost;
  }
}

}  // namespace

void DropUntexturedDepths(ViewData* view) {
  if (!IsUnfiltered(*view)) {
    return;
  }
  const std::unique_ptr<Device> device = Device::CreateCpu(1);
  const DeviceImage<float> on_device = ComputeGray(view->color.View(), *device);
  const ImageView<const float> gray = on_device.View();
  const NoiseCurve noise = EstimateNoise(gray, *device);
  for (int y = 0; y < gray.height; ++y) {
    for (int x = 0; x < gray.width; ++x) {
      const float min_variance =
          std::clamp(kMinNoiseVariances * noise.Variance(gray(x, y)),
                     kMinVariance,
                     kMaxVariance);
      if (view->is_to_refine(x, y) != 0 &&
          OwnTexture(gray, x, y) < min_variance) {
        DropDepth(x, y, view);
      }
    }
  }
}

int64_t DropUntexturedDepthsWorkingBytes(int64_t num_pixels) {
  return BytesOf<float>(num_pixels) + EstimateNoiseWorkingBytes(num_pixels);
}

}  // namespace tsar
