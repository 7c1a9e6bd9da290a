// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/content_hash.h"

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace tsar {
namespace {

// The fingerprints of all workspaces hang on it.
TEST(ContentHashTest, IsXxh3) {
  ContentHash hash;
  EXPECT_EQ(hash.Value(), 0x2D06800538D394C2u);
}

TEST(ContentHashTest, DoesNotDependOnTheSplit) {
  std::string bytes;
  for (int i = 0; i < 200; ++i) {
    bytes.push_back(static_cast<char>(i * 7));
  }
  ContentHash whole;
  whole.Update(bytes.data(), bytes.size());
  for (size_t step : {1u, 3u, 31u, 32u, 33u, 100u}) {
    ContentHash parts;
    for (size_t i = 0; i < bytes.size(); i += step) {
      parts.Update(bytes.data() + i, std::min(step, bytes.size() - i));
    }
    EXPECT_EQ(parts.Value(), whole.Value()) << step;
  }
}

TEST(ContentHashTest, NothingChangesNothing) {
  ContentHash hash;
  hash.Update(nullptr, 0);
  EXPECT_EQ(hash.Value(), ContentHash().Value());
  ContentHash expected;
  for (ContentHash* either : {&hash, &expected}) {
    either->Update("12345", 5);
  }
  // Also between two parts of a block.
  hash.Update(nullptr, 0);
  EXPECT_EQ(hash.Value(), expected.Value());
  for (ContentHash* either : {&hash, &expected}) {
    either->Update("6789", 4);
  }
  EXPECT_EQ(hash.Value(), expected.Value());
}

TEST(ContentHashTest, SeesEveryByteAndTheLength) {
  const std::string bytes(77, '\0');
  std::vector<uint64_t> values;
  for (size_t i = 0; i < bytes.size(); ++i) {
    std::string changed = bytes;
    changed[i] = 1;
    ContentHash hash;
    hash.Update(changed.data(), changed.size());
    values.push_back(hash.Value());
    ContentHash shorter;
    shorter.Update(bytes.data(), i);
    values.push_back(shorter.Value());
  }
  std::sort(values.begin(), values.end());
  EXPECT_EQ(std::adjacent_find(values.begin(), values.end()), values.end());
}

}  // namespace
}  // namespace tsar
