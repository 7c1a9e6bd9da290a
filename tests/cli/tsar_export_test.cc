// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include <filesystem>

#include "tests/cli/command_test.h"
#include "tests/support/mask_files.h"
#include <sys/resource.h>

namespace tsar {
namespace {

namespace fs = std::filesystem;

class TsarExportTest : public CommandTest<&RunTsarExport> {
 protected:
  void SetUp() override { MakeTestWorkspace(root_); }

  Outcome Write(const std::string& format, const Words& more = {}) const {
    Words arguments = {"--format", format, "--output_path", output_.string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return Run(arguments);
  }

  const fs::path output_ = folder_.Path() / "exported";
};

TEST_F(TsarExportTest, TellsOfHowManyImagesThereAreMasks) {
  const fs::path masks = folder_.Path() / "masks";
  WriteMask(masks / "c.png.png", 8, 6, [](int x, int) { return x < 4; });
  EXPECT_THAT(Write("npy", {"--mask_path", masks.string()}).out,
              testing::HasSubstr("\n  with depth: 3 images, 83.3333 % of all "
                                 "pixels\n  masks for 1 of 3 images\n"));
}

TEST_F(TsarExportTest, TellsWhatItWroteAndWhatComesNext) {
  const std::string text = "Exported 3 images to " + output_.string() +
                           "\n  with depth: 3 images, 100 % of all pixels\n";
  EXPECT_EQ(Write("npy").out, text);
  EXPECT_TRUE(fs::is_regular_file(output_ / "depth/left/b.png.npy"));
  EXPECT_EQ(Write("nerfstudio", {"--overwrite", "1"}).out,
            text + "Train with: ns-train depth-nerfacto --data " +
                output_.string() + "\n");
  EXPECT_TRUE(fs::is_regular_file(output_ / "transforms.json"));
  EXPECT_FALSE(fs::exists(output_ / "depth"));
  EXPECT_EQ(Write("3dgs", {"--overwrite", "1"}).out,
            text + "Train with: python train.py -s " + output_.string() +
                " -d depths\n");
  EXPECT_TRUE(fs::is_regular_file(output_ / "depths/left/b.png"));
  EXPECT_EQ(
      Write("png16", {"--overwrite", "1", "--depth_scale", "0.01"}).exit_code,
      0);
}

TEST_F(TsarExportTest, TakesTheMapsThatAreAskedFor) {
  EXPECT_EQ(Write("npy").exit_code, 0);
  const std::string geometric = ReadText(output_ / "depth/a.png.npy");
  EXPECT_EQ(Write("npy", {"--overwrite", "1", "--input_type", "photometric"})
                .exit_code,
            0);
  EXPECT_NE(ReadText(output_ / "depth/a.png.npy"), geometric);
}

TEST_F(TsarExportTest, WrongInputIsOneLine) {
  const std::string output = output_.string();
  ExpectFailure(
      {"--output_path", output},
      "--format is missing; give npy, exr, png16, nerfstudio or 3dgs");
  ExpectFailure({"--output_path", output, "--format", "ply"}, "png16");
  ExpectFailure({"--format", "npy"}, "--output_path");
  ExpectFailure(
      {"--output_path", output, "--format", "npy", "--depth_scale", "0.1"},
      "--depth_scale is for --format png16 alone");
  ExpectFailure(
      {"--output_path", output, "--format", "png16", "--depth_scale", "0"},
      "--depth_scale");
  ExpectFailure({"--output_path", root_.string(), "--format", "npy"},
                "is no export; give another folder as --output_path");
  ExpectFailure(
      {"--output_path", (root_ / "images/new").string(), "--format", "npy"},
      "is in the folder images of a workspace");
  fs::remove_all(root_ / "stereo/depth_maps");
  fs::create_directories(root_ / "stereo/depth_maps");
  ExpectFailure({"--output_path", output, "--format", "npy"},
                "no image has geometric depth and normal maps");
}

// As on a full disk.
TEST_F(TsarExportTest, LeavesNothingWhereFilesFindNoRoom) {
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit small = {150, before.rlim_max};  // Of a header alone is 128.
  setrlimit(RLIMIT_FSIZE, &small);
  const Outcome outcome = Write("npy");
  setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, testing::HasSubstr("File too large"));
  EXPECT_FALSE(fs::exists(output_));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_.Path()), {}), 1);
}

}  // namespace
}  // namespace tsar
