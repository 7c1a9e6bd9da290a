// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "tests/tools/import/import_scene.h"

#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/io/map_paths.h"
#include "colmap_tsar/io/sparse_model.h"

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
void ExportCams(const std::vector<SceneImage>& images,
                const std::filesystem::path& folder) {
  for (size_t i = 0; i < images.size(); ++i) {
    WriteText(folder / "cams" / Numbered("%08d_cam.txt", i),
              CamBytes(images[i].camera));
  }
}

}  // namespace

std::vector<SceneImage> DrawImportScene(const std::filesystem::path& root) {
  MakeSyntheticWorkspace(root);
  const Eigen::Quaterniond turn(
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()));
  SparseModel model = ReadSparseModel(root / "sparse");
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
  WriteText(root / "sparse/images.txt", images.str());
  WriteText(root / "sparse/points3D.txt", points.str());

  model = ReadSparseModel(root / "sparse");
  std::vector<SceneImage> scene;
  for (const SparseModel::ModelImage& image : model.images) {
    const MapPaths paths = GetMapPaths(root, image.name, MapType::kGeometric);
    scene.push_back({image.name,
                     image.camera,
                     ReadDepthMap(paths.depth),
                     ReadNormalMap(paths.normal)});
  }
  return scene;
}

void RemoveStereo(const std::filesystem::path& root) {
  std::filesystem::remove_all(root / "stereo");
}

void ExportAcm(const std::vector<SceneImage>& images,
               const std::filesystem::path& folder) {
  for (size_t i = 0; i < images.size(); ++i) {
    const int width = images[i].depth.Width();
    const int height = images[i].depth.Height();
    const std::filesystem::path maps =
        folder / "ACMM" / Numbered("2333_%08d", i);
    WriteText(maps / "depths.dmb",
              DmbBytes(width,
                       height,
                       1,
                       std::vector<float>(images[i].depth.NumPixels(), 4.9f)));
    WriteText(maps / "depths_geom.dmb",
              DmbBytes(width, height, 1, ValuesOf(images[i].depth)));
    WriteText(maps / "normals.dmb",
              DmbBytes(width, height, 3, ValuesOf(ToWorld(images[i]))));
    WriteText(maps / "costs.dmb",
              DmbBytes(width,
                       height,
                       1,
                       std::vector<float>(images[i].depth.NumPixels(), 0.25f)));
  }
  ExportCams(images, folder);
}

void ExportApd(const std::vector<SceneImage>& images,
               const std::filesystem::path& folder,
               bool has_version) {
  const char* extension = has_version ? ".dmb" : ".bin";
  for (size_t i = 0; i < images.size(); ++i) {
    const int width = images[i].depth.Width();
    const int height = images[i].depth.Height();
    const std::filesystem::path maps = folder / "APD" / Numbered("%08d", i);
    WriteText(
        maps / (std::string("depths") + extension),
        ApdBytes(width, height, 1, ValuesOf(images[i].depth), has_version));
    WriteText(
        maps / (std::string("normals") + extension),
        ApdBytes(width, height, 3, ValuesOf(ToWorld(images[i])), has_version));
    WriteText(maps / "weak.bin", "not read");
  }
  ExportCams(images, folder);
}

void ExportOpenMvs(const std::vector<SceneImage>& images,
                   const std::filesystem::path& folder) {
  for (size_t i = 0; i < images.size(); ++i) {
    DmapContent content;
    content.image_name = "/home/somebody/dense/images/" + images[i].name;
    content.camera = images[i].camera;
    content.depth = images[i].depth;
    content.normal = images[i].normal;
    content.has_confidence = true;
    content.has_views = i % 2 == 0;
    // OpenMVS has an order of its own.
    WriteText(folder / Numbered("depth%04d.dmap", 10 - i), DmapBytes(content));
  }
}

}  // namespace tsar
