// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/io/map_paths.h"
#include "colmap_tsar/io/sparse_model.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "tests/cli/command_test.h"
#include "tests/support/external_writers.h"
#include "tests/support/synthetic_workspace.h"
#include <Eigen/Geometry>

namespace tsar {

// One image of the scene with its geometric maps.
struct SceneImage {
  std::string name;
  Camera camera;
  Image<float> depth;
  Image<Vec3f> normal;
};

inline std::string Numbered(const char* format, size_t number) {
  char text[64];
  std::snprintf(text, sizeof(text), format, static_cast<int>(number));
  return text;
}

inline Vec3f ToWorld(const Camera& camera, const Vec3f& n) {
  return ToVec3f(camera.rotation.transpose() * Eigen::Vector3d(n.x, n.y, n.z));
}

inline Image<Vec3f> ToWorld(const SceneImage& image) {
  Image<Vec3f> normals = image.normal;
  for (Vec3f& normal : normals) {
    normal = ToWorld(image.camera, normal);
  }
  return normals;
}

// The synthetic workspace (see synthetic_workspace.h) with the world turned, so
// that no camera has the world's axes, and with sparse points on the wall; its
// images in the order of their ids: v0.png, v1.png, left/v2.png, v3.png. Writes
// their maps as other programs do, into the folder `other`, and runs
// tsar_import on them.
class TsarImportTest : public CommandTest<&RunTsarImport> {
 protected:
  TsarImportTest() { always_ = {"--TsarImport.device", "cpu"}; }

  // Without --output_path: into a folder that does not exist yet.
  Words Arguments(const std::string& format, Words arguments) const {
    const auto set_default = [&](const char* option, const std::string& value) {
      if (std::ranges::find(arguments, option) == arguments.end()) {
        arguments.insert(arguments.end(), {option, value});
      }
    };
    set_default("--output_path", output_.string());
    set_default("--input_path", other_.string());
    set_default("--format", format);
    return arguments;
  }
  Outcome Import(const std::string& format, const Words& arguments = {}) const {
    if (std::ranges::find(arguments, "--output_path") == arguments.end()) {
      std::filesystem::remove_all(output_);
    }
    return Run(Arguments(format, arguments));
  }
  void ExpectSuccess(const Outcome& outcome, const Words& texts = {}) const {
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    for (const std::string& text : texts) {
      EXPECT_THAT(outcome.out, testing::HasSubstr(text));
    }
  }
  void ExpectFailure(const std::string& format,
                     const Words& texts,
                     const Words& arguments = {}) const {
    std::filesystem::remove_all(output_);
    CommandTest::ExpectFailure(Arguments(format, arguments), texts);
  }

  // Expects the scene's maps in the output, up to these errors; pixels may lack
  // a depth where is_filtered, but not many.
  void ExpectScene(float max_depth_error,
                   float max_normal_error,
                   bool is_filtered = false) const {
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
        depth_error = std::max(
            depth_error, std::abs(depth.Data()[i] - image.depth.Data()[i]));
        normal_error = std::max(
            normal_error, Norm(normal.Data()[i] - image.normal.Data()[i]));
      }
      EXPECT_LE(depth_error, max_depth_error);
      EXPECT_LE(normal_error, max_normal_error);
      EXPECT_LT(num_missing, static_cast<int>(depth.NumPixels()) * 2 / 3);
    }
  }

  void ExpectRefinable() const {
    const Outcome outcome = RunCommandWith<&RunTsarRefine>(
        {"--workspace_path", output_.string(), "--TsarRefine.device", "cpu"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, testing::HasSubstr("4 images: 4 refined\n"));
  }

  MapPaths Paths(const SceneImage& image,
                 MapType type = MapType::kGeometric) const {
    return GetMapPaths(output_, image.name, type);
  }

  // With the images numbered in the order in which they are given.
  void WriteAcm(const std::vector<SceneImage>& images) const {
    for (size_t i = 0; i < images.size(); ++i) {
      const int width = images[i].depth.Width();
      const int height = images[i].depth.Height();
      const std::filesystem::path maps =
          other_ / "ACMM" / Numbered("2333_%08d", i);
      WriteText(
          maps / "depths.dmb",
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

  void WriteApd(bool has_version) const {
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
          ApdBytes(
              width, height, 3, ValuesOf(ToWorld(scene_[i])), has_version));
      WriteText(maps / "weak.bin", "not read");
    }
    WriteCams(scene_, other_);
  }

  void WriteOpenMvs() const {
    for (size_t i = 0; i < scene_.size(); ++i) {
      DmapContent content;
      content.image_name = "/home/somebody/dense/images/" + scene_[i].name;
      content.camera = scene_[i].camera;
      content.depth = scene_[i].depth;
      content.normal = scene_[i].normal;
      content.has_confidence = true;
      content.has_views = i % 2 == 0;
      // OpenMVS has an order of its own.
      WriteText(other_ / Numbered("depth%04d.dmap", 10 - i),
                DmapBytes(content));
    }
  }

  // As depth images called NAME with another extension.
  void WriteDepth(
      const std::string& extension,
      float scale,
      const std::function<std::string(int, int, const std::vector<float>&)>&
          encode,
      const std::vector<SceneImage>& images) const {
    for (const SceneImage& image : images) {
      std::vector<float> values = ValuesOf(image.depth);
      for (float& value : values) {
        value *= scale;
      }
      WriteText((other_ / image.name).replace_extension(extension),
                encode(image.depth.Width(), image.depth.Height(), values));
    }
  }
  void WritePfm(float scale, const std::vector<SceneImage>& images) const {
    WriteDepth(
        ".pfm",
        scale,
        [](int width, int height, const auto& values) {
          return PfmBytes(width, height, 1, values, true);
        },
        images);
  }
  void WritePfm() const { WritePfm(1.f, scene_); }

  const std::filesystem::path other_ = folder_.Path() / "other";
  const std::filesystem::path output_ = folder_.Path() / "imported";
  const std::vector<SceneImage> scene_ = DrawScene();

 private:
  // cams/00000000_cam.txt and so on.
  static void WriteCams(const std::vector<SceneImage>& images,
                        const std::filesystem::path& folder) {
    for (size_t i = 0; i < images.size(); ++i) {
      WriteText(folder / "cams" / Numbered("%08d_cam.txt", i),
                CamBytes(images[i].camera));
    }
  }

  std::vector<SceneImage> DrawScene() const {
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
      const MapPaths paths =
          GetMapPaths(root_, image.name, MapType::kGeometric);
      scene.push_back({image.name,
                       image.camera,
                       ReadDepthMap(paths.depth),
                       ReadNormalMap(paths.normal)});
    }
    return scene;
  }
};

}  // namespace tsar
