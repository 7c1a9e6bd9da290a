// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/superpixels/slic.h"

#include "colmap_tsar/device/atomic.h"
#include "colmap_tsar/device/connected_components.h"
#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/device/scan_and_sort.h"
#include "colmap_tsar/view/superpixels/cielab.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace tsar {
namespace {

struct Cluster {
  float x;
  float y;
  Vec3f lab;
  float mean_score;
};

// Clusters start on a regular grid and stay within their cell's neighborhood,
// so that a pixel compares only nine of them.
struct ClusterGrid {
  int columns;
  int rows;
  float cell_width;
  float cell_height;

  TSAR_HD int ColumnOf(int x) const {
    const int column = static_cast<int>(x / cell_width);
    return column < columns ? column : columns - 1;
  }
  TSAR_HD int RowOf(int y) const {
    const int row = static_cast<int>(y / cell_height);
    return row < rows ? row : rows - 1;
  }
};

// The divisors of the color (CIELAB) and the spatial distance in Eq. 3.
constexpr float kColorScale = 10.f;
constexpr float kSpatialScale = 20.f;

struct InitClusterKernel {
  ClusterGrid grid;
  ImageView<const Vec3f> lab;
  ImageView<const float> score;
  Cluster* clusters;

  // Sets the position of least color gradient around the center of the cell, so
  // that no cluster starts on an edge.
  TSAR_HD void operator()(int column, int row) const {
    const int middle_x = static_cast<int>((column + 0.5f) * grid.cell_width);
    const int middle_y = static_cast<int>((row + 0.5f) * grid.cell_height);
    float best = -1.f;
    int best_x = middle_x < lab.width ? middle_x : lab.width - 1;
    int best_y = middle_y < lab.height ? middle_y : lab.height - 1;
    for (int y = middle_y - 1; y <= middle_y + 1; ++y) {
      for (int x = middle_x - 1; x <= middle_x + 1; ++x) {
        if (x < 1 || y < 1 || x >= lab.width - 1 || y >= lab.height - 1) {
          continue;
        }
        const Vec3f dx = lab(x + 1, y) - lab(x - 1, y);
        const Vec3f dy = lab(x, y + 1) - lab(x, y - 1);
        const float gradient = Dot(dx, dx) + Dot(dy, dy);
        if (best < 0.f || gradient < best) {
          best = gradient;
          best_x = x;
          best_y = y;
        }
      }
    }
    clusters[row * grid.columns + column] = {static_cast<float>(best_x),
                                             static_cast<float>(best_y),
                                             lab(best_x, best_y),
                                             score(best_x, best_y)};
  }
};

struct AssignKernel {
  ClusterGrid grid;
  ImageView<const Vec3f> lab;
  const Cluster* clusters;
  float inverse_color_scale;
  float inverse_spatial_scale;
  ImageView<int> labels;

  TSAR_HD void operator()(int x, int y) const {
    const int column = grid.ColumnOf(x);
    const int row = grid.RowOf(y);
    float best = INFINITY;
    int best_label = row * grid.columns + column;
    for (int r = row - 1; r <= row + 1; ++r) {
      for (int c = column - 1; c <= column + 1; ++c) {
        if (r < 0 || c < 0 || r >= grid.rows || c >= grid.columns) {
          continue;
        }
        const int k = r * grid.columns + c;
        const Cluster& cluster = clusters[k];
        const Vec3f color = (lab(x, y) - cluster.lab) * inverse_color_scale;
        const float dx = (x - cluster.x) * inverse_spatial_scale;
        const float dy = (y - cluster.y) * inverse_spatial_scale;
        const float distance =
            Dot(color, color) + dx * dx + dy * dy + cluster.mean_score;
        if (distance < best) {
          best = distance;
          best_label = k;
        }
      }
    }
    labels(x, y) = best_label;
  }
};

// Colors and scores are summed in units of 1 / kFixedPoint: sums of integers do
// not depend on their order.
constexpr float kFixedPoint = 65536.f;

// The sums over the pixels of a cluster.
struct ClusterSum {
  int64_t count;
  int64_t x;
  int64_t y;
  int64_t l;
  int64_t a;
  int64_t b;
  int64_t score;
};

// The number of pixels of a row that are summed before they are added to their
// clusters, which reduces contention.
constexpr int kPieceWidth = 16;

struct SumKernel {
  ImageView<const Vec3f> lab;
  ImageView<const float> score;
  ImageView<const int> labels;
  ClusterSum* sums;

  TSAR_HD void operator()(int piece, int y) const {
    const int begin = piece * kPieceWidth;
    const int end =
        begin + kPieceWidth < labels.width ? begin + kPieceWidth : labels.width;
    ClusterSum sum = {};
    int label = labels(begin, y);
    for (int x = begin; x < end; ++x) {
      if (labels(x, y) != label) {
        Add(sum, sums + label);
        sum = {};
        label = labels(x, y);
      }
      const Vec3f color = lab(x, y);
      sum.count += 1;
      sum.x += x;
      sum.y += y;
      sum.l += static_cast<int64_t>(color.x * kFixedPoint);
      sum.a += static_cast<int64_t>(color.y * kFixedPoint);
      sum.b += static_cast<int64_t>(color.z * kFixedPoint);
      sum.score += static_cast<int64_t>(score(x, y) * kFixedPoint);
    }
    Add(sum, sums + label);
  }

  TSAR_HD static void Add(const ClusterSum& sum, ClusterSum* total) {
    AtomicAdd(&total->count, sum.count);
    AtomicAdd(&total->x, sum.x);
    AtomicAdd(&total->y, sum.y);
    AtomicAdd(&total->l, sum.l);
    AtomicAdd(&total->a, sum.a);
    AtomicAdd(&total->b, sum.b);
    AtomicAdd(&total->score, sum.score);
  }
};

// Moves clusters to the mean of their pixels and clears the sums.
struct UpdateKernel {
  ClusterSum* sums;
  Cluster* clusters;

  TSAR_HD void operator()(int64_t k) const {
    const ClusterSum sum = sums[k];
    if (sum.count > 0) {
      const double scale = 1.0 / static_cast<double>(sum.count);
      const double fixed_scale = scale / kFixedPoint;
      clusters[k] = {static_cast<float>(sum.x * scale),
                     static_cast<float>(sum.y * scale),
                     {static_cast<float>(sum.l * fixed_scale),
                      static_cast<float>(sum.a * fixed_scale),
                      static_cast<float>(sum.b * fixed_scale)},
                     static_cast<float>(sum.score * fixed_scale)};
    }
    sums[k] = {};
  }
};

// Lower bound of a superpixel's size, so that 16 bits index the superpixels of
// the largest raster.
constexpr int kMinSize = 10;

// The least number of pixels of a superpixel.
int MinSize(int superpixel_size) {
  return std::max(superpixel_size / 4, kMinSize);
}

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

Superpixels ComputeSuperpixels(ImageView<const Rgb> color,
                               ImageView<const float> score,
                               int superpixel_size,
                               Device& device) {
  const int width = color.width;
  const int height = color.height;
  const float step = std::sqrt(static_cast<float>(superpixel_size));
  ClusterGrid grid;
  grid.columns = std::max(1, static_cast<int>(width / step + 0.5f));
  grid.rows = std::max(1, static_cast<int>(height / step + 0.5f));
  grid.cell_width = static_cast<float>(width) / grid.columns;
  grid.cell_height = static_cast<float>(height) / grid.rows;

  const DeviceImage<Vec3f> lab = ConvertToLab(color, device);
  const size_t num_clusters = static_cast<size_t>(grid.columns) * grid.rows;
  Buffer<Cluster> clusters(device, num_clusters);
  Buffer<ClusterSum> sums(device, num_clusters);
  Fill(device, sums.Data(), num_clusters, ClusterSum{});
  DeviceImage<int> labels(device, width, height);
  ParallelFor(device,
              grid.columns,
              grid.rows,
              InitClusterKernel{grid, lab.View(), score, clusters.Data()});
  for (int i = 0; i < kNumSlicIterations; ++i) {
    ParallelFor(device,
                width,
                height,
                AssignKernel{grid,
                             lab.View(),
                             clusters.Data(),
                             1.f / kColorScale,
                             1.f / kSpatialScale,
                             labels.View()});
    ParallelFor(device,
                (width + kPieceWidth - 1) / kPieceWidth,
                height,
                SumKernel{lab.View(), score, labels.View(), sums.Data()});
    ParallelFor(device,
                static_cast<int64_t>(num_clusters),
                UpdateKernel{sums.Data(), clusters.Data()});
  }
  Superpixels superpixels;
  superpixels.count = MergeFragments(labels, MinSize(superpixel_size), device);
  superpixels.labels = std::move(labels);
  return superpixels;
}

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
