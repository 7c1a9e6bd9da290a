// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

// A wall along an axis of a Manhattan frame, seen by cameras in front of it.

#include "colmap_tsar/scene/evidence/observed_view.h"
#include "colmap_tsar/scene/evidence/scene_model.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "tests/support/pixel_mean.h"
#include "tests/support/scene_model_testing.h"
#include "tests/support/synthetic_observations.h"
#include "tests/support/synthetic_scene.h"
#include <gtest/gtest.h>

namespace tsar {

// The frame is that of the world, x to the right, y down. The wall is the
// model's only plane at first. One pixel spans 1 / 24 of a unit on it.
class DrawnWallTest : public testing::Test {
 protected:
  static constexpr int kWidth = 160;
  static constexpr int kHeight = 120;
  static constexpr int kSuperpixelSize = 10;
  static constexpr int kNumColumns = kWidth / kSuperpixelSize;
  static constexpr int kNumSuperpixels =
      kNumColumns * kHeight / kSuperpixelSize;
  static constexpr double kDistance = 5.0;
  static constexpr double kPixel = kDistance / 120.0;

  DrawnWallTest() {
    model_.frames.push_back(Eigen::Matrix3d::Identity());
    AddPlane({0.0, 0.0, -1.0}, {0.0, 0.0, kDistance}, 2, 1000.0);
  }

  // axis: that of its normal. Returns its number.
  int AddPlane(const Eigen::Vector3d& normal,
               const Eigen::Vector3d& center,
               int axis,
               double support) {
    return AddAlignedPlane(normal, center, axis, support, &model_);
  }

  // Looks a little up or down; a line along the wall's x is a row.
  static Camera CameraAt(const Eigen::Vector3d& center) {
    Camera camera =
        CameraLookingAt(center, {center.x(), 0.1, center.z() + kDistance});
    camera.width = kWidth;
    camera.height = kHeight;
    camera.fx = camera.fy = 120.0;
    camera.cx = 0.5 * kWidth;
    camera.cy = 0.5 * kHeight;
    return camera;
  }

  // Where the ray through a pixel meets the wall.
  static Eigen::Vector3d OnWall(const Camera& camera, double x, double y) {
    const Eigen::Vector3d ray =
        camera.rotation.transpose() *
        Eigen::Vector3d(
            (x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy, 1.0);
    const Eigen::Vector3d center = camera.Center();
    return center + (kDistance - center.z()) / ray.z() * ray;
  }

  // An image of one brightness in which nothing was measured, with square
  // superpixels.
  static ViewEvidence BareEvidence(const Camera& camera) {
    ViewEvidence evidence;
    evidence.width = kWidth;
    evidence.height = kHeight;
    evidence.intrinsics = camera.GetIntrinsics();
    evidence.resolution.error_per_depth = 0.001f;
    evidence.superpixels =
        SquareSuperpixels<uint16_t>(kWidth, kHeight, kSuperpixelSize);
    evidence.weights.resize(kNumSuperpixels, 0.f);
    evidence.first_observation.resize(kNumSuperpixels + 1, 0);
    evidence.gray = Image<uint8_t>(kWidth, kHeight, 100);
    return evidence;
  }

  static int SuperpixelAt(int x, int y) {
    return y / kSuperpixelSize * kNumColumns + x / kSuperpixelSize;
  }

  // level: the gray level of each point of the wall. Pixels have the mean of
  // what they cover.
  static void Paint(
      const Camera& camera,
      const std::function<double(const Eigen::Vector3d& point)>& level,
      ViewEvidence* evidence) {
    constexpr int kSamples = 4;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const auto sample = [&](int i, int j) {
          return level(OnWall(camera,
                              x + (i + 0.5) / kSamples - 0.5,
                              y + (j + 0.5) / kSamples - 0.5));
        };
        evidence->gray(x, y) = static_cast<uint8_t>(
            std::clamp(std::lround(PixelMean<kSamples>(sample)), 0l, 255l));
      }
    }
  }

  struct Depth {
    double z = 0.0;  // 0: none.
    bool is_measured = true;
  };

  // depth: of the ray that meets the wall at this point. Every second column
  // and row is an observation, of confidence 0.5.
  static void Measure(
      const Camera& camera,
      const std::function<Depth(const Eigen::Vector3d& point)>& depth,
      ViewEvidence* evidence) {
    evidence->observations.clear();
    evidence->sources.clear();
    const Intrinsics intrinsics = camera.GetIntrinsics();
    for (int s = 0; s < kNumSuperpixels; ++s) {
      evidence->first_observation[s] =
          static_cast<int>(evidence->observations.size());
      int count = 0;
      for (int i = 0; i < kSuperpixelSize * kSuperpixelSize / 4; ++i) {
        constexpr int kHalf = kSuperpixelSize / 2;
        const int x = s % kNumColumns * kSuperpixelSize + 2 * (i % kHalf);
        const int y = s / kNumColumns * kSuperpixelSize + 2 * (i / kHalf);
        const Depth of_pixel = depth(OnWall(camera, x, y));
        if (of_pixel.z > 0.0) {
          const Vec3f ray =
              intrinsics.Ray(static_cast<float>(x), static_cast<float>(y));
          evidence->observations.push_back(
              {{ray.x, ray.y, static_cast<float>(of_pixel.z)}, 0.5f});
          evidence->sources.push_back(of_pixel.is_measured
                                          ? ObservationSource::kMeasured
                                          : ObservationSource::kRegionPlane);
          ++count;
        }
      }
      evidence->weights[s] = 4.f * 0.5f * count;
    }
    evidence->first_observation[kNumSuperpixels] =
        static_cast<int>(evidence->observations.size());
  }

  // In the camera, of a point.
  static double DepthOf(const Camera& camera, const Eigen::Vector3d& point) {
    return (camera.rotation * point + camera.translation).z();
  }

  static std::vector<int> AllOn(int plane) {
    return std::vector<int>(kNumSuperpixels, plane);
  }

  // From the superpixels whose middle shows the wall above this height.
  static void RelabelAbove(double y,
                           const Camera& camera,
                           int label,
                           std::vector<int>* labels) {
    for (int s = 0; s < kNumSuperpixels; ++s) {
      const double middle_x = (s % kNumColumns + 0.5) * kSuperpixelSize - 0.5;
      const double middle_y = (s / kNumColumns + 0.5) * kSuperpixelSize - 0.5;
      if (OnWall(camera, middle_x, middle_y).y() < y) {
        (*labels)[s] = label;
      }
    }
  }

  SceneModel model_;
};

}  // namespace tsar
