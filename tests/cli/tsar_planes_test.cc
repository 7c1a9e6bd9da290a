// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/scene_model_file.h"

#include <cmath>
#include <filesystem>
#include <string>

#include "tests/cli/command_test.h"
#include "tests/support/room_workspace.h"
#include <nlohmann/json.hpp>

namespace tsar {
namespace {

namespace fs = std::filesystem;

class TsarPlanesTest : public CommandTest<&RunTsarPlanes> {
 protected:
  Outcome Write(const fs::path& path, const Words& more = {}) const {
    Words arguments = {"--output_path", path.string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return Run(arguments);
  }

  void SetUp() override { room_.Write(); }

  const RoomWorkspace room_{root_};
  const fs::path json_ = folder_.Path() / "planes.json";
};

TEST_F(TsarPlanesTest, WritesThePlanes) {
  const auto workspace = ReadTree(room_.root);
  const Outcome outcome = Write(json_);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(
      outcome.out,
      testing::StartsWith("Wrote 7 planes of 8 images to " + json_.string() +
                          ", 6 with an outline\n  floor: 1, area 20"));
  EXPECT_THAT(outcome.out, testing::HasSubstr("\n  wall: 4, area "));
  const auto json = nlohmann::json::parse(ReadText(json_));
  EXPECT_EQ(json["planes"].size(), 7u);
  EXPECT_TRUE(ReadTree(room_.root) == workspace);

  ExpectFailure({"--output_path", json_.string()}, "--overwrite 1");
  EXPECT_EQ(Write(json_, {"--overwrite", "1", "--min_area", "15"}).exit_code,
            0);
  EXPECT_EQ(nlohmann::json::parse(ReadText(json_))["planes"].size(), 2u);
}

int CountOf(const std::string& text, const std::string& part) {
  int count = 0;
  for (size_t place = text.find(part); place != std::string::npos;
       place = text.find(part, place + 1)) {
    ++count;
  }
  return count;
}

// Planes without outlines are neither in files of faces nor counted: one plane
// of the room is seen by no image.
TEST_F(TsarPlanesTest, CountsWhatTheFileHolds) {
  for (const auto& [name, group] : {std::pair("planes.obj", "\ng plane_"),
                                    std::pair("planes.dxf", "\nPOLYLINE\n")}) {
    const fs::path path = folder_.Path() / name;
    const std::string out = Write(path).out;
    EXPECT_THAT(out,
                testing::StartsWith("Wrote 6 planes of 8 images to " +
                                    path.string() + "\n"));
    EXPECT_THAT(out, testing::HasSubstr("for an outline: 1 (JSON has them)\n"));
    // The front wall of the room has a hole.
    EXPECT_EQ(CountOf(ReadText(path), group), name[7] == 'o' ? 6 : 7);
    EXPECT_EQ(Write(path, {"--overwrite", "1"}).exit_code, 0);
    for (const char* text : {"years of work",
                             "#!/bin/sh\n# tsar_planes AC1009\nFLOOR\n",
                             R"({"planes": "tsar_planes"})"}) {
      WriteText(path, text);
      ExpectFailure({"--output_path", path.string(), "--overwrite", "1"},
                    Words{path.string(), "is no file of planes"});
    }
  }
}

TEST_F(TsarPlanesTest, TurnsAndScales) {
  EXPECT_EQ(
      Write(json_, {"--up", "y", "--scale", "2", "--min_area", "60"}).exit_code,
      0);
  const auto json = nlohmann::json::parse(ReadText(json_));
  EXPECT_EQ(json["vertical"], nlohmann::json({0, 1, 0}));
  EXPECT_EQ(json["unit"], "meter");
  ASSERT_EQ(json["planes"].size(), 2u);  // Those of at least 15 square units.
  for (const auto& plane : json["planes"]) {
    EXPECT_NEAR(std::abs(plane["normal"][1].get<double>()), 1.0, 1e-3);
    EXPECT_GT(plane["area"].get<double>(), 60.0);
  }
}

TEST_F(TsarPlanesTest, DrawsAFloorPlanOfTheWalls) {
  const fs::path plan = folder_.Path() / "plan.svg";
  Outcome outcome = Run({"--plan_path", plan.string()});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, "Drew 4 walls to " + plan.string() + "\n");
  EXPECT_EQ(CountOf(ReadText(plan), "<g id=\"plane_"), 4);
  ExpectFailure({"--plan_path", plan.string()}, "--overwrite 1");
  EXPECT_EQ(Run({"--plan_path", plan.string(), "--overwrite", "1"}).exit_code,
            0);
  const std::string dxf = (folder_.Path() / "plan.dxf").string();
  outcome = Write(json_, {"--plan_path", dxf, "--scale", "2"});
  EXPECT_THAT(outcome.out, testing::StartsWith("Wrote 7 planes"));
  EXPECT_THAT(outcome.out, testing::HasSubstr("\nDrew 4 walls to " + dxf));
  EXPECT_TRUE(fs::is_regular_file(json_));
  EXPECT_EQ(CountOf(ReadText(dxf), "\nLINE\n"), 4);
  const std::string other = (folder_.Path() / "other.dxf").string();
  // The walls are the smaller planes.
  outcome = Write(folder_.Path() / "other.json",
                  {"--plan_path", other, "--min_area", "15"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, testing::HasSubstr("no plane is a wall"));
  EXPECT_FALSE(fs::exists(folder_.Path() / "other.json"));
}

TEST_F(TsarPlanesTest, RefusesWhatCannotBe) {
  fs::create_directories(json_);
  const auto path = [&](const char* name) {
    return (folder_.Path() / name).string();
  };
  const std::string file = path("a.json");
  const std::pair<Words, const char*> failures[] = {
      {{}, "output_path"},
      {{"--output_path", json_.string()}, "is no file of planes"},
      {{"--output_path", path("planes")}, "does not tell the format"},
      {{"--output_path", path("none/a.json")},
       "no such folder to write the file of planes into"},
      {{"--output_path", (room_.root / "stereo/a.json").string()}, "stereo"},
      {{"--output_path", file, "--input_type", "photometric"},
       "no refined photometric maps"},
      {{"--plan_path", path("a.dxf"), "--output_path", path("a.dxf")},
       "--plan_path: is the --output_path, too"},
      {{"--plan_path", path("plan.png")}, "let it end in .svg or .dxf"},
      {{"--plan_path", path("none/a.svg")}, "choose another --plan_path"},
      // Options that have no effect on a floor plan alone.
      {{"--plan_path", path("a.dxf"), "--up", "y"},
       "--up is for --output_path"}};
  for (const auto& [arguments, text] : failures) {
    ExpectFailure(arguments, text);
  }
  fs::remove(GetSceneModelPath(room_.root).Path());
  ExpectFailure({"--output_path", file}, "without keeping the planes");
}

}  // namespace
}  // namespace tsar
