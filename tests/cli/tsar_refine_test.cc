// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/refine_option_list.h"

#include <map>
#include <utility>

#include "tests/cli/tsar_refine_fixture.h"
#include "tests/support/external_writers.h"
#include "tests/support/mask_files.h"

namespace tsar {
namespace {

TEST_F(TsarRefineTest, TakesWhatAllCommandsOfColmapTake) {
  EXPECT_EQ(Run({"--random_seed", "7", "--log_to_stderr", "1"}).exit_code, 0);
  EXPECT_EQ(UsedOptions()["seed"], "7");
}

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
            "4 images: nothing to do, 4 done before with the same options\n");
  EXPECT_EQ(again.err, "");

  const Outcome restored = Run({"--restore", "1"});
  EXPECT_EQ(restored.exit_code, 0) << restored.err;
  EXPECT_EQ(restored.out, "Put the original maps of 4 images back.\n");
  EXPECT_TRUE(ReadTree(root_) == before);
}

// As the programs leave it that train on the undistorted images.
TEST_F(TsarRefineTest, TakesAModelInTheFolder0) {
  std::filesystem::rename(root_ / "sparse", root_ / "0");
  std::filesystem::create_directory(root_ / "sparse");
  std::filesystem::rename(root_ / "0", root_ / "sparse/0");
  const std::string output = (folder_.Path() / "out").string();
  const Outcome second = Run({"--output_path", output});
  EXPECT_EQ(second.exit_code, 0) << second.err;
  EXPECT_THAT(second.out, testing::Not(testing::HasSubstr("first copy")));
  EXPECT_TRUE(
      std::filesystem::exists(folder_.Path() / "out/sparse/images.txt"));
  const Outcome refined = Run({});
  EXPECT_EQ(refined.exit_code, 0) << refined.err;
  EXPECT_THAT(refined.out,
              testing::HasSubstr((root_ / "sparse").string() +
                                 " itself: first copy there what is in " +
                                 (root_ / "sparse/0").string() + "\nNext: "));
  const std::string picture = (folder_.Path() / "picture.png").string();
  const std::string planes = (folder_.Path() / "planes.json").string();
  const auto run = [&](CommandFunction command, const std::string& path) {
    const Outcome outcome =
        RunCaptured("colmap",
                    {"--workspace_path", root_.string(), "--output_path", path},
                    command);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_TRUE(std::filesystem::exists(path));
  };
  run([](int argc,
         char** argv) { return RunCommand(&RunTsarReport, argc, argv); },
      picture);
  run([](int argc,
         char** argv) { return RunCommand(&RunTsarPlanes, argc, argv); },
      planes);
  // Once it is copied, nothing is to be done again.
  for (const char* name : {"cameras.txt", "images.txt", "points3D.txt"}) {
    std::filesystem::copy(root_ / "sparse/0" / name, root_ / "sparse" / name);
  }
  const Outcome again = Run({});
  EXPECT_THAT(again.out, testing::HasSubstr("4 done before"));
  EXPECT_THAT(again.out, testing::Not(testing::HasSubstr("first copy")));
}

TEST_F(TsarRefineTest, TellsOfHowManyImagesThereAreMasksAndPriors) {
  const std::filesystem::path masks = folder_.Path() / "masks";
  const std::filesystem::path priors = folder_.Path() / "priors";
  WriteMask(
      masks / "left/v2.png.png", 96, 72, [](int x, int) { return x < 9; });
  std::filesystem::create_directories(priors / "left");
  WriteText(priors / "left/v2.pfm",
            PfmBytes(4, 3, 1, std::vector<float>(12, 2.f), true));
  const Outcome outcome = Run({"--mask_path",
                               masks.string(),
                               "--prior_path",
                               priors.string(),
                               "--prior_type",
                               "metric"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out,
              testing::HasSubstr(
                  "4 images: 4 refined\n  masks for 1 of 4 images\n  depth "
                  "priors for 1 of 4 images, 1 of them not used "
                  "(stereo/tsar/manifest.json says why)\n"));
}

TEST_F(TsarRefineTest, RefinesListedImagesAlone) {
  const std::string list = (folder_.Path() / "list.txt").string();
  WriteText(list, "v1.png\nv9.png\n");
  ExpectFailure({"--image_list_path", list},
                {"ERROR: " + list + ": line 2 names v9.png"});
  WriteText(list,
            std::string("\x7F"
                        "ELF\x02\x01\0\0\n",
                        9));
  ExpectFailure({"--image_list_path", list}, {"line 1 is no image name"});
  WriteText(list, "v1.png\nv3.png\n");
  ExpectFailure({"--image_list_path", list, "--restore", "1"},
                {"leave --image_list_path out"});
  ExpectFailure({"--image_list_path", list, "--TsarRefine.pass", "observe"},
                {"--image_list_path", "--TsarRefine.pass all"});
  const Outcome outcome = Run({"--image_list_path", list});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out,
              testing::HasSubstr("4 images: 2 refined, 2 not in the list\n"));
}

TEST_F(TsarRefineTest, WritesASecondWorkspace) {
  const auto before = ReadTree(root_);
  const std::string output = (folder_.Path() / "out").string();
  const Outcome outcome =
      Run({"--output_path", output, "--input_type", "photometric"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out,
              testing::HasSubstr(output + " --input_type photometric"));
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
            "[TsarRefine]\npreset = paper\nseed = 2\nnum_iterations = 2\n");
  const Outcome outcome = Run({"--project_path",
                               (folder_.Path() / "project.ini").string(),
                               "--TsarRefine.seed=3"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const auto& [name, value] : paper) {
    EXPECT_EQ(UsedOptions()[name],
              name == "num_iterations" ? "2"
              : name == "seed"         ? "3"
                                       : value)
        << name;
  }
}

TEST_F(TsarRefineTest, WrongOptionsAreOneLine) {
  const std::string here = root_.string();
  const std::string nowhere = (folder_.Path() / "nowhere").string();
  const std::pair<Words, Words> failures[] = {
      {{"--TsarRefine.num_thread", "3"},
       {"--TsarRefine.num_thread", "num_threads"}},
      {{"--TsarRefine.num_iterations", "0"},
       {"--TsarRefine.num_iterations", "'0'", "from 1 to 10"}},
      {{"--TsarRefine.filter_confidence=0",
        "--TsarRefine.filter_discontinuity=0",
        "--TsarRefine.view_agreement=0"},
       {"--TsarRefine.filter: nothing is left"}},
      {{"--TsarRefine.num_threads", "0"}, {"num_threads"}},
      {{"--TsarRefine.gpu_index", "0,-3"}, {"gpu_index", "-3"}},
      {{"--TsarRefine.gpu_index", "first"}, {"gpu_index", "first"}},
      {{"--TsarRefine.preset", "best"}, {"preset", "paper"}},
      {{"--input_type", "normal"}, {"input_type", "photometric"}},
      {{"--prior_type", "metric"}, {"--prior_type", "--prior_path"}},
      {{"--prior_path", nowhere, "--prior_type", "depth"},
       {"--prior_type", "auto, metric, relative, inverse"}},
      {{"--prior_path", nowhere},
       {"ERROR: " + nowhere + ": there is no such folder",
        "check --prior_path"}},
      {{"--mask_path", nowhere},
       {"ERROR: " + nowhere + ": there is no such folder",
        "check --mask_path"}},
      {{"--output_path", here}, {"--output_path"}},
      {{"--restore", "1", "--output_path", "out"}, {"--output_path"}},
      {{"--restore", "1", "--mask_path", here}, {"leave --mask_path out"}},
      {{"--restore", "1", "--prior_path", here}, {"leave --prior_path out"}},
      {{"--restore", "1"}, {"nothing to restore"}},
      {{"--TsarRefine.shard", "0/2"}, {"TsarRefine.pass observe"}},
      {{"--TsarRefine.pass", "half"}, {"pass", "compose"}},
      {{"--TsarRefine.pass", "compose", "--TsarRefine.shard", "1/2"},
       {"0, 1 have not", "pass observe"}},
      {{"--TsarRefine.pass", "merge"}, {"4 of 4 images"}},
  };
  for (const auto& [arguments, texts] : failures) {
    SCOPED_TRACE(testing::PrintToString(arguments));
    ExpectFailure(arguments, texts);
  }
  for (const char* shard : {"3/", "0/0", "-1/2", "1/2x", "2/2"}) {
    ExpectFailure({"--TsarRefine.pass",
                   "observe",
                   std::string("--TsarRefine.shard=") + shard},
                  {"TsarRefine.shard", "i/n"});
  }
  EXPECT_THAT(RunCommandWith<&RunTsarRefine>({}).err,
              testing::HasSubstr("--workspace_path"));
}

TEST_F(TsarRefineTest, RefinesInShards) {
  const auto before = ReadTree(root_);
  for (const char* pass : {"observe", "compose"}) {
    if (pass == std::string("compose")) {
      const Outcome outcome = Run({"--TsarRefine.pass", "model"});
      EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
      EXPECT_THAT(outcome.out, testing::HasSubstr("planes of the scene"));
    }
    for (const char* shard : {"0/2", "1/2"}) {
      const Outcome outcome =
          Run({"--TsarRefine.pass", pass, "--TsarRefine.shard", shard});
      EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
      EXPECT_THAT(outcome.out, testing::HasSubstr("Shard "));
    }
  }
  const Outcome merged = Run({"--TsarRefine.pass", "merge"});
  EXPECT_EQ(merged.exit_code, 0) << merged.err;
  EXPECT_THAT(merged.out, testing::HasSubstr("4 images: 4 refined\n"));
  EXPECT_EQ(Run({"--restore", "1"}).exit_code, 0);
  EXPECT_TRUE(ReadTree(root_) == before);
}

TEST_F(TsarRefineTest, BrokenWorkspacesAreOneLine) {
  std::filesystem::remove(root_ / "images/v3.png");
  ExpectFailure({}, {"images/v3.png", "no such image"});
  std::filesystem::remove_all(root_ / "stereo");
  ExpectFailure({}, {"stereo", "no such folder"});
  ExpectFailure({"--restore", "1"}, {"stereo", "no such folder"});
}

TEST_F(TsarRefineTest, TakesListsOfGpus) {
  const Outcome outcome = Run({"--TsarRefine.gpu_index", "0,2"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(nlohmann::json::parse(ReadText(
                root_ / "stereo/tsar/manifest.json"))["runtime"]["gpu_index"],
            "0,2");
}

TEST(TsarRefine, HelpTeaches) {
  const Outcome outcome = RunCommandWith<&RunTsarRefine>({"--help"});
  for (const char* text : {"after patch_match_stereo",
                           "--restore 1",
                           "colmap tsar_refine --workspace_path dense",
                           "--TsarRefine.preset default|paper (=default)",
                           "manifest.json"}) {
    EXPECT_THAT(outcome.out, testing::HasSubstr(text));
  }
  const Outcome all = RunCommandWith<&RunTsarRefine>({"--help_all"});
  RefineOptions options;
  for (const RefineField& field : ListRefineFields(&options)) {
    EXPECT_THAT(all.out,
                testing::HasSubstr("\n  --TsarRefine." + field.name + " "));
  }
  EXPECT_THAT(all.out, testing::HasSubstr("In the preset paper: 1."));
}

}  // namespace
}  // namespace tsar
