// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "tests/tools/import/tsar_import_testing.h"

#include "colmap_tsar/cli/commands.h"
#include "colmap_tsar/io/map_io.h"

#include <algorithm>
#include <cmath>

#include "tests/support/external_writers.h"
#include "tests/support/synthetic_workspace.h"

namespace tsar {

using testing::HasSubstr;

Outcome TsarImportTest::RunImport(std::vector<std::string> arguments) const {
  arguments.insert(arguments.begin(), {"--workspace_path", root_.string()});
  return RunCaptured("colmap_tsar", arguments, [](int argc, char** argv) {
    return RunCommand(&RunTsarImport, argc, argv);
  });
}

Outcome TsarImportTest::Import(const std::string& format,
                               std::vector<std::string> arguments) const {
  arguments.insert(arguments.begin(),
                   {"--format", format, "--input_path", other_.string()});
  return RunImport(arguments);
}

void TsarImportTest::ExpectSuccess(
    const Outcome& outcome, const std::vector<std::string>& texts) const {
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const std::string& text : texts) {
    EXPECT_THAT(outcome.out, HasSubstr(text));
  }
}

void TsarImportTest::ExpectFailure(
    const std::vector<std::string>& arguments,
    const std::vector<std::string>& texts) const {
  const auto before = ReadTree(folder_.Path());
  const Outcome outcome = RunImport(arguments);
  EXPECT_EQ(outcome.exit_code, 1);
  const size_t line = outcome.err.find("ERROR: ");
  ASSERT_NE(line, std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.err.find('\n', line), outcome.err.size() - 1)
      << outcome.err;
  for (const std::string& text : texts) {
    EXPECT_THAT(outcome.err, HasSubstr(text));
  }
  EXPECT_TRUE(ReadTree(folder_.Path()) == before);
}

void TsarImportTest::ExpectImportFailure(
    const std::string& format,
    const std::vector<std::string>& texts,
    std::vector<std::string> arguments) const {
  arguments.insert(arguments.begin(),
                   {"--format", format, "--input_path", other_.string()});
  ExpectFailure(arguments, texts);
}

MapPaths TsarImportTest::Paths(const SceneImage& image, MapType type) const {
  return GetMapPaths(root_, image.name, type);
}

void TsarImportTest::ExpectScene(float max_depth_error,
                                 float max_normal_error) const {
  for (const SceneImage& image : scene_) {
    SCOPED_TRACE(image.name);
    const Image<float> depth = ReadDepthMap(Paths(image).depth);
    const Image<Vec3f> normal = ReadNormalMap(Paths(image).normal);
    ASSERT_TRUE(depth.HasSizeOf(image.depth));
    ASSERT_TRUE(normal.HasSizeOf(image.depth));
    float depth_error = 0.f;
    float normal_error = 0.f;
    for (size_t i = 0; i < depth.NumPixels(); ++i) {
      depth_error = std::max(depth_error,
                             std::abs(depth.Data()[i] - image.depth.Data()[i]));
      normal_error = std::max(normal_error,
                              Norm(normal.Data()[i] - image.normal.Data()[i]));
    }
    EXPECT_LE(depth_error, max_depth_error);
    EXPECT_LE(normal_error, max_normal_error);
  }
}

void TsarImportTest::ExpectRefinable() const {
  const Outcome outcome = RunCaptured(
      "colmap_tsar",
      {"--workspace_path", root_.string(), "--TsarRefine.device", "cpu"},
      [](int argc, char** argv) {
        return RunCommand(&RunTsarRefine, argc, argv);
      });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("4 images: 4 refined\n"));
}

void TsarImportTest::ExportDepth(
    const std::string& extension,
    float scale,
    const std::function<std::string(int, int, const std::vector<float>&)>&
        encode) const {
  for (const SceneImage& image : scene_) {
    std::vector<float> values = ValuesOf(image.depth);
    for (float& value : values) {
      value *= scale;
    }
    WriteText((other_ / image.name).replace_extension(extension),
              encode(image.depth.Width(), image.depth.Height(), values));
  }
}

void TsarImportTest::ExportPfm(float scale) const {
  ExportDepth(".pfm", scale, [](int width, int height, const auto& values) {
    return PfmBytes(width, height, 1, values, true);
  });
}

void TsarImportTest::ExportNormals() const {
  for (const SceneImage& image : scene_) {
    WriteText(folder_.Path() / "normals" / (image.name + ".pfm"),
              PfmBytes(image.depth.Width(),
                       image.depth.Height(),
                       3,
                       ValuesOf(image.normal),
                       false));
  }
}

}  // namespace tsar
