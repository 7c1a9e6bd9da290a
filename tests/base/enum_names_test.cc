// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/enum_names.h"

#include <gtest/gtest.h>

namespace tsar {
namespace {

enum class Fruit { kApple, kPear, kPlum };

// Not in the order of the values, and one has no name.
constexpr std::array kNames = {std::pair(Fruit::kPear, "pear"),
                               std::pair(Fruit::kApple, "apple")};

TEST(EnumNames, NamesValues) {
  EXPECT_EQ(EnumName(kNames, Fruit::kApple), "apple");
  EXPECT_EQ(EnumName(kNames, Fruit::kPear), "pear");
  EXPECT_THROW(EnumName(kNames, Fruit::kPlum), std::invalid_argument);
}

TEST(EnumNames, FindsValuesByTheirWholeNames) {
  EXPECT_EQ(FindEnumValue(kNames, "pear"), Fruit::kPear);
  EXPECT_EQ(EnumValue(kNames, "apple"), Fruit::kApple);
  for (const char* text : {"", "pea", "pears", "Pear", "plum"}) {
    EXPECT_EQ(FindEnumValue(kNames, text), std::nullopt) << text;
    EXPECT_THROW(EnumValue(kNames, text), std::invalid_argument) << text;
  }
}

}  // namespace
}  // namespace tsar
