// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/outline_pairs.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <tuple>
#include <utility>

namespace tsar {
namespace {

// Edges of one row.
struct EdgePair {
  int row = 0;
  float left = 0.f;
  float right = 0.f;
};

// In pixels.
constexpr float kBinSize = 2.f;
using Bin = std::pair<int, int>;
using Bins = std::map<Bin, std::vector<EdgePair>>;

Bin BinOf(const EdgePair& edges) {
  return {static_cast<int>(std::lround(edges.left / kBinSize)),
          static_cast<int>(std::lround(edges.right / kBinSize))};
}

Bins CollectPairs(const std::vector<std::vector<AcrossEdge>>& edges,
                  const OutlinePairOptions& options) {
  Bins bins;
  for (size_t row = 0; row < edges.size(); ++row) {
    const std::vector<AcrossEdge>& of_row = edges[row];
    for (size_t i = 0; i < of_row.size(); ++i) {
      float between = 0.f;  // The strongest.
      for (size_t j = i + 1; j < of_row.size(); ++j) {
        const float width = of_row[j].column - of_row[i].column;
        if (between >= options.max_between * of_row[i].strength ||
            width > options.max_width) {
          break;
        }
        if (width >= options.min_width &&
            between < options.max_between * of_row[j].strength) {
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
  const auto middle =
      values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Of the pairs those that lie where most do, one in each row: an edge may be
// double.
OutlinePair Join(std::vector<EdgePair> pairs,
                 const OutlinePairOptions& options) {
  const float left = Median(pairs, &EdgePair::left);
  const float right = Median(pairs, &EdgePair::right);
  std::erase_if(pairs, [&](const EdgePair& pair) {
    return std::abs(pair.left - left) > options.tolerance ||
           std::abs(pair.right - right) > options.tolerance;
  });
  const auto key = [&](const EdgePair& pair) {
    return std::tuple(
        pair.row,
        std::max(std::abs(pair.left - left), std::abs(pair.right - right)),
        pair.left,
        pair.right);
  };
  std::sort(
      pairs.begin(), pairs.end(), [&](const EdgePair& a, const EdgePair& b) {
        return key(a) < key(b);
      });
  pairs.erase(std::unique(pairs.begin(),
                          pairs.end(),
                          [](const EdgePair& a, const EdgePair& b) {
                            return a.row == b.row;
                          }),
              pairs.end());
  OutlinePair result;
  double sum_left = 0.0;
  double sum_right = 0.0;
  for (const EdgePair& pair : pairs) {
    result.rows.push_back(pair.row);
    sum_left += pair.left;
    sum_right += pair.right;
  }
  if (!pairs.empty()) {
    const auto count = static_cast<double>(pairs.size());
    result.left = static_cast<float>(sum_left / count);
    result.right = static_cast<float>(sum_right / count);
  }
  return result;
}

}  // namespace

std::vector<OutlinePair> FindOutlinePairs(
    const std::vector<std::vector<AcrossEdge>>& edges,
    const OutlinePairOptions& options) {
  Bins bins = CollectPairs(edges, options);
  std::vector<std::pair<size_t, Bin>> by_size;
  for (const auto& [bin, pairs] : bins) {
    by_size.emplace_back(pairs.size(), bin);
  }
  std::stable_sort(
      by_size.begin(), by_size.end(), [](const auto& a, const auto& b) {
        return a.first > b.first;
      });
  std::vector<OutlinePair> result;
  for (const auto& [size, bin] : by_size) {
    // An edge between two bins has half of its rows in each of up to four.
    if (4 * size < options.min_rows) {
      break;
    }
    if (!bins.contains(bin)) {
      continue;  // It has become part of another pair.
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
    if (around.size() >= options.min_rows) {
      OutlinePair pair = Join(std::move(around), options);
      if (pair.rows.size() >= options.min_rows) {
        result.push_back(std::move(pair));
      }
    }
  }
  return result;
}

}  // namespace tsar
