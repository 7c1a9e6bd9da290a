// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/run/refine_workspace.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <sstream>

#include "tests/support/synthetic_workspace.h"
#include "tests/support/test_workspace.h"
#include <nlohmann/json.hpp>

namespace tsar {

using Tree = std::map<std::string, std::string>;

// The files of a tree that other programs read.
inline Tree MapsOf(const std::filesystem::path& root) {
  Tree maps;
  for (const char* folder : {"stereo/depth_maps",
                             "stereo/normal_maps",
                             "stereo/confidence_maps",
                             "stereo/sigma_maps",
                             "stereo/provenance_maps",
                             "stereo/plane_maps"}) {
    // This program's own folders do not exist from the beginning.
    if (!std::filesystem::exists(root / folder)) {
      continue;
    }
    for (auto& [name, content] : ReadTree(root / folder)) {
      maps[std::string(folder) + "/" + name] = std::move(content);
    }
  }
  return maps;
}

// A photo with both ends, but zeros between them: that shows only when it is
// decoded.
inline std::string WithZeros(std::string photo) {
  const size_t middle = photo.size() / 2;
  return photo.replace(middle, 20, 20, '\0');
}

// Equality without printing megabytes where it fails.
inline void ExpectSameFiles(const Tree& a, const Tree& b) {
  for (const auto& [name, content] : a) {
    const auto found = b.find(name);
    ASSERT_NE(found, b.end()) << name << " is missing";
    EXPECT_TRUE(found->second == content) << name << " differs";
  }
  for (const auto& [name, content] : b) {
    EXPECT_EQ(a.count(name), 1u) << name << " is new";
  }
}

class RefineWorkspaceTest : public testing::Test {
 protected:
  void SetUp() override { MakeSyntheticWorkspace(root_); }

  // One thread, so that the order of the images is known.
  static WorkspaceRefineOptions Options(const std::filesystem::path& root) {
    WorkspaceRefineOptions options;
    options.workspace_path = root;
    options.devices.choice = DeviceChoice::kCpu;
    options.devices.num_threads = 1;
    return options;
  }

  static RunSummary Refine(const WorkspaceRefineOptions& options,
                           const RefineOptions& refine = {},
                           const std::function<bool()>& should_stop = nullptr) {
    std::ostringstream text;
    Progress progress(text, false);
    progress.SetStop(should_stop);
    return RefineWorkspace(options, refine, progress);
  }
  RunSummary Refine() { return Refine(Options(root_)); }

  // Expects an error before anything was changed.
  void ExpectRefusal(ErrorCode code,
                     const std::vector<std::string>& texts,
                     const WorkspaceRefineOptions& options) {
    const Tree before = ReadTree(folder_.Path());
    ExpectError(code, texts, [&] { Refine(options); });
    ExpectSameFiles(before, ReadTree(folder_.Path()));
  }
  void ExpectRefusal(ErrorCode code, const std::vector<std::string>& texts) {
    ExpectRefusal(code, texts, Options(root_));
  }

  MapPaths Paths(int view, MapType type = MapType::kGeometric) const {
    return GetMapPaths(root_, SyntheticWorkspace::Names()[view], type);
  }
  void RemoveMaps(int view, MapType type) const {
    std::filesystem::remove(Paths(view, type).depth);
    std::filesystem::remove(Paths(view, type).normal);
  }
  nlohmann::json Manifest() const {
    return nlohmann::json::parse(ReadText(root_ / "stereo/tsar/manifest.json"));
  }

  // Where an image's evidence lies while a run needs it.
  static std::filesystem::path Evidence(const std::filesystem::path& root,
                                        int view) {
    return root / "stereo/tsar/evidence" /
           (SyntheticWorkspace::Names()[view] + ".geometric.bin");
  }
  // Stops a run once all images have been observed.
  void Observe(const WorkspaceRefineOptions& options,
               const RefineOptions& refine = {}) {
    const std::filesystem::path root = options.output_path.empty()
                                           ? options.workspace_path
                                           : options.output_path;
    ExpectError(ErrorCode::kInterrupted,
                {"4 of 4 images were observed", "same command"},
                [&] {
                  Refine(options, refine, [&] {
                    return std::ranges::all_of(
                        std::array{0, 1, 2, 3}, [&](int view) {
                          return std::filesystem::exists(Evidence(root, view));
                        });
                  });
                });
    for (int view = 0; view < 4; ++view) {
      EXPECT_TRUE(std::filesystem::exists(Evidence(root, view)));
    }
  }
  // A workspace drawn and changed alike that is refined in one go.
  std::filesystem::path Whole(
      const RefineOptions& refine = {},
      const std::function<void(const std::filesystem::path&)>& change =
          [](const std::filesystem::path&) {}) const {
    const std::filesystem::path root = folder_.Path() / "whole";
    std::filesystem::remove_all(root);
    MakeSyntheticWorkspace(root);
    change(root);
    Refine(Options(root), refine);
    return root;
  }
  // Its maps.
  Tree RefinedInOneGo(
      const RefineOptions& refine = {},
      const std::function<void(const std::filesystem::path&)>& change =
          [](const std::filesystem::path&) {}) const {
    return MapsOf(Whole(refine, change));
  }
  void Redraw() const {
    std::filesystem::remove_all(root_);
    MakeSyntheticWorkspace(root_);
  }
  std::string WarningsOf(const WorkspaceRefineOptions& options,
                         int num_refined) const {
    testing::internal::CaptureStderr();
    EXPECT_EQ(Refine(options).num_refined, num_refined);
    return testing::internal::GetCapturedStderr();
  }
  static void RemoveDepths(const std::filesystem::path& root, int view) {
    for (const MapType type : {MapType::kPhotometric, MapType::kGeometric}) {
      WriteDepthMap(
          UserPath(
              GetMapPaths(root, SyntheticWorkspace::Names()[view], type).depth),
          Image<float>(96, 72, 0.f));
    }
  }
  // Expects the true depth on over half of the wall without texture.
  void ExpectBareWallFilled(int view) const {
    const Image<float> depth = ReadDepthMap(Paths(view).depth);
    int num_bare = 0;
    int num_right = 0;
    for (int y = 0; y < depth.Height(); ++y) {
      for (int x = 0; x < depth.Width(); ++x) {
        if (SyntheticWorkspace::IsBare(view, x, y)) {
          ++num_bare;
          num_right += std::abs(depth(x, y) - 5.f) < 0.05f ? 1 : 0;
        }
      }
    }
    EXPECT_GT(num_right, num_bare / 2) << view;
  }
  bool HasEvidence() const {
    return std::filesystem::exists(root_ / "stereo/tsar/evidence");
  }

  TemporaryFolder folder_;
  const std::filesystem::path root_ = folder_.Path() / "dense";
};

}  // namespace tsar
