// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/creases/plane_lines.h"

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/median.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <iterator>
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
// Differences, with their noise, are clamped to this many gray levels: one lamp
// is no line.
constexpr float kMaxDifference = 15.f;
// The length of pieces of a line.
constexpr float kPieceLength = 32.f;
// In bins of one pixel. The level around a line is that of bins at these
// distances,
constexpr int kNearestAround = 5;
constexpr int kFarthestAround = 14;
// of which this many are required.
constexpr size_t kMinAround = 6;
// The profile is centered on the visible part of a plane, which is very long at
// a grazing angle.
constexpr int kMaxBins = 4096;

float Median(std::vector<float> values) { return UpperMedian(&values); }

// The rise of brightness at a pixel, and its positions on the axis and along
// the line.
struct Rise {
  float position;
  float along;
  float rise;  // In gray levels.
};

using Pieces = std::vector<LinePiece>;

// Adds a pixel to its piece. Neighbors come one after the other.
void AddToPiece(const Rise& rise, float piece_length, Pieces* pieces) {
  const float along =
      (std::floor(rise.along / piece_length) + 0.5f) * piece_length;
  const auto found = std::find_if(
      pieces->rbegin(), pieces->rend(), [along](const auto& piece) {
        return piece.along == along;
      });
  LinePiece& piece = found != pieces->rend() ? *found : pieces->emplace_back();
  piece.along = along;
  piece.rise += rise.rise;
  ++piece.num_pixels;
}

// The median of the means of the bins around one, if there are enough.
std::optional<float> LevelAround(const std::vector<std::optional<float>>& means,
                                 int bin) {
  std::vector<float> around;
  for (int gap = kNearestAround; gap <= kFarthestAround; ++gap) {
    for (const int other : {bin - gap, bin + gap}) {
      if (other >= 0 && other < std::ssize(means) && means[other]) {
        around.push_back(*means[other]);
      }
    }
  }
  return around.size() >= kMinAround ? std::optional(Median(std::move(around)))
                                     : std::nullopt;
}

// Fills the bins. min_length: the least number of pixels of one.
void AddBins(const std::vector<Rise>& rises,
             float min_length,
             PlaneProfile* profile) {
  std::vector<float> positions;
  for (const Rise& rise : rises) {
    positions.push_back(rise.position);
  }
  profile->first = std::max(std::ranges::min(positions),
                            Median(positions) - kMaxBins / 2 * profile->pixel);
  std::vector<Pieces> pieces;
  for (const Rise& rise : rises) {
    const float bin = (rise.position - profile->first) / profile->pixel;
    if (bin >= 0.f && bin < kMaxBins) {
      const auto i = static_cast<size_t>(bin);
      pieces.resize(std::max(pieces.size(), i + 1));
      AddToPiece(rise, profile->piece_length, &pieces[i]);
    }
  }
  std::vector<std::optional<float>> means(pieces.size());
  profile->bins.resize(pieces.size());
  for (size_t i = 0; i < pieces.size(); ++i) {
    PlaneProfile::Bin& bin = profile->bins[i];
    for (const LinePiece& piece : pieces[i]) {
      bin.step += piece.rise;
      bin.num_pixels += piece.num_pixels;
    }
    if (bin.num_pixels >= min_length) {
      means[i] = bin.step / bin.num_pixels;
    }
  }
  for (size_t i = 0; i < pieces.size(); ++i) {
    PlaneProfile::Bin& bin = profile->bins[i];
    const std::optional<float> level = LevelAround(means, static_cast<int>(i));
    if (!means[i] || !level) {
      bin = {};
      continue;
    }
    bin.step = *means[i] - *level;
    if (std::abs(bin.step) >= 0.5f * kMinLineStep) {
      for (LinePiece& piece : pieces[i]) {
        piece.rise -= *level * piece.num_pixels;
      }
      bin.pieces.assign(pieces[i].begin(), pieces[i].end());
    }
  }
}

class ProfileMaker {
 public:
  ProfileMaker(const ObservedView& view,
               const std::vector<int>& labels,
               const SceneModel& model)
      : camera_(view.camera),
        intrinsics_(view.camera.GetIntrinsics()),
        model_(model),
        gray_(view.evidence->gray),
        planes_(view.evidence->width, view.evidence->height) {
    std::ranges::transform(view.evidence->superpixels,
                           planes_.begin(),
                           [&](uint16_t s) { return labels[s]; });
  }

  std::vector<PlaneProfile> Run() {
    std::map<int, int> areas;
    for (const int plane : planes_) {
      ++areas[plane];
    }
    const float min_area = kMinArea * planes_.NumPixels();
    std::vector<PlaneProfile> profiles;
    for (const auto& [index, area] : areas) {
      if (index < 0 || area < min_area || model_.planes[index].axis < 0) {
        continue;
      }
      for (int axis = 0; axis < 3; ++axis) {
        if (axis != model_.planes[index].axis) {
          MakeAcross(index, axis, &profiles);
        }
      }
    }
    return profiles;
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

  void MakeAcross(int index,
                  int axis,
                  std::vector<PlaneProfile>* profiles) const {
    const ModelPlane& plane = model_.planes[index];
    const PlaneAxis across(plane, AxisOf(model_, index, axis), camera_);
    const PlaneAxis along(
        plane, AxisOf(model_, index, 3 - axis - plane.axis), camera_);
    std::vector<Rise> rises;
    std::vector<float> pixels;
    std::vector<float> pixels_along;
    // The margin is the reach, plus a pixel for interpolation.
    const int margin = static_cast<int>(std::ceil(kReach)) + 1;
    for (int y = margin; y < planes_.Height() - margin; ++y) {
      for (int x = margin; x < planes_.Width() - margin; ++x) {
        if (planes_(x, y) != index && planes_(x, y) >= 0) {
          continue;
        }
        const float pixel = AddRise(index, across, along, x, y, &rises);
        if (pixel > 0.f && planes_(x, y) == index) {
          pixels.push_back(pixel);
          pixels_along.push_back(Slope(along, x, y).norm());
        }
      }
    }
    if (pixels.empty()) {
      return;
    }
    const float pixel_along = Median(std::move(pixels_along));
    if (!(pixel_along > 0.f && std::isfinite(pixel_along))) {
      return;
    }
    PlaneProfile& profile = profiles->emplace_back();
    profile.plane = index;
    profile.axis = axis;
    profile.pixel = Median(std::move(pixels));
    profile.piece_length = kPieceLength * pixel_along;
    AddBins(rises, kMinLength * planes_.Width(), &profile);
  }

  // The change of the position from pixel to pixel.
  Eigen::Vector2f Slope(const PlaneAxis& axis, int x, int y) const {
    const float position = axis.Position(intrinsics_.Ray(x, y));
    return {axis.Position(intrinsics_.Ray(x + 1.f, y)) - position,
            axis.Position(intrinsics_.Ray(x, y + 1.f)) - position};
  }

  // Returns the pixel's size across the line; 0 if it cannot be part of one.
  float AddRise(int plane,
                const PlaneAxis& across,
                const PlaneAxis& along,
                int x,
                int y,
                std::vector<Rise>* rises) const {
    const Eigen::Vector2f slope = Slope(across, x, y);
    const float pixel = slope.norm();
    if (!(pixel > 0.f && std::isfinite(pixel))) {
      return 0.f;
    }
    const Eigen::Vector2f reach = kReach * (slope / pixel);
    const Eigen::Vector2f far = kMaxDistance * (slope / pixel);
    if (!IsFree(plane, x + reach.x(), y + reach.y()) ||
        !IsFree(plane, x - reach.x(), y - reach.y()) ||
        (!IsOn(plane, x + far.x(), y + far.y()) &&
         !IsOn(plane, x - far.x(), y - far.y()))) {
      return 0.f;
    }
    const float rise =
        Gray(x + reach.x(), y + reach.y()) - Gray(x - reach.x(), y - reach.y());
    const Vec3f ray = intrinsics_.Ray(x, y);
    rises->push_back({across.Position(ray),
                      along.Position(ray),
                      std::clamp(rise, -kMaxDifference, kMaxDifference)});
    return pixel;
  }

  const Camera& camera_;
  const Intrinsics intrinsics_;
  const SceneModel& model_;
  const Image<uint8_t>& gray_;
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

std::vector<PlaneProfile> MakePlaneProfiles(const ObservedView& view,
                                            const std::vector<int>& labels,
                                            const SceneModel& model) {
  return ProfileMaker(view, labels, model).Run();
}

}  // namespace tsar
