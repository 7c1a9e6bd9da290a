// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/discovery/manhattan_frame.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include <Eigen/Core>
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

std::vector<int> BySupport(const std::vector<MeasuredPlane>& planes) {
  std::vector<int> order(planes.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return planes[a].support > planes[b].support;
  });
  return order;
}

// Finds the initial frame; nothing where no two planes are orthogonal.
std::optional<Frame> FindFrame(const std::vector<MeasuredPlane>& planes) {
  std::vector<int> order = BySupport(planes);
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
JointPlane Turned(const MeasuredPlane& measured,
                  const Eigen::Vector3d& direction) {
  const WorldPlane& plane = measured.plane;
  const Eigen::Vector3d normal = direction.dot(plane.normal) < 0.0
                                     ? Eigen::Vector3d(-direction)
                                     : direction;
  const Eigen::Vector3d middle = measured.samples.Middle();
  const Eigen::Vector3d on_plane = middle - plane.Height(middle) * plane.normal;
  return {{normal, -normal.dot(on_plane)}, &measured.samples};
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
    if (!(cosines.col(i).maxCoeff(&columns[static_cast<size_t>(i)]) >
          kCosSameFrame)) {
      return std::nullopt;
    }
  }
  return columns;
}

double AlignedSupport(const FrameOfBlock& block) {
  double support = 0.0;
  for (size_t p = 0; p < block.axes.size(); ++p) {
    support += block.axes[p] >= 0 ? block.supports[p] : 0.0;
  }
  return support;
}

}  // namespace

std::vector<WorldPlane> AlignToManhattanFrame(
    const std::vector<MeasuredPlane>& planes,
    double loss_scale,
    const std::function<bool(int p, const WorldPlane& plane)>& is_acceptable,
    std::optional<ManhattanFrame>* frame_found) {
  if (frame_found != nullptr) {
    frame_found->reset();
  }
  std::vector<WorldPlane> result;
  for (const MeasuredPlane& plane : planes) {
    result.push_back(plane.plane);
  }
  const std::optional<Frame> found = FindFrame(planes);
  if (!found) {
    return result;
  }
  const int num_planes = static_cast<int>(planes.size());
  std::vector<int> axes;
  std::vector<int> along;  // The planes near a direction.
  for (int p = 0; p < num_planes; ++p) {
    axes.push_back(NearestAxis(*found, planes[p].plane.normal));
    if (axes.back() >= 0) {
      along.push_back(p);
    }
  }
  std::vector<bool> is_regular(planes.size(), false);
  Frame frame = *found;
  bool changed = true;
  while (changed) {
    std::vector<JointPlane> joint;
    for (const int p : along) {
      joint.push_back(Turned(planes[p], found->col(axes[p])));
    }
    frame = FitTogether(std::nullopt, loss_scale, &joint) * *found;
    std::vector<int> accepted;
    std::fill(is_regular.begin(), is_regular.end(), false);
    for (size_t i = 0; i < along.size(); ++i) {
      const int p = along[i];
      if (is_acceptable(p, joint[i].plane)) {
        accepted.push_back(p);
        is_regular[p] = true;
        result[p] = joint[i].plane;
      } else {
        result[p] = planes[p].plane;
      }
    }
    changed = accepted.size() < along.size();
    along = std::move(accepted);
  }
  if (frame_found != nullptr) {
    ManhattanFrame of_planes{frame, std::vector<int>(planes.size(), -1)};
    for (const int p : along) {
      of_planes.axes[p] = axes[p];
    }
    *frame_found = std::move(of_planes);
  }
  for (int p = 0; p < num_planes; ++p) {
    for (int axis = 0; axis < 3 && !is_regular[p]; ++axis) {
      const Eigen::Vector3d direction = frame.col(axis);
      const Eigen::Vector3d& normal = planes[p].plane.normal;
      if (std::abs(normal.dot(direction)) > kSinMaxAngle) {
        continue;
      }
      std::vector<JointPlane> one = {
          Turned(planes[p],
                 (normal - normal.dot(direction) * direction).normalized())};
      FitTogether(direction, loss_scale, &one);
      if (is_acceptable(p, one[0].plane)) {
        is_regular[p] = true;
        result[p] = one[0].plane;
      }
    }
  }
  return result;
}

std::vector<Eigen::Matrix3d> FindSceneFrames(
    const std::vector<FrameOfBlock>& blocks, std::vector<ModelPlane>* planes) {
  std::vector<size_t> order(blocks.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    return AlignedSupport(blocks[a]) > AlignedSupport(blocks[b]);
  });
  std::vector<SceneFrame> frames;
  // Support per plane of the model, by frame and axis; -1 for support along
  // none.
  std::vector<std::map<std::pair<int, int>, double>> votes(planes->size());
  for (const size_t b : order) {
    const FrameOfBlock& block = blocks[b];
    std::array<int, 3> columns = {0, 1, 2};
    int frame = -1;
    for (size_t f = 0; f < frames.size() && block.rotation && frame < 0; ++f) {
      if (frames[f].component == block.component) {
        if (const auto matched =
                MatchColumns(frames[f].rotation, *block.rotation)) {
          columns = *matched;
          frame = static_cast<int>(f);
        }
      }
    }
    if (block.rotation && frame < 0) {
      frame = static_cast<int>(frames.size());
      frames.push_back({*block.rotation, block.component});
    }
    for (size_t p = 0; p < block.indices.size(); ++p) {
      const int axis = block.axes[p];
      const std::pair<int, int> along =
          axis < 0
              ? std::pair<int, int>(-1, -1)
              : std::pair<int, int>(frame, columns[static_cast<size_t>(axis)]);
      votes[static_cast<size_t>(block.indices[p])][along] += block.supports[p];
    }
  }
  std::vector<int> new_indices(frames.size(), -1);
  std::vector<Eigen::Matrix3d> result;
  for (size_t p = 0; p < planes->size(); ++p) {
    ModelPlane& plane = (*planes)[p];
    const auto most = std::max_element(
        votes[p].begin(), votes[p].end(), [](const auto& a, const auto& b) {
          return a.second < b.second;
        });
    if (most == votes[p].end() || most->first.first < 0) {
      continue;
    }
    const auto frame = static_cast<size_t>(most->first.first);
    const int axis = most->first.second;
    if (!(std::abs(frames[frame].rotation.col(axis).dot(plane.plane.normal)) >
          kCosSameFrame)) {
      continue;
    }
    if (new_indices[frame] < 0) {
      new_indices[frame] = static_cast<int>(result.size());
      result.push_back(frames[frame].rotation);
    }
    plane.frame = new_indices[frame];
    plane.axis = axis;
  }
  return result;
}

}  // namespace tsar
