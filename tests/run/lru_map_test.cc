// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/lru_map.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace tsar {
namespace {

bool Always(const std::string&) { return true; }

class LruMapTest : public testing::Test {
 protected:
  LruMapTest() {
    for (const int key : {1, 2, 3}) {
      map_.Add(key, "value " + std::to_string(key));
    }
  }
  // From the one that was used longest ago on.
  std::vector<std::string> TakeAll() {
    std::vector<std::string> values;
    while (const auto value = map_.TakeOldest(Always)) {
      values.push_back(*value);
    }
    return values;
  }

  LruMap<int, std::string> map_;
};

TEST_F(LruMapTest, TakesTheOneUsedLongestAgo) {
  EXPECT_EQ(map_.Size(), 3u);
  EXPECT_EQ(*map_.Use(1), "value 1");
  EXPECT_EQ(map_.Use(4), nullptr);
  EXPECT_EQ(TakeAll(),
            std::vector<std::string>({"value 2", "value 3", "value 1"}));
  EXPECT_EQ(map_.Size(), 0u);
  EXPECT_EQ(map_.Find(1), nullptr);
}

TEST_F(LruMapTest, FindingIsNotUsing) {
  *map_.Find(1) = "changed";
  EXPECT_EQ(map_.Find(4), nullptr);
  EXPECT_EQ(*map_.TakeOldest(Always), "changed");
}

TEST_F(LruMapTest, PassesOverWhatMayNotGo) {
  const auto may_go = [](const std::string& value) {
    return value != "value 1";
  };
  EXPECT_EQ(*map_.TakeOldest(may_go), "value 2");
  EXPECT_EQ(*map_.TakeOldest(may_go), "value 3");
  EXPECT_FALSE(map_.TakeOldest(may_go));
  EXPECT_EQ(TakeAll(), std::vector<std::string>({"value 1"}));
}

TEST_F(LruMapTest, ErasesOne) {
  map_.Erase(2);
  EXPECT_EQ(map_.Find(2), nullptr);
  map_.Add(2, "another");
  EXPECT_EQ(TakeAll(),
            std::vector<std::string>({"value 1", "value 3", "another"}));
}

TEST(LruMap, HoldsWhatCanOnlyBeMoved) {
  LruMap<std::string, std::unique_ptr<int>> map;
  map.Add("one", std::make_unique<int>(1));
  std::unique_ptr<int>* held = map.Use("one");
  map.Add("two", std::make_unique<int>(2));
  EXPECT_EQ(**held, 1);
  const auto taken =
      map.TakeOldest([](const std::unique_ptr<int>&) { return true; });
  EXPECT_EQ(**taken, 1);
}

}  // namespace
}  // namespace tsar
