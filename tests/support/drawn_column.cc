// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "tests/support/drawn_column.h"

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/random.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "tests/support/pixel_mean.h"
#include <Eigen/Geometry>

namespace tsar {
namespace {

Camera Look(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  Camera camera;
  camera.width = DrawnViews::kWidth;
  camera.height = DrawnViews::kHeight;
  camera.fx = camera.fy = DrawnViews::kFocal;
  camera.cx = 0.5 * (DrawnViews::kWidth - 1);
  camera.cy = 0.5 * (DrawnViews::kHeight - 1);
  const Eigen::Vector3d forward = (to - from).normalized();
  const Eigen::Vector3d right =
      forward.cross(Eigen::Vector3d::UnitZ()).normalized();
  camera.rotation.row(0) = right;
  camera.rotation.row(1) = forward.cross(right);
  camera.rotation.row(2) = forward;
  camera.translation = -camera.rotation * from;
  return camera;
}

void Draw(const DrawnScene& scene,
          const Camera& camera,
          double noise,
          Philox* random,
          ViewEvidence* evidence) {
  constexpr int kSamples = 4;  // Per pixel and direction.
  const Eigen::Vector3d center = camera.Center();
  const Eigen::Matrix3d to_world = camera.rotation.transpose();
  evidence->width = camera.width;
  evidence->height = camera.height;
  evidence->resolution.error_per_depth = 0.001f;
  evidence->confident_depth = Image<float>(camera.width, camera.height);
  evidence->superpixels = Image<uint16_t>(camera.width, camera.height);
  evidence->color = Image<Rgb>(camera.width, camera.height);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const auto sample = [&](int i, int j) {
        const double column = x - 0.5 + (i + 0.5) / kSamples;
        const double row = y - 0.5 + (j + 0.5) / kSamples;
        const Eigen::Vector3d ray((column - camera.cx) / camera.fx,
                                  (row - camera.cy) / camera.fy,
                                  1.0);
        return scene(center, to_world * ray);
      };
      const double gray = PixelMean<kSamples>(sample) +
                          noise * (2.0 * random->NextFloat() - 1.0);
      const auto level =
          static_cast<uint8_t>(std::lround(std::clamp(gray, 0.0, 255.0)));
      evidence->color(x, y) = {level, level, level};
    }
  }
}

}  // namespace

double DrawnColumn::operator()(const Eigen::Vector3d& from,
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

double DrawnWalls::operator()(const Eigen::Vector3d& from,
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

DrawnViews::DrawnViews(const DrawnScene& scene,
                       int num_views,
                       const Eigen::Matrix3d& rotation,
                       double noise,
                       double scale)
    : evidence_(static_cast<size_t>(num_views)) {
  Philox random(7, 0, 0);
  for (int i = 0; i < num_views; ++i) {
    const double angle = 0.9 * (i / (num_views - 1.0) - 0.5);
    const Eigen::Vector3d from(
        3.0 * std::sin(angle), 3.0 - 3.0 * std::cos(angle), 0.1 * (i % 3 - 1));
    // Not all of them look at the middle.
    const Eigen::Vector3d to(0.15 * (i % 3 - 1), 3.0, 0.05 * (i % 2));
    Camera camera = Look(from, to);
    ViewEvidence& evidence = evidence_[i];
    Draw(scene, camera, noise, &random, &evidence);
    camera.rotation = camera.rotation * rotation.transpose();
    camera.translation *= scale;
    evidence.intrinsics = camera.GetIntrinsics();
    views_.push_back({&evidence, camera});
  }
}

}  // namespace tsar
