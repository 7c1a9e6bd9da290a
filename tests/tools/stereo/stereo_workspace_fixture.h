// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/tools/stereo/stereo_workspace.h"

#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/synthetic_workspace.h"
#include "tests/support/test_workspace.h"

namespace tsar {

// A synthetic workspace without maps.
class StereoWorkspaceTest : public testing::Test {
 protected:
  static constexpr int kMapWidth = SyntheticWorkspace::kWidth / 4;
  static constexpr int kMapHeight = SyntheticWorkspace::kHeight / 4;

  void SetUp() override {
    MakeSyntheticWorkspace(root_);
    RemoveMaps(root_);
    options_.depth_min = 0.5 * SyntheticWorkspace::kDepth;
    options_.depth_max = 2.0 * SyntheticWorkspace::kDepth;
    options_.num_iterations = 2;
    // Enough for tests of files; matching itself needs all of an image.
    options_.max_image_size = kMapWidth;
  }

  // Two seconds later than before.
  static void Touch(const std::filesystem::path& path) {
    std::filesystem::last_write_time(
        path, std::filesystem::last_write_time(path) + std::chrono::seconds(2));
  }

  static void RemoveMaps(const std::filesystem::path& root) {
    for (const char* folder : {"depth_maps", "normal_maps"}) {
      std::filesystem::remove_all(root / "stereo" / folder);
    }
  }

  // The smallest costs of all pixels, then the second smallest.
  static std::vector<float> ReadCosts(const std::filesystem::path& path) {
    MapReader reader(path);
    std::vector<float> costs(reader.Size().NumValues());
    reader.Read(0, 0, costs);
    return costs;
  }

  StereoSummary Run(bool overwrite = false,
                    int num_threads = 1,
                    const std::function<bool()>& should_stop = nullptr) {
    DeviceOptions devices;
    devices.choice = DeviceChoice::kCpu;
    devices.num_threads = num_threads;
    std::ostringstream log;
    Progress progress(log, false);
    progress.SetStop(should_stop);
    return MatchWorkspace(root_,
                          devices,
                          options_,
                          overwrite,
                          progress,
                          {image_list_path_, mask_path_});
  }

  // Expects that a run fails and changes no map.
  void ExpectRefused(ErrorCode code,
                     const std::string& text,
                     bool overwrite = false) {
    const auto before = Maps();
    ExpectError(code, {text}, [&] { Run(overwrite); });
    EXPECT_TRUE(Maps() == before);
  }

  std::map<std::string, std::string> Maps() const {
    std::map<std::string, std::string> maps;
    for (const char* folder : {"depth_maps", "normal_maps", "cost_maps"}) {
      if (!std::filesystem::exists(root_ / "stereo" / folder)) {
        continue;
      }
      for (auto& [name, content] : ReadTree(root_ / "stereo" / folder)) {
        maps[std::string(folder) + "/" + name] = std::move(content);
      }
    }
    return maps;
  }

  TemporaryFolder folder_;
  const std::filesystem::path root_ = folder_.Path() / "dense";
  StereoOptions options_;
  std::filesystem::path image_list_path_;
  std::filesystem::path mask_path_;
};

}  // namespace tsar
