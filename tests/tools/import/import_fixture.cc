// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "tests/tools/import/import_fixture.h"

#include "colmap_tsar/cli/commands.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/io/sparse_model.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>

#include "tests/support/external_writers.h"
#include "tests/support/synthetic_workspace.h"
#include "tests/support/test_workspace.h"
#include <Eigen/Geometry>

namespace tsar {
namespace {

std::string Numbered(const char* format, size_t number) {
  char text[64];
  std::snprintf(text, sizeof(text), format, static_cast<int>(number));
  return text;
}

Image<Vec3f> ToWorld(const SceneImage& image) {
  Image<Vec3f> normals(image.normal.Width(), image.normal.Height());
  for (size_t i = 0; i < normals.NumPixels(); ++i) {
    const Vec3f& n = image.normal.Data()[i];
    const Eigen::Vector3f turned =
        (image.camera.rotation.transpose() * Eigen::Vector3d(n.x, n.y, n.z))
            .cast<float>();
    normals.Data()[i] = {turned.x(), turned.y(), turned.z()};
  }
  return normals;
}

// cams/00000000_cam.txt and so on.
void WriteCams(const std::vector<SceneImage>& images,
               const std::filesystem::path& folder) {
  for (size_t i = 0; i < images.size(); ++i) {
    WriteText(folder / "cams" / Numbered("%08d_cam.txt", i),
              CamBytes(images[i].camera));
  }
}

}  // namespace

std::vector<SceneImage> TsarImportTest::DrawScene() const {
  MakeSyntheticWorkspace(root_);
  const Eigen::Quaterniond turn(
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()));
  SparseModel model = ReadSparseModel(root_ / "sparse");
  std::ostringstream images;
  images.precision(17);
  const Eigen::Quaterniond back = turn.conjugate();
  for (size_t i = 0; i < model.images.size(); ++i) {
    images << i + 1 << " " << back.w() << " " << back.x() << " " << back.y()
           << " " << back.z() << " "
           << model.images[i].camera.translation.transpose() << " 1 "
           << model.images[i].name << "\n\n";
  }
  std::ostringstream points;
  points.precision(17);
  int id = 0;
  for (double x = -2.6; x < 4.0; x += 0.3) {
    for (double y = -1.9; y < 2.0; y += 0.3) {
      const Eigen::Vector3d point(x, y, SyntheticWorkspace::kDepth);
      std::ostringstream track;
      for (size_t i = 0; i < model.images.size(); ++i) {
        const Camera& camera = model.images[i].camera;
        const Eigen::Vector3d seen = point + camera.translation;
        const double column = camera.fx * seen.x() / seen.z() + camera.cx;
        if (column > 0.0 && column < camera.width - 1.0) {
          track << " " << i + 1 << " 0";
        }
      }
      points << ++id << " " << (turn * point).transpose() << " 0 0 0 1"
             << track.str() << "\n";
    }
  }
  WriteText(root_ / "sparse/images.txt", images.str());
  WriteText(root_ / "sparse/points3D.txt", points.str());

  model = ReadSparseModel(root_ / "sparse");
  std::vector<SceneImage> scene;
  for (const SparseModel::ModelImage& image : model.images) {
    const MapPaths paths = GetMapPaths(root_, image.name, MapType::kGeometric);
    scene.push_back({image.name,
                     image.camera,
                     ReadDepthMap(paths.depth),
                     ReadNormalMap(paths.normal)});
  }
  return scene;
}

void TsarImportTest::WriteAcm(const std::vector<SceneImage>& images) const {
  for (size_t i = 0; i < images.size(); ++i) {
    const int width = images[i].depth.Width();
    const int height = images[i].depth.Height();
    const std::filesystem::path maps =
        other_ / "ACMM" / Numbered("2333_%08d", i);
    WriteText(maps / "depths.dmb",
              DmbBytes(width,
                       height,
                       1,
                       std::vector<float>(images[i].depth.NumPixels(), 4.9f)));
    WriteText(maps / "depths_geom.dmb",
              DmbBytes(width, height, 1, ValuesOf(images[i].depth)));
    WriteText(maps / "normals.dmb",
              DmbBytes(width, height, 3, ValuesOf(ToWorld(images[i]))));
    WriteText(maps / "costs.dmb", "not read");
  }
  WriteCams(images, other_);
}

void TsarImportTest::WriteApd(bool has_version) const {
  const std::string extension = has_version ? ".dmb" : ".bin";
  for (size_t i = 0; i < scene_.size(); ++i) {
    const int width = scene_[i].depth.Width();
    const int height = scene_[i].depth.Height();
    const std::filesystem::path maps = other_ / "APD" / Numbered("%08d", i);
    WriteText(
        maps / ("depths" + extension),
        ApdBytes(width, height, 1, ValuesOf(scene_[i].depth), has_version));
    WriteText(
        maps / ("normals" + extension),
        ApdBytes(width, height, 3, ValuesOf(ToWorld(scene_[i])), has_version));
    WriteText(maps / "weak.bin", "not read");
  }
  WriteCams(scene_, other_);
}

void TsarImportTest::WriteOpenMvs() const {
  for (size_t i = 0; i < scene_.size(); ++i) {
    DmapContent content;
    content.image_name = "/home/somebody/dense/images/" + scene_[i].name;
    content.camera = scene_[i].camera;
    content.depth = scene_[i].depth;
    content.normal = scene_[i].normal;
    content.has_confidence = true;
    content.has_views = i % 2 == 0;
    // OpenMVS has an order of its own.
    WriteText(other_ / Numbered("depth%04d.dmap", 10 - i), DmapBytes(content));
  }
}

void TsarImportTest::WriteDepth(
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

void TsarImportTest::WritePfm(float scale) const {
  WriteDepth(".pfm", scale, [](int width, int height, const auto& values) {
    return PfmBytes(width, height, 1, values, true);
  });
}

Outcome TsarImportTest::Import(const std::string& format,
                               std::vector<std::string> arguments) const {
  const auto is_given = [&](const std::string& option) {
    return std::ranges::find(arguments, option) != arguments.end();
  };
  if (!is_given("--output_path")) {
    std::filesystem::remove_all(output_);
    arguments.insert(arguments.end(), {"--output_path", output_.string()});
  }
  if (!is_given("--input_path")) {
    arguments.insert(arguments.end(), {"--input_path", other_.string()});
  }
  arguments.insert(arguments.end(),
                   {"--format", format, "--workspace_path", root_.string()});
  arguments.insert(arguments.end(), {"--TsarImport.device", "cpu"});
  return RunCaptured("colmap_tsar", arguments, [](int argc, char** argv) {
    return RunCommand(&RunTsarImport, argc, argv);
  });
}

void TsarImportTest::ExpectSuccess(
    const Outcome& outcome, const std::vector<std::string>& texts) const {
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const std::string& text : texts) {
    EXPECT_THAT(outcome.out, testing::HasSubstr(text));
  }
}

void TsarImportTest::ExpectFailure(
    const std::string& format,
    const std::vector<std::string>& texts,
    const std::vector<std::string>& arguments) const {
  std::filesystem::remove_all(output_);
  const auto before = ReadTree(folder_.Path());
  const Outcome outcome = Import(format, arguments);
  EXPECT_EQ(outcome.exit_code, 1);
  const size_t line = outcome.err.find("ERROR: ");
  ASSERT_NE(line, std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.err.find('\n', line), outcome.err.size() - 1)
      << outcome.err;
  for (const std::string& text : texts) {
    EXPECT_THAT(outcome.err, testing::HasSubstr(text));
  }
  EXPECT_TRUE(ReadTree(folder_.Path()) == before);
}

void TsarImportTest::ExpectScene(float max_depth_error,
                                 float max_normal_error,
                                 bool is_filtered) const {
  for (const SceneImage& image : scene_) {
    SCOPED_TRACE(image.name);
    const Image<float> depth = ReadDepthMap(Paths(image).depth);
    const Image<Vec3f> normal = ReadNormalMap(Paths(image).normal);
    ASSERT_TRUE(depth.HasSizeOf(image.depth));
    ASSERT_TRUE(normal.HasSizeOf(image.depth));
    float depth_error = 0.f;
    float normal_error = 0.f;
    int num_missing = 0;
    for (size_t i = 0; i < depth.NumPixels(); ++i) {
      if (is_filtered && depth.Data()[i] == 0.f) {
        ++num_missing;
        continue;
      }
      depth_error = std::max(depth_error,
                             std::abs(depth.Data()[i] - image.depth.Data()[i]));
      normal_error = std::max(normal_error,
                              Norm(normal.Data()[i] - image.normal.Data()[i]));
    }
    EXPECT_LE(depth_error, max_depth_error);
    EXPECT_LE(normal_error, max_normal_error);
    EXPECT_LT(num_missing, static_cast<int>(depth.NumPixels()) * 2 / 3);
  }
}

void TsarImportTest::ExpectRefinable() const {
  const Outcome outcome = RunCaptured(
      "colmap_tsar",
      {"--workspace_path", output_.string(), "--TsarRefine.device", "cpu"},
      [](int argc, char** argv) {
        return RunCommand(&RunTsarRefine, argc, argv);
      });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, testing::HasSubstr("4 images: 4 refined\n"));
}

}  // namespace tsar
