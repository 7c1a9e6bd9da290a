// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/fusion/fusion_options.h"

#include "tests/support/test_workspace.h"

namespace tsar {
namespace {

TEST(FusionOptionsTest, PresetsAreValidAndThePapersIsAsPrinted) {
  for (const std::string& name : FusionPresetNames()) {
    PresetFusionOptions(name).Check();
  }
  const FusionOptions paper = PresetFusionOptions("paper");
  EXPECT_EQ(paper.max_depth_error, 0.01);
  EXPECT_EQ(paper.max_normal_error, 30.0);
  EXPECT_EQ(paper.max_reproj_error, 2.0);
  EXPECT_EQ(paper.min_num_views, 3);
  EXPECT_FALSE(paper.weights_depths);
  EXPECT_FALSE(paper.reject_contradicted);
  ExpectError(ErrorCode::kBadOption, {"preset", "default or paper"}, [] {
    PresetFusionOptions("pape");
  });
}

TEST(FusionOptionsTest, EveryLimitIsChecked) {
  const auto expect_bad = [](const std::string& name,
                             void (*change)(FusionOptions*)) {
    FusionOptions options;
    change(&options);
    ExpectError(ErrorCode::kBadOption, {name}, [&] { options.Check(); });
  };
  expect_bad("min_num_views", [](FusionOptions* o) { o->min_num_views = 0; });
  expect_bad("max_reproj_error",
             [](FusionOptions* o) { o->max_reproj_error = 0.0; });
  expect_bad("max_depth_error",
             [](FusionOptions* o) { o->max_depth_error = 1.0; });
  expect_bad("max_normal_error",
             [](FusionOptions* o) { o->max_normal_error = 90.0; });
  expect_bad("check_num_images",
             [](FusionOptions* o) { o->check_num_images = 65; });
  expect_bad("point_spacing", [](FusionOptions* o) { o->point_spacing = 0; });
}

}  // namespace
}  // namespace tsar
