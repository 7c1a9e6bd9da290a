// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

// Drawn views to be refined, and checks of the maps.

#include "colmap_tsar/compose/compose_image.h"
#include "colmap_tsar/view/refine_option_list.h"

#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/find_scene_in.h"
#include "tests/support/image_evidence.h"
#include "tests/support/synthetic_views.h"
#include "tests/support/test_device.h"
#include <gtest/gtest.h>

namespace tsar {

class SyntheticViewsTest : public testing::Test {
 protected:
  SyntheticViewsTest()
      : device_(CreateTestDevice(2)), drawn_(MakeSyntheticViews({})) {}

  float RelativeError(const Image<float>& depth, int x, int y) const {
    return std::abs(depth(x, y) / drawn_.truth(x, y) - 1.f);
  }
  // Depths of the first view, which is the reference.
  const Image<float>& Before() const { return drawn_.views[0].depth; }
  bool IsBare(int x, int y) const {
    return SyntheticViews::IsBare(
        drawn_.views[0].camera.GetIntrinsics().Ray(x, y));
  }
  // Evidence of the first num_views views, with all others as their sources.
  std::vector<std::unique_ptr<ViewEvidence>> Observe(
      size_t num_views, const RefineOptions& options = {}) const {
    std::vector<std::unique_ptr<ViewEvidence>> evidence;
    for (size_t i = 0; i < num_views; ++i) {
      std::vector<const ViewData*> sources;
      for (const ViewData& view : drawn_.views) {
        if (&view != &drawn_.views[i]) {
          sources.push_back(&view);
        }
      }
      RefineResult result = MakeImageEvidence(drawn_.views[i],
                                              UploadViews(sources, *device_),
                                              static_cast<uint32_t>(i),
                                              options,
                                              *device_);
      EXPECT_TRUE(result.maps.depth.Empty());
      evidence.push_back(std::move(result.evidence));
    }
    return evidence;
  }
  RefineResult Compose(
      const std::vector<std::unique_ptr<ViewEvidence>>& evidence,
      const RefineOptions& options = {}) const {
    std::vector<ObservedView> views;
    for (size_t i = 0; i < evidence.size(); ++i) {
      views.push_back(MakeObservedView(*evidence[i], drawn_.views[i].camera));
    }
    return ComposeImage(drawn_.views[0],
                        views,
                        FindSceneIn(views, options, *device_),
                        options,
                        *device_);
  }
  // Checks that hold with any options.
  void ExpectSoundMaps(const RefinedMaps& maps) const {
    ASSERT_TRUE(maps.depth.HasSizeOf(Before()));
    const Intrinsics intrinsics = drawn_.views[0].camera.GetIntrinsics();
    for (int y = 0; y < maps.depth.Height(); ++y) {
      for (int x = 0; x < maps.depth.Width(); ++x) {
        const float depth = maps.depth(x, y);
        const Vec3f& normal = maps.normal(x, y);
        ASSERT_TRUE(std::isfinite(depth) && depth >= 0.f) << x << ", " << y;
        ASSERT_EQ(maps.confidence(x, y) > 0, depth > 0.f) << x << ", " << y;
        ASSERT_EQ(maps.provenance(x, y) != 0, depth > 0.f) << x << ", " << y;
        if (depth > 0.f) {
          ASSERT_NEAR(Norm(normal), 1.f, 1e-4f) << x << ", " << y;
          ASSERT_LT(Dot(normal, intrinsics.Ray(x, y)), 0.f) << x << ", " << y;
        } else {
          ASSERT_EQ(normal, Vec3f{}) << x << ", " << y;
        }
      }
    }
  }
  // Checks that the part without texture gets the wall's plane.
  void ExpectBarePartIsFilled(const RefinedMaps& maps) const {
    int num_bare = 0;
    int num_right = 0;
    for (int y = 0; y < maps.depth.Height(); ++y) {
      for (int x = 0; x < maps.depth.Width(); ++x) {
        if (IsBare(x, y)) {
          ++num_bare;
          num_right +=
              RelativeError(maps.depth, x, y) < 5e-3f &&
                      AngleBetween(maps.normal(x, y), drawn_.wall.normal) < 2.f
                  ? 1
                  : 0;
        }
      }
    }
    ASSERT_GT(num_bare, 500);
    EXPECT_GT(num_right, 0.95 * num_bare);
  }
  // refine: called with each bool among the options inverted, except one of
  // this name.
  void ExpectSoundMapsOfEverySwitch(
      const std::function<RefineResult(const RefineOptions&)>& refine,
      const std::string& left_out = "") const {
    RefineOptions list;
    const size_t num_fields = ListRefineFields(&list).size();
    int num_switches = 0;
    for (size_t i = 0; i < num_fields; ++i) {
      RefineOptions options;
      const RefineField field = ListRefineFields(&options)[i];
      if (!std::holds_alternative<bool*>(field.value) ||
          field.name == left_out) {
        continue;
      }
      bool* value = std::get<bool*>(field.value);
      *value = !*value;
      SCOPED_TRACE(field.name);
      const RefineResult result = refine(options);
      ExpectSoundMaps(result.maps);
      EXPECT_EQ(result.reason_to_keep, "");
      ++num_switches;
    }
    EXPECT_GT(num_switches, 8);
  }
  // scale: of the depths of b, relative to those of a.
  static void ExpectSameMaps(const RefinedMaps& a,
                             const RefinedMaps& b,
                             float scale = 1.f) {
    for (size_t i = 0; i < a.depth.NumPixels(); ++i) {
      ASSERT_EQ(a.depth.Data()[i] * scale, b.depth.Data()[i]) << i;
      ASSERT_EQ(a.normal.Data()[i], b.normal.Data()[i]) << i;
      ASSERT_EQ(a.confidence.Data()[i], b.confidence.Data()[i]) << i;
      ASSERT_EQ(a.provenance.Data()[i], b.provenance.Data()[i]) << i;
    }
  }

  std::unique_ptr<Device> device_;
  SyntheticViews drawn_;
};

}  // namespace tsar
