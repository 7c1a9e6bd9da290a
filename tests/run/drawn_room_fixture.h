// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

// The views of a drawn room, to be modeled.

#include "colmap_tsar/scene/model_scene.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <sstream>
#include <utility>
#include <vector>

#include "tests/support/synthetic_room.h"
#include <gtest/gtest.h>

namespace tsar {

inline constexpr int kFirstImage = 10;

// The images have one color. Each view is a source of all others.
class DrawnRoomTest : public testing::Test {
 protected:
  explicit DrawnRoomTest(SyntheticRoom room = SyntheticRoom())
      : room_(std::move(room)) {
    for (size_t i = 0; i < room_.evidence.size(); ++i) {
      ViewEvidence& evidence = room_.evidence[i];
      const Intrinsics intrinsics = room_.cameras[i].GetIntrinsics();
      evidence.intrinsics = intrinsics;
      evidence.noise = 0.15f;
      evidence.superpixels =
          Image<uint16_t>(SyntheticRoom::kWidth, SyntheticRoom::kHeight);
      for (int y = 0; y < SyntheticRoom::kHeight; ++y) {
        for (int x = 0; x < SyntheticRoom::kWidth; ++x) {
          evidence.superpixels(x, y) = static_cast<uint16_t>(
              y / SyntheticRoom::kSuperpixelSize * SyntheticRoom::kWidth /
                  SyntheticRoom::kSuperpixelSize +
              x / SyntheticRoom::kSuperpixelSize);
        }
      }
      evidence.color = Image<Rgb>(
          SyntheticRoom::kWidth, SyntheticRoom::kHeight, Rgb{100, 100, 100});
      evidence.gray = Image<uint8_t>(
          SyntheticRoom::kWidth, SyntheticRoom::kHeight, 100);
      evidence.confident_depth =
          Image<float>(SyntheticRoom::kWidth, SyntheticRoom::kHeight, 0.f);
      for (const WorldPlane& plane : room_.Candidates()) {
        evidence.candidates.push_back(ToCameraPlane(plane, room_.cameras[i]));
      }
      SceneView view;
      view.image = kFirstImage + static_cast<int>(i);
      view.camera = room_.cameras[i];
      for (size_t j = 0; j < room_.evidence.size(); ++j) {
        if (j != i) {
          view.sources.push_back(j);
        }
      }
      views_.push_back(view);
    }
  }

  std::optional<SceneModel> Run(
      const std::function<bool()>& should_stop = nullptr) {
    const SceneEvidence evidence = {
        [&](size_t view) {
          return std::make_shared<const ViewEvidence>(room_.evidence[view]);
        },
        [&](size_t view) { return room_.evidence[view]; }};
    text_.str("");
    Progress progress(text_, false);
    progress.SetStop(should_stop);
    return ModelScene(
        {views_, evidence, refine_options_, options_, resources_, progress});
  }

  // The number of the model's plane for this surface, or -1.
  int Find(const DrawnSurface& surface, const SceneModel& model) const {
    for (size_t i = 0; i < model.planes.size(); ++i) {
      if (AngleBetween(model.planes[i].plane, surface.plane) < 0.2 &&
          std::abs(model.planes[i].plane.Height(surface.middle)) < 0.004) {
        return static_cast<int>(i);
      }
    }
    return -1;
  }

  static void ExpectSame(const SceneModel& a, const SceneModel& b) {
    ASSERT_EQ(a.planes.size(), b.planes.size());
    for (size_t i = 0; i < a.planes.size(); ++i) {
      EXPECT_EQ(a.planes[i].plane.normal, b.planes[i].plane.normal);
      EXPECT_EQ(a.planes[i].plane.offset, b.planes[i].plane.offset);
      EXPECT_EQ(a.planes[i].covariance, b.planes[i].covariance);
      EXPECT_EQ(a.planes[i].axis, b.planes[i].axis);
    }
    ASSERT_EQ(a.frames.size(), b.frames.size());
    for (size_t i = 0; i < a.frames.size(); ++i) {
      EXPECT_EQ(a.frames[i], b.frames[i]);
    }
    ASSERT_EQ(a.views.size(), b.views.size());
    for (const auto& [image, labels] : a.views) {
      EXPECT_EQ(labels.planes, b.views.at(image).planes);
      EXPECT_EQ(labels.origins, b.views.at(image).origins);
      EXPECT_TRUE(labels.qualities == b.views.at(image).qualities);
    }
  }

  // More threads, blocks and views at a time, with room for the costs of some
  // views, and of all. Changes the resources.
  void ExpectSameWithMoreResources(const SceneModel& expected) {
    resources_.num_threads = 4;
    resources_.num_blocks = 2;
    resources_.num_views = 3;
    ExpectSame(expected, *Run());
    for (const int64_t max_kept_bytes : {int64_t{10000}, int64_t{1} << 30}) {
      resources_.max_kept_bytes = max_kept_bytes;
      ExpectSame(expected, *Run());
    }
  }

  SyntheticRoom room_;
  std::vector<SceneView> views_;
  RefineOptions refine_options_;
  ModelSceneOptions options_{.progress_prefix = "Model,"};
  ModelResources resources_;
  std::ostringstream text_;
};

}  // namespace tsar
