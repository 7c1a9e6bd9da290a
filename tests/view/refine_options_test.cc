// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/view/refine_option_list.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <utility>

#include <gtest/gtest.h>

namespace tsar {
namespace {

size_t RoundUp(size_t value, size_t unit) {
  return (value + unit - 1) / unit * unit;
}

// A member that is missing in the list leaves a gap that alignment does not
// explain.
TEST(RefineFields, CoverTheWholeStruct) {
  RefineOptions options;
  const auto* begin = reinterpret_cast<const char*>(&options);
  std::vector<std::pair<size_t, size_t>> members;
  for (const RefineField& field : ListRefineFields(&options)) {
    std::visit(
        [&](const auto* value) {
          members.emplace_back(
              static_cast<size_t>(reinterpret_cast<const char*>(value) - begin),
              sizeof(*value));
        },
        field.value);
  }
  std::sort(members.begin(), members.end());
  size_t end = 0;
  for (const auto& [offset, size] : members) {
    EXPECT_EQ(offset, RoundUp(end, size));
    end = offset + size;
  }
  EXPECT_EQ(sizeof(RefineOptions), RoundUp(end, alignof(RefineOptions)));
}

TEST(RefineFields, HaveNamesDescriptionsAndDefaultsInRange) {
  RefineOptions options;
  std::set<std::string> names;
  for (const RefineField& field : ListRefineFields(&options)) {
    EXPECT_TRUE(names.insert(field.name).second) << field.name;
    EXPECT_EQ(field.description.back(), '.') << field.name;
  }
  EXPECT_NO_THROW(RefineOptions().Check());
  EXPECT_NO_THROW(PresetOptions(RefinePreset::kPaper).Check());
}

// S_sp, kappa and upsilon as printed, on a map 3110 wide with its raster of
// 777.
TEST(RefineOptions, TakeTheSizesThatThePaperPrints) {
  RefineOptions options = PresetOptions(RefinePreset::kPaper);
  options.superpixel_size = 400 / 16;
  options.min_region_size = 8000 / 16;
  options.hough_max_gap = 4;  // 3.75
  EXPECT_NO_THROW(options.Check());
}

TEST(RefineOptions, CheckNamesTheOption) {
  RefineOptions options;
  options.min_aggregated_score = std::numeric_limits<double>::quiet_NaN();
  try {
    options.Check();
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.Code(), ErrorCode::kBadOption);
    EXPECT_NE(std::string(error.what()).find("min_aggregated_score"),
              std::string::npos);
  }
}

TEST(HashRefineOptions, ChangesWithEveryField) {
  std::set<std::string> hashes = {HashRefineOptions({})};
  EXPECT_EQ(HashRefineOptions({}), *hashes.begin());
  const size_t num_fields = [] {
    RefineOptions options;
    return ListRefineFields(&options).size();
  }();
  for (size_t i = 0; i < num_fields; ++i) {
    RefineOptions options;
    const RefineField field = ListRefineFields(&options)[i];
    std::visit(
        [](auto* value) {
          *value = static_cast<std::remove_reference_t<decltype(*value)>>(
              *value == 0 ? 1 : 0);
        },
        field.value);
    EXPECT_TRUE(hashes.insert(HashRefineOptions(options)).second) << field.name;
  }
}

}  // namespace
}  // namespace tsar
