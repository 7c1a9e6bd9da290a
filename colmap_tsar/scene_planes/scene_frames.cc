// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/scene_frames.h"

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

constexpr double kCosMaxAngle = 0.99939;  // 2 degrees.

struct SceneFrame {
  Eigen::Matrix3d rotation;
  int component = 0;
};

// For each column of the second frame the one of the first that it is, whatever
// its sign; nothing where they differ.
std::optional<std::array<int, 3>> MatchColumns(const Eigen::Matrix3d& first,
                                               const Eigen::Matrix3d& second) {
  const Eigen::Matrix3d cosines = (first.transpose() * second).cwiseAbs();
  std::array<int, 3> columns = {};
  for (int i = 0; i < 3; ++i) {
    if (!(cosines.col(i).maxCoeff(&columns[static_cast<size_t>(i)]) >
          kCosMaxAngle)) {
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

std::vector<Eigen::Matrix3d> FindSceneFrames(
    const std::vector<FrameOfBlock>& blocks, std::vector<ModelPlane>* planes) {
  std::vector<size_t> order(blocks.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    return AlignedSupport(blocks[a]) > AlignedSupport(blocks[b]);
  });
  std::vector<SceneFrame> frames;
  // Per plane of the model, by frame and axis; -1 for what lies along none.
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
    for (size_t p = 0; p < block.places.size(); ++p) {
      const int axis = block.axes[p];
      const std::pair<int, int> along =
          axis < 0
              ? std::pair<int, int>(-1, -1)
              : std::pair<int, int>(frame, columns[static_cast<size_t>(axis)]);
      votes[static_cast<size_t>(block.places[p])][along] += block.supports[p];
    }
  }
  std::vector<int> places(frames.size(), -1);
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
          kCosMaxAngle)) {
      continue;
    }
    if (places[frame] < 0) {
      places[frame] = static_cast<int>(result.size());
      result.push_back(frames[frame].rotation);
    }
    plane.frame = places[frame];
    plane.axis = axis;
  }
  return result;
}

}  // namespace tsar
