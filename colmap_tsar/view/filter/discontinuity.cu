// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/filter/discontinuity.h"

#include "colmap_tsar/device/connected_components.h"
#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/device/parallel_for_pixels.h"

#include <cmath>

namespace tsar {
namespace {

// Layers k = 1 ... kNumLayers, each half as wide as the one before.
constexpr int kNumLayers = 3;
// t_d = kMaxStep * 2^k: neighbors closer in disparity are connected (paper
// pixels).
constexpr float kMaxStep = 3.f;
// t_n = kMinSize * 2^k: components with more pixels of their layer are kept.
constexpr int kMinSize = 5;

// Computes one layer: the valid pixel nearest to the center of each block. An
// average would invent disparities between the two sides of an edge.
struct ReduceDisparityKernel {
  ImageView<const float> depth;
  DisparityScale scale;
  int block;

  TSAR_HD float operator()(int x, int y) const {
    const float middle = 0.5f * (block - 1);
    float best_distance = 4.f * block * block;
    float best_depth = 0.f;
    for (int dy = 0; dy < block; ++dy) {
      for (int dx = 0; dx < block; ++dx) {
        const int column = x * block + dx;
        const int row = y * block + dy;
        if (!depth.Contains(column, row) || !(depth(column, row) > 0.f)) {
          continue;
        }
        const float distance =
            (dx - middle) * (dx - middle) + (dy - middle) * (dy - middle);
        if (distance < best_distance) {
          best_distance = distance;
          best_depth = depth(column, row);
        }
      }
    }
    return best_depth > 0.f ? scale.ToDisparity(best_depth) : 0.f;
  }
};

struct ContinuousDisparity {
  const float* disparity;
  float max_step;

  TSAR_HD bool Contains(int i) const { return disparity[i] > 0.f; }
  TSAR_HD bool Connected(int i, int j) const {
    return fabsf(disparity[i] - disparity[j]) < max_step;
  }
};

struct AddLayerKernel {
  ImageView<const float> depth;
  DisparityScale scale;
  int block;
  ImageView<const float> disparity;
  ImageView<const int> labels;
  const int* sizes;
  float max_step;
  int min_size;
  float weight;
  ImageView<float> score;

  TSAR_HD void operator()(int x, int y) const {
    const float z = depth(x, y);
    if (!(z > 0.f)) {
      return;
    }
    // A block represents one surface only; a pixel on another one, next to an
    // edge, uses the result of a neighboring block.
    const float own = scale.ToDisparity(z);
    for (int row = y / block - 1; row <= y / block + 1; ++row) {
      for (int column = x / block - 1; column <= x / block + 1; ++column) {
        if (IsKept(column, row) &&
            fabsf(own - disparity(column, row)) < max_step) {
          score(x, y) += weight;
          return;
        }
      }
    }
  }

  TSAR_HD bool IsKept(int column, int row) const {
    if (!labels.Contains(column, row)) {
      return false;
    }
    const int label = labels(column, row);
    return label >= 0 && sizes[label] > min_size;
  }
};

}  // namespace

DeviceImage<float> ComputeDiscontinuity(ImageView<const float> depth,
                                        const DisparityScale& scale,
                                        Device& device) {
  DeviceImage<float> score(device, depth.width, depth.height);
  Fill(device, score.View().data, depth.NumPixels(), 0.f);
  for (int k = 1; k <= kNumLayers; ++k) {
    const int block = 1 << k;
    const int width = (depth.width + block - 1) / block;
    const int height = (depth.height + block - 1) / block;
    const DeviceImage<float> disparity = MapPixels<float>(
        device, width, height, ReduceDisparityKernel{depth, scale, block});
    const float max_step = kMaxStep * block;
    DeviceImage<int> labels(device, width, height);
    LabelComponents(device,
                    ContinuousDisparity{disparity.View().data, max_step},
                    Connectivity::kEight,
                    labels.View());
    const size_t num_pixels = labels.View().NumPixels();
    Buffer<int> sizes(device, num_pixels);
    Fill(device, sizes.Data(), num_pixels, 0);
    CountComponentPixels(device, labels.View(), sizes.Data());
    ParallelFor(device,
                depth.width,
                depth.height,
                AddLayerKernel{depth,
                               scale,
                               block,
                               disparity.View(),
                               labels.View(),
                               sizes.Data(),
                               max_step,
                               kMinSize * block,
                               1.f / k,
                               score.View()});
  }
  return score;
}

}  // namespace tsar
