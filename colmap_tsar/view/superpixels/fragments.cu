// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/superpixels/fragments.h"

#include "colmap_tsar/device/atomic.h"
#include "colmap_tsar/device/connected_components.h"
#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/device/scan_and_sort.h"

#include <cstdint>
#include <utility>

namespace tsar {
namespace {

struct SameLabel {
  const int* labels;
  TSAR_HD bool Contains(int /*i*/) const { return true; }
  TSAR_HD bool Connected(int i, int j) const { return labels[i] == labels[j]; }
};

// Segments, each identified by its first pixel, its root.
struct Segments {
  ImageView<int> roots;  // Each pixel's segment.
  int* sizes;            // In pixels; 0 for pixels that are no roots.
  // The neighbor that a fragment will join, packed so that the greatest value
  // is chosen; 0 if none is known.
  uint64_t* choices;
  int min_size;

  TSAR_HD bool IsFragment(int root) const {
    return sizes[root] > 0 && sizes[root] < min_size;
  }
  // A key that is greater for larger segments and, among equals, for earlier
  // roots.
  TSAR_HD uint64_t Pack(int root) const {
    return static_cast<uint64_t>(sizes[root]) << 32 |
           (UINT32_MAX - static_cast<uint32_t>(root));
  }
  TSAR_HD static int Unpack(uint64_t choice) {
    return static_cast<int>(UINT32_MAX - static_cast<uint32_t>(choice));
  }
};

struct ChooseKernel {
  Segments segments;

  TSAR_HD void operator()(int x, int y) const {
    const int root = segments.roots(x, y);
    if (x + 1 < segments.roots.width) {
      Offer(root, segments.roots(x + 1, y));
    }
    if (y + 1 < segments.roots.height) {
      Offer(root, segments.roots(x, y + 1));
    }
  }

  TSAR_HD void Offer(int a, int b) const {
    if (a == b) {
      return;
    }
    if (segments.IsFragment(a)) {
      AtomicMax(segments.choices + a, segments.Pack(b));
    }
    if (segments.IsFragment(b)) {
      AtomicMax(segments.choices + b, segments.Pack(a));
    }
  }
};

struct JoinKernel {
  Segments segments;
  TSAR_HD void operator()(int64_t i) const {
    if (segments.choices[i] != 0) {
      UniteRoots(segments.roots.data,
                 static_cast<int>(i),
                 Segments::Unpack(segments.choices[i]));
      segments.choices[i] = 0;
    }
  }
};

// Adds the sizes of merged roots to their new roots.
struct AddSizesKernel {
  Segments segments;
  TSAR_HD void operator()(int64_t i) const {
    const int root = segments.roots.data[i];
    if (root != i && segments.sizes[i] > 0) {
      AtomicAdd(segments.sizes + root, segments.sizes[i]);
      segments.sizes[i] = 0;
    }
  }
};

struct IsRootKernel {
  const int* roots;
  int* is_root;
  TSAR_HD void operator()(int64_t i) const {
    is_root[i] = roots[i] == i ? 1 : 0;
  }
};

struct RenameKernel {
  const int* names;
  int* labels;
  TSAR_HD void operator()(int64_t i) const { labels[i] = names[labels[i]]; }
};

}  // namespace

int MergeFragments(DeviceImage<int>& labels, int min_size, Device& device) {
  const int width = labels.Width();
  const int height = labels.Height();
  DeviceImage<int> roots(device, width, height);
  const size_t num_pixels = roots.View().NumPixels();
  const int64_t count = static_cast<int64_t>(num_pixels);
  LabelComponents(
      device, SameLabel{labels.View().data}, Connectivity::kFour, roots.View());
  Buffer<int> sizes(device, num_pixels);
  Fill(device, sizes.Data(), num_pixels, 0);
  CountComponentPixels(device, roots.View(), sizes.Data());
  Buffer<uint64_t> choices(device, num_pixels);
  Fill(device, choices.Data(), num_pixels, uint64_t{0});

  const Segments segments{roots.View(), sizes.Data(), choices.Data(), min_size};
  // Every fragment joins another segment, so the smallest one's size doubles at
  // least in each round.
  for (int64_t smallest = 1; smallest < min_size; smallest *= 2) {
    ParallelFor(device, width, height, ChooseKernel{segments});
    ParallelFor(device, count, JoinKernel{segments});
    FlattenTrees(device, roots.View());
    ParallelFor(device, count, AddSizesKernel{segments});
  }

  Buffer<int> is_root(device, num_pixels);
  ParallelFor(device, count, IsRootKernel{roots.View().data, is_root.Data()});
  const Buffer<int> names = ExclusiveSum(is_root.Data(), num_pixels, device);
  ParallelFor(device, count, RenameKernel{names.Data(), roots.View().data});
  labels = std::move(roots);
  int num_segments = 0;
  device.CopyToHost(&num_segments, names.Data() + count, sizeof(int));
  return num_segments;
}

}  // namespace tsar
