// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/segmentation/regions.h"

#include "colmap_tsar/device/connected_components.h"
#include "colmap_tsar/device/fill.h"

#include <utility>
#include <vector>

namespace tsar {
namespace {

struct OffEdges {
  const uint8_t* edges;
  TSAR_HD bool Contains(int i) const { return edges[i] == 0; }
  TSAR_HD bool Connected(int /*i*/, int /*j*/) const { return true; }
};

struct RenameKernel {
  const int* names;
  ImageView<int> labels;
  TSAR_HD void operator()(int64_t i) const {
    if (labels.data[i] >= 0) {
      labels.data[i] = names[labels.data[i]];
    }
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

struct CopyKernel {
  ImageView<const int> source;
  ImageView<int> target;
  TSAR_HD void operator()(int64_t i) const { target.data[i] = source.data[i]; }
};

// Kernel{labels before, labels after}, num_steps times.
template <typename Kernel>
DeviceImage<int> Repeat(ImageView<const int> labels,
                        int num_steps,
                        Device& device) {
  DeviceImage<int> result(device, labels.width, labels.height);
  DeviceImage<int> next(device, labels.width, labels.height);
  ParallelFor(device,
              static_cast<int64_t>(labels.NumPixels()),
              CopyKernel{labels, result.View()});
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
  LabelComponents(device,
                  OffEdges{edges.data},
                  Connectivity::kFour,
                  regions.labels.View());
  Buffer<int> sizes(device, edges.NumPixels());
  Fill(device, sizes.Data(), sizes.Size(), 0);
  CountComponentPixels(device, regions.labels.View(), sizes.Data());

  // Roots are numbered on the host; there are few of them.
  std::vector<int> names = sizes.ToHost();
  for (int& name : names) {
    name = name > min_size ? regions.count++ : -1;
  }
  const Buffer<int> device_names(device, names);
  ParallelFor(device,
              static_cast<int64_t>(edges.NumPixels()),
              RenameKernel{device_names.Data(), regions.labels.View()});
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
