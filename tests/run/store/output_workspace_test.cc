// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/output_workspace.h"

#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/run/store/restore.h"
#include "colmap_tsar/run/store/write_back.h"

#include "tests/support/synthetic_workspace.h"
#include "tests/support/test_workspace.h"

namespace tsar {
namespace {

constexpr MapType kGeometric = MapType::kGeometric;

class OutputWorkspaceTest : public testing::Test {
 protected:
  void SetUp() override { MakeTestWorkspace(root_); }

  Workspace Create() {
    return CreateOutputWorkspace(Workspace(root_, kGeometric), output_);
  }
  ImageRecord Record() {
    ImageRecord record;
    record.options_hash = "options";
    return record;
  }
  static float Depth(const Workspace& workspace, int image) {
    return ReadDepthMap(workspace.Paths(image, kGeometric).depth)(0, 0);
  }
  static float OriginalDepth(const Workspace& workspace) {
    return workspace.ReadOriginalMaps(0, kGeometric).depth(0, 0);
  }
  void ExpectRefused(const std::filesystem::path& output) {
    SCOPED_TRACE(output);
    const Workspace input(root_, kGeometric);
    ExpectError(ErrorCode::kUnsupported, {output.string()}, [&] {
      CreateOutputWorkspace(input, output);
    });
  }

  TemporaryFolder folder_;
  std::filesystem::path root_ = folder_.Path() / "dense";
  std::filesystem::path output_ = folder_.Path() / "refined/dense";
};

TEST_F(OutputWorkspaceTest, HoldsEverythingThatTheInputHolds) {
  const Workspace output = Create();
  EXPECT_EQ(output.Root(), output_);
  EXPECT_EQ(output.ModelFolder(), output_ / "sparse");
  ASSERT_EQ(output.Problems().size(), 3u);
  EXPECT_EQ(output.ReadImage(1, 8, 6)(0, 0).r, 200);
  EXPECT_EQ(ReadText(output_ / "stereo/fusion.cfg"),
            ReadText(root_ / "stereo/fusion.cfg"));
  for (const auto& entry : std::filesystem::recursive_directory_iterator(
           root_ / "stereo/depth_maps")) {
    if (!entry.is_directory()) {
      EXPECT_EQ(ReadText(output_ / entry.path().lexically_relative(root_)),
                ReadText(entry.path()));
    }
  }
}

// COLMAP, which is to fuse its maps, looks nowhere else.
TEST_F(OutputWorkspaceTest, HasTheModelInSparseItself) {
  std::filesystem::rename(root_ / "sparse", root_ / "0");
  std::filesystem::create_directory(root_ / "sparse");
  std::filesystem::rename(root_ / "0", root_ / "sparse/0");
  const auto before = ReadTree(root_);
  const Workspace output = Create();
  EXPECT_EQ(output.ModelFolder(), output_ / "sparse");
  EXPECT_EQ(output.Model().images.size(), 3u);
  EXPECT_EQ(ReadText(output_ / "sparse/images.txt"),
            ReadText(root_ / "sparse/0/images.txt"));
  EXPECT_EQ(ReadTree(root_), before);
  // A model that appears there later takes precedence.
  for (const char* name : {"cameras.txt", "images.txt", "points3D.txt"}) {
    std::filesystem::copy(root_ / "sparse/0" / name, root_ / "sparse" / name);
  }
  Create();
  EXPECT_TRUE(
      std::filesystem::equivalent(output_ / "sparse", root_ / "sparse"));
}

TEST_F(OutputWorkspaceTest, LeavesTheInputAlone) {
  const auto before = ReadTree(root_);
  const Workspace output = Create();
  WriteRefined(output, 0, MakeRefinedMaps(42.f), Record());
  WriteRefined(output, 1, MakeRefinedMaps(43.f), Record());
  KeepImage(output, 2, Record());
  EXPECT_EQ(Depth(output, 0), 42.f);
  EXPECT_EQ(Depth(output, 1), 43.f);
  EXPECT_EQ(Depth(output, 2), 6.f);
  EXPECT_EQ(OriginalDepth(output), 2.f);
  EXPECT_EQ(ReadTree(root_), before);
  Restore(output_);
  EXPECT_EQ(Depth(output, 0), 2.f);
  EXPECT_EQ(ReadTree(root_), before);
}

TEST_F(OutputWorkspaceTest, GoesOnWhereItStopped) {
  WriteRefined(Create(), 0, MakeRefinedMaps(42.f), Record());
  const Workspace output = Create();
  EXPECT_EQ(Depth(output, 0), 42.f);
  EXPECT_TRUE(IsDone(output, 0, Record()));
  EXPECT_FALSE(IsDone(output, 1, Record()));
  EXPECT_EQ(OriginalDepth(output), 2.f);
  KeepImage(output, 0, Record());
  EXPECT_EQ(Depth(Create(), 0), 2.f);
}

// Only the link to the images is left.
TEST_F(OutputWorkspaceTest, TakesUpAnInterruptedBeginning) {
  Create();
  std::filesystem::remove_all(output_ / "stereo");
  std::filesystem::remove_all(output_ / "sparse");
  EXPECT_EQ(Depth(Create(), 1), 4.f);
  std::filesystem::remove_all(output_);
  std::filesystem::create_directory(output_);
  std::filesystem::create_symlink("images", output_ / "images.tsar_tmp");
  EXPECT_EQ(Depth(Create(), 1), 4.f);
  EXPECT_TRUE(std::filesystem::exists(root_ / "images/a.png"));
}

// Whatever has become of the maps of both meanwhile.
TEST_F(OutputWorkspaceTest, TakesTheOriginalsThatTheInputHasNow) {
  const Workspace input(root_, kGeometric);
  WriteRefined(input, 0, MakeRefinedMaps(41.f), Record());
  const Workspace output = Create();
  EXPECT_EQ(Depth(output, 0), 2.f);
  Restore(root_);
  EXPECT_EQ(Depth(Create(), 0), 2.f);
  WriteRefined(output, 0, MakeRefinedMaps(42.f), Record());
  // The input has been refined: its original is the same.
  WriteRefined(input, 0, MakeRefinedMaps(43.f), Record());
  EXPECT_EQ(Depth(Create(), 0), 42.f);
  EXPECT_EQ(OriginalDepth(output), 2.f);
  WriteTestMaps(root_, "a.png", kGeometric, 9.f);
  EXPECT_EQ(OriginalDepth(Create()), 9.f);
  // Files that somebody wrote into the output are superseded, not lost.
  const auto superseded =
      GetSupersededFolder(output_) / "depth_maps/a.png.geometric.bin";
  std::filesystem::remove(output.Paths(0, kGeometric).depth);
  std::filesystem::remove(output.Paths(0, kGeometric).normal);
  WriteTestMaps(output_, "a.png", kGeometric, 10.f);
  EXPECT_EQ(OriginalDepth(Create()), 9.f);
  EXPECT_EQ(ReadDepthMap(superseded)(0, 0), 10.f);
}

TEST_F(OutputWorkspaceTest, AnOutputOfAnOutputHasTheSameOriginals) {
  WriteRefined(Create(), 0, MakeRefinedMaps(42.f), Record());
  for (int i = 0; i < 2; ++i) {
    const Workspace second = CreateOutputWorkspace(
        Workspace(output_, kGeometric), folder_.Path() / "second");
    EXPECT_EQ(Depth(second, 0), 2.f);
  }
}

TEST_F(OutputWorkspaceTest, WorksWithMissingMaps) {
  std::filesystem::remove(
      Workspace(root_, kGeometric).Paths(0, kGeometric).depth);
  const Workspace output = Create();
  EXPECT_FALSE(output.HasMaps(0, kGeometric));
  EXPECT_FALSE(std::filesystem::exists(output.Paths(0, kGeometric).depth));
  EXPECT_TRUE(output.HasMaps(1, kGeometric));
}

TEST_F(OutputWorkspaceTest, RefusesPlacesThatBelongToTheInput) {
  ExpectRefused(root_);
  ExpectRefused(root_ / "stereo/../");
  ExpectRefused(root_ / "stereo");
  ExpectRefused(root_ / "stereo/refined");
  ExpectRefused(root_ / "images/new/refined");
  ExpectRefused(folder_.Path());
  std::filesystem::create_symlink(root_ / "stereo", folder_.Path() / "link");
  ExpectRefused(folder_.Path() / "link/refined");
  std::filesystem::create_directory(folder_.Path() / "models");
  std::filesystem::create_symlink(folder_.Path() / "models",
                                  root_ / "sparse/0");
  ExpectRefused(folder_.Path() / "models/refined");
}

TEST_F(OutputWorkspaceTest, RefusesForeignFoldersAndFiles) {
  WriteText(output_ / "precious.txt", "mine");
  ExpectRefused(output_);
  EXPECT_EQ(ReadText(output_ / "precious.txt"), "mine");
  ExpectRefused(output_ / "precious.txt");
}

TEST_F(OutputWorkspaceTest, RefusesTheOutputOfAnotherInput) {
  const auto other = folder_.Path() / "other";
  MakeTestWorkspace(other);
  CreateOutputWorkspace(Workspace(other, kGeometric), output_);
  ExpectRefused(output_);
}

}  // namespace
}  // namespace tsar
