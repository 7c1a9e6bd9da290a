// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/random.h"
#include "colmap_tsar/scene_planes/discover_planes.h"
#include "colmap_tsar/scene_planes/view_evidence.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace tsar {

// What a ray from a point shows, in grey levels. World frame, z upwards.
using DrawnScene = std::function<double(const Eigen::Vector3d& from,
                                        const Eigen::Vector3d& direction)>;

// A bare column before a bare background.
struct DrawnColumn {
  static constexpr double kBackground = 90.0;
  static constexpr double kColumn = 160.0;

  Eigen::Vector2d center = {0.1, 3.0};
  double radius = 0.25;
  double bottom = -0.6;
  double top = 0.7;

  double operator()(const Eigen::Vector3d& from,
                    const Eigen::Vector3d& direction) const {
    const Eigen::Vector2d across = direction.head<2>();
    const Eigen::Vector2d to_center = center - from.head<2>();
    const double along = to_center.dot(across) / across.norm();
    const double beside = to_center.squaredNorm() - along * along;
    if (!(beside < radius * radius)) {
      return kBackground;
    }
    const double distance =
        (along - std::sqrt(radius * radius - beside)) / across.norm();
    const double height = from.z() + distance * direction.z();
    return height > bottom && height < top ? kColumn : kBackground;
  }
};

// Upright walls between corners, seen from above; as high as the column.
struct DrawnWalls {
  std::vector<Eigen::Vector2d> corners;

  double operator()(const Eigen::Vector3d& from,
                    const Eigen::Vector3d& direction) const {
    for (size_t i = 0; i + 1 < corners.size(); ++i) {
      Eigen::Matrix2d system;
      system << direction.head<2>(), corners[i] - corners[i + 1];
      const Eigen::Vector2d solution =
          system.inverse() * (corners[i] - from.head<2>());
      const double height = from.z() + solution.x() * direction.z();
      if (solution.x() > 0.0 && solution.y() >= 0.0 && solution.y() <= 1.0 &&
          height > DrawnColumn().bottom && height < DrawnColumn().top) {
        return DrawnColumn::kColumn;
      }
    }
    return DrawnColumn::kBackground;
  }
};

// Views of it from an arc of almost a radian around (0, 3), at a distance of 3.
class DrawnViews {
 public:
  static constexpr int kWidth = 240;
  static constexpr int kHeight = 180;
  static constexpr double kFocal = 220.0;

  // rotation: of the whole scene with its cameras. noise: its greatest value,
  // in grey levels. scale: by which the scene is larger than it is drawn.
  DrawnViews(const DrawnScene& scene,
             int num_views,
             const Eigen::Matrix3d& rotation = Eigen::Matrix3d::Identity(),
             double noise = 0.0,
             double scale = 1.0)
      : evidence_(static_cast<size_t>(num_views)) {
    Philox random(7, 0, 0);
    for (int i = 0; i < num_views; ++i) {
      const double angle = 0.9 * (i / (num_views - 1.0) - 0.5);
      const Eigen::Vector3d from(3.0 * std::sin(angle),
                                 3.0 - 3.0 * std::cos(angle),
                                 0.1 * (i % 3 - 1));
      // Not all of them look at the middle.
      const Eigen::Vector3d to(0.15 * (i % 3 - 1), 3.0, 0.05 * (i % 2));
      Camera camera = Look(from, to);
      ViewEvidence& evidence = evidence_[static_cast<size_t>(i)];
      Draw(scene, camera, noise, &random, &evidence);
      camera.rotation = camera.rotation * rotation.transpose();
      camera.translation *= scale;
      evidence.intrinsics = camera.GetIntrinsics();
      views_.push_back({&evidence, camera});
    }
  }
  DrawnViews(const DrawnViews&) = delete;

  const std::vector<ObservedView>& Views() const { return views_; }
  ViewEvidence& Evidence(size_t view) { return evidence_[view]; }

  // Every view looks at what the others look at.
  std::vector<std::vector<size_t>> Neighbours() const {
    std::vector<std::vector<size_t>> neighbours(views_.size());
    for (size_t i = 0; i < views_.size(); ++i) {
      for (size_t j = 0; j < views_.size(); ++j) {
        if (i != j) {
          neighbours[i].push_back(j);
        }
      }
    }
    return neighbours;
  }

 private:
  static Camera Look(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    Camera camera;
    camera.width = kWidth;
    camera.height = kHeight;
    camera.fx = camera.fy = kFocal;
    camera.cx = 0.5 * (kWidth - 1);
    camera.cy = 0.5 * (kHeight - 1);
    const Eigen::Vector3d forward = (to - from).normalized();
    const Eigen::Vector3d right =
        forward.cross(Eigen::Vector3d::UnitZ()).normalized();
    camera.rotation.row(0) = right;
    camera.rotation.row(1) = forward.cross(right);
    camera.rotation.row(2) = forward;
    camera.translation = -camera.rotation * from;
    return camera;
  }

  static void Draw(const DrawnScene& scene,
                   const Camera& camera,
                   double noise,
                   Philox* random,
                   ViewEvidence* evidence) {
    constexpr int kSamples = 4;  // Per pixel and direction.
    evidence->width = kWidth;
    evidence->height = kHeight;
    evidence->resolution.error_per_depth = 0.001f;
    evidence->confident_depth = Image<float>(kWidth, kHeight);
    evidence->superpixels = Image<uint16_t>(kWidth, kHeight);
    evidence->color = Image<Rgb>(kWidth, kHeight);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        double sum = 0.0;
        for (int k = 0; k < kSamples * kSamples; ++k) {
          const double column = x - 0.5 + (k % kSamples + 0.5) / kSamples;
          const double row = y - 0.5 + (k / kSamples + 0.5) / kSamples;
          const Eigen::Vector3d ray((column - camera.cx) / camera.fx,
                                    (row - camera.cy) / camera.fy,
                                    1.0);
          sum += scene(camera.Center(), camera.rotation.transpose() * ray);
        }
        const double gray = sum / (kSamples * kSamples) +
                            noise * (2.0 * random->NextFloat() - 1.0);
        const auto level =
            static_cast<uint8_t>(std::lround(std::clamp(gray, 0.0, 255.0)));
        evidence->color(x, y) = {level, level, level};
      }
    }
  }

  std::vector<ViewEvidence> evidence_;
  std::vector<ObservedView> views_;
};

}  // namespace tsar
