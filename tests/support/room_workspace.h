// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene/evidence/scene_model.h"

#include <filesystem>

#include <Eigen/Geometry>

namespace tsar {

// A refined workspace of an empty room of 5 x 2.5 x 4 (x, y, z; y points down)
// that eight cameras in its corners see completely. Its planes: floor, ceiling,
// the walls at x = 0, x = 5, z = 0 and z = 4, and one that no image shows. The
// last wall has a window from (1.5, -0.6) to (3, 0.5), in which nothing is
// known.
struct RoomWorkspace {
  static constexpr int kWidth = 320;
  static constexpr int kHeight = 240;
  static constexpr int kNumImages = 8;
  enum { kFloor, kCeiling, kLeft, kRight, kFront, kBack, kUnseen, kNumPlanes };

  explicit RoomWorkspace(const std::filesystem::path& root);

  // Makes the workspace; the room's coordinates are moved to the world's by
  // `pose`. Every fourth column of the maps is interpolated, the rest measured.
  void Write() const;
  // The model without the file's views.
  SceneModel Model() const;
  // In the world.
  Eigen::Vector3d Point(double x, double y, double z) const {
    return pose * Eigen::Vector3d(x, y, z);
  }

  std::filesystem::path root;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  // This many of a thousand pixels get a random label.
  int num_wrong_per_mille = 0;
};

}  // namespace tsar
