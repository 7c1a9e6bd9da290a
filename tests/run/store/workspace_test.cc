// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/workspace.h"

#include "colmap_tsar/io/map_io.h"

#include "tests/support/test_workspace.h"

namespace tsar {
namespace {

constexpr MapType kGeometric = MapType::kGeometric;
constexpr MapType kPhotometric = MapType::kPhotometric;

class WorkspaceTest : public testing::Test {
 protected:
  void SetUp() override { MakeTestWorkspace(root_); }
  void ReplaceText(const std::string& file,
                   const std::string& from,
                   const std::string& to) {
    std::string text = ReadText(root_ / file);
    const size_t position = text.find(from);
    ASSERT_NE(position, std::string::npos);
    WriteText(root_ / file, text.replace(position, from.size(), to));
  }

  TemporaryFolder folder_;
  std::filesystem::path root_ = folder_.Path() / "dense";
};

TEST_F(WorkspaceTest, ReadsModelAndProblems) {
  const Workspace workspace(root_, kGeometric);
  EXPECT_EQ(workspace.Type(), kGeometric);
  ASSERT_EQ(workspace.Model().images.size(), 3u);
  ASSERT_EQ(workspace.Problems().size(), 3u);
  EXPECT_EQ(workspace.Problems()[1].reference, 1);
  EXPECT_THAT(workspace.Problems()[1].sources, testing::ElementsAre(0, 2));
  EXPECT_EQ(workspace.ImagePath(1), root_ / "images/left/b.png");
  EXPECT_EQ(workspace.Paths(1, kGeometric).depth,
            root_ / "stereo/depth_maps/left/b.png.geometric.bin");
  EXPECT_EQ(workspace.Paths(0, kPhotometric).normal,
            root_ / "stereo/normal_maps/a.png.photometric.bin");
  EXPECT_EQ(workspace.Paths(0, kPhotometric).cost,
            root_ / "stereo/cost_maps/a.png.photometric.bin");
  EXPECT_EQ(workspace.Paths(0, kPhotometric).confidence.Path(),
            root_ / "stereo/confidence_maps/a.png.photometric.png");
  EXPECT_EQ(workspace.Paths(0, kPhotometric).provenance.Path(),
            root_ / "stereo/provenance_maps/a.png.photometric.png");
}

TEST_F(WorkspaceTest, NamesMissingFolders) {
  for (const std::filesystem::path& folder : {root_ / "stereo/normal_maps",
                                              root_ / "stereo/depth_maps",
                                              root_ / "stereo",
                                              root_ / "sparse",
                                              root_ / "images",
                                              root_}) {
    std::filesystem::remove_all(folder);
    ExpectError(ErrorCode::kNotFound, {folder.string() + ":"}, [&] {
      Workspace(root_, kGeometric);
    });
  }
}

TEST_F(WorkspaceTest, RefusesNamesThatLeadOut) {
  for (const char* name : {"../a.png", "x/../../a.png", "/etc/a.png", ".."}) {
    MakeTestWorkspace(root_);
    ReplaceText("sparse/images.txt", "a.png", name);
    ExpectError(ErrorCode::kUnsupported, {root_.string(), name}, [&] {
      Workspace(root_, kGeometric);
    });
  }
}

TEST_F(WorkspaceTest, ReadsMaps) {
  const Workspace workspace(root_, kGeometric);
  EXPECT_TRUE(workspace.HasMaps(1, kPhotometric));
  const DepthNormal maps = workspace.ReadOriginalMaps(1, kPhotometric);
  EXPECT_EQ(maps.depth.Width(), 4);
  EXPECT_EQ(maps.depth(3, 2), 3.f);
  EXPECT_EQ(maps.normal(3, 2), (Vec3f{0, 0, -3}));
  EXPECT_EQ(maps.num_not_finite, 0);
  EXPECT_EQ(workspace.ReadOriginalMaps(1, kGeometric).depth(0, 0), 4.f);
}

TEST_F(WorkspaceTest, NamesTheMissingMap) {
  const Workspace workspace(root_, kGeometric);
  std::filesystem::remove(workspace.Paths(0, kGeometric).normal);
  std::filesystem::remove(workspace.Paths(1, kGeometric).depth);
  EXPECT_FALSE(workspace.HasMaps(0, kGeometric));
  EXPECT_TRUE(workspace.HasMaps(0, kPhotometric));
  EXPECT_FALSE(workspace.HasMaps(1, kGeometric));
  ExpectError(ErrorCode::kNotFound,
              {workspace.Paths(0, kGeometric).normal.string()},
              [&] { workspace.ReadOriginalMaps(0, kGeometric); });
  ExpectError(ErrorCode::kNotFound,
              {workspace.Paths(1, kGeometric).depth.string()},
              [&] { workspace.ReadOriginalMaps(1, kGeometric); });
}

// The test image has blue = x, green = 10 y, red = 200.
TEST_F(WorkspaceTest, ReadsImages) {
  const Workspace workspace(root_, kGeometric);
  const Image<Rgb> image = workspace.ReadImage(1, 8, 6);
  EXPECT_EQ(image(7, 2).r, 200);
  EXPECT_EQ(image(7, 2).g, 20);
  EXPECT_EQ(image(7, 2).b, 7);
  const Image<Rgb> half = workspace.ReadImage(1, 4, 3);
  ASSERT_EQ(half.Width(), 4);
  ASSERT_EQ(half.Height(), 3);
  EXPECT_EQ(half(0, 1).r, 200);
  EXPECT_EQ(half(0, 1).g, 25);
  EXPECT_NEAR(half(3, 1).b, 6.5, 0.51);
}

TEST_F(WorkspaceTest, RefusesImagesOfAnotherSize) {
  ReplaceText("sparse/cameras.txt", "8 6", "6 8");
  const Workspace workspace(root_, kGeometric);
  ExpectError(ErrorCode::kMismatch,
              {workspace.ImagePath(0).string(), "8 x 6", "6 x 8"},
              [&] { workspace.ReadImage(0, 6, 8); });
}

}  // namespace
}  // namespace tsar
