// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/plane_export/support_mask.h"

#include "colmap_tsar/base/median.h"

#include <algorithm>
#include <cmath>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace tsar {
namespace {

constexpr double kMaxCells = 1 << 20;
constexpr double kMaxCellsOfAll = 1 << 26;
constexpr double kPixelsPerCell = 2.0;  // Per side.

// Most samples per side of a pixel, for those larger than half a cell.
constexpr int kMaxSamples = 16;

Eigen::Vector2d NumCells(const Eigen::AlignedBox2d& box, double cell) {
  return ((box.sizes() / cell).array().floor() + 1 + 2 * SupportGrid::kPadding)
      .matrix();
}

double CellFor(const PlaneStatistics& statistics) {
  // The padding must fit, too.
  double cell = kPixelsPerCell * statistics.MedianFootprint();
  while (NumCells(statistics.box, cell).prod() > kMaxCells) {
    cell *= 1.25;
  }
  return cell;
}

int NumSamples(double extent, double cell) {
  return static_cast<int>(std::clamp(
      std::ceil(2.0 * extent / cell), 1.0, static_cast<double>(kMaxSamples)));
}

constexpr uint8_t kInside = 255;
constexpr float kMinCoverage = 0.5f;
constexpr float kMinShareOfMedian = 0.1f;
constexpr float kMinShareOfNeighbors = 0.5f;
// Gaps of up to twice this many cells are closed.
constexpr int kClosingRadius = 2;
constexpr int kMinCells = 16;  // Least cells of a hole or island.
// The largest share of a support beyond a crease at which it ends.
constexpr double kMaxShareBeyond = 0.05;
// The extension of a crease's observed part for clipping, in cells.
constexpr double kCreaseMargin = 4.0;

static_assert(kClosingRadius < SupportGrid::kPadding);

cv::Mat ToMat(Image<uint8_t>* image) {
  return cv::Mat(image->Height(), image->Width(), CV_8UC1, image->Data());
}

float MedianOfCovered(const Image<float>& coverage) {
  std::vector<float> covered;
  std::ranges::copy_if(coverage, std::back_inserter(covered), [](float value) {
    return value > 0.f;
  });
  return covered.empty() ? 0.f : UpperMedian(&covered);
}

Image<uint8_t> Threshold(const Image<float>& coverage) {
  const float min_coverage =
      std::max(kMinCoverage, kMinShareOfMedian * MedianOfCovered(coverage));
  const cv::Mat values(coverage.Height(),
                       coverage.Width(),
                       CV_32FC1,
                       const_cast<float*>(coverage.Data()));
  cv::Mat largest;
  cv::dilate(values, largest, cv::Mat::ones(3, 3, CV_8UC1));
  Image<uint8_t> mask(coverage.Width(), coverage.Height());
  cv::Mat inside = ToMat(&mask);
  // Comparisons give kInside.
  inside |=
      (values >= min_coverage) & (values >= kMinShareOfNeighbors * largest);
  return mask;
}

// Inverts components of `value` that are too small.
void RemoveSmall(uint8_t value, Image<uint8_t>* mask) {
  cv::Mat pixels = ToMat(mask);
  const cv::Mat of_value = pixels == value;
  cv::Mat labels;
  cv::Mat statistics;
  cv::Mat centroids;
  // Gaps are 8-connected, islands 4-connected.
  cv::connectedComponentsWithStats(of_value,
                                   labels,
                                   statistics,
                                   centroids,
                                   value == kInside ? 4 : 8,
                                   CV_32S);
  for (int y = 0; y < pixels.rows; ++y) {
    for (int x = 0; x < pixels.cols; ++x) {
      const int label = labels.at<int>(y, x);
      if (label > 0 &&
          statistics.at<int>(label, cv::CC_STAT_AREA) < kMinCells) {
        pixels.at<uint8_t>(y, x) = static_cast<uint8_t>(kInside - value);
      }
    }
  }
}

// If two cells touch only in a corner, adds one of the cells between.
void JoinCorners(Image<uint8_t>* mask) {
  bool has_changed = true;
  while (has_changed) {
    has_changed = false;
    for (int y = 0; y + 1 < mask->Height(); ++y) {
      for (int x = 0; x + 1 < mask->Width(); ++x) {
        uint8_t& a = (*mask)(x, y);
        uint8_t& b = (*mask)(x + 1, y);
        if (a == (*mask)(x + 1, y + 1) && b == (*mask)(x, y + 1) && a != b) {
          a = b = kInside;
          has_changed = true;
        }
      }
    }
  }
}

void ClipAtCrease(const SupportGrid& grid,
                  const CreaseLine& crease,
                  Image<uint8_t>* mask) {
  double num_left = 0.0;
  double num_right = 0.0;
  for (int y = 0; y < mask->Height(); ++y) {
    for (int x = 0; x < mask->Width(); ++x) {
      if ((*mask)(x, y) != 0) {
        (crease.Height(grid.Middle(x, y)) > 0.0 ? num_left : num_right) += 1.0;
      }
    }
  }
  if (std::min(num_left, num_right) >
      kMaxShareBeyond * (num_left + num_right)) {
    return;
  }
  const double kept_side = num_left > num_right ? 1.0 : -1.0;
  for (int y = 0; y < mask->Height(); ++y) {
    for (int x = 0; x < mask->Width(); ++x) {
      const Eigen::Vector2d middle = grid.Middle(x, y);
      if (kept_side * crease.Height(middle) < 0.0 &&
          crease.IsBeside(middle, kCreaseMargin * grid.cell)) {
        (*mask)(x, y) = 0;
      }
    }
  }
}

}  // namespace

std::vector<SupportGrid> MakeSupportGrids(
    const std::vector<PlaneStatistics>& statistics) {
  std::vector<SupportGrid> grids(statistics.size());
  double num_cells = 0.0;
  for (size_t p = 0; p < grids.size(); ++p) {
    if (statistics[p].num_pixels > 0) {
      grids[p].cell = CellFor(statistics[p]);
      num_cells += NumCells(statistics[p].box, grids[p].cell).prod();
    }
  }
  const double growth = std::sqrt(std::max(1.0, num_cells / kMaxCellsOfAll));
  for (size_t p = 0; p < grids.size(); ++p) {
    if (statistics[p].num_pixels > 0) {
      SupportGrid& grid = grids[p];
      grid.cell *= growth;
      const Eigen::Vector2d size = NumCells(statistics[p].box, grid.cell);
      grid.corner =
          statistics[p].box.min() -
          Eigen::Vector2d::Constant((SupportGrid::kPadding - 0.5) * grid.cell);
      grid.coverage =
          Image<float>(static_cast<int>(size.x()), static_cast<int>(size.y()));
    }
  }
  return grids;
}

void AddCoverage(const PlaneView& view,
                 const std::vector<PlaneCoordinates>& planes,
                 std::vector<SupportGrid>* grids) {
  const auto add = [&](int p,
                       int x,
                       int y,
                       const PlaneProjection& projection,
                       const PlaneProjection::Hit& hit) {
    SupportGrid& grid = (*grids)[p];
    const int num_x = NumSamples(hit.extent.x(), grid.cell);
    const int num_y = NumSamples(hit.extent.y(), grid.cell);
    const auto weight =
        static_cast<float>(hit.area / (grid.cell * grid.cell * num_x * num_y));
    for (int j = 0; j < num_y; ++j) {
      for (int i = 0; i < num_x; ++i) {
        PlaneProjection::Hit sample;
        if (!projection.Intersect(x + (i + 0.5) / num_x - 0.5,
                                  y + (j + 0.5) / num_y - 0.5,
                                  &sample)) {
          continue;
        }
        const Eigen::Vector2d place = (sample.point - grid.corner) / grid.cell;
        // Samples outside of the padding belong to border pixels.
        if (place.x() >= 1.0 && place.y() >= 1.0 &&
            place.x() < grid.coverage.Width() - 1 &&
            place.y() < grid.coverage.Height() - 1) {
          grid.coverage(static_cast<int>(place.x()),
                        static_cast<int>(place.y())) += weight;
        }
      }
    }
  };
  ForEachPlanePixel(view, planes, add);
}

Image<uint8_t> FindSupport(const SupportGrid& grid,
                           const std::vector<CreaseLine>& creases) {
  Image<uint8_t> mask = Threshold(grid.coverage);
  RemoveSmall(kInside, &mask);
  cv::Mat pixels = ToMat(&mask);
  constexpr int kSide = 2 * kClosingRadius + 1;
  cv::morphologyEx(
      pixels, pixels, cv::MORPH_CLOSE, cv::Mat::ones(kSide, kSide, CV_8UC1));
  for (const CreaseLine& crease : creases) {
    ClipAtCrease(grid, crease, &mask);
  }
  RemoveSmall(0, &mask);
  RemoveSmall(kInside, &mask);
  JoinCorners(&mask);
  return mask;
}

}  // namespace tsar
