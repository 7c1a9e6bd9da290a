// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/output_workspace.h"

#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/run/store/restore.h"
#include "colmap_tsar/run/store/write_back.h"

#include <map>

#include "tests/support/test_workspace.h"
#include "tests/support/write_refined.h"

namespace tsar {
namespace {

constexpr MapType kGeometric = MapType::kGeometric;

class OutputWorkspaceTest : public testing::Test {
 protected:
  void SetUp() override { MakeTestWorkspace(root_); }

  Workspace Create() {
    return CreateOutputWorkspace(
        Workspace(root_, kGeometric), output_, kGeometric);
  }
  ImageRecord Record() {
    ImageRecord record;
    record.options_hash = "options";
    return record;
  }
  std::map<std::string, std::string> InputFiles() {
    std::map<std::string, std::string> files;
    for (const auto& entry :
         std::filesystem::recursive_directory_iterator(root_)) {
      files[entry.path()] =
          entry.is_directory() ? "folder" : ReadText(entry.path());
    }
    return files;
  }
  static float Depth(const Workspace& workspace, int image) {
    return ReadDepthMap(workspace.DepthPath(image, kGeometric))(0, 0);
  }
  void ExpectRefused(const std::filesystem::path& output) {
    SCOPED_TRACE(output);
    const Workspace input(root_, kGeometric);
    ExpectError(ErrorCode::kUnsupported, {output.string()}, [&] {
      CreateOutputWorkspace(input, output, kGeometric);
    });
  }

  TemporaryFolder folder_;
  std::filesystem::path root_ = folder_.Path() / "dense";
  std::filesystem::path output_ = folder_.Path() / "refined/dense";
};

TEST_F(OutputWorkspaceTest, HoldsEverythingThatTheInputHolds) {
  const Workspace output = Create();
  EXPECT_TRUE(output.IsOutput());
  EXPECT_TRUE(std::filesystem::equivalent(output.SourceRoot(), root_));
  EXPECT_EQ(output.Root(), output_);
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

// COLMAP, which is to fuse its maps, knows no other place.
TEST_F(OutputWorkspaceTest, HasTheModelInSparseItself) {
  std::filesystem::rename(root_ / "sparse", root_ / "0");
  std::filesystem::create_directory(root_ / "sparse");
  std::filesystem::rename(root_ / "0", root_ / "sparse/0");
  const auto before = InputFiles();
  const Workspace output = Create();
  EXPECT_EQ(output.ModelFolder(), output_ / "sparse");
  EXPECT_EQ(output.Model().images.size(), 3u);
  EXPECT_EQ(ReadText(output_ / "sparse/images.txt"),
            ReadText(root_ / "sparse/0/images.txt"));
  EXPECT_EQ(InputFiles(), before);
  // Of a model that is there later, the output takes that.
  for (const char* name : {"cameras.txt", "images.txt", "points3D.txt"}) {
    std::filesystem::copy(root_ / "sparse/0" / name, root_ / "sparse" / name);
  }
  Create();
  EXPECT_TRUE(
      std::filesystem::equivalent(output_ / "sparse", root_ / "sparse"));
}

TEST_F(OutputWorkspaceTest, LeavesTheInputAlone) {
  const auto before = InputFiles();
  const Workspace output = Create();
  WriteRefined(output, 0, MakeRefinedMaps(42.f), Record());
  WriteRefined(output, 1, MakeRefinedMaps(43.f), Record());
  KeepImage(output, 2, Record());
  EXPECT_EQ(Depth(output, 0), 42.f);
  EXPECT_EQ(Depth(output, 1), 43.f);
  EXPECT_EQ(Depth(output, 2), 6.f);
  EXPECT_EQ(output.ReadOriginalMaps(0, kGeometric).depth(0, 0), 2.f);
  EXPECT_FALSE(std::filesystem::exists(output_ / "stereo/tsar/original"));
  EXPECT_EQ(InputFiles(), before);
}

TEST_F(OutputWorkspaceTest, GoesOnWhereItStopped) {
  WriteRefined(Create(), 0, MakeRefinedMaps(42.f), Record());
  const Workspace output = Create();
  EXPECT_EQ(Depth(output, 0), 42.f);
  EXPECT_TRUE(IsDone(output, 0, "options", {}));
  EXPECT_FALSE(IsDone(output, 1, "options", {}));
  EXPECT_EQ(output.ReadOriginalMaps(0, kGeometric).depth(0, 0), 2.f);
}

// Only the marker was written when the program was killed.
TEST_F(OutputWorkspaceTest, TakesUpAnInterruptedBeginning) {
  Create();
  for (const char* name : {"images", "sparse", "stereo/depth_maps"}) {
    std::filesystem::remove_all(output_ / name);
  }
  EXPECT_EQ(Depth(Create(), 1), 4.f);
  EXPECT_TRUE(std::filesystem::exists(root_ / "images/a.png"));
}

TEST_F(OutputWorkspaceTest, NewInputMapsAreTheOriginals) {
  const Workspace output = Create();
  WriteRefined(output, 0, MakeRefinedMaps(42.f), Record());
  WriteTestMaps(root_, "a.png", kGeometric, 9.f);
  EXPECT_EQ(output.ReadOriginalMaps(0, kGeometric).depth(0, 0), 9.f);
}

TEST_F(OutputWorkspaceTest, KeepingAnImageLinksItsOriginalAgain) {
  const Workspace output = Create();
  WriteRefined(output, 0, MakeRefinedMaps(42.f), Record());
  KeepImage(output, 0, Record());
  EXPECT_EQ(Depth(output, 0), 2.f);
  EXPECT_TRUE(std::filesystem::is_symlink(output.DepthPath(0, kGeometric)));
}

TEST_F(OutputWorkspaceTest, LinksTheOriginalsOfARefinedInput) {
  WriteRefined(
      Workspace(root_, kGeometric), 0, MakeRefinedMaps(42.f), Record());
  const Workspace output = Create();
  EXPECT_EQ(Depth(output, 0), 2.f);
  EXPECT_EQ(output.ReadOriginalMaps(0, kGeometric).depth(0, 0), 2.f);
}

TEST_F(OutputWorkspaceTest, AnOutputOfAnOutputHasTheSameOriginals) {
  WriteRefined(Create(), 0, MakeRefinedMaps(42.f), Record());
  const auto second_path = folder_.Path() / "second";
  for (int i = 0; i < 2; ++i) {
    const Workspace second = CreateOutputWorkspace(
        Workspace(output_, kGeometric), second_path, kGeometric);
    EXPECT_TRUE(std::filesystem::equivalent(second.SourceRoot(), root_));
    EXPECT_EQ(Depth(second, 0), 2.f);
  }
}

TEST_F(OutputWorkspaceTest, WorksWithMissingMaps) {
  std::filesystem::remove(
      Workspace(root_, kGeometric).DepthPath(0, kGeometric));
  const Workspace output = Create();
  EXPECT_FALSE(output.HasMaps(0, kGeometric));
  EXPECT_FALSE(std::filesystem::exists(output.DepthPath(0, kGeometric)));
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
  CreateOutputWorkspace(Workspace(other, kGeometric), output_, kGeometric);
  ExpectRefused(output_);
}

TEST_F(OutputWorkspaceTest, CannotBeRestored) {
  Create();
  ExpectError(ErrorCode::kUnsupported,
              {output_.string(), root_.filename().string()},
              [&] { Restore(output_); });
}

TEST_F(OutputWorkspaceTest, NamesAMovedInputAndABrokenMarker) {
  Create();
  std::filesystem::rename(root_, folder_.Path() / "moved");
  ExpectError(
      ErrorCode::kNotFound, {}, [&] { Workspace(output_, kGeometric); });
  const auto marker = output_ / "stereo/tsar/output_of.json";
  WriteText(marker, "{}");
  ExpectError(ErrorCode::kCorrupt, {marker.string()}, [&] {
    ReadOutputMarker(output_);
  });
}

}  // namespace
}  // namespace tsar
