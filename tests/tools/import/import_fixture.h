// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/io/map_paths.h"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "tests/cli/command_test.h"
#include "tests/support/test_workspace.h"

namespace tsar {

// One image of the scene with its geometric maps.
struct SceneImage {
  std::string name;
  Camera camera;
  Image<float> depth;
  Image<Vec3f> normal;
};

// The synthetic workspace (see synthetic_workspace.h) with the world turned, so
// that no camera has the world's axes, and with sparse points on the wall; its
// images in the order of their ids: v0.png, v1.png, left/v2.png, v3.png. Writes
// their maps as other programs do, into the folder `other`, and runs
// tsar_import on them.
class TsarImportTest : public testing::Test {
 protected:
  // Without --output_path: into a folder that is not there.
  Outcome Import(const std::string& format,
                 std::vector<std::string> arguments = {}) const;
  void ExpectSuccess(const Outcome& outcome,
                     const std::vector<std::string>& texts = {}) const;
  // Expects exit code 1, one line with these texts (after lines of progress),
  // and no file changed.
  void ExpectFailure(const std::string& format,
                     const std::vector<std::string>& texts,
                     const std::vector<std::string>& arguments = {}) const;
  // Expects the scene's maps in the output, up to these errors; pixels may lack
  // a depth where is_filtered, but not many.
  void ExpectScene(float max_depth_error,
                   float max_normal_error,
                   bool is_filtered = false) const;
  void ExpectRefinable() const;

  MapPaths Paths(const SceneImage& image,
                 MapType type = MapType::kGeometric) const {
    return GetMapPaths(output_, image.name, type);
  }

  // With the images numbered in the order in which they are given.
  void WriteAcm(const std::vector<SceneImage>& images) const;
  void WriteApd(bool has_version) const;
  void WriteOpenMvs() const;
  // As depth images called NAME with another extension.
  void WriteDepth(
      const std::string& extension,
      float scale,
      const std::function<std::string(int, int, const std::vector<float>&)>&
          encode) const;
  void WritePfm(float scale = 1.f) const;

  TemporaryFolder folder_;
  const std::filesystem::path root_ = folder_.Path() / "dense";
  const std::filesystem::path other_ = folder_.Path() / "other";
  const std::filesystem::path output_ = folder_.Path() / "imported";
  const std::vector<SceneImage> scene_ = DrawScene();

 private:
  std::vector<SceneImage> DrawScene() const;
};

}  // namespace tsar
