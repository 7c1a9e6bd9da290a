// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/cli/name_suggestion.h"

#include <gtest/gtest.h>

namespace tsar {
namespace {

using Names = std::vector<std::string>;

TEST(EditDistance, CountsInsertionsDeletionsAndReplacements) {
  EXPECT_EQ(EditDistance("", ""), 0);
  EXPECT_EQ(EditDistance("", "abc"), 3);
  EXPECT_EQ(EditDistance("abc", "abc"), 0);
  EXPECT_EQ(EditDistance("kitten", "sitting"), 3);
  EXPECT_EQ(EditDistance("sitting", "kitten"), 3);
}

TEST(SuggestNames, PutsTheNearestFirst) {
  const Names names = {"num_threads", "num_thread", "cache_size"};
  EXPECT_EQ(SuggestNames("num_threat", names),
            (Names{"num_thread", "num_threads"}));
}

TEST(SuggestNames, FindsANameWhoseGroupWasForgotten) {
  EXPECT_EQ(SuggestNames("device", {"TsarRefine.device", "workspace_path"}),
            Names{"TsarRefine.device"});
}

TEST(SuggestNames, SuggestsNothingForANameLikeNoOther) {
  EXPECT_TRUE(SuggestNames("zzzzzz", {"device", "workspace_path"}).empty());
}

TEST(SuggestNames, SuggestsAtMostThree) {
  EXPECT_EQ(SuggestNames("a", {"b", "c", "d", "e"}), (Names{"b", "c", "d"}));
}

}  // namespace
}  // namespace tsar
