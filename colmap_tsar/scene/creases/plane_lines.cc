// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/creases/plane_lines.h"

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/median.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

namespace tsar {
namespace {

// Lengths are in pixels of the raster.
// Only planes that cover this share of the raster,
constexpr float kMinArea = 0.02f;
// and lines that are at least this long, as a share of the raster's width.
constexpr float kMinLength = 0.1f;
// Brightness is compared this far on either side of a pixel.
constexpr float kReach = 1.5f;
// A line lies on the plane if a pixel labeled with it is within this distance
// on either side.
constexpr float kMaxDistance = 6.f;
// In gray levels. Walls darken toward their creases by one level in ten pixels,
// and noise is below one along a line of sixty.
constexpr float kMinStep = 1.f;
// Differences are clamped to this many gray levels: one lamp is no line.
constexpr float kMaxDifference = 15.f;
// The share of the line's pixels at which brightness must rise by half of its
// step or more. A poster's edge covers a small share of such a line.
constexpr float kMinShare = 0.5f;
// In bins of one pixel. The level around a line is that of bins at these
// distances,
constexpr int kNearestAround = 5;
constexpr int kFarthestAround = 14;
// of which this many are required; of several lines closer to each other than
// kMinGap only the strongest counts.
constexpr size_t kMinAround = 6;
constexpr int kMinGap = 4;
// The profile is centered on the visible part of a plane, which is very long at
// a grazing angle.
constexpr int kMaxBins = 4096;

float Median(std::vector<float> values) { return UpperMedian(&values); }

Image<float> GrayLevels(const Image<Rgb>& color) {
  Image<float> gray(color.Width(), color.Height());
  std::transform(color.begin(), color.end(), gray.begin(), GrayLevel);
  return gray;
}

// The slope of brightness along an axis, by position.
class LineProfile {
 public:
  struct Sample {
    float position;
    float rise;  // In gray levels.
  };

  // pixel: the size of a bin.
  LineProfile(const std::vector<Sample>& samples, float pixel, int min_length)
      : pixel_(pixel) {
    std::vector<float> positions;
    for (const Sample& sample : samples) {
      positions.push_back(sample.position);
    }
    first_ = std::max(std::ranges::min(positions),
                      Median(positions) - kMaxBins / 2 * pixel);
    for (const Sample& sample : samples) {
      const float bin = (sample.position - first_) / pixel;
      if (bin >= 0.f && bin < kMaxBins) {
        const auto i = static_cast<size_t>(bin);
        bins_.resize(std::max(bins_.size(), i + 1));
        bins_[i].push_back(sample.rise);
      }
    }
    for (const std::vector<float>& bin : bins_) {
      std::optional<float>& mean = means_.emplace_back();
      if (static_cast<int>(bin.size()) >= min_length) {
        mean = std::accumulate(bin.begin(), bin.end(), 0.f) / bin.size();
      }
    }
    for (int bin = 0; bin < NumBins(); ++bin) {
      steps_.push_back(Mean(bin) ? *Mean(bin) - LevelAround(bin) : 0.f);
    }
  }

  int NumBins() const { return static_cast<int>(bins_.size()); }
  float Step(int bin) const { return steps_[bin]; }
  float Position(int bin) const { return first_ + (bin + 0.5f) * pixel_; }

  bool IsPeak(int bin) const {
    const float step = std::abs(Step(bin));
    for (int other = std::max(bin - kMinGap, 0);
         other <= std::min(bin + kMinGap, NumBins() - 1);
         ++other) {
      const float rival = std::abs(Step(other));
      if (rival > step || (rival == step && other < bin)) {
        return false;
      }
    }
    return true;
  }

  // The share of the pixels at which brightness rises by half of the step or
  // more.
  float Share(int bin) const {
    const std::vector<float>& rises = bins_[bin];
    const float step = Step(bin);
    const float level = *Mean(bin) - step;
    const auto num_rises = std::ranges::count_if(
        rises, [&](float rise) { return (rise - level) / step > 0.5f; });
    return static_cast<float>(num_rises) / rises.size();
  }

 private:
  const std::optional<float>& Mean(int bin) const { return means_[bin]; }

  // The level of the bin itself where there are too few bins around it.
  float LevelAround(int bin) const {
    std::vector<float> around;
    for (int gap = kNearestAround; gap <= kFarthestAround; ++gap) {
      for (const int other : {bin - gap, bin + gap}) {
        if (other >= 0 && other < NumBins() && Mean(other)) {
          around.push_back(*Mean(other));
        }
      }
    }
    return around.size() >= kMinAround ? Median(std::move(around)) : *Mean(bin);
  }

  float pixel_;
  float first_ = 0.f;
  std::vector<std::vector<float>> bins_;
  std::vector<std::optional<float>> means_;
  std::vector<float> steps_;
};

class LineFinder {
 public:
  LineFinder(const ObservedView& view,
             const std::vector<int>& labels,
             const SceneModel& model)
      : camera_(view.camera),
        intrinsics_(view.camera.GetIntrinsics()),
        model_(model),
        gray_(GrayLevels(view.evidence->color)),
        planes_(view.evidence->width, view.evidence->height) {
    std::ranges::transform(view.evidence->superpixels,
                           planes_.begin(),
                           [&](uint16_t s) { return labels[s]; });
  }

  std::vector<PlaneLine> Run() {
    std::map<int, int> areas;
    for (const int plane : planes_) {
      ++areas[plane];
    }
    const float min_area = kMinArea * planes_.NumPixels();
    std::vector<PlaneLine> lines;
    for (const auto& [index, area] : areas) {
      if (index < 0 || area < min_area) {
        continue;
      }
      const ModelPlane& plane = model_.planes[index];
      for (int axis = 0; axis < 3 && plane.axis >= 0; ++axis) {
        if (axis != plane.axis) {
          FindAcross(index, axis, &lines);
        }
      }
    }
    return lines;
  }

 private:
  // Whether none of the pixels that Gray() reads there shows another plane: the
  // outline of an occluder is a line as well.
  bool IsFree(int plane, float x, float y) const {
    const auto column = static_cast<int>(x);
    const auto row = static_cast<int>(y);
    for (const int label : {planes_(column, row),
                            planes_(column + 1, row),
                            planes_(column, row + 1),
                            planes_(column + 1, row + 1)}) {
      if (label != plane && label >= 0) {
        return false;
      }
    }
    return true;
  }

  bool IsOn(int plane, float x, float y) const {
    const auto column = static_cast<int>(std::lround(x));
    const auto row = static_cast<int>(std::lround(y));
    return column >= 0 && row >= 0 && column < planes_.Width() &&
           row < planes_.Height() && planes_(column, row) == plane;
  }

  float Gray(float x, float y) const {
    const auto column = static_cast<int>(x);
    const auto row = static_cast<int>(y);
    const float right = x - column;
    const float below = y - row;
    return (gray_(column, row) * (1.f - right) +
            gray_(column + 1, row) * right) *
               (1.f - below) +
           (gray_(column, row + 1) * (1.f - right) +
            gray_(column + 1, row + 1) * right) *
               below;
  }

  void FindAcross(int index, int axis, std::vector<PlaneLine>* lines) const {
    const ModelPlane& plane = model_.planes[index];
    const PlaneAxis in_view(plane, AxisOf(model_, index, axis), camera_);
    std::vector<LineProfile::Sample> samples;
    std::vector<float> pixels;
    // The margin is the reach, plus a pixel for interpolation.
    const int margin = static_cast<int>(std::ceil(kReach)) + 1;
    for (int y = margin; y < planes_.Height() - margin; ++y) {
      for (int x = margin; x < planes_.Width() - margin; ++x) {
        if (planes_(x, y) == index || planes_(x, y) < 0) {
          AddSample(index, in_view, x, y, &samples, &pixels);
        }
      }
    }
    if (pixels.empty()) {
      return;
    }
    const float pixel = Median(std::move(pixels));
    const auto min_length = static_cast<int>(kMinLength * planes_.Width());
    const LineProfile profile(samples, pixel, std::max(min_length, 1));
    for (int bin = 0; bin < profile.NumBins(); ++bin) {
      const float step = profile.Step(bin);
      if (std::abs(step) >= kMinStep && profile.IsPeak(bin) &&
          profile.Share(bin) >= kMinShare) {
        lines->push_back({index, axis, profile.Position(bin), pixel, step});
      }
    }
  }

  void AddSample(int plane,
                 const PlaneAxis& in_view,
                 int x,
                 int y,
                 std::vector<LineProfile::Sample>* samples,
                 std::vector<float>* pixels) const {
    const float position = in_view.Position(intrinsics_.Ray(x, y));
    float across_x = in_view.Position(intrinsics_.Ray(x + 1.f, y)) - position;
    float across_y = in_view.Position(intrinsics_.Ray(x, y + 1.f)) - position;
    const float pixel = std::hypot(across_x, across_y);
    if (!(pixel > 0.f)) {
      return;
    }
    across_x /= pixel;
    across_y /= pixel;
    const float reach_x = kReach * across_x;
    const float reach_y = kReach * across_y;
    const float far_x = kMaxDistance * across_x;
    const float far_y = kMaxDistance * across_y;
    if (!IsFree(plane, x + reach_x, y + reach_y) ||
        !IsFree(plane, x - reach_x, y - reach_y) ||
        (!IsOn(plane, x + far_x, y + far_y) &&
         !IsOn(plane, x - far_x, y - far_y))) {
      return;
    }
    const float rise =
        Gray(x + reach_x, y + reach_y) - Gray(x - reach_x, y - reach_y);
    samples->push_back(
        {position, std::clamp(rise, -kMaxDifference, kMaxDifference)});
    if (planes_(x, y) == plane) {
      pixels->push_back(pixel);
    }
  }

  const Camera& camera_;
  const Intrinsics intrinsics_;
  const SceneModel& model_;
  const Image<float> gray_;
  // For each pixel of the raster the original of its plane's copies, or -1.
  Image<int> planes_;
};

}  // namespace

WorldPlane PlaneAtLine(const SceneModel& model,
                       const PlaneLine& line,
                       int side) {
  const Eigen::Vector3d axis = AxisOf(model, line.plane, line.axis);
  WorldPlane plane;
  plane.normal = side == 0 ? axis : Eigen::Vector3d(-axis);
  plane.offset = -plane.normal.dot(PointOn(line, model));
  return plane;
}

std::vector<int> FindPlaneCopies(
    const SceneModel& model,
    const std::vector<Camera>& cameras,
    const std::vector<const std::vector<int>*>& labels) {
  const std::vector<ModelPlane>& planes = model.planes;
  std::vector<std::vector<float>> distances(planes.size());
  for (size_t view = 0; view < cameras.size(); ++view) {
    for (const int plane :
         std::set<int>(labels[view]->begin(), labels[view]->end())) {
      if (plane >= 0) {
        distances[plane].push_back(static_cast<float>(
            std::abs(planes[plane].plane.Height(cameras[view].Center()))));
      }
    }
  }
  std::vector<int> copies(planes.size());
  std::iota(copies.begin(), copies.end(), 0);
  std::vector<int> by_support = copies;
  std::ranges::stable_sort(by_support, std::greater{}, [&](int plane) {
    return planes[plane].support;
  });
  // Planes that are not copies by component, axis and sign of the normal, then
  // by offset.
  std::map<std::tuple<int, int, bool>, std::multimap<double, int>> originals;
  for (const int index : by_support) {
    const ModelPlane& plane = planes[index];
    if (plane.axis < 0 || distances[index].empty()) {
      continue;
    }
    const Eigen::Vector3d& normal = plane.plane.normal;
    const bool is_along = normal.dot(AxisOf(model, index, plane.axis)) > 0.0;
    std::multimap<double, int>& of_axis =
        originals[{plane.component, 3 * plane.frame + plane.axis, is_along}];
    const double max_gap = kCopyTolerance * Median(distances[index]);
    const auto nearest = of_axis.lower_bound(plane.plane.offset - max_gap);
    if (nearest != of_axis.end() &&
        nearest->first <= plane.plane.offset + max_gap) {
      copies[index] = nearest->second;
    } else {
      of_axis.emplace(plane.plane.offset, index);
    }
  }
  return copies;
}

std::vector<PlaneLine> FindPlaneLines(const ObservedView& view,
                                      const std::vector<int>& labels,
                                      const SceneModel& model) {
  return LineFinder(view, labels, model).Run();
}

}  // namespace tsar
