// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/creases/shared_lines.h"

#include "colmap_tsar/base/median.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <tuple>

namespace tsar {
namespace {

// The least number of views that must see a line at the same position,
constexpr int kMinViews = 3;
// and its largest distance from the middle of theirs, in pixels of the
// raster.
constexpr float kMaxGap = 1.5f;

struct LineInView {
  PlaneLine line;
  size_t view;
};

// A range of lines in the order of their positions.
struct Window {
  size_t begin;
  size_t end;
  int num_views;
};

// The widest windows that begin at each line.
std::vector<Window> FindWindows(const std::vector<LineInView>& lines) {
  std::vector<Window> windows;
  std::map<size_t, int> views;
  size_t end = 0;
  for (size_t begin = 0; begin < lines.size(); ++begin) {
    // One gap to either side of the middle.
    const float last =
        lines[begin].line.position + 2.f * kMaxGap * lines[begin].line.pixel;
    for (; end < lines.size() && lines[end].line.position <= last; ++end) {
      ++views[lines[end].view];
    }
    windows.push_back({begin, end, static_cast<int>(views.size())});
    const auto own = views.find(lines[begin].view);
    if (--own->second == 0) {
      views.erase(own);
    }
  }
  return windows;
}

PlaneLine Average(const std::vector<LineInView>& lines, const Window& window) {
  PlaneLine shared = lines[window.begin].line;
  shared.num_views = window.num_views;
  std::vector<float> pixels;
  double positions = 0.0;
  double weights = 0.0;
  double steps = 0.0;
  for (size_t i = window.begin; i < window.end; ++i) {
    const PlaneLine& line = lines[i].line;
    const double weight = 1.0 / (double{line.pixel} * line.pixel);
    positions += weight * line.position;
    weights += weight;
    steps += line.step;
    pixels.push_back(line.pixel);
  }
  shared.position = static_cast<float>(positions / weights);
  shared.pixel = UpperMedian(&pixels);
  shared.step = static_cast<float>(steps / (window.end - window.begin));
  return shared;
}

}  // namespace

std::vector<PlaneLine> JoinPlaneLines(
    const std::vector<std::vector<PlaneLine>>& lines) {
  // Lines by plane, axis, and sign of the step.
  std::map<std::tuple<int, int, bool>, std::vector<LineInView>> groups;
  for (size_t view = 0; view < lines.size(); ++view) {
    for (const PlaneLine& line : lines[view]) {
      groups[{line.plane, line.axis, line.step > 0.f}].push_back({line, view});
    }
  }
  std::vector<PlaneLine> shared;
  for (auto& [key, of_group] : groups) {
    std::ranges::stable_sort(of_group, {}, [](const LineInView& in_view) {
      return in_view.line.position;
    });
    std::vector<Window> windows = FindWindows(of_group);
    std::ranges::stable_sort(windows, std::greater{}, &Window::num_views);
    std::vector<uint8_t> is_taken(of_group.size(), 0);
    for (const Window& window : windows) {
      const auto begin = is_taken.begin() + window.begin;
      const auto end = is_taken.begin() + window.end;
      if (window.num_views >= kMinViews && std::find(begin, end, 1) == end) {
        std::fill(begin, end, uint8_t{1});
        shared.push_back(Average(of_group, window));
      }
    }
  }
  std::ranges::stable_sort(shared, {}, [](const PlaneLine& line) {
    return std::tie(line.plane, line.axis, line.position);
  });
  return shared;
}

}  // namespace tsar
