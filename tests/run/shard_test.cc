// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/shard.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <sstream>

#include "tests/support/test_workspace.h"

namespace tsar {
namespace {

TEST(ParseShardTest, CountsFromZero) {
  EXPECT_EQ(ParseShard("0/3").index, 0);
  EXPECT_EQ(ParseShard("2/3").index, 2);
  EXPECT_EQ(ParseShard("2/3").count, 3);
  EXPECT_EQ(ParseShard("0/1").count, 1);
  EXPECT_EQ(ParseShard("99999/100000").index, 99999);
  EXPECT_EQ(ParseShard("").index, 0);
  EXPECT_EQ(ParseShard("").count, 1);
}

TEST(ParseShardTest, RefusesEverythingElse) {
  for (const std::string text : {"3/",
                                 "/3",
                                 "/",
                                 "3",
                                 "0/0",
                                 "-1/2",
                                 "1/2x",
                                 "x1/2",
                                 "1/-2",
                                 " 1/2",
                                 "1 / 2",
                                 "1/2/3",
                                 "1.0/2",
                                 "+1/2",
                                 "0x1/2",
                                 "2/2",
                                 "3/2",
                                 "1/1e3",
                                 "1/99999999999999",
                                 "99999999999999/3",
                                 "0/100001"}) {
    ExpectError(ErrorCode::kBadOption, {"shard", "i/n", "such as 0/4"}, [&] {
      ParseShard(text);
    });
  }
}

// A workspace of images along a closed path, each with its `reach` neighbors
// on both sides as sources, listed in an order that has nothing to do with it.
class SplitImagesTest : public testing::Test {
 protected:
  void Make(int num_images, int reach, int large_image = -1) {
    num_images_ = num_images;
    for (const char* folder :
         {"images", "stereo/depth_maps", "stereo/normal_maps"}) {
      std::filesystem::create_directories(root_ / folder);
    }
    std::ostringstream images;
    std::ostringstream config;
    for (int i = 0; i < num_images; ++i) {
      images << i + 1 << " 1 0 0 0 " << i << " 0 0 "
             << (i == large_image ? 2 : 1) << " " << Name(i) << "\n\n";
    }
    // Neither number divides the other.
    constexpr int kStep = 7;
    for (int i = 0; i < num_images; ++i) {
      const int place = i * kStep % num_images;
      config << Name(place) << "\n";
      for (int j = 1; j <= reach; ++j) {
        config << (j == 1 ? "" : ", ") << Name((place + j) % num_images) << ", "
               << Name((place + num_images - j) % num_images);
      }
      config << "\n";
    }
    WriteText(root_ / "sparse/cameras.txt",
              "1 PINHOLE 96 72 80 80 48 36\n2 PINHOLE 192 144 80 80 96 72\n");
    WriteText(root_ / "sparse/images.txt", images.str());
    WriteText(root_ / "sparse/points3D.txt", "");
    WriteText(root_ / "stereo/patch-match.cfg", config.str());
  }
  static std::string Name(int place) {
    std::ostringstream name;
    name << "v" << 1000 + place * 37 % 1000 << ".png";
    return name.str();
  }
  std::vector<std::vector<size_t>> Split(int count) const {
    return SplitImages(Workspace(root_, MapType::kGeometric), count);
  }
  // The share of all pairs of image and source that are in one part.
  double ShareInside(const std::vector<std::vector<size_t>>& shards) const {
    const Workspace workspace(root_, MapType::kGeometric);
    int num_pairs = 0;
    int num_inside = 0;
    for (const std::vector<size_t>& shard : shards) {
      std::vector<int> references;
      for (const size_t index : shard) {
        references.push_back(workspace.Problems()[index].reference);
      }
      for (const size_t index : shard) {
        for (const int source : workspace.Problems()[index].sources) {
          ++num_pairs;
          num_inside +=
              std::count(references.begin(), references.end(), source);
        }
      }
    }
    return static_cast<double>(num_inside) / num_pairs;
  }
  void ExpectEachImageOnce(const std::vector<std::vector<size_t>>& shards) {
    std::vector<size_t> all;
    for (const std::vector<size_t>& shard : shards) {
      EXPECT_TRUE(std::is_sorted(shard.begin(), shard.end()));
      all.insert(all.end(), shard.begin(), shard.end());
    }
    std::sort(all.begin(), all.end());
    std::vector<size_t> expected(static_cast<size_t>(num_images_));
    std::iota(expected.begin(), expected.end(), size_t{0});
    EXPECT_EQ(all, expected);
  }

  int num_images_ = 0;
  TemporaryFolder folder_;
  const std::filesystem::path root_ = folder_.Path() / "dense";
};

TEST_F(SplitImagesTest, PartsAreEqualAndHoldNeighbors) {
  Make(100, 3);
  for (const int count : {1, 2, 3, 4, 7}) {
    const auto shards = Split(count);
    ASSERT_EQ(shards.size(), static_cast<size_t>(count));
    ExpectEachImageOnce(shards);
    for (const std::vector<size_t>& shard : shards) {
      EXPECT_GE(static_cast<int>(shard.size()), 100 / count);
      EXPECT_LE(static_cast<int>(shard.size()), 100 / count + 1);
    }
    // For random parts it is 1 / count. Each part has at most four ends, and at
    // each end 3 + 2 + 1 of 600 pairs lead out of it.
    EXPECT_GE(ShareInside(shards), 1.0 - 2 * count * 12 / 600.0);
    EXPECT_EQ(Split(count), shards);
  }
}

TEST_F(SplitImagesTest, LargeImagesCountForMore) {
  // One image is as much work as four.
  Make(29, 2, 11);
  const Workspace workspace(root_, MapType::kGeometric);
  for (const std::vector<size_t>& shard : Split(4)) {
    int work = 0;
    for (const size_t index : shard) {
      const int image = workspace.Problems()[index].reference;
      work += workspace.Model().images[image].camera.width == 192 ? 4 : 1;
    }
    EXPECT_NEAR(work, 8, 2);
  }
}

TEST_F(SplitImagesTest, MorePartsThanImagesLeavesSomeEmpty) {
  Make(3, 1);
  const auto shards = Split(8);
  ASSERT_EQ(shards.size(), 8u);
  ExpectEachImageOnce(shards);
  for (const std::vector<size_t>& shard : shards) {
    EXPECT_LE(shard.size(), 1u);
  }
}

TEST_F(SplitImagesTest, DoesNotDependOnTheOrderOfTheLines) {
  Make(20, 2);
  const auto names = [&](int count) {
    const Workspace workspace(root_, MapType::kGeometric);
    std::vector<std::vector<std::string>> result;
    for (const std::vector<size_t>& shard : SplitImages(workspace, count)) {
      result.emplace_back();
      for (const size_t index : shard) {
        const int image = workspace.Problems()[index].reference;
        result.back().push_back(workspace.Model().images[image].name);
      }
      std::sort(result.back().begin(), result.back().end());
    }
    return result;
  };
  const auto before = names(3);
  // The same pairs of lines, the last first.
  std::istringstream config(ReadText(root_ / "stereo/patch-match.cfg"));
  std::string reversed;
  std::string sources;
  for (std::string image; std::getline(config, image);) {
    std::getline(config, sources);
    reversed = image + "\n" + sources + "\n" + reversed;
  }
  WriteText(root_ / "stereo/patch-match.cfg", reversed);
  EXPECT_EQ(names(3), before);
}

TEST_F(SplitImagesTest, TakesImagesWithoutNeighbors) {
  Make(6, 1);
  std::string config;
  for (int i = 0; i < 6; ++i) {
    config += Name(i) + "\n__auto__, 20\n";  // There are no points.
  }
  WriteText(root_ / "stereo/patch-match.cfg", config);
  const auto shards = Split(3);
  ExpectEachImageOnce(shards);
  for (const std::vector<size_t>& shard : shards) {
    EXPECT_EQ(shard.size(), 2u);
  }
}

}  // namespace
}  // namespace tsar
