// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/vector.h"

#include <filesystem>
#include <string>
#include <vector>

namespace tsar {

// One image of the scene with its geometric maps.
struct SceneImage {
  std::string name;
  Camera camera;
  Image<float> depth;
  Image<Vec3f> normal;
};

// The synthetic workspace (see synthetic_workspace.h) with the world turned, so
// that no camera has the world's axes, and with sparse points on the wall.
// Returns its images in the order of their ids: v0.png, v1.png, left/v2.png,
// v3.png.
std::vector<SceneImage> DrawImportScene(const std::filesystem::path& root);

// Leaves images/ and sparse/ alone.
void RemoveStereo(const std::filesystem::path& root);

// The scene's maps as other programs write them, into a folder, with the images
// numbered in the order in which they are given.
void ExportAcm(const std::vector<SceneImage>& images,
               const std::filesystem::path& folder);
void ExportApd(const std::vector<SceneImage>& images,
               const std::filesystem::path& folder,
               bool has_version);
void ExportOpenMvs(const std::vector<SceneImage>& images,
                   const std::filesystem::path& folder);

}  // namespace tsar
