// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/report/page_data.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace tsar {
namespace {

constexpr char kStart[] = "window.tsarReport = ";

nlohmann::json Parse(const PageData& data) {
  const std::string script = PageDataScript(data);
  EXPECT_EQ(script.find(kStart), 0u);
  EXPECT_TRUE(script.ends_with(";\n"));
  const size_t begin = sizeof(kStart) - 1;
  return nlohmann::json::parse(script.substr(begin, script.size() - 2 - begin));
}

ImagePage MakeImage(const std::string& name) {
  ImagePage image;
  image.name = name;
  image.folder = "00000_a";
  image.width = 40;
  image.height = 30;
  image.picture_width = 20;
  image.picture_height = 15;
  image.range = {1.5f, 4.f};
  image.num_before = 300;
  image.num_after = 900;
  image.num_by_provenance = {300, 200, 0, 100, 500, 0, 100, 30};
  image.seconds = {{"matching", 2.5}};
  return image;
}

TEST(PageData, HoldsWhatThePageShows) {
  PageData data;
  data.version = "1.2.3";
  data.workspace = "dense";
  data.type = "geometric";
  data.images = {MakeImage("left/a.png")};
  data.kept = {{"b.png", "no depth"}};
  data.points.num_shown[1] = 7;
  data.points.num_all[1] = 70;
  data.points.eye = {1, 2, 3};
  const nlohmann::json json = Parse(data);
  EXPECT_EQ(json["version"], "1.2.3");
  const nlohmann::json& image = json["images"][0];
  EXPECT_EQ(image["name"], "left/a.png");
  EXPECT_EQ(image["before"], 300);
  EXPECT_EQ(image["after"], 900);
  EXPECT_EQ(image["provenance"].size(), json["provenance"].size());
  EXPECT_EQ(image["provenance"][4], 500);
  EXPECT_EQ(image["provenance"][6], 100);
  EXPECT_EQ(image["provenance"][7], 30);
  EXPECT_EQ(image["seconds"]["matching"], 2.5);
  EXPECT_EQ(image["nearest"], 1.5);
  EXPECT_EQ(json["kept"][0]["reason"], "no depth");
  EXPECT_EQ(json["points"]["shown"][1], 7);
  EXPECT_EQ(json["points"]["all"][1], 70);
  EXPECT_EQ(json["points"]["eye"], (nlohmann::json{1.0, 2.0, 3.0}));
  EXPECT_TRUE(json["points"]["target"].is_null());
  data.points.target = {4, 5, 6};
  EXPECT_EQ(Parse(data)["points"]["target"], (nlohmann::json{4.0, 5.0, 6.0}));
  EXPECT_TRUE(json["gains"].empty());
  EXPECT_EQ(json["provenance"][1]["name"], "measured");
  EXPECT_EQ(json["provenance"][6]["name"], "guessed");
  EXPECT_EQ(json["provenance"][7]["name"], "prior");
  EXPECT_EQ(json["depth_colors"].size(), json["value_colors"].size());
}

TEST(PageData, HostileNamesStayText) {
  PageData data;
  const std::string names[] = {"</script><script>alert(1)</script>.png",
                               "\"; alert(1); //.png",
                               "\\\" <!-- \n.png",
                               "line\xE2\x80\xA8separator.png"};
  for (const std::string& name : names) {
    data.images.push_back(MakeImage(name));
    data.kept.push_back({name, name});
  }
  const std::string script = PageDataScript(data);
  EXPECT_THAT(script, testing::Not(testing::HasSubstr("<")));
  EXPECT_THAT(script, testing::Not(testing::HasSubstr("\xE2\x80\xA8")));
  const nlohmann::json json = Parse(data);
  for (size_t i = 0; i < std::size(names); ++i) {
    EXPECT_EQ(json["images"][i]["name"], names[i]);
    EXPECT_EQ(json["kept"][i]["reason"], names[i]);
  }
}

TEST(PageData, NamesThatAreNoUtf8DoNotBreakIt) {
  PageData data;
  data.images = {MakeImage("latin1\xE9.png")};
  EXPECT_EQ(Parse(data)["images"][0]["name"], "latin1\xEF\xBF\xBD.png");
}

TEST(PageData, ShowsGainsRowByRow) {
  PageData data;
  DepthScore before = {"textureless", 0.02, 1, 2, 10};
  DepthScore after = {"textureless", 0.02, 6, 8, 10};
  data.gains.depth = {{1, 0, {before}}, {1, 0, {after}}};
  data.gains.clouds = {{5, 9, {{0.1, 0.25, 0.5, 0.4}}},
                       {6, 9, {{0.1, 0.5, 0.75, 0.6}}}};
  const nlohmann::json gains = Parse(data)["gains"];
  EXPECT_EQ(gains["depth"][0]["area"], "textureless");
  EXPECT_EQ(gains["depth"][0]["before"]["recall"], 0.1);
  EXPECT_EQ(gains["depth"][0]["after"]["precision"], 0.75);
  EXPECT_EQ(gains["clouds"][0]["tolerance"], 0.1);
  EXPECT_EQ(gains["clouds"][0]["before"]["completeness"], 0.25);
  EXPECT_EQ(gains["clouds"][0]["after"]["accuracy"], 0.75);
  EXPECT_EQ(gains["clouds"][0]["after"]["f1"], 0.6);
}

}  // namespace
}  // namespace tsar
