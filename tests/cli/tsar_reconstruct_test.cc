// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "tests/cli/command_test.h"
#include "tests/support/external_writers.h"

namespace tsar {
namespace {

namespace fs = std::filesystem;

class TsarReconstructTest : public CommandTest<&RunTsarReconstruct> {
 protected:
  void SetUp() override {
    MakeSyntheticWorkspace(root_);
    for (const char* folder : {"depth_maps", "normal_maps"}) {
      fs::remove_all(root_ / "stereo" / folder);
    }
    always_ = {"--TsarReconstruct.device=cpu",
               "--TsarStereo.depth_min=1",
               "--TsarStereo.depth_max=10",
               "--TsarStereo.num_iterations=2"};
  }

  const fs::path cloud_ = root_ / "reconstruction/fused.ply";
  const fs::path page_ = root_ / "reconstruction/report/index.html";
};

TEST_F(TsarReconstructTest, MakesACloudAndAPageAndGoesOnWhereItStopped) {
  const Outcome outcome = Run({});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, testing::HasSubstr("Stereo. Pass 3 of 3: [4/4]"));
  EXPECT_THAT(outcome.err, testing::HasSubstr("Refinement. Pass "));
  EXPECT_THAT(outcome.err, testing::HasSubstr("Page: [4/4]"));
  EXPECT_THAT(outcome.out, testing::HasSubstr(" points: " + cloud_.string()));
  EXPECT_THAT(outcome.out, testing::HasSubstr("Open " + page_.string()));
  EXPECT_THAT(outcome.out, testing::Not(testing::HasSubstr("Next: ")));
  const auto expected = ReadTree(root_);
  // As if the fusion had been interrupted.
  fs::remove_all(cloud_);
  fs::remove_all(page_.parent_path());
  const Outcome again = Run({});
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_THAT(again.out, testing::HasSubstr("4 done before: "));
  EXPECT_THAT(again.out, testing::HasSubstr("nothing to do, 4 done before"));
  EXPECT_TRUE(ReadTree(root_) == expected);
}

TEST_F(TsarReconstructTest, TakesTheOptionsOfTheThreeCommands) {
  EXPECT_EQ(Run({"--TsarStereo.geom_consistency=0",
                 "--TsarRefine.preset=paper",
                 "--TsarRefine.seed=5",
                 "--TsarFuse.min_num_views=4",
                 "--output_path",
                 (folder_.Path() / "out").string()})
                .exit_code,
            0);
  const std::string manifest = ReadText(root_ / "stereo/tsar/manifest.json");
  EXPECT_THAT(manifest, testing::HasSubstr("\"seed\": \"5\""));
  EXPECT_THAT(manifest, testing::HasSubstr("\"view_agreement\": \"0\""));
  EXPECT_FALSE(fs::exists(root_ / "stereo/depth_maps/v0.png.geometric.bin"));
  EXPECT_TRUE(fs::exists(folder_.Path() / "out/fused.ply.vis"));
  ExpectFailure({"--TsarRefine.shard=0/2"}, Words{"TsarRefine.shard"});
  ExpectFailure({"--TsarStereo.num_levels=4"}, Words{"restore 1"});
  ExpectFailure({"--output_path", (root_ / "stereo/out").string()},
                Words{"--output_path"});
}

TEST_F(TsarReconstructTest, TakesMapsOfOthersOnlyWhereToldTo) {
  MakeSyntheticWorkspace(root_);
  ExpectFailure({}, Words{"is of another program", "--overwrite 1"});
  EXPECT_EQ(Run({"--stereo=0"}).exit_code, 0);
  EXPECT_TRUE(fs::exists(cloud_));
  EXPECT_FALSE(fs::exists(root_ / "stereo/tsar_stereo"));
}

}  // namespace
}  // namespace tsar
