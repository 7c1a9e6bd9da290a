// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/bounding_creases.h"

#include "colmap_tsar/scene_planes/plane_axis.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include <Eigen/Geometry>

namespace tsar {
namespace {

Eigen::Vector3d AxisOf(const PlaneLine& line, const SceneModel& model) {
  const ModelPlane& plane = model.planes[static_cast<size_t>(line.plane)];
  return model.frames[static_cast<size_t>(plane.frame)].col(line.axis);
}

// The plane at right angles through the line, toward the side from which it is
// seen if the plane goes on to this side of it: 0 below its place, 1 above.
WorldPlane PlaneOnLine(const PlaneLine& line,
                       int beyond,
                       const SceneModel& model) {
  const ModelPlane& plane = model.planes[static_cast<size_t>(line.plane)];
  const Eigen::Vector3d axis = AxisOf(line, model);
  WorldPlane result;
  result.normal = beyond == 0 ? axis : Eigen::Vector3d(-axis);
  result.offset = -result.normal.dot(plane.center + double{line.place} * axis);
  return result;
}

class LineTest {
 public:
  LineTest(const ObservedView& view,
           const SharedLine& shared,
           const std::vector<uint8_t>& is_plane,
           const SceneModel& model,
           const BoundingCreaseOptions& options)
      : evidence_(*view.evidence),
        intrinsics_(view.camera.GetIntrinsics()),
        line_(shared.line),
        is_plane_(is_plane),
        options_(options),
        axis_(model.planes[static_cast<size_t>(line_.plane)],
              AxisOf(line_, model),
              view.camera) {
    for (int side = 0; side < 2; ++side) {
      const WorldPlane on_line = PlaneOnLine(line_, side, model);
      if (on_line.Height(view.camera.Center()) > 0.0) {
        half_planes_[static_cast<size_t>(side)] =
            ToCameraPlane(on_line, view.camera);
      }
    }
  }

  LineEvidence Run() {
    AddAreas();
    for (int s = 0; s < evidence_.NumSuperpixels(); ++s) {
      AddMeasurements(static_cast<size_t>(s));
    }
    return result_;
  }

 private:
  // 0 or 1; nothing next to the line, or where the plane is not seen.
  std::optional<size_t> SideOf(const Vec3f& ray) const {
    const float height = axis_.Place(ray) - line_.place;
    // Not for NaN either.
    return std::abs(height) >= options_.margin * line_.pixel
               ? std::optional<size_t>(height > 0.f ? 1 : 0)
               : std::nullopt;
  }

  void AddAreas() {
    for (int y = 0; y < evidence_.height; ++y) {
      for (int x = 0; x < evidence_.width; ++x) {
        if (is_plane_[evidence_.superpixels(x, y)] == 0) {
          continue;
        }
        if (const auto side = SideOf(intrinsics_.Ray(static_cast<float>(x),
                                                     static_cast<float>(y)))) {
          ++result_.sides[*side].area;
        }
      }
    }
    for (size_t side = 0; side < 2; ++side) {
      result_.sides[side].num_views =
          half_planes_[side] &&
          result_.sides[side].area >= options_.min_view_area;
    }
  }

  void AddMeasurements(size_t s) {
    const auto begin = static_cast<size_t>(evidence_.first_observation[s]);
    const auto end = static_cast<size_t>(evidence_.first_observation[s + 1]);
    float confidence = 0.f;
    for (size_t i = begin; i < end; ++i) {
      confidence += evidence_.observations[i].confidence;
    }
    for (size_t i = begin; i < end; ++i) {
      if (evidence_.is_measured[i] != 0) {
        AddMeasurement(evidence_.observations[i].sample,
                       evidence_.observations[i].confidence *
                           evidence_.weights[s] / confidence);
      }
    }
  }

  void AddMeasurement(const RayDepth& sample, double weight) {
    const Vec3f ray = {sample.x, sample.y, 1.f};
    const auto number = SideOf(ray);
    if (!number) {
      return;
    }
    LineEvidence::Side& side = result_.sides[*number];
    const float unit = evidence_.resolution.RelativeDepthError(sample.z);
    const float on_plane = axis_.InCamera().Depth(ray);
    if (std::abs(on_plane - sample.z) < options_.tolerance * unit * sample.z) {
      side.measured += weight;
    }
    if (half_planes_[*number]) {
      const float depth = half_planes_[*number]->Depth(ray);
      // The other half of it is behind the plane.
      if (depth > 0.f && depth < on_plane &&
          sample.z > depth * (1.f + options_.min_through * unit)) {
        side.through += weight;
      }
    }
  }

  const ViewEvidence& evidence_;
  const Intrinsics intrinsics_;
  const PlaneLine& line_;
  const std::vector<uint8_t>& is_plane_;
  const BoundingCreaseOptions& options_;
  const PlaneAxis axis_;
  // Those that the camera sees.
  std::array<std::optional<Plane>, 2> half_planes_;
  LineEvidence result_;
};

// A line at which its plane ends.
struct EndOfPlane {
  SharedLine shared;
  int beyond;  // Side of it.
};

bool Ends(const LineEvidence& evidence,
          size_t beyond,
          const BoundingCreaseOptions& options) {
  const LineEvidence::Side& side = evidence.sides[beyond];
  return side.num_views >= options.min_views && side.area > options.min_area &&
         side.measured <= options.max_measured * side.area &&
         side.through <= options.max_through * side.area &&
         evidence.sides[1 - beyond].measured > options.min_measured;
}

class CreaseFinderOfModel {
 public:
  CreaseFinderOfModel(const std::vector<SharedLine>& lines,
                      const std::vector<LineEvidence>& evidence,
                      const BoundingCreaseOptions& options,
                      SceneModel* model)
      : lines_(lines),
        evidence_(evidence),
        options_(options),
        model_(model),
        first_new_(model->planes.size()) {
    for (size_t i = 0; i < lines.size(); ++i) {
      on_axis_[{lines[i].line.plane, lines[i].line.axis}].push_back(i);
    }
  }

  std::vector<BoundingCrease> Run() {
    std::vector<BoundingCrease> creases;
    for (const auto& [key, ends] : FindEnds()) {
      creases.push_back(MakeCrease(Outermost(ends)));
    }
    return creases;
  }

 private:
  using Ends = std::vector<EndOfPlane>;

  // By plane, axis and side.
  std::map<std::tuple<int, int, int>, Ends> FindEnds() const {
    std::map<std::tuple<int, int, int>, Ends> ends;
    for (size_t i = 0; i < lines_.size(); ++i) {
      const PlaneLine& line = lines_[i].line;
      for (const int beyond : {0, 1}) {
        if (tsar::Ends(evidence_[i], static_cast<size_t>(beyond), options_) &&
            !IsLined(line)) {
          ends[{line.plane, line.axis, beyond}].push_back({lines_[i], beyond});
        }
      }
    }
    return ends;
  }

  bool IsLined(const PlaneLine& crease) const {
    int count = 0;
    for (const size_t i : on_axis_.at({crease.plane, crease.axis})) {
      const PlaneLine& line = lines_[i].line;
      const double below = evidence_[i].sides[0].measured;
      const double above = evidence_[i].sides[1].measured;
      count +=
          std::min(below, above) > options_.min_lined_share * (below + above) &&
          std::abs(line.step) > options_.min_lined_step * std::abs(crease.step);
    }
    return count >= options_.min_lined;
  }

  // ends: of one side of a plane. Of a fall and a rise side by side, their
  // middle.
  EndOfPlane Outermost(const Ends& ends) const {
    const auto is_further = [](const EndOfPlane& a, const EndOfPlane& b) {
      return a.beyond == 0 ? a.shared.line.place < b.shared.line.place
                           : a.shared.line.place > b.shared.line.place;
    };
    EndOfPlane last = *std::min_element(ends.begin(), ends.end(), is_further);
    PlaneLine& line = last.shared.line;
    std::optional<EndOfPlane> partner;
    for (const EndOfPlane& end : ends) {
      const PlaneLine& other = end.shared.line;
      if (other.step * line.step < 0.f &&
          std::abs(other.place - line.place) <
              options_.max_crease_width * line.pixel &&
          (!partner || is_further(end, *partner))) {
        partner = end;
      }
    }
    if (partner) {
      line.place = 0.5f * (line.place + partner->shared.line.place);
    }
    return last;
  }

  BoundingCrease MakeCrease(const EndOfPlane& end) {
    const PlaneLine& line = end.shared.line;
    BoundingCrease crease;
    crease.plane = line.plane;
    crease.limit = PlaneOnLine(line, end.beyond, *model_);
    crease.beyond = FindPlane(line, crease.limit);
    // Also where another wall's crease has proposed it.
    crease.is_new =
        crease.beyond < 0 || static_cast<size_t>(crease.beyond) >= first_new_;
    if (crease.beyond < 0) {
      crease.beyond = static_cast<int>(model_->planes.size());
      model_->planes.push_back(MakePlane(line, crease.limit));
    }
    return crease;
  }

  // One that was measured well enough, or that begins at another crease; -1
  // where there is none.
  int FindPlane(const PlaneLine& line, const WorldPlane& limit) const {
    const ModelPlane& ending = model_->planes[static_cast<size_t>(line.plane)];
    const Eigen::Vector3d on_line =
        ending.center + double{line.place} * AxisOf(line, *model_);
    const double max_offset = double{options_.max_offset} * line.pixel;
    for (size_t i = 0; i < model_->planes.size(); ++i) {
      const ModelPlane& plane = model_->planes[i];
      if (plane.component == ending.component && plane.frame == ending.frame &&
          plane.axis == line.axis &&
          plane.plane.normal.dot(limit.normal) > 0.0 &&
          (i >= first_new_ ||
           plane.support >= options_.min_support * ending.support) &&
          std::abs(plane.plane.Height(on_line)) < max_offset) {
        return static_cast<int>(i);
      }
    }
    return -1;
  }

  ModelPlane MakePlane(const PlaneLine& line, const WorldPlane& limit) const {
    const ModelPlane& ending = model_->planes[static_cast<size_t>(line.plane)];
    ModelPlane plane;
    plane.plane = limit;
    plane.center = ending.center + double{line.place} * AxisOf(line, *model_);
    plane.axis_s = ending.plane.normal;
    plane.axis_t = limit.normal.cross(plane.axis_s);
    // Its direction is that of the frame; its place is known to a pixel.
    plane.covariance(2, 2) = double{line.pixel} * line.pixel;
    plane.component = ending.component;
    plane.frame = ending.frame;
    plane.axis = line.axis;
    return plane;
  }

  const std::vector<SharedLine>& lines_;
  const std::vector<LineEvidence>& evidence_;
  const BoundingCreaseOptions& options_;
  SceneModel* const model_;
  const size_t first_new_;  // Plane of the model.
  // Numbers of lines, by plane and axis.
  std::map<std::pair<int, int>, std::vector<size_t>> on_axis_;
};

}  // namespace

LineEvidence& LineEvidence::operator+=(const LineEvidence& other) {
  for (size_t i = 0; i < sides.size(); ++i) {
    sides[i].area += other.sides[i].area;
    sides[i].measured += other.sides[i].measured;
    sides[i].through += other.sides[i].through;
    sides[i].num_views += other.sides[i].num_views;
  }
  return *this;
}

EvidenceOfLines TestPlaneLines(const ObservedView& view,
                               const std::vector<int>& labels,
                               const std::vector<int>& copies,
                               const std::vector<SharedLine>& lines,
                               const SceneModel& model,
                               const BoundingCreaseOptions& options) {
  std::set<int> planes;
  for (const int label : labels) {
    if (label >= 0) {
      planes.insert(copies[static_cast<size_t>(label)]);
    }
  }
  EvidenceOfLines evidence;
  for (const int plane : planes) {
    const auto is_before = [](const SharedLine& line, int number) {
      return line.line.plane < number;
    };
    auto line = std::lower_bound(lines.begin(), lines.end(), plane, is_before);
    // Per superpixel, whether it has the plane, or none.
    std::vector<uint8_t> is_plane;
    for (; line != lines.end() && line->line.plane == plane; ++line) {
      for (size_t s = is_plane.size(); s < labels.size(); ++s) {
        is_plane.push_back(labels[s] < 0 ||
                           copies[static_cast<size_t>(labels[s])] == plane);
      }
      evidence[static_cast<size_t>(line - lines.begin())] =
          LineTest(view, *line, is_plane, model, options).Run();
    }
  }
  return evidence;
}

std::vector<BoundingCrease> FindBoundingCreases(
    const std::vector<SharedLine>& lines,
    const std::vector<LineEvidence>& evidence,
    const std::vector<int>& copies,
    const BoundingCreaseOptions& options,
    SceneModel* model) {
  std::vector<BoundingCrease> creases =
      CreaseFinderOfModel(lines, evidence, options, model).Run();
  const size_t num_originals = creases.size();
  for (size_t i = 0; i < num_originals; ++i) {
    for (size_t plane = 0; plane < copies.size(); ++plane) {
      if (copies[plane] == creases[i].plane &&
          static_cast<int>(plane) != creases[i].plane) {
        creases.push_back(creases[i]);
        creases.back().plane = static_cast<int>(plane);
      }
    }
  }
  return creases;
}

}  // namespace tsar
