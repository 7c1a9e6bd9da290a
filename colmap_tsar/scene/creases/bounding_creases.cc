// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/creases/bounding_creases.h"

#include "colmap_tsar/scene/creases/plane_lines.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <tuple>
#include <utility>

#include <Eigen/Geometry>

namespace tsar {
namespace {

// The least number of views that show some of the area beyond, from in front
// of it.
constexpr int kMinViews = 3;
// The largest shares of the area beyond that may be measured on the plane, or
// seen through the plane that begins there: some matches are wrong. The
// former is also relative to the measurements on this side.
constexpr double kMaxMeasured = 0.03;
constexpr double kMaxThrough = 0.03;
// The least area beyond, summed over views, and the least sum of measurements
// on this side, in pixels.
constexpr double kMinArea = 200.0;
constexpr double kMinMeasured = 100.0;
// This many parallel lines with this share of the crease's step and of the
// measurements on either side are a pattern, as of tiles and boards.
constexpr int kMinPatternLines = 2;
constexpr float kMinPatternStep = 0.7f;
constexpr double kMinPatternShare = 0.05;
// Lines that are this close, in pixels, are one of a pattern. A fall and a rise
// of brightness are one dark crease between them.
constexpr float kMaxCreaseWidth = 14.f;
// A plane of the model that passes within this many pixels of the crease,
// almost parallel to the plane that would begin there, replaces it: the one
// with the largest support, if that is at least this share of the support of
// the plane that ends.
constexpr float kMaxOffset = 10.f;
constexpr double kMinSupport = 0.1;

// Whether the line's plane ends there: nothing was measured on the side beyond.
bool PlaneEnds(const LineEvidence& evidence, int beyond) {
  const LineEvidence::Side& side = evidence.sides[beyond];
  const double measured_before = evidence.sides[1 - beyond].measured;
  return side.num_views >= kMinViews && side.area > kMinArea &&
         side.measured <= kMaxMeasured * std::min(side.area, measured_before) &&
         side.through <= kMaxThrough * side.area &&
         measured_before > kMinMeasured;
}

class CreaseFinder {
 public:
  CreaseFinder(const std::vector<PlaneLine>& lines,
               const std::vector<LineEvidence>& evidence,
               const std::vector<int>& copies,
               SceneModel* model)
      : lines_(lines),
        evidence_(evidence),
        copies_(copies),
        model_(model),
        first_new_(static_cast<int>(model->planes.size())) {
    for (size_t i = 0; i < lines.size(); ++i) {
      on_axis_[{lines[i].plane, lines[i].axis}].push_back(i);
    }
  }

  std::vector<BoundingCrease> Run() {
    std::vector<BoundingCrease> creases;
    for (const auto& [key, ends] : FindEnds()) {
      const int beyond = std::get<2>(key);
      creases.push_back(MakeCrease(Outermost(ends, beyond), beyond));
    }
    PlaceNewPlanes();
    return creases;
  }

 private:
  using Lines = std::vector<PlaneLine>;

  // The lines at which planes end, by plane, axis and the side beyond.
  std::map<std::tuple<int, int, int>, Lines> FindEnds() const {
    std::map<std::tuple<int, int, int>, Lines> ends;
    for (size_t i = 0; i < lines_.size(); ++i) {
      const PlaneLine& line = lines_[i];
      for (const int beyond : {0, 1}) {
        // Unmeasured planes do not begin at edges that few views see.
        if (PlaneEnds(evidence_[i], beyond) && !IsPattern(line) &&
            (2 * line.num_views >= evidence_[i].sides[beyond].num_views ||
             FindPlane(line, PlaneAtLine(*model_, line, beyond)) >= 0)) {
          ends[{line.plane, line.axis, beyond}].push_back(line);
        }
      }
    }
    return ends;
  }

  // The lines that amount to a pattern; those side by side are one, as of a
  // skirting board.
  bool IsPattern(const PlaneLine& crease) const {
    int count = 0;
    float last = -INFINITY;
    for (const size_t i : on_axis_.at({crease.plane, crease.axis})) {
      const PlaneLine& line = lines_[i];
      const double below = evidence_[i].sides[0].measured;
      const double above = evidence_[i].sides[1].measured;
      if (line.position - last > kMaxCreaseWidth * line.pixel &&
          std::min(below, above) > kMinPatternShare * (below + above) &&
          std::abs(line.step) > kMinPatternStep * std::abs(crease.step)) {
        ++count;
        last = line.position;
      }
    }
    return count >= kMinPatternLines;
  }

  // The outermost of the ends of a plane on one side; if it is one of a fall
  // and a rise side by side, their middle.
  static PlaneLine Outermost(const Lines& ends, int beyond) {
    const auto is_further = [&](const PlaneLine& a, const PlaneLine& b) {
      return beyond == 0 ? a.position < b.position : a.position > b.position;
    };
    PlaneLine last = *std::ranges::min_element(ends, is_further);
    const PlaneLine* partner = nullptr;
    for (const PlaneLine& other : ends) {
      if (other.step * last.step < 0.f &&
          std::abs(other.position - last.position) <
              kMaxCreaseWidth * last.pixel &&
          (partner == nullptr || is_further(other, *partner))) {
        partner = &other;
      }
    }
    if (partner != nullptr) {
      last.position = 0.5f * (last.position + partner->position);
    }
    return last;
  }

  BoundingCrease MakeCrease(const PlaneLine& line, int beyond) {
    BoundingCrease crease;
    crease.plane = line.plane;
    crease.limit = PlaneAtLine(*model_, line, beyond);
    crease.beyond = FindPlane(line, crease.limit);
    if (crease.beyond < 0) {
      crease.beyond = static_cast<int>(model_->planes.size());
      model_->planes.push_back(MakePlane(line, crease.limit));
    }
    crease.is_new = crease.beyond >= first_new_;
    if (crease.is_new) {
      creases_of_new_.resize(model_->planes.size() - first_new_);
      creases_of_new_[crease.beyond - first_new_].push_back(
          {-model_->planes[crease.beyond].plane.normal.dot(
               PointOn(line, *model_)),
           double(line.num_views)});
    }
    return crease;
  }

  // The plane within reach with the largest support that has the same normal,
  // enough support and is not a copy, or else the nearest that begins at
  // another crease; -1 where there is none.
  int FindPlane(const PlaneLine& line, const WorldPlane& limit) const {
    const ModelPlane& ending = model_->planes[line.plane];
    const double max_gap = double{kMaxOffset} * line.pixel;
    const Eigen::Vector3d on_line = PointOn(line, *model_);
    const auto gap = [&](int plane) {
      return std::abs(model_->planes[plane].plane.Height(on_line));
    };
    const auto preference = [&](int plane) {
      return std::pair(model_->planes[plane].support, -gap(plane));
    };
    int best = -1;
    for (int i = 0; i < static_cast<int>(model_->planes.size()); ++i) {
      const ModelPlane& plane = model_->planes[i];
      if (plane.component == ending.component &&
          plane.plane.normal.dot(limit.normal) > kMinCopyCosine &&
          (i >= first_new_ ||
           (copies_[i] == i &&
            plane.support >= kMinSupport * ending.support)) &&
          gap(i) < max_gap && (best < 0 || preference(i) > preference(best))) {
        best = i;
      }
    }
    return best;
  }

  ModelPlane MakePlane(const PlaneLine& line, const WorldPlane& limit) const {
    const ModelPlane& ending = model_->planes[line.plane];
    ModelPlane plane;
    plane.plane = limit;
    plane.center = PointOn(line, *model_);
    plane.axis_s = ending.plane.normal;
    plane.axis_t = limit.normal.cross(plane.axis_s);
    // Its normal is taken from the frame, and its offset is known to a pixel.
    plane.covariance(2, 2) = double{line.pixel} * line.pixel;
    plane.component = ending.component;
    plane.frame = ending.frame;
    plane.axis = line.axis;
    return plane;
  }

  // Sets the offset of each new plane to the mean over its creases, weighted by
  // the numbers of views that see them.
  void PlaceNewPlanes() {
    for (size_t i = 0; i < creases_of_new_.size(); ++i) {
      double sum = 0.0;
      double weights = 0.0;
      for (const auto& [offset, weight] : creases_of_new_[i]) {
        sum += weight * offset;
        weights += weight;
      }
      const double middle = sum / weights;
      double variance = 0.0;
      for (const auto& [offset, weight] : creases_of_new_[i]) {
        variance += weight * (offset - middle) * (offset - middle) / weights;
      }
      ModelPlane& plane = model_->planes[first_new_ + i];
      plane.center += (plane.plane.offset - middle) * plane.plane.normal;
      plane.plane.offset = middle;
      plane.covariance(2, 2) += variance;
    }
  }

  const std::vector<PlaneLine>& lines_;
  const std::vector<LineEvidence>& evidence_;
  const std::vector<int>& copies_;
  SceneModel* const model_;
  const int first_new_;  // Index of the first new plane.
  // By new plane, for each of its creases the offset of the plane through it
  // and the number of views that see it.
  std::vector<std::vector<std::pair<double, double>>> creases_of_new_;
  // Indices of lines, by plane and axis.
  std::map<std::pair<int, int>, std::vector<size_t>> on_axis_;
};

}  // namespace

std::vector<BoundingCrease> FindBoundingCreases(
    const std::vector<PlaneLine>& lines,
    const std::vector<LineEvidence>& evidence,
    const std::vector<int>& copies,
    SceneModel* model) {
  return CreaseFinder(lines, evidence, copies, model).Run();
}

}  // namespace tsar
