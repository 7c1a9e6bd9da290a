// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/map_io.h"

#include <cmath>

#include "tests/support/external_writers.h"
#include "tests/tools/import/tsar_import_testing.h"

namespace tsar {
namespace {

using testing::HasSubstr;

TEST_F(TsarImportTest, TakesOpenMvsMapsBitByBit) {
  ExportOpenMvs(scene_, other_);
  RemoveStereo(root_);
  const Outcome outcome = Import("openmvs");
  ExpectSuccess(outcome,
                {"4 images: 4 imported, 0 without a map\n",
                 "Normals came with 4",
                 "Depth over that of the sparse points: median 1.00",
                 "Depths from 4.995 to 5.005",
                 ", sparse points from 5 to 5\n",
                 "Next: colmap_tsar tsar_refine --workspace_path " +
                     root_.string() + " --input_type geometric\n"});
  EXPECT_THAT(outcome.err, HasSubstr("Checking: [4/4]"));
  EXPECT_THAT(outcome.err, HasSubstr("Importing: [4/4]"));
  ExpectScene(0.f, 0.f);
  EXPECT_EQ(ReadText(root_ / "stereo/patch-match.cfg"),
            "v0.png\n__auto__, 20\nv1.png\n__auto__, 20\nleft/v2.png\n"
            "__auto__, 20\nv3.png\n__auto__, 20\n");
  EXPECT_EQ(ReadText(root_ / "stereo/fusion.cfg"),
            "v0.png\nv1.png\nleft/v2.png\nv3.png\n");
  ExpectRefinable();
}

TEST_F(TsarImportTest, TakesAcmMaps) {
  ExportAcm(scene_, other_);
  RemoveStereo(root_);
  ExpectSuccess(Import("acm"), {"4 imported", "Normals came with 4"});
  ExpectScene(0.f, 1e-6f);
  EXPECT_FALSE(std::filesystem::exists(root_ / "stereo/cost_maps"));
  ExpectRefinable();
}

TEST_F(TsarImportTest, TakesTheProgramsFolderToo) {
  ExportAcm(scene_, other_);
  RemoveStereo(root_);
  ExpectSuccess(RunImport({"--format",
                           "acm",
                           "--input_path",
                           (other_ / "ACMM/").string(),
                           "--import_costs",
                           "1"}),
                {"4 imported", "Costs came with 4"});
  ExpectScene(0.f, 1e-6f);
  const PlanarMap costs = ReadPlanarMap(Paths(scene_[0]).cost);
  EXPECT_EQ(costs.channels, 2);
  EXPECT_EQ(costs.values.front(), 0.25f);
  EXPECT_EQ(costs.values.back(), 2.f);
  ExpectRefinable();
}

TEST_F(TsarImportTest, TakesPhotometricAcmMaps) {
  ExportAcm(scene_, other_);
  RemoveStereo(root_);
  ExpectSuccess(
      Import("acm", {"--output_type", "photometric", "--import_costs", "1"}),
      {"Normals came with 0", "--input_type photometric"});
  const Image<float> depth =
      ReadDepthMap(Paths(scene_[1], MapType::kPhotometric).depth);
  EXPECT_EQ(depth(5, 5), 4.9f);
  EXPECT_FALSE(std::filesystem::exists(root_ / "stereo/cost_maps"));
  EXPECT_FALSE(std::filesystem::exists(Paths(scene_[1]).depth));
}

TEST_F(TsarImportTest, TakesApdMapsWithBothHeaders) {
  for (const bool has_version : {false, true}) {
    std::filesystem::remove_all(other_);
    ExportApd(scene_, other_, has_version);
    RemoveStereo(root_);
    ExpectSuccess(Import("apd"), {"4 imported", "Normals came with 4"});
    ExpectScene(0.f, 1e-6f);
  }
  ExpectRefinable();
}

TEST_F(TsarImportTest, TakesFloatDepthAndNormals) {
  ExportPfm();
  ExportNormals();
  RemoveStereo(root_);
  ExpectSuccess(
      Import("depth", {"--normal_path", (folder_.Path() / "normals").string()}),
      {"4 imported", "Normals came with 4"});
  ExpectScene(0.f, 0.f);
  ExpectRefinable();
}

TEST_F(TsarImportTest, TakesNumPyArraysAndComputesNormals) {
  ExportDepth(".npy", 1.f, [](int width, int height, const auto& values) {
    std::ostringstream shape;
    shape << "(" << height << ", " << width << ", 1)";
    return NpyBytes("<f4", shape.str(), FloatData(values));
  });
  RemoveStereo(root_);
  ExpectSuccess(Import("depth"), {"Normals came with 0"});
  ExpectScene(0.f, 2.f);
  const Image<Vec3f> normals = ReadNormalMap(Paths(scene_[0]).normal);
  EXPECT_NEAR(Norm(normals(10, 10)), 1.f, 1e-5f);
  EXPECT_LT(normals(10, 10).z, -0.9f);
  ExpectRefinable();
}

TEST_F(TsarImportTest, TakesPngInMillimetersOrOtherUnits) {
  const auto encode = [](int width, int height, const auto& values) {
    std::vector<uint16_t> integers;
    for (const float value : values) {
      integers.push_back(static_cast<uint16_t>(std::lround(value)));
    }
    return PngBytes(width, height, integers);
  };
  ExportDepth(".png", 1000.f, encode);
  RemoveStereo(root_);
  ExpectSuccess(Import("depth"), {"4 imported"});
  ExpectScene(0.00051f, 2.f);
  ExportDepth(".png", 5000.f, encode);
  ExpectImportFailure("depth",
                      {"depths are 5",
                       "times those of the sparse points",
                       "--depth_scale 0.0002",
                       "--check_scale 0"});
  ExpectSuccess(Import("depth", {"--depth_scale", "0.0002"}), {"4 imported"});
  ExpectScene(0.00011f, 2.f);
  ExpectRefinable();
}

TEST_F(TsarImportTest, KeepsTheSizeOfTheMaps) {
  const SceneImage& image = scene_[0];
  WriteText(other_ / "v0.png.pfm",
            PfmBytes(48, 36, 1, std::vector<float>(48 * 36, 5.f), true));
  RemoveStereo(root_);
  ExpectSuccess(Import("depth"), {"1 imported, 3 without a map"});
  EXPECT_EQ(ReadDepthMap(Paths(image).depth).Width(), 48);
  // Rounded in one direction or the other.
  for (const int height : {35, 37}) {
    WriteText(
        other_ / "v0.png.pfm",
        PfmBytes(48,
                 height,
                 1,
                 std::vector<float>(static_cast<size_t>(48 * height), 5.f),
                 true));
    ExpectSuccess(Import("depth"));
  }
  WriteText(other_ / "v0.png.pfm",
            PfmBytes(36, 48, 1, std::vector<float>(48 * 36, 5.f), true));
  ExpectImportFailure("depth", {"v0.png.pfm", "36 x 48", "v0.png of 96 x 72"});
}

}  // namespace
}  // namespace tsar
