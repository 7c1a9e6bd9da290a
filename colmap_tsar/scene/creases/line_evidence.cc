// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/creases/line_evidence.h"

#include "colmap_tsar/scene/creases/plane_lines.h"
#include "colmap_tsar/scene/evidence/view_evidence.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
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

// Cumulative sums of weights at positions that are known beforehand.
class SumsByPosition {
 public:
  explicit SumsByPosition(std::vector<float> positions)
      : positions_(std::move(positions)), sums_(positions_.size() + 1, 0.0) {
    std::ranges::sort(positions_);
  }

  void Add(float position, double weight) {
    sums_[std::ranges::lower_bound(positions_, position) -
          positions_.begin()] += weight;
  }

  // The sum of weights up to and including a position.
  double UpTo(float position) const {
    const auto end = std::ranges::upper_bound(positions_, position);
    return std::accumulate(
        sums_.begin(), sums_.begin() + (end - positions_.begin()), 0.0);
  }

 private:
  std::vector<float> positions_;
  std::vector<double> sums_;
};

// The pixels of one side of lines: up to each cut, or beyond it.
struct SideSums {
  explicit SideSums(std::vector<float> positions)
      : cuts(std::move(positions)), area(cuts), measured(cuts) {}

  std::vector<float> cuts;  // By line.
  SumsByPosition area;
  SumsByPosition measured;  // Measured on the plane.
};

// Computes the evidence of one view for the lines of one plane along one axis.
class LineTest {
 public:
  // is_plane: by superpixel, whether it is labeled with the plane or with none.
  LineTest(const ObservedView& view,
           const std::vector<uint8_t>& is_plane,
           const std::vector<SharedLine>& lines,
           const SceneModel& model)
      : evidence_(*view.evidence),
        camera_(view.camera),
        intrinsics_(view.camera.GetIntrinsics()),
        is_plane_(is_plane),
        lines_(lines),
        model_(model) {}

  // shown: by superpixel, whether it is labeled with the plane.
  ViewLineEvidence Run(size_t first,
                       size_t last,
                       const std::vector<uint8_t>& shown,
                       const std::vector<Vec3f>& middles) const {
    const PlaneLine& any = lines_[first].line;
    const PlaneAxis axis(
        model_.planes[any.plane], AxisOf(model_, any.plane, any.axis), camera_);
    ViewLineEvidence result;
    result.first = first;
    result.last = last;
    const std::vector<Measurement> measurements = Measurements(axis);
    double on_plane = 0.0;
    for (const Measurement& measurement : measurements) {
      on_plane += measurement.is_on_plane ? measurement.weight : 0.0;
    }
    result.measured = std::round(on_plane);
    const auto [begin, end] = LinesAround(axis, shown, middles, first, last);
    result.begin = begin;
    if (begin == end) {
      return result;
    }
    std::vector<float> cuts[2];
    for (size_t i = begin; i < end; ++i) {
      const PlaneLine& line = lines_[i].line;
      cuts[0].push_back(line.position - kMargin * line.pixel);
      // Measurements at the limit count as above it.
      cuts[1].push_back(
          std::nextafter(line.position + kMargin * line.pixel, -INFINITY));
    }
    SideSums below(cuts[0]);
    SideSums above(cuts[1]);
    const double area = AddArea(axis, &below.area, &above.area);
    for (const Measurement& measurement : measurements) {
      if (measurement.is_on_plane) {
        below.measured.Add(measurement.position, measurement.weight);
        above.measured.Add(measurement.position, measurement.weight);
      }
    }
    for (size_t i = begin; i < end; ++i) {
      LineEvidence& line = result.lines.emplace_back();
      const float low = below.cuts[i - begin];
      const float high = above.cuts[i - begin];
      line.sides[0].area = below.area.UpTo(low);
      line.sides[1].area = area - above.area.UpTo(high);
      line.sides[0].measured = std::round(below.measured.UpTo(low));
      line.sides[1].measured = std::round(on_plane - above.measured.UpTo(high));
      for (const int side : {0, 1}) {
        LookThrough(i, axis, measurements, side, &line);
      }
    }
    return result;
  }

 private:
  // Adds the pixels labeled with the plane or with none; returns their number.
  double AddArea(const PlaneAxis& axis,
                 SumsByPosition* below,
                 SumsByPosition* above) const {
    double area = 0.0;
    for (int y = 0; y < evidence_.height; ++y) {
      for (int x = 0; x < evidence_.width; ++x) {
        if (is_plane_[evidence_.superpixels(x, y)] == 0) {
          continue;
        }
        const float position = axis.Position(intrinsics_.Ray(x, y));
        if (!std::isnan(position)) {
          below->Add(position, 1.0);
          above->Add(position, 1.0);
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
      const auto found = std::ranges::lower_bound(
          lines_.begin() + first,
          lines_.begin() + last,
          wanted,
          {},
          [](const SharedLine& line) { return line.line.position; });
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
    const PlaneLine& line = lines_[index].line;
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
  const std::vector<SharedLine>& lines_;
  const SceneModel& model_;
};

void AddTo(const LineEvidence& from, LineEvidence* to) {
  for (size_t i = 0; i < from.sides.size(); ++i) {
    to->sides[i].area += from.sides[i].area;
    to->sides[i].measured += from.sides[i].measured;
    to->sides[i].through += from.sides[i].through;
    to->sides[i].num_views += from.sides[i].num_views;
  }
}

}  // namespace

std::vector<ViewLineEvidence> TestPlaneLines(
    const ObservedView& view,
    const std::vector<int>& labels,
    const std::vector<SharedLine>& lines,
    const SceneModel& model) {
  const std::vector<Vec3f> middles =
      MiddleRays(*view.evidence, view.camera.GetIntrinsics());
  std::vector<ViewLineEvidence> result;
  for (const int plane : std::set<int>(labels.begin(), labels.end())) {
    const auto on_plane =
        std::ranges::equal_range(lines, plane, {}, [](const SharedLine& line) {
          return line.line.plane;
        });
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
          std::find_if(first, on_plane.end(), [&](const SharedLine& line) {
            return line.line.axis != first->line.axis;
          });
      result.push_back(test.Run(
          first - lines.begin(), last - lines.begin(), shown, middles));
      first = last;
    }
  }
  return result;
}

LineEvidenceSum::LineEvidenceSum(size_t num_lines)
    : of_lines_(num_lines), elsewhere_(num_lines + 1) {}

void LineEvidenceSum::Add(const std::vector<ViewLineEvidence>& view) {
  for (const ViewLineEvidence& evidence : view) {
    const size_t end = evidence.begin + evidence.lines.size();
    for (size_t i = 0; i < evidence.lines.size(); ++i) {
      AddTo(evidence.lines[i], &of_lines_[evidence.begin + i]);
    }
    elsewhere_[evidence.first][1] += evidence.measured;
    elsewhere_[evidence.begin][1] -= evidence.measured;
    elsewhere_[end][0] += evidence.measured;
    elsewhere_[evidence.last][0] -= evidence.measured;
  }
}

std::vector<LineEvidence> LineEvidenceSum::Get() const {
  std::vector<LineEvidence> result = of_lines_;
  std::array<double, 2> measured = {};
  for (size_t i = 0; i < result.size(); ++i) {
    for (size_t side = 0; side < 2; ++side) {
      measured[side] += elsewhere_[i][side];
      result[i].sides[side].measured += measured[side];
    }
  }
  return result;
}

}  // namespace tsar
