// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/tools/stereo/stereo_workspace.h"

#include <utility>
#include <vector>

#include "tests/tools/stereo/stereo_workspace_fixture.h"

namespace tsar {
namespace {

TEST_F(StereoWorkspaceTest, MakesListedImagesAsAmongAll) {
  // A chain: the last pass on an image needs the photometric maps of its
  // source alone, and of the source's own, but not of the rest.
  WriteText(root_ / "stereo/patch-match.cfg",
            "v0.png\nv1.png\nv1.png\nleft/v2.png\nleft/v2.png\nv3.png\n"
            "v3.png\nleft/v2.png\n");
  options_.num_geometric_passes = 2;
  Run();
  const auto whole = Maps();
  for (const char* folder :
       {"depth_maps", "normal_maps", "cost_maps", "tsar_stereo"}) {
    std::filesystem::remove_all(root_ / "stereo" / folder);
  }
  image_list_path_ = folder_.Path() / "list.txt";
  WriteText(image_list_path_, "v0.png\r\n");
  EXPECT_EQ(Run().num_images, 1);
  const auto listed = Maps();
  const std::vector<std::pair<std::string, bool>> expected = {
      {"depth_maps/v0.png.geometric.bin", true},
      {"cost_maps/v0.png.geometric.bin", true},
      {"depth_maps/v0.png.photometric.bin", true},
      {"depth_maps/v1.png.photometric.bin", true},
      {"depth_maps/left/v2.png.photometric.bin", true},
      {"depth_maps/v3.png.photometric.bin", false},
      {"depth_maps/v1.png.geometric.bin", false},
      {"depth_maps/left/v2.png.geometric.bin", false}};
  for (const auto& [name, is_there] : expected) {
    ASSERT_EQ(listed.count(name), is_there ? 1u : 0u) << name;
    if (is_there) {
      EXPECT_TRUE(listed.at(name) == whole.at(name)) << name << " differs";
    }
  }
  EXPECT_EQ(Run().num_skipped, 1);
  // Now all; what was made stays.
  image_list_path_.clear();
  EXPECT_EQ(Run().num_skipped, 1);
  EXPECT_TRUE(Maps() == whole);
}

TEST_F(StereoWorkspaceTest, NeverRemovesMapsThatTheListLeavesOut) {
  WriteText(root_ / "stereo/depth_maps/v1.png.geometric.bin", "of COLMAP");
  image_list_path_ = folder_.Path() / "list.txt";
  WriteText(image_list_path_, "v0.png\n");
  ExpectRefused(ErrorCode::kUnsupported, "another program");
  ExpectRefused(ErrorCode::kUnsupported, "not in the list", true);
  WriteText(image_list_path_, "v9.png\n");
  ExpectRefused(ErrorCode::kMismatch, "line 1 names v9.png", true);
}

TEST_F(StereoWorkspaceTest, GoesOnAfterAnInterruptionInAnyPass) {
  Run();
  const auto expected = Maps();
  // Files of maps, also of those between the passes.
  const auto count_files = [&] {
    int count = 0;
    for (const auto& entry :
         std::filesystem::recursive_directory_iterator(root_ / "stereo")) {
      count += entry.path().extension() == ".bin" ? 1 : 0;
    }
    return count;
  };
  std::filesystem::remove_all(root_ / "stereo/tsar_stereo");
  RemoveMaps(root_);
  std::filesystem::remove_all(root_ / "stereo/cost_maps");
  int num_interruptions = 0;
  for (;;) {
    const int num_before = count_files();
    try {
      Run(false, 1, [&] { return count_files() > num_before; });
      break;
    } catch (const Error& error) {
      ASSERT_EQ(error.Code(), ErrorCode::kInterrupted) << error.what();
      ASSERT_LT(++num_interruptions, 100);
    }
  }
  // Four passes of four images, each of which may end a run; what has been
  // computed by then is written. After the last there is nothing to interrupt.
  EXPECT_GE(num_interruptions, 2);
  EXPECT_LT(num_interruptions, 4 * 4);
  EXPECT_TRUE(Maps() == expected);
  for (const char* pass : {"pass_1", "pass_2"}) {
    EXPECT_FALSE(std::filesystem::exists(root_ / "stereo/tsar_stereo" / pass));
  }
}

TEST_F(StereoWorkspaceTest, RefusesMapsOfOthersUnlessToldToReplaceThem) {
  MakeSyntheticWorkspace(root_);
  ExpectRefused(ErrorCode::kUnsupported, "overwrite 1");
  Run(/*overwrite=*/true);
  // Now they are its own, but made with other options.
  options_.num_iterations = 1;
  ExpectRefused(ErrorCode::kUnsupported, "other options");
}

TEST_F(StereoWorkspaceTest, RemovesNothingWhereOneImageHasBeenRefined) {
  MakeSyntheticWorkspace(root_);
  const Workspace workspace(root_, MapType::kGeometric);
  const MapPaths paths = workspace.Paths(3, MapType::kGeometric);
  CreateFolders(paths.original_depth.Parent());
  std::filesystem::copy_file(paths.depth, paths.original_depth);
  ExpectRefused(ErrorCode::kUnsupported, "restore 1", true);
}

TEST_F(StereoWorkspaceTest, LeavesWhatIsDoneAlsoWhereItHasBeenRefined) {
  Run();
  const MapPaths paths =
      Workspace(root_, MapType::kGeometric).Paths(3, MapType::kGeometric);
  CreateFolders(paths.original_depth.Parent());
  std::filesystem::copy_file(paths.depth, paths.original_depth);
  const auto expected = ReadTree(root_);
  EXPECT_EQ(Run().num_skipped, 4);
  EXPECT_TRUE(ReadTree(root_) == expected);
  options_.num_iterations = 1;
  ExpectRefused(ErrorCode::kUnsupported, "restore 1", true);
  options_.num_iterations = 2;
  std::filesystem::remove(Workspace(root_, MapType::kGeometric)
                              .Paths(0, MapType::kGeometric)
                              .depth);
  ExpectRefused(ErrorCode::kUnsupported, "restore 1");
}

TEST_F(StereoWorkspaceTest, NamesWhatHasChanged) {
  Run();
  const auto expected = ReadTree(root_);
  EXPECT_EQ(Run().num_skipped, 4);
  EXPECT_TRUE(ReadTree(root_) == expected);
  Touch(root_ / "images/v1.png");
  ExpectRefused(ErrorCode::kUnsupported,
                "images/v1.png: its photo has changed since the maps were "
                "made; give overwrite 1 to make all maps anew");
  Touch(root_ / "images/left/v2.png");
  ExpectRefused(ErrorCode::kUnsupported,
                "images/left/v2.png: its photo has changed since the maps were "
                "made, and 1 other image has changed, too; give overwrite 1");
  const auto maps = Maps();
  EXPECT_EQ(Run(/*overwrite=*/true).num_skipped, 0);
  EXPECT_TRUE(Maps() == maps);
  EXPECT_EQ(Run().num_skipped, 4);
}

// A run that was killed before its first map, and a file that is not whole.
TEST_F(StereoWorkspaceTest, BeginsAnewWhereThereIsNothingToLose) {
  Run();
  const auto expected = Maps();
  const std::filesystem::path inputs = root_ / "stereo/tsar_stereo/inputs.txt";
  const std::string text = ReadText(inputs);
  for (const std::string& broken : {std::string("a b c d e f v0.png\n"),
                                    text.substr(text.find('\n') + 1),
                                    text.substr(0, text.find('\n') + 20),
                                    std::string()}) {
    WriteText(inputs, broken);
    ExpectRefused(ErrorCode::kUnsupported, "overwrite 1");
    RemoveMaps(root_);
    std::filesystem::remove_all(root_ / "stereo/cost_maps");
    EXPECT_EQ(Run().num_skipped, 0);
    EXPECT_TRUE(Maps() == expected);
    EXPECT_EQ(ReadText(inputs), text);
  }
}

// As if the images had meanwhile been undistorted to another size.
TEST_F(StereoWorkspaceTest, MapsOfAnotherSizeAreNotItsOwn) {
  options_.num_iterations = 1;
  Run();
  const Workspace workspace(root_, MapType::kGeometric);
  const std::filesystem::path path =
      workspace.Paths(1, MapType::kGeometric).depth;
  WriteDepthMap(UserPath(path), Image<float>(kMapHeight, kMapWidth, 5.f));
  ExpectRefused(ErrorCode::kUnsupported, "overwrite 1");
  EXPECT_EQ(Run(/*overwrite=*/true).num_skipped, 0);
  EXPECT_EQ(ReadMapSize(path).width, kMapWidth);
}

}  // namespace
}  // namespace tsar
