// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/device/parallel_for.h"

namespace tsar {

namespace internal {
template <typename T, typename Function>
struct MapPixelsKernel {
  Function function;
  ImageView<T> result;
  TSAR_HD void operator()(int x, int y) const { result(x, y) = function(x, y); }
};
}  // namespace internal

// The image with the value function(x, y), a T, in each pixel. function: a
// struct with TSAR_HD operator(), copied to the device.
template <typename T, typename Function>
DeviceImage<T> MapPixels(Device& device,
                         int width,
                         int height,
                         const Function& function) {
  DeviceImage<T> result(device, width, height);
  ParallelFor(device,
              width,
              height,
              internal::MapPixelsKernel<T, Function>{function, result.View()});
  return result;
}

}  // namespace tsar
