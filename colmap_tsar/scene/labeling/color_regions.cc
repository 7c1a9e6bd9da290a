// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/labeling/color_regions.h"

#include "colmap_tsar/base/vector.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <numeric>
#include <queue>
#include <tuple>

namespace tsar {
namespace {

// The distance of the compared colors from the border on each side, where they
// do not mix.
constexpr int kReach = 2;
// In gray levels.
constexpr float kMaxSteps[] = {2.f, 4.f, 8.f};

// The border of two regions: their color difference, summed over the pairs of
// pixels across it.
struct Border {
  Vec3f step;
  int count = 0;

  float MeanStep() const {
    return Norm(step) / static_cast<float>(std::max(count, 1));
  }
};

// Borders by the neighbor's index. The step is the region's color less the
// neighbor's.
using Borders = std::map<int, Border>;

Vec3f ColorOf(const Rgb& color) {
  return {static_cast<float>(color.r),
          static_cast<float>(color.g),
          static_cast<float>(color.b)};
}

std::vector<Borders> MeasureBorders(const ViewEvidence& evidence) {
  const Image<uint16_t>& superpixels = evidence.superpixels;
  const Image<Rgb>& color = evidence.color;
  std::vector<Borders> borders(evidence.NumSuperpixels());
  const auto compare = [&](int x, int y, int dx, int dy) {
    const int first = superpixels(x, y);
    const int second = superpixels(x + dx, y + dy);
    const int ax = x - (kReach - 1) * dx;
    const int ay = y - (kReach - 1) * dy;
    const int bx = x + kReach * dx;
    const int by = y + kReach * dy;
    if (first == second || !color.Contains(ax, ay) || !color.Contains(bx, by)) {
      return;
    }
    const Vec3f step = ColorOf(color(ax, ay)) - ColorOf(color(bx, by));
    Border& there = borders[first][second];
    there.step = there.step + step;
    ++there.count;
    Border& back = borders[second][first];
    back.step = back.step - step;
    ++back.count;
  };
  for (int y = 0; y + 1 < superpixels.Height(); ++y) {
    for (int x = 0; x + 1 < superpixels.Width(); ++x) {
      compare(x, y, 1, 0);
      compare(x, y, 0, 1);
    }
  }
  return borders;
}

// Transfers all borders of `gone` to `kept`.
void Merge(int kept, int gone, std::vector<Borders>* borders) {
  Borders& of_kept = (*borders)[kept];
  for (const auto& [other, border] : (*borders)[gone]) {
    Borders& of_other = (*borders)[other];
    of_other.erase(gone);
    if (other == kept) {
      continue;
    }
    Border& joined = of_kept[other];
    joined.step = joined.step + border.step;
    joined.count += border.count;
    of_other[kept] = {joined.step * -1.f, joined.count};
  }
  (*borders)[gone].clear();
}

// Indexes the regions in the order of their first superpixels.
ColorRegions IndexRegions(const std::vector<int>& merged_into) {
  ColorRegions regions;
  for (size_t s = 0; s < merged_into.size(); ++s) {
    // Regions merge into those of lower indices, which are already set.
    const auto into = static_cast<size_t>(merged_into[s]);
    regions.of_superpixel.push_back(into == s ? regions.count++
                                              : regions.of_superpixel[into]);
  }
  return regions;
}

}  // namespace

std::vector<ColorRegions> FindColorRegions(const ObservedView& view) {
  std::vector<Borders> borders = MeasureBorders(*view.evidence);
  for (size_t s = 0; s < view.sides.size(); ++s) {
    std::erase_if(borders[s], [&](const auto& border) {
      return view.sides[border.first] != view.sides[s];
    });
  }
  std::vector<int> merged_into(borders.size());
  std::iota(merged_into.begin(), merged_into.end(), 0);
  // A mean step, as it was when it was pushed, and the two regions.
  using Candidate = std::tuple<float, int, int>;
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> queue;
  const auto push = [&](int a, int b, const Border& border) {
    queue.emplace(border.MeanStep(), std::min(a, b), std::max(a, b));
  };
  for (size_t s = 0; s < borders.size(); ++s) {
    for (const auto& [other, border] : borders[s]) {
      if (static_cast<int>(s) < other) {
        push(static_cast<int>(s), other, border);
      }
    }
  }
  std::vector<ColorRegions> levels;
  for (const float max_step : kMaxSteps) {
    while (!queue.empty() && std::get<0>(queue.top()) <= max_step) {
      const auto [step, kept, gone] = queue.top();
      queue.pop();
      const Borders& of_kept = borders[kept];
      const auto border = of_kept.find(gone);
      if (border == of_kept.end() || border->second.MeanStep() != step) {
        continue;  // One of the two has grown since.
      }
      Merge(kept, gone, &borders);
      merged_into[gone] = kept;
      for (const auto& [other, joined] : of_kept) {
        push(kept, other, joined);
      }
    }
    levels.push_back(IndexRegions(merged_into));
  }
  return levels;
}

}  // namespace tsar
