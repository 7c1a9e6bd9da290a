// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/io/map_paths.h"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "tests/cli/command_test.h"
#include "tests/support/test_workspace.h"
#include "tests/tools/import/import_scene.h"

namespace tsar {

// Exports the maps of the import scene to a folder as another program would and
// runs tsar_import on it.
class TsarImportTest : public testing::Test {
 protected:
  Outcome RunImport(std::vector<std::string> arguments) const;
  // From the folder of the other program.
  Outcome Import(const std::string& format,
                 std::vector<std::string> arguments = {}) const;

  void ExpectSuccess(const Outcome& outcome,
                     const std::vector<std::string>& texts = {}) const;
  // Expects exit code 1, one line with these texts (after lines of progress),
  // and no file changed.
  void ExpectFailure(const std::vector<std::string>& arguments,
                     const std::vector<std::string>& texts) const;
  void ExpectImportFailure(const std::string& format,
                           const std::vector<std::string>& texts,
                           std::vector<std::string> arguments = {}) const;
  // Expects the scene's maps in the workspace, up to these errors.
  void ExpectScene(float max_depth_error, float max_normal_error) const;
  void ExpectRefinable() const;

  MapPaths Paths(const SceneImage& image,
                 MapType type = MapType::kGeometric) const;

  // As depth images called NAME with another extension.
  void ExportDepth(
      const std::string& extension,
      float scale,
      const std::function<std::string(int, int, const std::vector<float>&)>&
          encode) const;
  void ExportPfm(float scale = 1.f) const;
  void ExportNormals() const;

  TemporaryFolder folder_;
  const std::filesystem::path root_ = folder_.Path() / "dense";
  const std::filesystem::path other_ = folder_.Path() / "other";
  const std::vector<SceneImage> scene_ = DrawImportScene(root_);
};

}  // namespace tsar
