// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "tests/cli/command_test.h"
#include <nlohmann/json.hpp>

namespace tsar {
namespace {

TEST(TsarEvaluate, WrongArgumentsAreOneLine) {
  using Words = std::vector<std::string>;
  const std::pair<Words, std::string> failures[] = {
      {{}, "depth, cloud or fused_pixels"},
      {{"mesh"}, "depth, cloud or fused_pixels"},
      {{"cloud", "--mask_path", "masks"}, "ERROR: unknown option --mask_path"},
      {{"depth", "--workspace_path", "nowhere", "--tolerances=0.1,"},
       "ERROR: --tolerances: "}};
  for (const auto& [arguments, text] : failures) {
    SCOPED_TRACE(testing::PrintToString(arguments));
    const Outcome outcome = RunCommandWith<&RunTsarEvaluate>(arguments);
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.err, testing::HasSubstr(text));
  }
}

using TsarEvaluateDepthTest = CommandTest<&RunTsarEvaluate>;

TEST_F(TsarEvaluateDepthTest, TellsHowManyImagesAreRefined) {
  MakeSyntheticWorkspace(root_);
  const Words depth = {
      "tsar_evaluate", "depth", "--workspace_path", root_.string()};
  const std::string name = SyntheticWorkspace::Names()[0];
  WriteText(root_ / "ground_truth/depth" / (name + ".bin"),
            ReadText(GetMapPaths(root_, name, MapType::kGeometric).depth));
  EXPECT_EQ(RunWith(depth).err, "");
  std::filesystem::create_directories(root_ / "stereo/tsar/evidence");
  const Outcome outcome = RunWith(depth);
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.err, testing::HasSubstr("0 of 4 images are refined"));
}

// A scan of one point, and a cloud that has it and a point in front of it.
class TsarEvaluateCloudTest : public testing::Test {
 protected:
  TsarEvaluateCloudTest() {
    WriteText(
        folder_.Path() / "scan.mlp",
        "<MeshLabProject><MeshGroup><MLMesh filename=\"scan.ply\">"
        "<MLMatrix44>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</MLMatrix44></MLMesh>"
        "</MeshGroup></MeshLabProject>");
    WriteText(folder_.Path() / "scan.ply",
              kPly + "element vertex 1\n" + kXyz + "2 0 0\n");
    WriteText(folder_.Path() / "cloud.ply",
              kPly + "element vertex 2\n" + kXyz + "2 0 0\n1 0 0\n");
  }
  Outcome Evaluate(const std::string& json) const {
    return RunWith({"tsar_evaluate",
                    "cloud",
                    "--input_path",
                    (folder_.Path() / "cloud.ply").string(),
                    "--ground_truth_path",
                    (folder_.Path() / "scan.mlp").string(),
                    "--tolerances",
                    "0.1",
                    "--json",
                    json});
  }

  const std::string kPly = "ply\nformat ascii 1.0\n";
  const std::string kXyz =
      "property float x\nproperty float y\nproperty float z\nend_header\n";
  const TemporaryFolder folder_;
};

TEST_F(TsarEvaluateCloudTest, PrintsJsonOrATable) {
  const Outcome outcome = Evaluate("1");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  nlohmann::json json = nlohmann::json::parse(outcome.out);
  EXPECT_NEAR(json["scores"][0]["f1"].get<double>(), 2.0 / 3.0, 1e-12);
  json["scores"][0].erase("f1");
  EXPECT_EQ(json,
            nlohmann::json::parse(
                R"({"num_points": 2, "num_scan_points": 1, "scores": [
                  {"tolerance": 0.1, "completeness": 1, "accuracy": 0.5}]})"));
  const std::string table = Evaluate("0").out;
  EXPECT_THAT(table, testing::HasSubstr("points: 2\nscan points: 1\n"));
  EXPECT_THAT(table, testing::HasSubstr("1.0000       0.5000       0.6667"));
}

}  // namespace
}  // namespace tsar
