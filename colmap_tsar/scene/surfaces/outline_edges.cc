// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/surfaces/outline_edges.h"

#include "colmap_tsar/base/median.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

namespace tsar {

namespace {

// Lengths are in pixels.
constexpr float kMinWidth = 10.f;
constexpr float kMaxWidth = 400.f;
constexpr size_t kMinRows = 20;
// The largest distance of a row's edges from those of the pair.
constexpr float kTolerance = 1.5f;
// The upper limit of the strength of edges between the two of a pair,
// relative to the weaker one.
constexpr float kMaxBetween = 0.6f;

// The width of the raster's border, in pixels, without valid edges.
constexpr double kMargin = 4.0;

// Colors are averaged along the axis, and differentiated across it.
constexpr std::array<float, 5> kSmoothing = {1.f, 2.f, 3.f, 2.f, 1.f};
constexpr float kSumOfSmoothing = 9.f;
constexpr int kReach = 2;
// The derivative below at the least step that is an edge, of 4 gray levels.
constexpr float kMinSlope = 4.f * 3.f / 8.f;

using Channel = Image<float>;

struct RectifiedImage {
  std::array<Channel, 3> channels;
  Image<uint8_t> is_valid;
};

// The position in the view's raster of a pixel of the rectified image; nothing
// where it is outside or in the border.
std::optional<Eigen::Vector2d> PositionInRaster(const AxisCamera& camera,
                                                double column,
                                                double row) {
  const Camera& view = camera.view;
  const Eigen::Vector3d ray =
      camera.to_view * Eigen::Vector3d((column - camera.cx) / camera.focal,
                                       (row - camera.cy) / camera.focal,
                                       1.0);
  if (!(ray.z() > 0.0)) {
    return std::nullopt;
  }
  const double x = view.fx * ray.x() / ray.z() + view.cx;
  const double y = view.fy * ray.y() / ray.z() + view.cy;
  const bool is_inside = x >= kMargin && y >= kMargin &&
                         x < view.width - 1 - kMargin &&
                         y < view.height - 1 - kMargin;
  return is_inside ? std::optional(Eigen::Vector2d(x, y)) : std::nullopt;
}

RectifiedImage Rectify(const Image<Rgb>& color, const AxisCamera& camera) {
  RectifiedImage rectified;
  for (Channel& channel : rectified.channels) {
    channel = Channel(camera.width, camera.height);
  }
  rectified.is_valid = Image<uint8_t>(camera.width, camera.height);
  for (int row = 0; row < camera.height; ++row) {
    for (int column = 0; column < camera.width; ++column) {
      const std::optional<Eigen::Vector2d> position =
          PositionInRaster(camera, column, row);
      if (!position) {
        continue;
      }
      const int left = static_cast<int>(position->x());
      const int above = static_cast<int>(position->y());
      const auto right = static_cast<float>(position->x() - left);
      const auto below = static_cast<float>(position->y() - above);
      const auto mean = [&](uint8_t Rgb::*channel) {
        const auto at = [&](int i, int j) -> float {
          return color(left + i, above + j).*channel;
        };
        return (at(0, 0) * (1.f - right) + at(1, 0) * right) * (1.f - below) +
               (at(0, 1) * (1.f - right) + at(1, 1) * right) * below;
      };
      rectified.channels[0](column, row) = mean(&Rgb::r);
      rectified.channels[1](column, row) = mean(&Rgb::g);
      rectified.channels[2](column, row) = mean(&Rgb::b);
      rectified.is_valid(column, row) = 1;
    }
  }
  return rectified;
}

// The mean square of the channels' derivatives across the axis in one row; 0
// where its support is not fully in the image.
std::vector<float> SquaredSlopes(const RectifiedImage& rectified, int row) {
  const int width = rectified.is_valid.Width();
  std::vector<float> slopes(width, 0.f);
  std::vector<uint8_t> is_valid(width, 1);
  for (int y = row - kReach; y <= row + kReach; ++y) {
    for (int x = 0; x < width; ++x) {
      is_valid[x] &= rectified.is_valid(x, y);
    }
  }
  for (const Channel& channel : rectified.channels) {
    std::vector<float> smooth(width, 0.f);
    for (int y = -kReach; y <= kReach; ++y) {
      const float weight = kSmoothing[y + kReach] / kSumOfSmoothing;
      for (int x = 0; x < width; ++x) {
        smooth[x] += weight * channel(x, row + y);
      }
    }
    for (size_t x = kReach; x + kReach < smooth.size(); ++x) {
      const float slope = (smooth[x + 2] - smooth[x - 2] +
                           2.f * (smooth[x + 1] - smooth[x - 1])) /
                          8.f;
      slopes[x] += slope * slope / 3.f;
    }
  }
  for (size_t x = 0; x < slopes.size(); ++x) {
    for (int i = -kReach; i <= kReach; ++i) {
      const size_t other = x + i;
      if (other >= slopes.size() || is_valid[other] == 0) {
        slopes[x] = 0.f;
      }
    }
  }
  return slopes;
}

// A pair of edges in one row.
struct EdgePair {
  int row = 0;
  float left = 0.f;
  float right = 0.f;
};

// Size of a bin, in pixels.
constexpr float kBinSize = 2.f;
using Bin = std::pair<int, int>;
using Bins = std::map<Bin, std::vector<EdgePair>>;

Bin BinOf(const EdgePair& edges) {
  return {static_cast<int>(std::lround(edges.left / kBinSize)),
          static_cast<int>(std::lround(edges.right / kBinSize))};
}

Bins CollectPairs(const std::vector<std::vector<AcrossEdge>>& edges) {
  Bins bins;
  for (size_t row = 0; row < edges.size(); ++row) {
    const std::vector<AcrossEdge>& of_row = edges[row];
    for (size_t i = 0; i < of_row.size(); ++i) {
      float between = 0.f;  // The strongest edge.
      for (size_t j = i + 1; j < of_row.size(); ++j) {
        const float width = of_row[j].column - of_row[i].column;
        if (between >= kMaxBetween * of_row[i].strength || width > kMaxWidth) {
          break;
        }
        if (width >= kMinWidth && between < kMaxBetween * of_row[j].strength) {
          const EdgePair pair = {
              static_cast<int>(row), of_row[i].column, of_row[j].column};
          bins[BinOf(pair)].push_back(pair);
        }
        between = std::max(between, of_row[j].strength);
      }
    }
  }
  return bins;
}

float Median(const std::vector<EdgePair>& pairs, float EdgePair::*column) {
  std::vector<float> values;
  for (const EdgePair& pair : pairs) {
    values.push_back(pair.*column);
  }
  return UpperMedian(&values);
}

// Joins the pairs near their median position, one in each row: an edge may be
// double.
OutlinePair Join(std::vector<EdgePair> pairs) {
  const float left = Median(pairs, &EdgePair::left);
  const float right = Median(pairs, &EdgePair::right);
  std::erase_if(pairs, [&](const EdgePair& pair) {
    return std::abs(pair.left - left) > kTolerance ||
           std::abs(pair.right - right) > kTolerance;
  });
  std::ranges::sort(pairs, {}, [&](const EdgePair& pair) {
    return std::tuple(
        pair.row,
        std::max(std::abs(pair.left - left), std::abs(pair.right - right)),
        pair.left,
        pair.right);
  });
  const auto of_same_row = std::ranges::unique(pairs, {}, &EdgePair::row);
  pairs.erase(of_same_row.begin(), of_same_row.end());
  OutlinePair result;
  double sum_left = 0.0;
  double sum_right = 0.0;
  for (const EdgePair& pair : pairs) {
    result.rows.push_back(pair.row);
    sum_left += pair.left;
    sum_right += pair.right;
  }
  if (!pairs.empty()) {
    result.left = static_cast<float>(sum_left / pairs.size());
    result.right = static_cast<float>(sum_right / pairs.size());
  }
  return result;
}

}  // namespace

std::vector<std::vector<AcrossEdge>> FindEdgesAcross(const Image<Rgb>& color,
                                                     const AxisCamera& camera) {
  const RectifiedImage rectified = Rectify(color, camera);
  std::vector<std::vector<AcrossEdge>> edges(camera.height);
  for (int row = kReach; row < camera.height - kReach; ++row) {
    std::vector<float> slopes = SquaredSlopes(rectified, row);
    for (float& slope : slopes) {
      slope = std::sqrt(slope);
    }
    for (size_t x = 1; x + 1 < slopes.size(); ++x) {
      const float before = slopes[x - 1];
      const float peak = slopes[x];
      const float after = slopes[x + 1];
      if (peak > kMinSlope && peak >= before && peak > after) {
        const float bend = before + after - 2.f * peak;
        edges[row].push_back({x + 0.5f * (before - after) / bend, peak});
      }
    }
  }
  return edges;
}

bool IsInRaster(const AxisCamera& camera, double column, double row) {
  // The derivative uses the pixels around.
  return PositionInRaster(camera, column - kReach, row - kReach) &&
         PositionInRaster(camera, column + kReach, row + kReach);
}

std::vector<OutlinePair> FindOutlinePairs(
    const std::vector<std::vector<AcrossEdge>>& edges) {
  Bins bins = CollectPairs(edges);
  std::vector<std::pair<size_t, Bin>> by_size;
  for (const auto& [bin, pairs] : bins) {
    by_size.emplace_back(pairs.size(), bin);
  }
  std::ranges::stable_sort(
      by_size, std::greater{}, &std::pair<size_t, Bin>::first);
  std::vector<OutlinePair> result;
  for (const auto& [size, bin] : by_size) {
    // A pair between bins is spread over up to four of them.
    if (4 * size < kMinRows) {
      break;
    }
    if (!bins.contains(bin)) {
      continue;  // It is part of another pair.
    }
    std::vector<EdgePair> around;
    for (int left = bin.first - 1; left <= bin.first + 1; ++left) {
      for (int right = bin.second - 1; right <= bin.second + 1; ++right) {
        const auto found = bins.find({left, right});
        if (found != bins.end()) {
          around.insert(
              around.end(), found->second.begin(), found->second.end());
          bins.erase(found);
        }
      }
    }
    if (around.size() >= kMinRows) {
      OutlinePair pair = Join(std::move(around));
      if (pair.rows.size() >= kMinRows) {
        result.push_back(std::move(pair));
      }
    }
  }
  return result;
}

}  // namespace tsar
