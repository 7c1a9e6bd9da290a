// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/refinement/slic.h"

#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/refinement/fragments.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>

namespace tsar {
namespace {

// L in [0, 100], a and b around 0, as SLIC's colour distance expects.
Image<Vec3f> ConvertToLab(const Image<Rgb>& color) {
  cv::Mat rgb(color.Height(),
              color.Width(),
              CV_8UC3,
              const_cast<Rgb*>(color.Data()));
  cv::Mat scaled;
  rgb.convertTo(scaled, CV_32FC3, 1.0 / 255.0);
  Image<Vec3f> lab(color.Width(), color.Height());
  cv::Mat target(color.Height(), color.Width(), CV_32FC3, lab.Data());
  cv::cvtColor(scaled, target, cv::COLOR_RGB2Lab);
  return lab;
}

struct Cluster {
  float x;
  float y;
  Vec3f lab;
  float mean_score;
};

// Clusters start on a regular grid and stay within their cell's
// neighbourhood, so that a pixel needs to look at nine of them only.
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

struct InitClusterKernel {
  ClusterGrid grid;
  ImageView<const Vec3f> lab;
  ImageView<const float> score;
  Cluster* clusters;

  // The position of least colour gradient around the middle of the cell, so
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
  float color_scale;
  float spatial_scale;
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
        const Vec3f color = (lab(x, y) - cluster.lab) * (1.f / color_scale);
        const float dx = (x - cluster.x) / spatial_scale;
        const float dy = (y - cluster.y) / spatial_scale;
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

// The mean of a cluster's pixels, gathered in raster order from the cells in
// which they can lie.
struct UpdateKernel {
  ClusterGrid grid;
  ImageView<const Vec3f> lab;
  ImageView<const float> score;
  ImageView<const int> labels;
  Cluster* clusters;

  TSAR_HD void operator()(int column, int row) const {
    const int k = row * grid.columns + column;
    const int x_begin = Begin((column - 1) * grid.cell_width);
    const int y_begin = Begin((row - 1) * grid.cell_height);
    const int x_end = End((column + 2) * grid.cell_width, lab.width);
    const int y_end = End((row + 2) * grid.cell_height, lab.height);
    Cluster sum = {};
    int count = 0;
    for (int y = y_begin; y < y_end; ++y) {
      for (int x = x_begin; x < x_end; ++x) {
        if (labels(x, y) == k) {
          sum.x += x;
          sum.y += y;
          sum.lab = sum.lab + lab(x, y);
          sum.mean_score += score(x, y);
          ++count;
        }
      }
    }
    if (count > 0) {
      const float inverse = 1.f / count;
      clusters[k] = {sum.x * inverse,
                     sum.y * inverse,
                     sum.lab * inverse,
                     sum.mean_score * inverse};
    }
  }

  TSAR_HD static int Begin(float value) {
    return value < 0.f ? 0 : static_cast<int>(value);
  }
  TSAR_HD static int End(float value, int size) {
    const int end = static_cast<int>(value) + 1;
    return end < size ? end : size;
  }
};

}  // namespace

Superpixels ComputeSuperpixels(const Image<Rgb>& color,
                               ImageView<const float> score,
                               const SlicOptions& options,
                               Device& device) {
  const int width = color.Width();
  const int height = color.Height();
  const float step = std::sqrt(static_cast<float>(options.superpixel_size));
  ClusterGrid grid;
  grid.columns = std::max(1, static_cast<int>(width / step + 0.5f));
  grid.rows = std::max(1, static_cast<int>(height / step + 0.5f));
  grid.cell_width = static_cast<float>(width) / grid.columns;
  grid.cell_height = static_cast<float>(height) / grid.rows;

  const DeviceImage<Vec3f> lab(device, ConvertToLab(color));
  Buffer<Cluster> clusters(device,
                           static_cast<size_t>(grid.columns) * grid.rows);
  DeviceImage<int> labels(device, width, height);
  ParallelFor(
      device,
      grid.columns,
      grid.rows,
      InitClusterKernel{grid, lab.View(), score, clusters.Data()});
  for (int i = 0; i < options.num_iterations; ++i) {
    ParallelFor(device,
                width,
                height,
                AssignKernel{grid,
                             lab.View(),
                             clusters.Data(),
                             options.color_scale,
                             options.spatial_scale,
                             labels.View()});
    ParallelFor(
        device,
        grid.columns,
        grid.rows,
        UpdateKernel{
            grid, lab.View(), score, labels.View(), clusters.Data()});
  }
  Superpixels superpixels;
  superpixels.count =
      MergeFragments(labels, options.superpixel_size / 4, device);
  superpixels.labels = std::move(labels);
  return superpixels;
}

}  // namespace tsar
