// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/compose/photometric_detail.h"

#include "colmap_tsar/base/arithmetic.h"
#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/device/parallel_for_pixels.h"
#include "colmap_tsar/matching/gray_pair.h"
#include "colmap_tsar/view/denoise/estimate_noise.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tsar {
namespace {

// Smaller offsets, in pixels of disparity, may be errors of matching and leave
// the surface as it is.
constexpr float kMinOffset = 0.08f;
// The largest change of depth, relative to it.
constexpr float kMaxDepthChange = 0.01f;
// Pixels between others with an offset, at most twice this far apart, take
// their neighbors' offsets.
constexpr int kClosingRadius = 7;
// The scale at which offsets are averaged, and their largest standard
// deviation.
constexpr float kSmoothingSigma = 3.f;
constexpr float kMaxDeviation = 0.15f;
// The reach of the smoothing, in its standard deviations.
constexpr float kSmoothingReach = 3.f;

struct KnownOffsetKernel {
  ImageView<const float> weight;

  TSAR_HD uint8_t operator()(int x, int y) const {
    return weight(x, y) > 0.f ? 1 : 0;
  }
};

// Dilates or erodes a mask along rows or columns. Pixels outside are ignored.
struct LineKernel {
  ImageView<const uint8_t> mask;
  int radius;
  bool along_x;
  bool dilate;
  ImageView<uint8_t> result;

  TSAR_HD void operator()(int x, int y) const {
    // One set pixel decides a dilation, one unset pixel an erosion.
    const uint8_t decisive = dilate ? 1 : 0;
    for (int d = -radius; d <= radius; ++d) {
      const int u = along_x ? x + d : x;
      const int v = along_x ? y : y + d;
      if (mask.Contains(u, v) && mask(u, v) == decisive) {
        result(x, y) = decisive;
        return;
      }
    }
    result(x, y) = 1 - decisive;
  }
};

// Moves depths by the mean offset of the pixels around.
struct MoveKernel {
  static constexpr int kMaxReach = 16;

  ImageView<const float> offset;
  ImageView<const float> weight;
  ImageView<const uint8_t> is_among_known;
  DepthResolution resolution;
  int reach;  // Pixels to either side, at most kMaxReach.
  // Weights by distance in pixels.
  float gaussian[kMaxReach + 1];
  ImageView<float> depth;

  TSAR_HD void operator()(int x, int y) const {
    if (weight(x, y) == PhotometricOffsets::kNeverMoves ||
        (weight(x, y) <= 0.f && is_among_known(x, y) == 0)) {
      return;
    }
    float sum_weights = 0.f;
    float sum = 0.f;
    float squares = 0.f;
    for (int j = -reach; j <= reach; ++j) {
      for (int i = -reach; i <= reach; ++i) {
        const int u = x + i;
        const int v = y + j;
        if (!weight.Contains(u, v) || !(weight(u, v) > 0.f)) {
          continue;
        }
        const float of_pixel =
            weight(u, v) * gaussian[i < 0 ? -i : i] * gaussian[j < 0 ? -j : j];
        sum_weights += of_pixel;
        sum += of_pixel * offset(u, v);
        squares += of_pixel * offset(u, v) * offset(u, v);
      }
    }
    if (!(sum_weights > 0.f)) {
      return;
    }
    const float mean = sum / sum_weights;
    const float variance = squares / sum_weights - mean * mean;
    const float own = depth(x, y);
    const float moved = DepthAtOffset(own, mean, resolution);
    if (variance < kMaxDeviation * kMaxDeviation && fabsf(mean) >= kMinOffset &&
        fabsf(moved - own) <= kMaxDepthChange * own) {
      depth(x, y) = moved;
    }
  }
};

// Closes a mask: sets the pixels between set ones.
void CloseMask(int radius, DeviceImage<uint8_t>* mask, Device& device) {
  DeviceImage<uint8_t> other(device, mask->Width(), mask->Height());
  for (const bool dilate : {true, false}) {
    for (const bool along_x : {true, false}) {
      ParallelFor(device,
                  mask->Width(),
                  mask->Height(),
                  LineKernel{std::as_const(*mask).View(),
                             radius,
                             along_x,
                             dilate,
                             other.View()});
      std::swap(*mask, other);
    }
  }
}

// Moves the depths that have significant offsets.
void MoveDepths(const PhotometricOffsets& offsets,
                const DepthResolution& resolution,
                DeviceImage<float>* depth,
                Device& device) {
  DeviceImage<uint8_t> is_among_known =
      MapPixels<uint8_t>(device,
                         depth->Width(),
                         depth->Height(),
                         KnownOffsetKernel{offsets.weight.View()});
  CloseMask(kClosingRadius, &is_among_known, device);
  MoveKernel move{offsets.offset.View(),
                  offsets.weight.View(),
                  std::as_const(is_among_known).View(),
                  resolution,
                  std::min(static_cast<int>(kSmoothingReach * kSmoothingSigma),
                           MoveKernel::kMaxReach),
                  {},
                  depth->View()};
  for (int i = 0; i <= move.reach; ++i) {
    const float distance = static_cast<float>(i) / kSmoothingSigma;
    move.gaussian[i] = ExpOfNegative(-0.5f * distance * distance);
  }
  ParallelFor(device, depth->Width(), depth->Height(), move);
}

}  // namespace

void RestoreDetail(
    const DeviceReference& reference,
    const std::vector<std::shared_ptr<const UploadedView>>& sources,
    const DepthResolution& resolution,
    ComposedMap* composed,
    Device& device) {
  const DeviceImage<float> gray = ComputeGray(reference.color.View(), device);
  std::vector<SourceView> views;
  for (const auto& source : sources) {
    views.push_back({source->camera.GetIntrinsics(),
                     ComputeRelativePose(reference.camera, source->camera),
                     source->gray.View(),
                     source->depth.View()});
  }
  const Buffer<SourceView> device_views(device, views);
  const PhotometricInputs inputs{reference.MapIntrinsics(),
                                 gray.View(),
                                 device_views,
                                 resolution,
                                 EstimateNoise(gray.View(), device)};
  MoveDepths(MeasureOffsets(*composed, inputs, device),
             resolution,
             &composed->map.depth,
             device);
}

}  // namespace tsar
