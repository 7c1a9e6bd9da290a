// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/device/pixel_groups.h"

#include "colmap_tsar/device/atomic.h"
#include "colmap_tsar/device/fill.h"
#include "colmap_tsar/device/parallel_for.h"

#include <algorithm>
#include <vector>

#ifdef __CUDACC__
#include <thrust/execution_policy.h>
#include <thrust/sequence.h>
#include <thrust/sort.h>
#endif

namespace tsar {
namespace {

PixelGroups GroupPixelsOnCpu(ImageView<const int> labels,
                             int num_labels,
                             Device& device) {
  std::vector<int> begin(num_labels + 1, 0);
  const size_t num_pixels = labels.NumPixels();
  for (size_t i = 0; i < num_pixels; ++i) {
    if (labels.data[i] >= 0) {
      ++begin[labels.data[i] + 1];
    }
  }
  for (int k = 0; k < num_labels; ++k) {
    begin[k + 1] += begin[k];
  }
  std::vector<int> pixels(begin.back());
  std::vector<int> next(begin.begin(), begin.end() - 1);
  for (size_t i = 0; i < num_pixels; ++i) {
    if (labels.data[i] >= 0) {
      pixels[next[labels.data[i]]++] = static_cast<int>(i);
    }
  }
  return {Buffer<int>(device, begin), Buffer<int>(device, pixels)};
}

#ifdef __CUDACC__

// Offsets are where the sorted labels change; labels without pixels get the
// offset of the next one that has some.
struct FindGroupBegins {
  const int* sorted_labels;
  int64_t count;
  int num_labels;
  int* begin;
  __device__ __host__ void operator()(int64_t i) const {
    const int first = i == 0 ? 0 : sorted_labels[i - 1] + 1;
    const int last = i == count ? num_labels : sorted_labels[i];
    for (int k = first < 0 ? 0 : first; k <= last; ++k) {
      begin[k] = static_cast<int>(i);
    }
  }
};

PixelGroups GroupPixelsOnGpu(ImageView<const int> labels,
                             int num_labels,
                             Device& device) {
  CudaDevice& cuda = static_cast<CudaDevice&>(device);
  cuda.Activate();
  const size_t num_pixels = labels.NumPixels();
  Buffer<int> keys(device, num_pixels);
  CheckCuda(cudaMemcpyAsync(keys.Data(),
                            labels.data,
                            num_pixels * sizeof(int),
                            cudaMemcpyDeviceToDevice,
                            cuda.Stream()),
            "copying labels");
  Buffer<int> indices(device, num_pixels);
  const auto policy = thrust::cuda::par.on(cuda.Stream());
  thrust::sequence(policy, indices.Data(), indices.Data() + num_pixels);
  thrust::stable_sort_by_key(
      policy, keys.Data(), keys.Data() + num_pixels, indices.Data());
  // Pixels of no group sort to the front; they are cut off.
  int num_ungrouped = 0;
  {
    std::vector<int> sorted = keys.ToHost();
    num_ungrouped = static_cast<int>(
        std::lower_bound(sorted.begin(), sorted.end(), 0) - sorted.begin());
  }
  const size_t num_grouped = num_pixels - num_ungrouped;
  PixelGroups groups{Buffer<int>(device, num_labels + 1),
                     Buffer<int>(device, num_grouped)};
  if (num_grouped > 0) {
    CheckCuda(cudaMemcpyAsync(groups.pixels.Data(),
                              indices.Data() + num_ungrouped,
                              num_grouped * sizeof(int),
                              cudaMemcpyDeviceToDevice,
                              cuda.Stream()),
              "copying pixels");
  }
  ParallelFor(device,
              static_cast<int64_t>(num_grouped) + 1,
              FindGroupBegins{keys.Data() + num_ungrouped,
                              static_cast<int64_t>(num_grouped),
                              num_labels,
                              groups.begin.Data()});
  return groups;
}

#endif

}  // namespace

PixelGroups GroupPixels(ImageView<const int> labels,
                        int num_labels,
                        Device& device) {
#ifdef __CUDACC__
  if (device.IsCuda()) {
    return GroupPixelsOnGpu(labels, num_labels, device);
  }
#endif
  return GroupPixelsOnCpu(labels, num_labels, device);
}

}  // namespace tsar
