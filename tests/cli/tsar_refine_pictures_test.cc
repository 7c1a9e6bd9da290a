// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/report/debug_pictures.h"

#include <map>

#include "tests/cli/tsar_refine_fixture.h"
#include <opencv2/imgcodecs.hpp>

namespace tsar {
namespace {

// What refinement writes for others to read.
std::map<std::string, std::string> ReadMaps(const std::filesystem::path& root) {
  std::map<std::string, std::string> maps;
  for (const char* folder : {"depth_maps",
                             "normal_maps",
                             "confidence_maps",
                             "sigma_maps",
                             "provenance_maps"}) {
    for (const auto& [path, content] : ReadTree(root / "stereo" / folder)) {
      maps[std::string(folder) + "/" + path] = content;
    }
  }
  return maps;
}

TEST_F(TsarRefineTest, PicturesOfAllStagesChangeNoMap) {
  EXPECT_EQ(Run({}).exit_code, 0);
  const auto maps = ReadMaps(root_);
  ASSERT_FALSE(maps.empty());
  // Images that were done before are done again, for their pictures.
  const std::filesystem::path debug = folder_.Path() / "debug";
  const Outcome drawn = Run({"--TsarRefine.debug_path", debug.string()});
  EXPECT_EQ(drawn.exit_code, 0) << drawn.err;
  EXPECT_THAT(drawn.out, testing::HasSubstr("4 images: 4 refined\n"));
  EXPECT_TRUE(ReadMaps(root_) == maps);
  for (const std::string& image : SyntheticWorkspace::Names()) {
    for (const RefineStageInfo& info : RefineStages()) {
      const auto path = DebugPicturePath(debug, image, info.stage);
      EXPECT_FALSE(cv::imread(path.string()).empty()) << path;
    }
  }
  EXPECT_THAT(Run({}).out, testing::HasSubstr("4 done before"));
}

TEST_F(TsarRefineTest, StagesThatAreOffHaveNoPictures) {
  const std::filesystem::path debug = folder_.Path() / "debug";
  const Outcome drawn = Run({"--TsarRefine.debug_path",
                             debug.string(),
                             "--TsarRefine.scene_planes",
                             "0",
                             "--TsarRefine.view_agreement",
                             "0"});
  EXPECT_EQ(drawn.exit_code, 0) << drawn.err;
  for (const RefineStageInfo& info : RefineStages()) {
    const bool is_off = info.stage == RefineStage::kAgreement ||
                        info.stage == RefineStage::kSceneLabels ||
                        info.stage == RefineStage::kLabelEvidence ||
                        info.stage == RefineStage::kScenePlanes;
    EXPECT_NE(std::filesystem::exists(
                  DebugPicturePath(debug, "left/v2.png", info.stage)),
              is_off)
        << info.name;
  }
}

TEST_F(TsarRefineTest, APathForPicturesThatIsNoFolderIsOneLine) {
  WriteText(folder_.Path() / "file", "");
  ExpectFailure({"--TsarRefine.debug_path", (folder_.Path() / "file").string()},
                {"file"});
}

TEST_F(TsarRefineTest, PicturesGoWhereNothingElseIs) {
  ExpectFailure({"--TsarRefine.debug_path", (root_ / "images").string()},
                {"folder images", "--TsarRefine.debug_path"});
  ExpectFailure({"--TsarRefine.debug_path", root_.string()}, {"no picture"});
  const auto debug = folder_.Path() / "debug";
  WriteText(debug / "v0.png/thesis.tex", "years of work");
  ExpectFailure({"--TsarRefine.debug_path", debug.string()},
                {"v0.png/thesis.tex", "no picture"});
}

TEST_F(TsarRefineTest, ShardsDrawNoPictures) {
  const auto debug = folder_.Path() / "debug";
  ExpectFailure({"--TsarRefine.debug_path",
                 debug.string(),
                 "--TsarRefine.shard",
                 "0/2",
                 "--TsarRefine.pass",
                 "observe"},
                {"TsarRefine.debug_path", "shards"});
}

}  // namespace
}  // namespace tsar
