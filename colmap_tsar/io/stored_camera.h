// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <span>
#include <string>

#include <Eigen/Core>

namespace tsar {

// The calibration that another program stored with a map, in its own units:
// x_cam = rotation * (x_world - center).
struct StoredCamera {
  std::string file;  // For messages.
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  // Intrinsics of an image whose size may be unknown.
  double fx = 1.0;
  double fy = 1.0;
  double cx = 0.0;
  double cy = 0.0;
};

// Sets `camera` from a calibration matrix and checks it. Throws Error kCorrupt,
// naming camera.file, where a value is not finite, a focal length is not
// positive, or the rotation is invalid.
void SetCalibration(const Eigen::Matrix3d& k, StoredCamera* camera);

// Reads a cams/%08d_cam.txt of MVSNet and its successors: the word "extrinsic",
// 4 x 4 numbers [R t; 0 1] with x_cam = R x + t, the word "intrinsic", 3 x 3
// numbers K; the depth ranges that follow are ignored. name: the file, for
// messages. Throws Error kCorrupt.
StoredCamera ParseCamFile(std::span<const uint8_t> bytes,
                          const std::string& name);

}  // namespace tsar
