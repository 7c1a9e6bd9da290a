// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/refine_option_list.h"

#include <map>
#include <utility>

#include "tests/cli/command_test.h"
#include "tests/support/external_writers.h"
#include "tests/support/mask_files.h"
#include <nlohmann/json.hpp>

namespace tsar {
namespace {

class TsarRefineTest : public CommandTest<&RunTsarRefine> {
 protected:
  void SetUp() override {
    MakeSyntheticWorkspace(root_);
    always_ = {"--TsarRefine.device", "cpu"};
  }
};

TEST_F(TsarRefineTest, RefinesReportsAndRestores) {
  const auto before = ReadTree(root_);
  const Outcome refined = Run({});
  EXPECT_EQ(refined.exit_code, 0) << refined.err;
  EXPECT_THAT(refined.out, testing::HasSubstr("4 images: 4 refined\n"));
  EXPECT_THAT(refined.out, testing::HasSubstr("Pixels with depth: "));
  EXPECT_THAT(refined.out,
              testing::HasSubstr("Next: colmap stereo_fusion "
                                 "--workspace_path " +
                                 root_.string() + " --input_type geometric"));
  EXPECT_THAT(refined.err, testing::HasSubstr("[4/4]"));
  EXPECT_FALSE(ReadTree(root_) == before);

  const Outcome again = Run({});
  EXPECT_EQ(again.exit_code, 0);
  EXPECT_EQ(again.out,
            "4 images: nothing to do, 4 done before with the same options\n"
            "Next: colmap stereo_fusion --workspace_path " +
                root_.string() + " --input_type geometric --output_path " +
                (root_ / "fused.ply").string() + "\n");
  EXPECT_EQ(again.err, "");

  const Outcome restored = Run({"--restore", "1"});
  EXPECT_EQ(restored.exit_code, 0) << restored.err;
  EXPECT_EQ(restored.out, "Put the original maps of 4 images back.\n");
  EXPECT_TRUE(ReadTree(root_) == before);
}

// As left by programs that train on the undistorted images.
TEST_F(TsarRefineTest, TellsToCopyAModelInTheFolder0) {
  std::filesystem::rename(root_ / "sparse", root_ / "0");
  std::filesystem::create_directory(root_ / "sparse");
  std::filesystem::rename(root_ / "0", root_ / "sparse/0");
  const Outcome refined = Run({});
  EXPECT_EQ(refined.exit_code, 0) << refined.err;
  EXPECT_THAT(refined.out,
              testing::HasSubstr((root_ / "sparse").string() +
                                 " itself: first copy there what is in " +
                                 (root_ / "sparse/0").string() + "\nNext: "));
}

// Masks, priors, a list of images, a second workspace and its maps.
TEST_F(TsarRefineTest, TellsWhatItWasGiven) {
  const auto before = ReadTree(root_);
  const std::filesystem::path masks = folder_.Path() / "masks";
  const std::filesystem::path priors = folder_.Path() / "priors";
  const std::string output = (folder_.Path() / "out").string();
  const std::string list = (folder_.Path() / "list.txt").string();
  WriteMask(
      masks / "left/v2.png.png", 96, 72, [](int x, int) { return x < 9; });
  std::filesystem::create_directories(priors / "left");
  WriteText(priors / "left/v2.pfm",
            PfmBytes(4, 3, 1, std::vector<float>(12, 2.f), true));
  Words words = {"--mask_path",
                 masks.string(),
                 "--prior_path",
                 priors.string(),
                 "--prior_type",
                 "metric",
                 "--image_list_path",
                 list,
                 "--output_path",
                 output,
                 "--input_type",
                 "photometric"};
  WriteText(list, "v1.png\nv9.png\n");
  ExpectFailure(words, {"list.txt", "v9.png"});
  WriteText(list, "v1.png\nleft/v2.png\n");
  const Outcome outcome = Run(words);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out,
              testing::AllOf(
                  testing::HasSubstr(
                      "4 images: 2 refined, 2 not in the list\n  masks for 1 "
                      "of 4 images\n  depth priors for 1 of 4 images, 1 of "
                      "them not used (stereo/tsar/manifest.json says why)\n"),
                  testing::HasSubstr(output + " --input_type photometric")));
  EXPECT_TRUE(ReadTree(root_) == before);
  EXPECT_TRUE(std::filesystem::is_regular_file(
      folder_.Path() / "out/stereo/depth_maps/left/v2.png.photometric.bin"));
}

TEST_F(TsarRefineTest, OptionsComeOnTopOfThePreset) {
  const std::map<std::string, std::string> paper =
      RefineOptionsText(PresetOptions(RefinePreset::kPaper));
  ASSERT_EQ(paper.at("view_agreement"), "0");
  ASSERT_NE(paper.at("num_iterations"), "2");
  WriteText(folder_.Path() / "project.ini",
            "random_seed = 0\n[TsarRefine]\npreset = paper\n"
            "num_iterations = 2\ngpu_index = 0,2\nseed = 2\n");
  for (const Words& more : {Words{}, Words{"--random_seed=3"}}) {
    Words words = {"--project_path",
                   (folder_.Path() / "project.ini").string(),
                   "--log_to_stderr",
                   "1"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = Run(words);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    const auto manifest =
        nlohmann::json::parse(ReadText(root_ / "stereo/tsar/manifest.json"));
    EXPECT_EQ(manifest["runtime"]["gpu_index"], "0,2");
    for (const auto& [name, value] : paper) {
      EXPECT_EQ(manifest["options"][name],
                name == "num_iterations" ? "2"
                : name != "seed"         ? value
                : more.empty()           ? "2"
                                         : "3")
          << name;
    }
  }
}

TEST_F(TsarRefineTest, WrongOptionsAreOneLine) {
  const std::string here = root_.string();
  const std::string nowhere = (folder_.Path() / "nowhere").string();
  const std::pair<Words, Words> failures[] = {
      {{"--TsarRefine.filter_confidence=0",
        "--TsarRefine.filter_discontinuity=0",
        "--TsarRefine.view_agreement=0"},
       {"--TsarRefine.filter: nothing is left"}},
      {{"--prior_type", "metric"}, {"--prior_type", "--prior_path"}},
      {{"--prior_path", nowhere},
       {"ERROR: " + nowhere + ": there is no such folder",
        "check --prior_path"}},
      {{"--mask_path", nowhere},
       {"ERROR: " + nowhere + ": there is no such folder",
        "check --mask_path"}},
      {{"--output_path", here}, {"--output_path"}},
      {{"--image_list_path", here, "--TsarRefine.pass", "observe"},
       {"--image_list_path", "--TsarRefine.pass all"}},
      {{"--restore", "1", "--image_list_path", here},
       {"leave --image_list_path out"}},
      {{"--restore", "1", "--output_path", "out"}, {"--output_path"}},
      {{"--restore", "1", "--mask_path", here}, {"leave --mask_path out"}},
      {{"--restore", "1", "--prior_path", here}, {"leave --prior_path out"}},
      {{"--restore", "1"}, {"nothing to restore"}},
      {{"--TsarRefine.shard", "0/2"}, {"TsarRefine.pass observe"}},
      {{"--TsarRefine.pass", "compose", "--TsarRefine.shard", "1/2"},
       {"was not observed", "pass observe"}},
      {{"--TsarRefine.pass", "merge"}, {"4 of 4 images"}},
  };
  for (const auto& [arguments, texts] : failures) {
    SCOPED_TRACE(testing::PrintToString(arguments));
    ExpectFailure(arguments, texts);
  }
  ExpectFailure({"--TsarRefine.pass", "observe", "--TsarRefine.shard=2/2"},
                {"TsarRefine.shard", "i/n"});
}

TEST(TsarRefine, HelpTeaches) {
  const Outcome outcome = RunCommandWith<&RunTsarRefine>({"--help"});
  for (const char* text : {"Run it after",
                           "--restore 1",
                           "colmap tsar_refine --workspace_path dense",
                           "--TsarRefine.preset default|paper (=default)",
                           "manifest.json"}) {
    EXPECT_THAT(outcome.out, testing::HasSubstr(text));
  }
  EXPECT_THAT(RunCommandWith<&RunTsarRefine>({"--help_json"}).out,
              testing::HasSubstr("In the preset paper: 1."));
}

}  // namespace
}  // namespace tsar
