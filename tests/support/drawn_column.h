// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/scene/evidence/observed_view.h"
#include "colmap_tsar/scene/evidence/view_evidence.h"

#include <cstddef>
#include <functional>
#include <vector>

#include <Eigen/Core>

namespace tsar {

// The gray level along a ray from a point. World frame, z upwards.
using DrawnScene = std::function<double(const Eigen::Vector3d& from,
                                        const Eigen::Vector3d& direction)>;

// A textureless column in front of a textureless background.
struct DrawnColumn {
  static constexpr double kBackground = 90.0;
  static constexpr double kColumn = 160.0;

  Eigen::Vector2d center = {0.1, 3.0};
  double radius = 0.25;
  double bottom = -0.6;
  double top = 0.7;

  double operator()(const Eigen::Vector3d& from,
                    const Eigen::Vector3d& direction) const;
};

// Upright walls between corners, seen from above; as high as the column.
struct DrawnWalls {
  std::vector<Eigen::Vector2d> corners;

  double operator()(const Eigen::Vector3d& from,
                    const Eigen::Vector3d& direction) const;
};

// Views of it from an arc of almost a radian around (0, 3), at a distance of 3.
class DrawnViews {
 public:
  static constexpr int kWidth = 240;
  static constexpr int kHeight = 180;
  static constexpr double kFocal = 220.0;

  // rotation: of the whole scene with its cameras. noise: its greatest value,
  // in gray levels. scale: the factor by which the scene is enlarged.
  DrawnViews(const DrawnScene& scene,
             int num_views,
             const Eigen::Matrix3d& rotation = Eigen::Matrix3d::Identity(),
             double noise = 0.0,
             double scale = 1.0);
  DrawnViews(const DrawnViews&) = delete;

  const std::vector<ObservedView>& Views() const { return views_; }
  ViewEvidence& Evidence(size_t view) { return evidence_[view]; }

  // All views look at the same surfaces.
  std::vector<std::vector<size_t>> Neighbors() const {
    std::vector<std::vector<size_t>> neighbors(views_.size());
    for (size_t i = 0; i < views_.size(); ++i) {
      for (size_t j = 0; j < views_.size(); ++j) {
        if (i != j) {
          neighbors[i].push_back(j);
        }
      }
    }
    return neighbors;
  }

 private:
  std::vector<ViewEvidence> evidence_;
  std::vector<ObservedView> views_;
};

}  // namespace tsar
