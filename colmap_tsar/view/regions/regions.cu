// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/regions/regions.h"

#include "colmap_tsar/device/connected_components.h"
#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/device/scan_and_sort.h"

#include <utility>

namespace tsar {
namespace {

struct OffEdges {
  const uint8_t* edges;
  TSAR_HD bool Contains(int i) const { return edges[i] == 0; }
  TSAR_HD bool Connected(int /*i*/, int /*j*/) const { return true; }
};

struct IsLargeKernel {
  const int* sizes;
  int min_size;
  int* is_large;
  TSAR_HD void operator()(int64_t i) const {
    is_large[i] = sizes[i] > min_size ? 1 : 0;
  }
};

// names: the number of large areas before each pixel; the value of a root
// differs from the next one's if its area is large.
struct RenameKernel {
  const int* names;
  ImageView<int> labels;
  TSAR_HD void operator()(int64_t i) const {
    const int root = labels.data[i];
    labels.data[i] =
        root >= 0 && names[root + 1] > names[root] ? names[root] : -1;
  }
};

struct GrowKernel {
  ImageView<const int> labels;
  ImageView<int> grown;

  TSAR_HD void operator()(int x, int y) const {
    int label = labels(x, y);
    if (label < 0) {
      label = Smaller(label, x - 1, y);
      label = Smaller(label, x + 1, y);
      label = Smaller(label, x, y - 1);
      label = Smaller(label, x, y + 1);
    }
    grown(x, y) = label;
  }

  TSAR_HD int Smaller(int label, int x, int y) const {
    const int other = labels.Contains(x, y) ? labels(x, y) : -1;
    return other >= 0 && (label < 0 || other < label) ? other : label;
  }
};

struct ShrinkKernel {
  ImageView<const int> labels;
  ImageView<int> shrunk;

  TSAR_HD void operator()(int x, int y) const {
    const int label = labels(x, y);
    shrunk(x, y) = Same(label, x - 1, y) && Same(label, x + 1, y) &&
                           Same(label, x, y - 1) && Same(label, x, y + 1)
                       ? label
                       : -1;
  }

  TSAR_HD bool Same(int label, int x, int y) const {
    return !labels.Contains(x, y) || labels(x, y) == label;
  }
};

// Applies Kernel{labels before, labels after} num_steps times.
template <typename Kernel>
DeviceImage<int> Repeat(ImageView<const int> labels,
                        int num_steps,
                        Device& device) {
  DeviceImage<int> result(device, labels.width, labels.height);
  DeviceImage<int> next(device, labels.width, labels.height);
  Copy(device, labels.data, labels.NumPixels(), result.View().data);
  for (int i = 0; i < num_steps; ++i) {
    ParallelFor(device,
                labels.width,
                labels.height,
                Kernel{result.View(), next.View()});
    std::swap(result, next);
  }
  return result;
}

}  // namespace

Regions FindRegions(ImageView<const uint8_t> edges,
                    int min_size,
                    Device& device) {
  Regions regions;
  regions.labels = DeviceImage<int>(device, edges.width, edges.height);
  const ImageView<int> view = regions.labels.View();
  LabelComponents(device, OffEdges{edges.data}, Connectivity::kFour, view);
  Buffer<int> sizes(device, view.NumPixels());
  Fill(device, sizes.Data(), sizes.Size(), 0);
  CountComponentPixels(device, view, sizes.Data());

  const int64_t count = static_cast<int64_t>(view.NumPixels());
  Buffer<int> is_large(device, view.NumPixels());
  ParallelFor(
      device, count, IsLargeKernel{sizes.Data(), min_size, is_large.Data()});
  const Buffer<int> names =
      ExclusiveSum(is_large.Data(), is_large.Size(), device);
  ParallelFor(device, count, RenameKernel{names.Data(), view});
  device.CopyToHost(&regions.count, names.Data() + count, sizeof(int));
  return regions;
}

DeviceImage<int> GrowLabels(ImageView<const int> labels,
                            int num_steps,
                            Device& device) {
  return Repeat<GrowKernel>(labels, num_steps, device);
}

DeviceImage<int> ShrinkLabels(ImageView<const int> labels,
                              int num_steps,
                              Device& device) {
  return Repeat<ShrinkKernel>(labels, num_steps, device);
}

}  // namespace tsar
