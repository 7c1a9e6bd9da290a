// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/creases/line_evidence.h"

#include "colmap_tsar/scene/creases/plane_lines.h"
#include "colmap_tsar/scene/evidence/view_evidence.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>

namespace tsar {
namespace {

// The largest residual of a depth on the plane, and the least distance of a
// depth behind the plane that begins at the line to count as seen through it,
// in relative depths of one pixel of disparity.
constexpr float kTolerance = 1.f;
constexpr float kMinThrough = 3.f;
// Pixels nearer to the line than this are no evidence.
constexpr float kMargin = 3.f;
// The least area for a view to count.
constexpr double kMinViewArea = 50.0;

// A measured depth on its ray.
struct Measurement {
  RayDepth sample;
  float position;  // Position of the ray on the axis.
  bool is_on_plane;
  double weight;
};

// Pixels of a plane.
struct Pixels {
  double area = 0.0;
  double measured = 0.0;  // Weight of what was measured on the plane.
};

// Cumulative sums of pixels at positions that are known beforehand.
class SumsByPosition {
 public:
  explicit SumsByPosition(std::vector<float> positions)
      : positions_(std::move(positions)), sums_(positions_.size() + 1) {
    std::ranges::sort(positions_);
  }

  void Add(float position, const Pixels& pixels) {
    Pixels& sum = sums_[std::ranges::lower_bound(positions_, position) -
                        positions_.begin()];
    sum.area += pixels.area;
    sum.measured += pixels.measured;
  }

  // The sum up to and including a position.
  Pixels UpTo(float position) const {
    const auto end = std::ranges::upper_bound(positions_, position);
    Pixels sum;
    for (auto i = positions_.begin(); i != end; ++i) {
      sum.area += sums_[i - positions_.begin()].area;
      sum.measured += sums_[i - positions_.begin()].measured;
    }
    return sum;
  }

 private:
  std::vector<float> positions_;
  std::vector<Pixels> sums_;
};

// Computes the evidence of one view for the lines of one plane along one axis.
class LineTest {
 public:
  // is_plane: by superpixel, whether it is labeled with the plane or with none.
  LineTest(const ObservedView& view,
           const std::vector<uint8_t>& is_plane,
           const std::vector<PlaneLine>& lines,
           const SceneModel& model)
      : evidence_(*view.evidence),
        camera_(view.camera),
        intrinsics_(view.camera.GetIntrinsics()),
        is_plane_(is_plane),
        lines_(lines),
        model_(model) {}

  // Sets the evidence for the lines from first to last, which are along one
  // axis. shown: by superpixel, whether it is labeled with the plane.
  void Run(size_t first,
           size_t last,
           const std::vector<uint8_t>& shown,
           const std::vector<Vec3f>& middles,
           std::vector<LineEvidence>* result) const {
    const PlaneLine& any = lines_[first];
    const PlaneAxis axis(
        model_.planes[any.plane], AxisOf(model_, any.plane, any.axis), camera_);
    const std::vector<Measurement> measurements = Measurements(axis);
    double on_plane = 0.0;
    for (const Measurement& measurement : measurements) {
      on_plane += measurement.is_on_plane ? measurement.weight : 0.0;
    }
    // All of it lies above the lines before these, and below those after them.
    const auto [begin, end] = LinesAround(axis, shown, middles, first, last);
    for (size_t i = first; i < begin; ++i) {
      (*result)[i].sides[1].measured = std::round(on_plane);
    }
    for (size_t i = end; i < last; ++i) {
      (*result)[i].sides[0].measured = std::round(on_plane);
    }
    if (begin == end) {
      return;
    }
    std::vector<float> cuts[2];
    for (size_t i = begin; i < end; ++i) {
      const PlaneLine& line = lines_[i];
      cuts[0].push_back(line.position - kMargin * line.pixel);
      // Measurements at the limit count as above it.
      cuts[1].push_back(
          std::nextafter(line.position + kMargin * line.pixel, -INFINITY));
    }
    SumsByPosition sums[] = {SumsByPosition(cuts[0]), SumsByPosition(cuts[1])};
    const double area = AddArea(axis, sums);
    for (const Measurement& measurement : measurements) {
      for (SumsByPosition& of_side : sums) {
        of_side.Add(
            measurement.position,
            {.measured = measurement.is_on_plane ? measurement.weight : 0.0});
      }
    }
    for (size_t i = begin; i < end; ++i) {
      LineEvidence& line = (*result)[i];
      const Pixels below = sums[0].UpTo(cuts[0][i - begin]);
      const Pixels up_to_above = sums[1].UpTo(cuts[1][i - begin]);
      line.sides[0].area = below.area;
      line.sides[1].area = area - up_to_above.area;
      line.sides[0].measured = std::round(below.measured);
      line.sides[1].measured = std::round(on_plane - up_to_above.measured);
      for (const int side : {0, 1}) {
        LookThrough(i, axis, measurements, side, &line);
      }
    }
  }

 private:
  // Adds the pixels labeled with the plane or with none to the sums of both
  // sides; returns their number.
  double AddArea(const PlaneAxis& axis, SumsByPosition (&sums)[2]) const {
    double area = 0.0;
    for (int y = 0; y < evidence_.height; ++y) {
      for (int x = 0; x < evidence_.width; ++x) {
        if (is_plane_[evidence_.superpixels(x, y)] == 0) {
          continue;
        }
        const float position = axis.Position(intrinsics_.Ray(x, y));
        if (!std::isnan(position)) {
          sums[0].Add(position, {.area = 1.0});
          sums[1].Add(position, {.area = 1.0});
          ++area;
        }
      }
    }
    return area;
  }

  std::vector<Measurement> Measurements(const PlaneAxis& axis) const {
    std::vector<Measurement> result;
    for (size_t s = 0; s < evidence_.weights.size(); ++s) {
      const int begin = evidence_.first_observation[s];
      const int end = evidence_.first_observation[s + 1];
      float confidence = 0.f;
      for (int i = begin; i < end; ++i) {
        confidence += evidence_.observations[i].confidence;
      }
      for (int i = begin; i < end; ++i) {
        const RayDepth& sample = evidence_.observations[i].sample;
        const Vec3f ray = {sample.x, sample.y, 1.f};
        const float position = axis.Position(ray);
        if (evidence_.sources[i] != ObservationSource::kMeasured ||
            std::isnan(position)) {
          continue;
        }
        const float max_gap = kTolerance * sample.z *
                              evidence_.resolution.RelativeDepthError(sample.z);
        result.push_back(
            {sample,
             position,
             std::abs(axis.InCamera().Depth(ray) - sample.z) < max_gap,
             evidence_.observations[i].confidence * evidence_.weights[s] /
                 confidence});
      }
    }
    return result;
  }

  // The lines within the visible part of the plane, extended by its length to
  // either side: views that do not show a line may look through the plane that
  // begins there.
  std::pair<size_t, size_t> LinesAround(const PlaneAxis& axis,
                                        const std::vector<uint8_t>& shown,
                                        const std::vector<Vec3f>& middles,
                                        size_t first,
                                        size_t last) const {
    float low = INFINITY;
    float high = -INFINITY;
    for (size_t s = 0; s < shown.size(); ++s) {
      const float position = shown[s] != 0 ? axis.Position(middles[s]) : NAN;
      if (!std::isnan(position)) {
        low = std::min(low, position);
        high = std::max(high, position);
      }
    }
    const float width = std::max(high - low, 0.f);
    const auto first_from = [&](float wanted) {
      const auto found = std::ranges::lower_bound(lines_.begin() + first,
                                                  lines_.begin() + last,
                                                  wanted,
                                                  {},
                                                  &PlaneLine::position);
      return static_cast<size_t>(found - lines_.begin());
    };
    const size_t begin = first_from(low - width);
    return {begin, std::max(begin, first_from(high + width))};
  }

  // Adds measurements behind the plane that begins at the line if the first one
  // ends at this side of it. Where the camera does not see that plane, the area
  // is no evidence.
  void LookThrough(size_t index,
                   const PlaneAxis& axis,
                   const std::vector<Measurement>& measurements,
                   int side,
                   LineEvidence* result) const {
    const PlaneLine& line = lines_[index];
    const WorldPlane limit = PlaneAtLine(model_, line, side);
    LineEvidence::Side& of_side = result->sides[side];
    if (limit.Height(camera_.Center()) <= 0.0) {
      of_side.area = 0.0;
      return;
    }
    of_side.num_views = of_side.area >= kMinViewArea;
    const Plane plane = ToCameraPlane(limit, camera_);
    const float margin = kMargin * line.pixel;
    for (const Measurement& measurement : measurements) {
      const float height = measurement.position - line.position;
      if ((side == 0 ? -height : height) < margin) {
        continue;
      }
      const RayDepth& sample = measurement.sample;
      const Vec3f ray = {sample.x, sample.y, 1.f};
      const float depth = plane.Depth(ray);
      const float unit = evidence_.resolution.RelativeDepthError(sample.z);
      // The other half of the orthogonal plane is behind the plane that ends.
      if (depth > 0.f && depth < axis.InCamera().Depth(ray) &&
          sample.z > depth * (1.f + kMinThrough * unit)) {
        of_side.through += measurement.weight;
      }
    }
    of_side.through = std::round(of_side.through);
  }

  const ViewEvidence& evidence_;
  const Camera& camera_;
  const Intrinsics intrinsics_;
  const std::vector<uint8_t>& is_plane_;
  const std::vector<PlaneLine>& lines_;
  const SceneModel& model_;
};

}  // namespace

std::vector<LineEvidence> TestPlaneLines(const ObservedView& view,
                                         const std::vector<int>& labels,
                                         const std::vector<PlaneLine>& lines,
                                         const SceneModel& model) {
  const std::vector<Vec3f> middles =
      MiddleRays(*view.evidence, view.camera.GetIntrinsics());
  std::vector<LineEvidence> result(lines.size());
  for (const int plane : std::set<int>(labels.begin(), labels.end())) {
    const auto on_plane =
        std::ranges::equal_range(lines, plane, {}, &PlaneLine::plane);
    if (plane < 0 || on_plane.empty()) {
      continue;
    }
    std::vector<uint8_t> shown;
    std::vector<uint8_t> is_plane;
    for (const int label : labels) {
      shown.push_back(label == plane);
      is_plane.push_back(shown.back() != 0 || label < 0);
    }
    const LineTest test(view, is_plane, lines, model);
    for (auto first = on_plane.begin(); first != on_plane.end();) {
      const auto last =
          std::find_if(first, on_plane.end(), [&](const PlaneLine& line) {
            return line.axis != first->axis;
          });
      test.Run(
          first - lines.begin(), last - lines.begin(), shown, middles, &result);
      first = last;
    }
  }
  return result;
}

void AddEvidence(const std::vector<LineEvidence>& of_view,
                 std::vector<LineEvidence>* sum) {
  for (size_t i = 0; i < of_view.size(); ++i) {
    for (const int side : {0, 1}) {
      const LineEvidence::Side& from = of_view[i].sides[side];
      LineEvidence::Side& to = (*sum)[i].sides[side];
      to.area += from.area;
      to.measured += from.measured;
      to.through += from.through;
      to.num_views += from.num_views;
    }
  }
}

}  // namespace tsar
