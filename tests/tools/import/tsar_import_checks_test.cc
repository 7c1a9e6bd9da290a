// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/map_io.h"

#include <cmath>

#include "tests/support/external_writers.h"
#include "tests/tools/import/tsar_import_testing.h"

namespace tsar {
namespace {

TEST_F(TsarImportTest, OtherOrdersOfImages) {
  // By name: left/v2.png, v0.png, v1.png, v3.png.
  const std::vector<SceneImage> by_name = {
      scene_[2], scene_[0], scene_[1], scene_[3]};
  ExportAcm(by_name, other_);
  RemoveStereo(root_);
  ExpectImportFailure("acm",
                      {"cams/00000000_cam.txt",
                       "camera of left/v2.png, not of v0.png",
                       "--index_order",
                       "--image_list"});
  ExpectSuccess(Import("acm", {"--index_order", "name"}));
  ExpectScene(0.f, 1e-6f);

  RemoveStereo(root_);
  const std::string list = (folder_.Path() / "list.txt").string();
  WriteText(list, "left/v2.png\n\n v0.png\r\nv1.png\nv3.png");
  ExpectSuccess(Import("acm", {"--image_list", list}));
  ExpectScene(0.f, 1e-6f);

  WriteText(list, "left/v2.png\nv0.png\nv1.png\n");
  ExpectImportFailure(
      "acm", {"2333_00000003", "images 0 to 2"}, {"--image_list", list});
  WriteText(list, "v0.png\nv2.png\n");
  ExpectImportFailure("acm",
                      {"list.txt", "line 2", "v2.png", "not in the sparse"},
                      {"--image_list", list});
  WriteText(list, "v0.png\nv0.png\n");
  ExpectImportFailure(
      "acm", {"line 2", "a second time"}, {"--image_list", list});
  WriteText(list, "\n");
  ExpectImportFailure("acm", {"names no image"}, {"--image_list", list});
}

TEST_F(TsarImportTest, OtherUnitsOfTheWholeModel) {
  std::vector<SceneImage> large = scene_;
  for (SceneImage& image : large) {
    image.camera.translation *= 1000.0;
    for (float& depth : image.depth) {
      depth *= 1000.f;
    }
  }
  ExportAcm(large, other_);
  RemoveStereo(root_);
  ExpectImportFailure("acm", {"cam.txt", "other units", "--depth_scale 0.001"});
  ExpectSuccess(Import("acm", {"--depth_scale", "0.001"}));
  ExpectScene(1e-6f, 1e-6f);
}

TEST_F(TsarImportTest, CamerasOfAnotherModel) {
  std::vector<SceneImage> other = scene_;
  other[2].camera.rotation = other[2].camera.rotation.transpose().eval();
  ExportAcm(other, other_);
  ExpectImportFailure(
      "acm",
      {"00000002_cam.txt", "left/v2.png", "degrees", "this sparse model"},
      {"--overwrite", "1"});
  other = scene_;
  other[1].camera.cx += 10.0;
  ExportAcm(other, other_);
  ExpectImportFailure("acm",
                      {"00000001_cam.txt", "v1.png", "principal point"},
                      {"--overwrite", "1"});
}

TEST_F(TsarImportTest, NormalsInAnotherFrame) {
  ExportPfm();
  ExportNormals();
  RemoveStereo(root_);
  const std::vector<std::string> normals = {
      "--normal_path", (folder_.Path() / "normals").string()};
  // The scene's normals look along an axis; only slanted ones tell.
  for (const SceneImage& image : scene_) {
    std::vector<float> values;
    for (int y = 0; y < image.depth.Height(); ++y) {
      for (int x = 0; x < image.depth.Width(); ++x) {
        const Vec3f ray = image.camera.GetIntrinsics().Ray(
            static_cast<float>(x), static_cast<float>(y));
        // Nearly at right angles to the ray, in all directions around it.
        const float angle = static_cast<float>(x + 13 * y);
        const Vec3f side = Normalized(
            Cross(ray, Vec3f{std::cos(angle), std::sin(angle), 0.3f}));
        const Vec3f n = Normalized(side - Normalized(ray) * 0.2f);
        const Eigen::Vector3d world =
            image.camera.rotation.transpose() * Eigen::Vector3d(n.x, n.y, n.z);
        for (int i = 0; i < 3; ++i) {
          values.push_back(static_cast<float>(world[i]));
        }
      }
    }
    WriteText(
        folder_.Path() / "normals" / (image.name + ".pfm"),
        PfmBytes(image.depth.Width(), image.depth.Height(), 3, values, true));
  }
  ExpectImportFailure("depth", {"--normal_frame world"}, normals);
  std::vector<std::string> in_world = normals;
  in_world.insert(in_world.end(), {"--normal_frame", "world"});
  ExpectSuccess(Import("depth", in_world));
}

TEST_F(TsarImportTest, ScalesEachImageToItsSparsePoints) {
  for (size_t i = 0; i < scene_.size(); ++i) {
    std::vector<float> values = ValuesOf(scene_[i].depth);
    for (float& value : values) {
      value *= static_cast<float>(i + 1);
    }
    WriteText(other_ / (scene_[i].name + ".pfm"),
              PfmBytes(96, 72, 1, values, true));
  }
  RemoveStereo(root_);
  ExpectSuccess(Import("depth"),
                {"WARNING: v1.png: depths are 2 times those of its",
                 "WARNING: v3.png: depths are 4 times those of its",
                 "--scale_to_sparse 1"});
  ExpectSuccess(Import("depth", {"--scale_to_sparse", "1"}),
                {"Before scaling, depth over that of the sparse points",
                 "Depths from 4.995 to 5.005"});
  ExpectScene(0.01f, 2.f);
  for (const auto& entry :
       std::filesystem::directory_iterator(root_ / "sparse")) {
    if (entry.path().filename() == "points3D.txt") {
      WriteText(entry.path(), "");
    }
  }
  ExpectImportFailure("depth",
                      {"v0.png.pfm", "only 0 sparse points"},
                      {"--scale_to_sparse", "1"});
  ExpectSuccess(Import("depth"), {"WARNING: no image has 5 sparse points"});
}

TEST_F(TsarImportTest, TakesOffScaleDepthsWhereTold) {
  ExportPfm(10.f);
  RemoveStereo(root_);
  ExpectImportFailure("depth", {"--depth_scale 0.1"});
  ExpectSuccess(Import("depth", {"--check_scale", "0"}),
                {"median 10.0", "WARNING: v0.png"});
}

}  // namespace
}  // namespace tsar
