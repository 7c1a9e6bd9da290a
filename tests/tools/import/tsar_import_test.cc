// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/cli/print_summary.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/tools/import/import_workspace.h"

#include <cmath>

#include "tests/support/external_writers.h"
#include "tests/support/synthetic_workspace.h"
#include "tests/tools/import/import_fixture.h"

namespace tsar {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

TEST_F(TsarImportTest, TakesOpenMvsMapsBitByBit) {
  WriteOpenMvs();
  fs::remove_all(root_ / "stereo");
  const auto before = ReadTree(root_);
  const Outcome outcome = Import("openmvs");
  ExpectSuccess(outcome,
                {"4 images: 4 imported, 0 without a map\n",
                 "Normals came with 4",
                 "Depth over that of the sparse points: median 1.00",
                 "Next: colmap_tsar tsar_refine --workspace_path " +
                     output_.string() + " --input_type geometric\n"});
  EXPECT_THAT(outcome.err, HasSubstr("Checking: [4/4]"));
  EXPECT_THAT(outcome.err, HasSubstr("Importing: [4/4]"));
  ExpectScene(0.f, 0.f);
  EXPECT_EQ(ReadText(output_ / "stereo/patch-match.cfg"),
            "v0.png\n__auto__, 20\nv1.png\n__auto__, 20\nleft/v2.png\n"
            "__auto__, 20\nv3.png\n__auto__, 20\n");
  EXPECT_EQ(ReadText(output_ / "stereo/fusion.cfg"),
            "v0.png\nv1.png\nleft/v2.png\nv3.png\n");
  ExpectRefinable();
  EXPECT_TRUE(ReadTree(root_) == before);
}

TEST_F(TsarImportTest, FiltersAcmMaps) {
  // A wall that no other view has.
  std::vector<SceneImage> images = scene_;
  for (int y = 20; y < 30; ++y) {
    for (int x = 60; x < 80; ++x) {
      images[1].depth(x, y) = 2.5f;
    }
  }
  WriteAcm(images);
  ExpectSuccess(Import("acm"),
                {"4 imported", "Normals came with 4", " % after the filter\n"});
  ExpectScene(0.f, 1e-6f, /*is_filtered=*/true);
  EXPECT_EQ(ReadNormalMap(Paths(scene_[1]).normal)(70, 25), Vec3f{});
  EXPECT_FALSE(fs::exists(Paths(scene_[1], MapType::kPhotometric).depth));
  ExpectRefinable();
}

TEST_F(TsarImportTest, TakesPhotometricAcmMapsAsTheyAre) {
  WriteAcm(scene_);
  ExpectSuccess(
      Import(
          "acm",
          {"--output_type", "photometric", "--input_path", other_ / "ACMM/"}),
      {"Normals came with 0", "--input_type photometric"});
  const Image<float> depth =
      ReadDepthMap(Paths(scene_[1], MapType::kPhotometric).depth);
  EXPECT_EQ(ValuesOf(depth), std::vector<float>(depth.NumPixels(), 4.9f));
  EXPECT_FALSE(fs::exists(Paths(scene_[1]).depth));
}

TEST_F(TsarImportTest, TakesApdMapsWithBothHeaders) {
  for (const bool has_version : {false, true}) {
    fs::remove_all(other_);
    WriteApd(has_version);
    ExpectSuccess(Import("apd"), {"4 imported", "Normals came with 4"});
    ExpectScene(0.f, 1e-6f, /*is_filtered=*/true);
  }
}

// The frame in which all normals face the camera is the right one.
TEST_F(TsarImportTest, TakesNormalsInEitherFrame) {
  WritePfm();
  for (const bool in_world : {false, true}) {
    std::vector<Vec3f> expected;
    for (const SceneImage& image : scene_) {
      const Intrinsics intrinsics = image.camera.GetIntrinsics();
      std::vector<float> values;
      for (int y = 0; y < 72; ++y) {
        for (int x = 0; x < 96; ++x) {
          const Vec3f ray =
              intrinsics.Ray(static_cast<float>(x), static_cast<float>(y));
          // Nearly at right angles to the ray, in all directions around it.
          const auto angle = static_cast<float>(x + 13 * y);
          const Vec3f side = Normalized(
              Cross(ray, Vec3f{std::cos(angle), std::sin(angle), 0.3f}));
          const Vec3f normal = Normalized(side - Normalized(ray) * 0.2f);
          if (x == 4 && y == 4) {
            expected.push_back(normal);
          }
          const Vec3f stored =
              in_world ? ToWorld(image.camera, normal) : normal;
          values.insert(values.end(), {stored.x, stored.y, stored.z});
        }
      }
      WriteText(folder_.Path() / "normals" / (image.name + ".pfm"),
                PfmBytes(96, 72, 3, values, true));
    }
    ExpectSuccess(
        Import("depth",
               {"--normal_path", (folder_.Path() / "normals").string()}),
        {"Normals came with 4"});
    for (size_t i = 0; i < scene_.size(); ++i) {
      const Image<Vec3f> normals = ReadNormalMap(Paths(scene_[i]).normal);
      EXPECT_LT(Norm(normals(4, 4) - expected[i]), 1e-5f);
    }
  }
}

TEST_F(TsarImportTest, TakesPngInMillimetersOrOtherUnits) {
  const auto encode = [](int width, int height, const auto& values) {
    std::vector<uint16_t> integers;
    for (const float value : values) {
      integers.push_back(static_cast<uint16_t>(std::lround(value)));
    }
    return PngBytes(width, height, integers);
  };
  WriteDepth(".png", 1000.f, encode, scene_);
  ExpectSuccess(Import("depth"), {"4 imported"});
  ExpectScene(0.00051f, 2.f);
  WriteDepth(".png", 5000.f, encode, scene_);
  ExpectFailure("depth",
                {"depths are 5",
                 "times those of the sparse points",
                 "--depth_scale 0.0002",
                 "--check_scale 0"});
  ExpectSuccess(Import("depth", {"--check_scale", "0"}), {"median 5.0"});
  WriteDepth(".png", 1020.f, encode, scene_);
  ExpectFailure("depth", {"--depth_scale 0.001,"}, {"--depth_scale", "1"});
  WriteDepth(".png", 5000.f, encode, scene_);
  ExpectSuccess(Import("depth", {"--depth_scale", "0.0002"}), {"4 imported"});
  ExpectScene(0.00011f, 2.f);
}

TEST_F(TsarImportTest, NumbersThatStandForNoDepthAreNone) {
  std::vector<SceneImage> images = scene_;
  // One image has none at all, and its map says nothing.
  std::ranges::fill(images[3].depth, 65.535f);
  for (SceneImage& image : images) {
    std::fill_n(image.depth.Data(), 96 * 30, 65.535f);
  }
  const auto encode = [](int width, int height, const auto& values) {
    std::vector<uint16_t> integers;
    for (const float value : values) {
      integers.push_back(static_cast<uint16_t>(std::lround(value)));
    }
    return PngBytes(width, height, integers);
  };
  WriteDepth(".png", 1000.f, encode, images);
  ExpectSuccess(Import("depth"),
                {"Pixels with depth: 35.5 %",
                 "median 1.000",
                 "v0.png and 3 more: many depths are 65535"});
  const Image<float> depth = ReadDepthMap(Paths(scene_[0]).depth);
  EXPECT_EQ(depth(50, 29), 0.f);
  EXPECT_NEAR(depth(50, 31), scene_[0].depth(50, 31), 0.001f);
}

TEST_F(TsarImportTest, KeepsTheSizeOfTheMaps) {
  const auto write = [&](int width, int height) {
    const std::vector<float> values(static_cast<size_t>(width * height), 5.f);
    WriteText(other_ / "v0.png.pfm", PfmBytes(width, height, 1, values, true));
  };
  write(48, 35);
  ExpectSuccess(Import("depth"), {"1 imported, 3 without a map"});
  EXPECT_EQ(ReadDepthMap(Paths(scene_[0]).depth).Height(), 35);
  write(36, 48);
  ExpectFailure("depth", {"v0.png.pfm", "36 x 48", "v0.png of 96 x 72"});
}

TEST_F(TsarImportTest, ReplacesAnImportAloneAndOnlyWhenAsked) {
  WritePfm();
  ExpectSuccess(Import("depth"));
  const auto imported = ReadTree(output_);
  const Words same = {"--output_path", output_.string()};
  const Words over = {"--output_path", output_.string(), "--overwrite", "1"};
  EXPECT_THAT(Import("depth", same).err, HasSubstr("give --overwrite 1"));
  ExpectSuccess(Import("depth", over));
  EXPECT_TRUE(ReadTree(output_) == imported);
  ExpectRefinable();
  EXPECT_THAT(Import("depth", over).err, HasSubstr("is not of the import"));
}

TEST_F(TsarImportTest, OtherOrdersOfImages) {
  // By name: left/v2.png, v0.png, v1.png, v3.png.
  WriteAcm({scene_[2], scene_[0], scene_[1], scene_[3]});
  ExpectFailure("acm",
                {"cams/00000000_cam.txt",
                 "camera of left/v2.png, not of v0.png",
                 "--image_list"});
  const std::string list = (folder_.Path() / "list.txt").string();
  WriteText(list, "left/v2.png\n\n v0.png\r\nv1.png\nv3.png");
  ExpectSuccess(Import("acm", {"--image_list", list}));
  ExpectScene(0.f, 1e-6f, /*is_filtered=*/true);
}

TEST_F(TsarImportTest, ScalesEachImageToItsSparsePoints) {
  for (size_t i = 0; i < scene_.size(); ++i) {
    WritePfm(static_cast<float>(i + 1), {scene_.begin() + i, scene_.end()});
  }
  ExpectSuccess(Import("depth"),
                {"WARNING: v1.png: depths are 2 times those of its",
                 "WARNING: v3.png: depths are 4 times those of its",
                 "--scale_to_sparse 1"});
  ExpectSuccess(Import("depth", {"--scale_to_sparse", "1"}),
                {"Before scaling, depth over that of the sparse points"});
  ExpectScene(0.01f, 2.f);
  WriteText(root_ / "sparse/points3D.txt", "");
  ExpectFailure(
      "depth", {"v0.pfm", "only 0 sparse points"}, {"--scale_to_sparse", "1"});
  ExpectSuccess(Import("depth"), {"WARNING: no image has 5 sparse points"});
}

TEST_F(TsarImportTest, Warnings) {
  WriteText(other_ / "v0.pfm",
            PfmBytes(96, 72, 1, std::vector<float>(96 * 72, NAN), true));
  ExpectSuccess(Import("depth"),
                {"Pixels with depth: 0.0 %", "v0.pfm: no pixel has a depth"});
  ImportSummary summary;
  summary.warnings.assign(30, "something");
  std::ostringstream text;
  PrintSummary(summary, text);
  EXPECT_THAT(text.str(), HasSubstr("WARNING: something\n  and 20 more\n"));
}

TEST_F(TsarImportTest, BrokenFilesAreOneLineAndNothingIsWritten) {
  WriteAcm(scene_);
  const fs::path normals = other_ / "ACMM/2333_00000003/normals.dmb";
  const std::string good = ReadText(normals);
  for (const auto& [bytes, texts] : std::vector<std::pair<std::string, Words>>{
           {good.substr(0, 1000), {"2333_00000003/normals.dmb", "72"}},
           {DmbBytes(2, 1, 3, {1, 2, 3, 4, 5, 6}),
            {"normals.dmb", "2 x 1", "96 x 72"}},
           {DmbBytes(2, 1, 1, {1, 2}), {"normals.dmb", "3 channel"}}}) {
    WriteText(normals, bytes);
    ExpectFailure("acm", texts);
  }
  WriteText(normals, good);
  ExpectFailure("apd", {"depths_geom.dmb", "[version]", "--format"});
  ExpectFailure("openmvs", {"depth0000.dmap"});
  ExpectFailure("depth", {"PFM", "v0.png"});
  WriteText(other_ / "cams/00000001_cam.txt", "extrinsic 1 2 3");
  ExpectFailure("acm", {"00000001_cam.txt", "extrinsic"});
}

TEST_F(TsarImportTest, WrongOptionsAreOneLine) {
  WritePfm();
  const std::string other = other_.string();
  const std::string inside = (root_ / "stereo/new").string();
  for (const auto& [format, texts, arguments] :
       std::vector<std::tuple<std::string, Words, Words>>{
           {"depth", {"no such folder"}, {"--input_path", "/no/where"}},
           {"acm", {"--normal_path"}, {"--normal_path", other}},
           {"depth", {"no such folder"}, {"--normal_path", "/no/where"}},
           {"depth", {"in the folder stereo"}, {"--output_path", inside}},
           {"depth",
            {"is no import"},
            {"--output_path", root_.string(), "--overwrite", "1"}}}) {
    ExpectFailure(format, texts, arguments);
  }
  fs::remove_all(root_ / "sparse");
  ExpectFailure("depth", {"sparse", "no such folder"});
}

}  // namespace
}  // namespace tsar
