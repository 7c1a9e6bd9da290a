// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/fusion/fusion_options.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"

namespace tsar {
namespace {

void Require(bool condition, const char* option, const std::string& range) {
  if (!condition) {
    throw Error(ErrorCode::kBadOption,
                OptionName(option) + " has to be " + range);
  }
}

}  // namespace

void FusionOptions::Check() const {
  Require(min_num_views >= 1 && min_num_views <= kMaxFusionSources + 1,
          "min_num_views",
          "from 1 to " + std::to_string(kMaxFusionSources + 1));
  Require(max_reproj_error > 0.0, "max_reproj_error", "above 0");
  // Above, no relative error could exceed four times this to contradict.
  Require(max_depth_error > 0.0 && max_depth_error < 0.25,
          "max_depth_error",
          "above 0 and below 0.25");
  Require(max_normal_error > 0.0 && max_normal_error < 90.0,
          "max_normal_error",
          "above 0 and below 90");
  Require(check_num_images >= 1 && check_num_images <= kMaxFusionSources,
          "check_num_images",
          "from 1 to " + std::to_string(kMaxFusionSources));
  Require(point_spacing >= 1 && point_spacing <= kMaxPointSpacing,
          "point_spacing",
          "from 1 to " + std::to_string(kMaxPointSpacing));
  Require(min_num_views <= check_num_images + 1,
          "min_num_views",
          "no more than one more than " + OptionName("check_num_images"));
}

const std::vector<std::string>& FusionPresetNames() {
  static const std::vector<std::string> names = {"default", "paper"};
  return names;
}

FusionOptions PresetFusionOptions(const std::string& name) {
  FusionOptions options;
  if (name == "default") {
    return options;
  }
  Require(name == "paper", "preset", "default or paper");
  options.reject_contradicted = false;
  options.min_num_views = 3;
  options.weights_depths = false;
  options.point_spacing = 1;
  return options;
}

}  // namespace tsar
