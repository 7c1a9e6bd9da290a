// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/creases/shared_lines.h"

#include "colmap_tsar/base/median.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <map>
#include <utility>
#include <vector>

namespace tsar {
namespace {

// The least number of views that must see a line.
constexpr int kMinViews = 3;
// The least ratio of a step to its standard error by the scatter of what each
// view shows of each piece of the line: it is no noise.
constexpr float kMinSignificance = 5.f;
// The same by the scatter of the pieces, in the mean of the views: it is the
// same all along the line. A poster's edge is only a part of such a line.
constexpr float kMinConsistency = 4.f;
// Of several lines closer to each other than this, in bins, only the strongest
// counts.
constexpr int kMinGap = 4;
// A step blurs over this many bins to either side; its place is their mean.
constexpr int kReach = 2;
// Profiles whose bins are this many times wider than those of most views are
// left out, since they do not show where a line is,
constexpr float kMaxWidth = 4.f;
// and those that begin this many pixels from the plane's center, where a float
// does not tell one pixel from the next.
constexpr float kMaxPosition = 1e6f;

// The bins of several views at one position.
using Bins = std::vector<const PlaneProfile::Bin*>;

float MeanStep(const Bins& bins) {
  float sum = 0.f;
  float num_pixels = 0.f;
  for (const PlaneProfile::Bin* bin : bins) {
    sum += bin->num_pixels * bin->step;
    num_pixels += bin->num_pixels;
  }
  return sum / num_pixels;
}

// The bins of the views that see the line.
Bins Showing(const Bins& bins, float step) {
  Bins showing;
  std::ranges::copy_if(
      bins, std::back_inserter(showing), [&](const PlaneProfile::Bin* bin) {
        return bin->step / step > 0.5f;
      });
  return showing;
}

// Sums of rises, and the ratio of their mean to its standard error.
class RiseSums {
 public:
  explicit RiseSums(float mean) : mean_(mean) {}

  void Add(float rise, float num_pixels) {
    const float residual = rise - num_pixels * mean_;
    squares_ += residual * residual;
    num_pixels_ += num_pixels;
    ++count_;
  }

  float Ratio() const {
    return count_ < 2.f ? 0.f
                        : std::abs(mean_) * num_pixels_ /
                              std::sqrt(squares_ * count_ / (count_ - 1.f));
  }

 private:
  float mean_;
  float squares_ = 0.f;
  float num_pixels_ = 0.f;
  float count_ = 0.f;
};

// Whether the step is no noise, and the same all along the line, in the views
// that see it. length: of a piece.
bool IsLine(const Bins& bins, float length) {
  const float step = MeanStep(bins);
  RiseSums by_view(step);
  std::map<float, LinePiece> pieces;
  for (const PlaneProfile::Bin* bin : bins) {
    for (const LinePiece& piece : bin->pieces) {
      by_view.Add(piece.rise, piece.num_pixels);
      LinePiece& sum = pieces[std::floor(piece.along / length)];
      sum.rise += piece.rise;
      sum.num_pixels += piece.num_pixels;
    }
  }
  RiseSums by_piece(step);
  for (const auto& [index, sum] : pieces) {
    by_piece.Add(sum.rise, sum.num_pixels);
  }
  return by_view.Ratio() >= kMinSignificance &&
         by_piece.Ratio() >= kMinConsistency;
}

// The bins of all profiles by position, as a number of pixels.
std::map<int, Bins> CollectBins(
    const std::vector<const PlaneProfile*>& profiles, float pixel) {
  std::map<int, Bins> bins;
  for (const PlaneProfile* profile : profiles) {
    const float width = profile->pixel / pixel;  // In pixels.
    const float first = profile->first / pixel;
    if (width > kMaxWidth || !(std::abs(first) < kMaxPosition)) {
      continue;
    }
    const auto end = first + width * static_cast<float>(profile->bins.size());
    for (auto i = static_cast<int>(std::ceil(first - 0.5f)); i + 0.5f < end;
         ++i) {
      const auto bin = static_cast<size_t>((i + 0.5f - first) / width);
      if (bin < profile->bins.size() && profile->bins[bin].num_pixels > 0.f) {
        bins[i].push_back(&profile->bins[bin]);
      }
    }
  }
  return bins;
}

bool IsPeak(const std::map<int, float>& steps, int bin) {
  const float step = std::abs(steps.at(bin));
  return std::all_of(steps.lower_bound(bin - kMinGap),
                     steps.upper_bound(bin + kMinGap),
                     [&](const std::pair<int, float>& other) {
                       const float rival = std::abs(other.second);
                       return rival < step ||
                              (rival == step && other.first >= bin);
                     });
}

// The mean position of a step, as a number of pixels.
float Middle(const std::map<int, float>& steps, int bin) {
  float weights = 0.f;
  float offset = 0.f;
  const auto end = steps.upper_bound(bin + kReach);
  for (auto other = steps.lower_bound(bin - kReach); other != end; ++other) {
    const float weight = std::max(other->second / steps.at(bin), 0.f);
    weights += weight;
    offset += weight * (other->first - bin);
  }
  return bin + 0.5f + offset / weights;
}

// The lines on one plane along one axis.
std::vector<PlaneLine> FindLines(
    const std::vector<const PlaneProfile*>& profiles) {
  std::vector<float> pixels;
  std::vector<float> piece_lengths;
  for (const PlaneProfile* profile : profiles) {
    pixels.push_back(profile->pixel);
    piece_lengths.push_back(profile->piece_length);
  }
  const float pixel = UpperMedian(&pixels);
  const float piece_length = UpperMedian(&piece_lengths);
  const std::map<int, Bins> bins = CollectBins(profiles, pixel);
  std::map<int, float> steps;
  for (const auto& [bin, of_views] : bins) {
    if (of_views.size() >= kMinViews) {
      steps[bin] = MeanStep(of_views);
    }
  }
  std::vector<PlaneLine> lines;
  for (const auto& [bin, step] : steps) {
    if (std::abs(step) < kMinLineStep || !IsPeak(steps, bin)) {
      continue;
    }
    const Bins showing = Showing(bins.at(bin), step);
    if (showing.size() >= kMinViews && IsLine(showing, piece_length)) {
      lines.push_back({profiles[0]->plane,
                       profiles[0]->axis,
                       Middle(steps, bin) * pixel,
                       pixel,
                       MeanStep(showing),
                       static_cast<int>(showing.size())});
    }
  }
  return lines;
}

}  // namespace

std::vector<PlaneLine> FindSharedLines(
    const std::vector<std::vector<PlaneProfile>>& of_views) {
  std::map<std::pair<int, int>, std::vector<const PlaneProfile*>> groups;
  for (const std::vector<PlaneProfile>& profiles : of_views) {
    for (const PlaneProfile& profile : profiles) {
      groups[{profile.plane, profile.axis}].push_back(&profile);
    }
  }
  std::vector<PlaneLine> lines;
  for (const auto& [key, profiles] : groups) {
    std::ranges::copy(FindLines(profiles), std::back_inserter(lines));
  }
  return lines;
}

}  // namespace tsar
