// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>
#include <vector>

#include "tests/run/refine_workspace_fixture.h"
#include <nlohmann/json.hpp>

namespace tsar {

// All files without times. Such trees are compared as a whole, since a failure
// should not print megabytes.
inline Tree ResultOf(const std::filesystem::path& root) {
  Tree tree = ReadTree(root);
  std::erase_if(tree, [](const auto& file) {
    return file.first.find("stereo/tsar/records/") == 0 ||
           file.first == "stereo/tsar/manifest.json" ||
           file.first == "stereo/tsar/lock";
  });
  return tree;
}

inline nlohmann::json ManifestOf(const std::filesystem::path& root) {
  nlohmann::json json =
      nlohmann::json::parse(ReadText(root / "stereo/tsar/manifest.json"));
  json.erase("seconds");
  json.erase("runtime");
  json.erase("inputs");
  for (nlohmann::json& image : json["images"]) {
    image.erase("seconds");
  }
  return json;
}

class RefineShardTest : public RefineWorkspaceTest {
 protected:
  static WorkspaceRefineOptions Options(const std::filesystem::path& root,
                                        const std::string& pass = "all",
                                        const std::string& shard = "") {
    WorkspaceRefineOptions options = RefineWorkspaceTest::Options(root);
    for (const RefinePass other : {RefinePass::kObserve,
                                   RefinePass::kModel,
                                   RefinePass::kCompose,
                                   RefinePass::kMerge}) {
      options.pass = ToString(other) == pass ? other : options.pass;
    }
    options.shard = ParseShard(shard);
    return options;
  }
  RunSummary Run(const std::string& pass,
                 const std::string& shard = "",
                 const RefineOptions& refine = {}) const {
    return Refine(Options(root_, pass, shard), refine);
  }
  // All shards in a pass; finds the planes of the scene before composing.
  void RunAll(const std::string& pass,
              int count,
              const RefineOptions& refine = {}) const {
    if (pass == "compose") {
      Run("model", "", refine);
    }
    for (int i = 0; i < count; ++i) {
      Run(pass, std::to_string(i) + "/" + std::to_string(count), refine);
    }
  }

  // Expects an error before a file was changed.
  void ExpectRefusal(ErrorCode code,
                     const std::vector<std::string>& texts,
                     const WorkspaceRefineOptions& options,
                     const RefineOptions& refine = {}) const {
    Tree before = ReadTree(root_);
    ExpectError(code, texts, [&] { Refine(options, refine); });
    Tree after = ReadTree(root_);
    // The last program removes what a shard leaves.
    before.erase("stereo/tsar/lock");
    after.erase("stereo/tsar/lock");
    EXPECT_TRUE(after == before);
  }
  void ExpectRefusal(ErrorCode code,
                     const std::vector<std::string>& texts,
                     const std::string& pass,
                     const std::string& shard = "") const {
    ExpectRefusal(code, texts, Options(root_, pass, shard));
  }
};

}  // namespace tsar
