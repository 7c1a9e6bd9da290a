// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/map_io.h"

#include <filesystem>

#include "tests/cli/command_test.h"
#include "tests/support/synthetic_workspace.h"
#include <nlohmann/json.hpp>

namespace tsar {
namespace {

namespace fs = std::filesystem;

class TsarFuseTest : public CommandTest<&RunTsarFuse> {
 protected:
  void SetUp() override { MakeSyntheticWorkspace(root_); }

  Outcome Fuse(const Words& more = {}) const {
    Words arguments = {
        "--output_path", output_.string(), "--TsarFuse.device", "cpu"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return Run(arguments);
  }

  uintmax_t FuseAnew(const Words& more) const {
    Words arguments = {"--overwrite", "1"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = Fuse(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return fs::file_size(output_);
  }

  const fs::path output_ = folder_.Path() / "fused.ply";
};

TEST_F(TsarFuseTest, TellsWhatItWroteAndReplacesACloudOnlyWhereToldTo) {
  WriteText(output_.string() + ".vis", std::string(8, '\0'));
  ExpectFailure({"--output_path", output_.string(), "--TsarFuse.device", "cpu"},
                Words{output_.string() + ".vis", "--overwrite 1"});
  const Outcome outcome = Fuse({"--overwrite", "1"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, testing::HasSubstr("Fused 4 images into "));
  EXPECT_THAT(outcome.out,
              testing::HasSubstr(" points: " + output_.string() + "\n"));
  EXPECT_THAT(outcome.out,
              testing::ContainsRegex("\nTime: [0-9]+\\.[0-9] s on [0-9]+ CPU"));
  EXPECT_GT(fs::file_size(output_.string() + ".vis"), 8u);
}

TEST_F(TsarFuseTest, ReplacesNothingButACloud) {
  const std::string list = output_.string() + ".vis";
  for (const auto& [path, text] :
       {std::pair(output_.string(), "years of work"),
        std::pair(output_.string(), "ply\nproperty float nx\nelement face 0\n"),
        std::pair(list, "years of work")}) {
    WriteText(path, text);
    ExpectFailure({"--output_path", output_.string(), "--overwrite", "1"},
                  Words{path, "is no"});
    fs::remove(path);
  }
  FuseAnew({});
  FuseAnew({});
}

TEST_F(TsarFuseTest, OptionsComeBeforeThoseOfThePreset) {
  const uintmax_t by_default = FuseAnew({});
  const uintmax_t dense = FuseAnew({"--TsarFuse.point_spacing", "1"});
  EXPECT_GT(dense, 3 * by_default);
  // The paper's fusion uses every pixel.
  EXPECT_GT(FuseAnew({"--TsarFuse.preset", "paper"}), 3 * by_default);
  EXPECT_LT(
      FuseAnew({"--TsarFuse.preset", "paper", "--TsarFuse.point_spacing", "2"}),
      dense / 2);
  EXPECT_LT(FuseAnew({"--TsarFuse.min_num_views", "4"}), by_default);
  const fs::path box = folder_.Path() / "box.txt";
  WriteText(box, "-100 -100 -100 0 100 100\n");
  EXPECT_LT(FuseAnew({"--bounding_box_path", box.string()}), by_default);
}

TEST_F(TsarFuseTest, RefusesWhatCannotBe) {
  ExpectFailure({"--output_path",
                 output_.string(),
                 "--bounding_box_path",
                 "/nowhere/box.txt"},
                "/nowhere/box.txt");
  ExpectFailure({"--output_path", (root_ / "stereo/fused.ply").string()},
                "--output_path");
}

class TsarEvaluateFusedPixelsTest : public CommandTest<&RunTsarEvaluate> {};

TEST_F(TsarEvaluateFusedPixelsTest, ComparesEachPointOnceWithTheTruth) {
  MakeSyntheticWorkspace(root_);
  const fs::path truth = folder_.Path() / "truth";
  for (const std::string& name : SyntheticWorkspace::Names()) {
    const ContainedPath path(truth, name + ".bin");
    CreateFolders(path.Parent());
    WriteDepthMap(path,
                  Image<float>(SyntheticWorkspace::kWidth,
                               SyntheticWorkspace::kHeight,
                               static_cast<float>(SyntheticWorkspace::kDepth)));
  }
  const auto evaluate = [&](const std::string& tolerances,
                            const std::string& min_num_views) {
    const Outcome outcome = Run({"fused_pixels",
                                 "--ground_truth_path",
                                 truth.string(),
                                 "--device",
                                 "cpu",
                                 "--json",
                                 "1",
                                 "--tolerances",
                                 tolerances,
                                 "--min_num_views",
                                 min_num_views});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return nlohmann::json::parse(outcome.out);
  };
  const nlohmann::json scores = evaluate("0.001,0.5", "3");
  const int num_pixels =
      SyntheticWorkspace::kWidth * SyntheticWorkspace::kHeight;
  EXPECT_EQ(scores["num_images"], 4);
  EXPECT_EQ(scores["num_known"], 4 * num_pixels);
  // Once, although all four images see it.
  EXPECT_GT(scores["num_fused"], num_pixels / 2);
  EXPECT_LT(scores["num_fused"], 2 * num_pixels);
  EXPECT_LT(scores["scores"][0]["of_fused"], 0.5);
  EXPECT_GT(scores["scores"][1]["of_fused"], 0.99);
  EXPECT_NEAR(scores["scores"][1]["of_known"].get<double>(),
              scores["scores"][1]["of_fused"].get<double>() *
                  scores["num_fused"].get<double>() / (4 * num_pixels),
              1e-9);
  EXPECT_GT(evaluate("0.5", "2")["num_fused"], scores["num_fused"]);
}

}  // namespace
}  // namespace tsar
