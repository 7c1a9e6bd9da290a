// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/written_map.h"

#include "colmap_tsar/base/content_hash.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/io/map_io.h"

#include <chrono>
#include <stdexcept>

#include "tests/support/test_workspace.h"

namespace tsar {
namespace {

class WrittenMapTest : public testing::Test {
 protected:
  void SetUp() override {
    WriteDepthMap(UserPath(path_), Image<float>(20, 20, 3.f));
    map_ = DescribeMap(path_);
  }
  // Another value at a place that is no sample.
  void Edit() const {
    std::string bytes = ReadText(path_);
    bytes.back() ^= 1;
    WriteText(path_, bytes);
    ASSERT_EQ(ReadSamples(path_), map_.samples);
  }
  void SetTime(int64_t nanoseconds) const {
    std::filesystem::last_write_time(
        path_,
        std::filesystem::last_write_time(path_) +
            std::chrono::nanoseconds(nanoseconds - TimeOf(path_)));
    ASSERT_EQ(TimeOf(path_), nanoseconds);
  }

  TemporaryFolder folder_;
  const std::filesystem::path path_ = folder_.Path() / "map.bin";
  WrittenMap map_;
};

TEST_F(WrittenMapTest, ComesBackFromItsText) {
  const WrittenMap read = WrittenMapFromText(ToText(map_));
  EXPECT_EQ(read.hash, map_.hash);
  EXPECT_EQ(read.time, map_.time);
  EXPECT_EQ(read.samples, map_.samples);
  for (const char* text : {"", "12:", "@12:", "xyz@12:", "12@:", "12@12:xyz"}) {
    EXPECT_ANY_THROW(WrittenMapFromText(text)) << text;
  }
}

TEST_F(WrittenMapTest, IsKnownByItsFingerprintAlone) {
  SetTime(map_.time + 1000000000);
  WrittenMap other = map_;
  ++other.hash;
  EXPECT_TRUE(IsAnyOf(path_, {other, map_}));
  EXPECT_FALSE(IsAnyOf(path_, {other}));
  EXPECT_FALSE(IsAnyOf(path_, {}));
  EXPECT_TRUE(IsAnyOf(path_, {map_}, Scrutiny::kTimeAndSamples));
  Edit();
  EXPECT_FALSE(IsAnyOf(path_, {map_}, Scrutiny::kTimeAndSamples));
  SetTime(map_.time);
  EXPECT_FALSE(IsAnyOf(path_, {map_}));
}

TEST_F(WrittenMapTest, IsKnownWithoutReadingItByTimeAndSamples) {
  WrittenMap other = map_;
  ++other.hash;
  EXPECT_TRUE(IsAnyOf(path_, {other}, Scrutiny::kTimeAndSamples));
  ++other.samples.back();
  EXPECT_FALSE(IsAnyOf(path_, {other}, Scrutiny::kTimeAndSamples));
  other = map_;
  ++other.hash;
  ++other.time;
  EXPECT_FALSE(IsAnyOf(path_, {other}, Scrutiny::kTimeAndSamples));
  WriteText(path_, "no map");
  SetTime(map_.time);
  EXPECT_FALSE(IsAnyOf(path_, {map_}, Scrutiny::kTimeAndSamples));
}

}  // namespace
}  // namespace tsar
