// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/discovery/manhattan_frame.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <numeric>
#include <utility>

#include <Eigen/Geometry>

namespace tsar {

namespace {

// Normals within this angle, 5 degrees, of a direction are candidates to lie
// along it.
constexpr double kSinMaxAngle = 0.0872;
constexpr double kCosMaxAngle = 0.9962;
// The number of planes of largest support whose pairs are tried as directions.
constexpr size_t kMaxPairedPlanes = 10;

using Frame = Eigen::Matrix3d;  // Its columns are directions.

// The direction along which the normal lies, or -1.
int NearestAxis(const Frame& frame, const Eigen::Vector3d& normal) {
  int axis = 0;
  const double cosine = (frame.transpose() * normal).cwiseAbs().maxCoeff(&axis);
  return cosine > kCosMaxAngle ? axis : -1;
}

double SupportAlong(const Frame& frame,
                    const std::vector<MeasuredPlane>& planes) {
  double support = 0.0;
  for (const MeasuredPlane& plane : planes) {
    if (NearestAxis(frame, plane.plane.normal) >= 0) {
      support += plane.support;
    }
  }
  return support;
}

// Finds the initial frame; nothing where no two planes are orthogonal.
std::optional<Frame> FindFrame(const std::vector<MeasuredPlane>& planes) {
  std::vector<int> order(planes.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(
      order, std::greater{}, [&](int p) { return planes[p].support; });
  order.resize(std::min(order.size(), kMaxPairedPlanes));
  std::optional<Frame> best;
  double best_support = 0.0;
  for (size_t i = 0; i < order.size(); ++i) {
    for (size_t j = 0; j < i; ++j) {
      const Eigen::Vector3d& first = planes[order[i]].plane.normal;
      const Eigen::Vector3d& other = planes[order[j]].plane.normal;
      // Each of the two may be off by the largest angle.
      if (std::abs(first.dot(other)) > 2.0 * kSinMaxAngle) {
        continue;
      }
      const Eigen::Vector3d second =
          (other - other.dot(first) * first).normalized();
      Frame frame;
      frame << first, second, first.cross(second);
      const double support = SupportAlong(frame, planes);
      if (support > best_support) {
        best_support = support;
        best = frame;
      }
    }
  }
  return best;
}

// The plane rotated to this normal, or to the opposite one, at its samples.
JointPlane Rotated(const MeasuredPlane& measured,
                   const Eigen::Vector3d& direction) {
  const WorldPlane& plane = measured.plane;
  const Eigen::Vector3d normal = direction.dot(plane.normal) < 0.0
                                     ? Eigen::Vector3d(-direction)
                                     : direction;
  const Eigen::Vector3d middle = measured.samples.Middle();
  const Eigen::Vector3d on_plane = middle - plane.Height(middle) * plane.normal;
  return {{normal, -normal.dot(on_plane)}, &measured.samples};
}

// Fits the frame together with the planes along its axes, and replaces these,
// except where that is not acceptable: the frame is then fitted without them.
std::optional<ManhattanFrame> FitFrame(
    const std::vector<MeasuredPlane>& planes,
    double loss_scale,
    const std::function<bool(int p, const WorldPlane& plane)>& is_acceptable,
    std::vector<WorldPlane>* result) {
  const std::optional<Frame> initial = FindFrame(planes);
  if (!initial) {
    return std::nullopt;
  }
  ManhattanFrame frame;
  std::vector<int> along;  // The planes near a direction.
  for (size_t p = 0; p < planes.size(); ++p) {
    frame.axes.push_back(NearestAxis(*initial, planes[p].plane.normal));
    if (frame.axes.back() >= 0) {
      along.push_back(static_cast<int>(p));
    }
  }
  bool changed = true;
  while (changed) {
    std::vector<JointPlane> joint;
    for (const int p : along) {
      joint.push_back(Rotated(planes[p], initial->col(frame.axes[p])));
    }
    frame.rotation = FitTogether(std::nullopt, loss_scale, &joint) * *initial;
    std::vector<int> accepted;
    for (size_t i = 0; i < along.size(); ++i) {
      const int p = along[i];
      if (is_acceptable(p, joint[i].plane)) {
        accepted.push_back(p);
        (*result)[p] = joint[i].plane;
      } else {
        frame.axes[p] = -1;
        (*result)[p] = planes[p].plane;
      }
    }
    changed = accepted.size() < along.size();
    along = std::move(accepted);
  }
  return frame;
}

constexpr double kCosSameFrame = 0.99939;  // 2 degrees.

struct SceneFrame {
  Eigen::Matrix3d rotation;
  int component = 0;
};

// For each column of the second frame the column of the first that equals it up
// to sign; nothing where the frames differ.
std::optional<std::array<int, 3>> MatchColumns(const Eigen::Matrix3d& first,
                                               const Eigen::Matrix3d& second) {
  const Eigen::Matrix3d cosines = (first.transpose() * second).cwiseAbs();
  std::array<int, 3> columns = {};
  for (int i = 0; i < 3; ++i) {
    if (!(cosines.col(i).maxCoeff(&columns[i]) > kCosSameFrame)) {
      return std::nullopt;
    }
  }
  return columns;
}

double AlignedSupport(const PlaneBlock& block) {
  double support = 0.0;
  for (const MeasuredScenePlane& plane : block.planes) {
    support += plane.found.axis >= 0 ? plane.found.support : 0.0;
  }
  return support;
}

// The frame of the block's component that equals the block's frame, added where
// there is none. columns: as by MatchColumns.
int FindOrAdd(const PlaneBlock& block,
              std::vector<SceneFrame>* frames,
              std::array<int, 3>* columns) {
  for (size_t f = 0; f < frames->size(); ++f) {
    const SceneFrame& frame = (*frames)[f];
    if (frame.component == block.component) {
      if (const auto matched = MatchColumns(frame.rotation, *block.frame)) {
        *columns = *matched;
        return static_cast<int>(f);
      }
    }
  }
  frames->push_back({*block.frame, block.component});
  return static_cast<int>(frames->size()) - 1;
}

// The support of a plane of the model that was aligned to each axis: by frame
// and column, or kNoAxis.
using AxisVotes = std::map<std::pair<int, int>, double>;
constexpr std::pair<int, int> kNoAxis = {-1, -1};

}  // namespace

std::vector<WorldPlane> AlignToManhattanFrame(
    const std::vector<MeasuredPlane>& planes,
    double loss_scale,
    const std::function<bool(int p, const WorldPlane& plane)>& is_acceptable,
    std::optional<ManhattanFrame>* frame_found) {
  std::vector<WorldPlane> result;
  for (const MeasuredPlane& plane : planes) {
    result.push_back(plane.plane);
  }
  const std::optional<ManhattanFrame> frame =
      FitFrame(planes, loss_scale, is_acceptable, &result);
  for (int p = 0; frame && p < static_cast<int>(planes.size()); ++p) {
    bool is_regular = frame->axes[p] >= 0;
    for (int axis = 0; axis < 3 && !is_regular; ++axis) {
      const Eigen::Vector3d direction = frame->rotation.col(axis);
      const Eigen::Vector3d& normal = planes[p].plane.normal;
      if (std::abs(normal.dot(direction)) > kSinMaxAngle) {
        continue;
      }
      std::vector<JointPlane> one = {
          Rotated(planes[p],
                  (normal - normal.dot(direction) * direction).normalized())};
      FitTogether(direction, loss_scale, &one);
      if (is_acceptable(p, one[0].plane)) {
        is_regular = true;
        result[p] = one[0].plane;
      }
    }
  }
  if (frame_found != nullptr) {
    *frame_found = frame;
  }
  return result;
}

std::vector<Eigen::Matrix3d> FindSceneFrames(
    const std::vector<PlaneBlock>& blocks,
    const std::vector<std::vector<int>>& indices,
    std::vector<ModelPlane>* planes) {
  std::vector<int> order(blocks.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(
      order, std::greater{}, [&](int b) { return AlignedSupport(blocks[b]); });
  std::vector<SceneFrame> frames;
  std::vector<AxisVotes> votes(planes->size());
  for (const int b : order) {
    const PlaneBlock& block = blocks[b];
    std::array<int, 3> columns = {0, 1, 2};
    const int frame = block.frame ? FindOrAdd(block, &frames, &columns) : -1;
    for (size_t p = 0; p < block.planes.size(); ++p) {
      const ScenePlane& plane = block.planes[p].found;
      votes[indices[b][p]]
           [plane.axis < 0 ? kNoAxis : std::pair(frame, columns[plane.axis])] +=
          plane.support;
    }
  }
  std::vector<int> new_indices(frames.size(), -1);
  std::vector<Eigen::Matrix3d> result;
  for (size_t p = 0; p < planes->size(); ++p) {
    ModelPlane& plane = (*planes)[p];
    const auto most =
        std::ranges::max_element(votes[p], {}, &AxisVotes::value_type::second);
    if (most == votes[p].end() || most->first.first < 0) {
      continue;
    }
    const auto [frame, axis] = most->first;
    const Eigen::Matrix3d& rotation = frames[frame].rotation;
    if (!(std::abs(rotation.col(axis).dot(plane.plane.normal)) >
          kCosSameFrame)) {
      continue;
    }
    if (new_indices[frame] < 0) {
      new_indices[frame] = static_cast<int>(result.size());
      result.push_back(rotation);
    }
    plane.frame = new_indices[frame];
    plane.axis = axis;
  }
  return result;
}

}  // namespace tsar
