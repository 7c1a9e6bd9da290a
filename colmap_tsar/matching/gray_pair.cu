// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/matching/gray_pair.h"

#include "colmap_tsar/device/parallel_for.h"

namespace tsar {
namespace {

struct PairKernel {
  ImageView<const float> gray;
  ImageView<GrayPair> pairs;

  TSAR_HD void operator()(int x, int y) const {
    const int right = x + 1 < gray.width ? x + 1 : x;
    pairs(x, y) = MakeGrayPair(gray(x, y), gray(right, y));
  }
};

}  // namespace

DeviceImage<GrayPair> PairGray(ImageView<const float> gray, Device& device) {
  DeviceImage<GrayPair> pairs(device, gray.width, gray.height);
  ParallelFor(device, gray.width, gray.height, PairKernel{gray, pairs.View()});
  return pairs;
}

}  // namespace tsar
