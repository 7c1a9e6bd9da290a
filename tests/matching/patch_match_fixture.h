// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

// A drawn plane for which PatchMatch looks.

#include "colmap_tsar/matching/patch_match.h"
#include "colmap_tsar/matching/plane_maps.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/matching/textured_plane.h"
#include "tests/support/for_each_pixel.h"
#include "tests/support/same_bytes.h"
#include "tests/support/test_device.h"
#include <gtest/gtest.h>

namespace tsar {

constexpr int kWidth = 64;
constexpr int kHeight = 48;
constexpr int kMargin = 8;
constexpr float kMaxCost = 2.f;
constexpr Vec3f kTilt = {0.3f, -0.2f, -1.f};
constexpr Vec3f kSlant = {1.f, 0.3f, -1.f};

struct HostHypotheses {
  Image<Plane> planes;
  Image<float> costs;
};

// How close planes are to the truth, over the pixels away from the border.
struct Accuracy {
  float share = 0.f;  // Of pixels whose depth is right to half a percent.
  float median_depth_error = 0.f;   // As a fraction of depth.
  float median_normal_error = 0.f;  // In degrees.
};

class PatchMatchTest : public testing::Test {
 protected:
  PatchMatchTest()
      : device_(CreateTestDevice(2)),
        camera_(SyntheticCamera(kWidth, kHeight, 100.0)),
        intrinsics_(camera_.GetIntrinsics()) {
    options_.depth_min = 1.5f;
    options_.depth_max = 6.f;
  }

  TexturedPlane BareScene(const Vec3f& direction) {
    return TexturedPlane(DrawnPlane(direction, 3.f), camera_, *device_);
  }
  // Seen by four sources that have depth maps.
  TexturedPlane Scene(const Vec3f& direction) {
    TexturedPlane scene = BareScene(direction);
    AddSources(&scene);
    return scene;
  }
  void AddSources(TexturedPlane* scene) {
    for (const double sign : {-1.0, 1.0}) {
      scene->AddSource(
          SourceCamera(camera_, {0.5 * sign, 0.0, 0.0}, -0.15 * sign));
      scene->AddSource(SourceCamera(camera_, {0.1, 0.4 * sign, 0.0}, 0.0));
    }
  }
  // The sources of a scene without their depth maps, with all lengths scaled.
  SourceViews Images(TexturedPlane& scene, float scale = 1.f) {
    std::vector<SourceView> sources = scene.HostSources();
    for (SourceView& source : sources) {
      source.depth = {};
      source.from_reference.translation =
          source.from_reference.translation * scale;
    }
    return SourceViews(*device_, sources);
  }

  DeviceImage<Plane> Draw(uint32_t stream = 1) {
    return DrawPlanes(intrinsics_, kWidth, kHeight, stream, options_, *device_);
  }
  DeviceImage<Plane> TruePlanes(const TexturedPlane& scene) {
    const ReferenceView reference = scene.Reference();
    return PlanesFromMaps(
        intrinsics_, reference.depth, reference.normal, *device_);
  }
  HostHypotheses Run(const TexturedPlane& scene,
                     const SourceViews& sources,
                     DeviceImage<Plane> planes,
                     uint32_t stream = 1,
                     ImageView<const uint8_t> keeps_plane = {}) {
    ReferenceView reference = scene.Reference();
    reference.depth = {};
    reference.normal = {};
    const PlaneHypotheses hypotheses =
        RunPatchMatch({reference, sources, stream, keeps_plane},
                      std::move(planes),
                      options_,
                      *device_);
    return {hypotheses.planes.ToHost(), hypotheses.costs.ToHost()};
  }

  Accuracy Compare(TexturedPlane& scene, const Image<Plane>& planes) const {
    std::vector<float> depth_errors;
    std::vector<float> normal_errors;
    int num_near = 0;
    ForEachPixel(
        kMargin,
        kWidth - kMargin,
        kMargin,
        kHeight - kMargin,
        [&](int x, int y) {
          const float depth = planes(x, y).Depth(intrinsics_.Ray(x, y));
          depth_errors.push_back(std::abs(depth / scene.Depth()(x, y) - 1.f));
          normal_errors.push_back(
              AngleBetween(planes(x, y).normal, scene.Normal()));
          num_near += depth_errors.back() < 0.005f ? 1 : 0;
        });
    const auto median = [](std::vector<float>& errors) {
      std::nth_element(
          errors.begin(), errors.begin() + errors.size() / 2, errors.end());
      return errors[errors.size() / 2];
    };
    return {static_cast<float>(num_near) / depth_errors.size(),
            median(depth_errors),
            median(normal_errors)};
  }

  void ExpectFound(TexturedPlane& scene, const Image<Plane>& planes) const {
    const Accuracy accuracy = Compare(scene, planes);
    EXPECT_GT(accuracy.share, 0.98f);
    EXPECT_LT(accuracy.median_depth_error, 1e-3f);
    EXPECT_LT(accuracy.median_normal_error, 4.f);
  }

  std::unique_ptr<Device> device_;
  Camera camera_;
  Intrinsics intrinsics_;
  PatchMatchOptions options_;
};

}  // namespace tsar
