// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/device/scan_and_sort.h"

#include "colmap_tsar/device/parallel_for.h"

#include <numeric>
#include <vector>

#ifdef __CUDACC__
#include <algorithm>
#include <bit>

#include <cub/device/device_radix_sort.cuh>
#include <cub/device/device_scan.cuh>
#endif

namespace tsar {
namespace {

Buffer<int> ExclusiveSumOnCpu(const int* values, size_t count, Device& device) {
  Buffer<int> sums(device, count + 1);
  sums.Data()[0] = 0;
  std::inclusive_scan(values, values + count, sums.Data() + 1);
  return sums;
}

// A counting sort; pixels of no group form one more label.
PixelGroups GroupPixelsOnCpu(ImageView<const int> labels,
                             int num_labels,
                             Device& device) {
  const size_t num_pixels = labels.NumPixels();
  const auto group_of = [&](size_t i) {
    return labels.data[i] < 0 ? num_labels : labels.data[i];
  };
  std::vector<int> next(num_labels + 2, 0);
  for (size_t i = 0; i < num_pixels; ++i) {
    ++next[group_of(i) + 1];
  }
  std::inclusive_scan(next.begin(), next.end(), next.begin());
  PixelGroups groups{Buffer<int>(device, num_labels + 1),
                     Buffer<int>(device, num_pixels)};
  groups.begin.Upload(next.data());
  for (size_t i = 0; i < num_pixels; ++i) {
    groups.pixels.Data()[next[group_of(i)]++] = static_cast<int>(i);
  }
  return groups;
}

#ifdef __CUDACC__

// Computes inclusive sums shifted by one element, so that no value is read
// beyond the last.
Buffer<int> ExclusiveSumOnGpu(const int* values, size_t count, Device& device) {
  CudaDevice& cuda = static_cast<CudaDevice&>(device);
  Buffer<int> sums(device, count + 1);
  Fill(device, sums.Data(), 1, 0);
  if (count == 0) {
    return sums;
  }
  // Without scratch memory, its size is set instead.
  size_t num_bytes = 0;
  const auto sum = [&](void* scratch, const char* what) {
    CheckCuda(cub::DeviceScan::InclusiveSum(scratch,
                                            num_bytes,
                                            values,
                                            sums.Data() + 1,
                                            static_cast<int64_t>(count),
                                            cuda.Stream()),
              what);
  };
  sum(nullptr, "preparing a prefix sum");
  Buffer<char> scratch(device, num_bytes);
  sum(scratch.Data(), "a prefix sum");
  return sums;
}

struct InitSortKernel {
  const int* labels;
  int num_labels;
  uint32_t* keys;
  int* pixels;
  TSAR_HD void operator()(int64_t i) const {
    keys[i] = static_cast<uint32_t>(labels[i] < 0 ? num_labels : labels[i]);
    pixels[i] = static_cast<int>(i);
  }
};

// Finds the offsets where the sorted keys change; labels without pixels get the
// offset of the next label that has some.
struct FindBeginsKernel {
  const uint32_t* sorted_keys;
  int64_t count;
  int num_labels;
  int* begin;
  TSAR_HD void operator()(int64_t i) const {
    const int first = i == 0 ? 0 : static_cast<int>(sorted_keys[i - 1]) + 1;
    const int last = i == count ? num_labels : static_cast<int>(sorted_keys[i]);
    for (int k = first; k <= last; ++k) {
      begin[k] = static_cast<int>(i);
    }
  }
};

PixelGroups GroupPixelsOnGpu(ImageView<const int> labels,
                             int num_labels,
                             Device& device) {
  CudaDevice& cuda = static_cast<CudaDevice&>(device);
  const int64_t num_pixels = static_cast<int64_t>(labels.NumPixels());
  PixelGroups groups{Buffer<int>(device, num_labels + 1),
                     Buffer<int>(device, num_pixels)};
  Buffer<uint32_t> keys(device, num_pixels);
  Buffer<uint32_t> sorted_keys(device, num_pixels);
  Buffer<int> pixels(device, num_pixels);
  ParallelFor(
      device,
      num_pixels,
      InitSortKernel{labels.data, num_labels, keys.Data(), pixels.Data()});
  const int num_bits =
      std::max(1, static_cast<int>(std::bit_width<uint32_t>(num_labels)));
  // Without scratch memory, its size is set instead.
  size_t num_bytes = 0;
  const auto sort = [&](void* scratch, const char* what) {
    CheckCuda(cub::DeviceRadixSort::SortPairs(scratch,
                                              num_bytes,
                                              keys.Data(),
                                              sorted_keys.Data(),
                                              pixels.Data(),
                                              groups.pixels.Data(),
                                              num_pixels,
                                              0,
                                              num_bits,
                                              cuda.Stream()),
              what);
  };
  sort(nullptr, "preparing to sort pixels");
  Buffer<char> scratch(device, num_bytes);
  sort(scratch.Data(), "sorting pixels");
  ParallelFor(
      device,
      num_pixels + 1,
      FindBeginsKernel{
          sorted_keys.Data(), num_pixels, num_labels, groups.begin.Data()});
  return groups;
}

#endif

}  // namespace

Buffer<int> ExclusiveSum(const int* values, size_t count, Device& device) {
#ifdef __CUDACC__
  if (device.IsCuda()) {
    return ExclusiveSumOnGpu(values, count, device);
  }
#endif
  return ExclusiveSumOnCpu(values, count, device);
}

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
