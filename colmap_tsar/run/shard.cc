// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/shard.h"

#include "colmap_tsar/base/enum_names.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/run/neighbor_order.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <numeric>
#include <utility>

namespace tsar {
namespace {

constexpr int kMaxShards = 100000;

constexpr std::array kPassNames = {
    std::pair(RefinePass::kAll, "all"),
    std::pair(RefinePass::kObserve, "observe"),
    std::pair(RefinePass::kModel, "model"),
    std::pair(RefinePass::kCompose, "compose"),
    std::pair(RefinePass::kMerge, "merge"),
};

Error Refused(const std::string& what) {
  return Error(ErrorCode::kBadOption,
               OptionName("shard") + ": " + what +
                   "; give i/n with i from 0 to n - 1, such as 0/4 for the "
                   "first of four parts");
}

// The work of each image: each of its pixels is compared with all sources.
std::vector<int64_t> FindWork(const Workspace& workspace) {
  std::vector<int64_t> work;
  for (const StereoProblem& problem : workspace.Problems()) {
    const Camera& camera = workspace.CameraOf(problem.reference);
    work.push_back(static_cast<int64_t>(camera.width) * camera.height *
                   static_cast<int64_t>(problem.sources.size() + 1));
  }
  return work;
}

}  // namespace

std::string ToString(const Shard& shard) {
  return std::to_string(shard.index) + " of " + std::to_string(shard.count);
}

Shard ParseShard(const std::string& text) {
  if (text.empty()) {
    return {};
  }
  Shard shard;
  std::sscanf(text.c_str(), "%9d/%9d", &shard.index, &shard.count);
  if (text != std::to_string(shard.index) + "/" + std::to_string(shard.count)) {
    throw Refused("'" + text + "' is not a part of the images");
  }
  shard.Check();
  return shard;
}

void Shard::Check() const {
  if (count < 1 || count > kMaxShards) {
    throw Refused("there can be 1 to " + std::to_string(kMaxShards) +
                  " parts, not " + std::to_string(count));
  }
  if (index < 0 || index >= count) {
    throw Refused(
        "of " + std::to_string(count) + (count == 1 ? " part" : " parts") +
        ", counted from 0 on, there is no part " + std::to_string(index));
  }
}

std::string ToString(RefinePass pass) { return EnumName(kPassNames, pass); }

std::vector<std::vector<size_t>> SplitImages(const Workspace& workspace,
                                             int count) {
  if (count == 1) {
    // Once sorted, the order of neighbors is that of the images.
    std::vector<size_t> all(workspace.Problems().size());
    std::iota(all.begin(), all.end(), size_t{0});
    return {std::move(all)};
  }
  const std::vector<int64_t> work = FindWork(workspace);
  const int64_t total = std::accumulate(work.begin(), work.end(), int64_t{0});
  std::vector<std::vector<size_t>> shards(static_cast<size_t>(count));
  int64_t before = 0;
  for (const size_t image : OrderByNeighbors(workspace)) {
    // The shard in which the middle of the image's work lies.
    const double middle =
        static_cast<double>(before) + 0.5 * static_cast<double>(work[image]);
    const auto shard =
        static_cast<size_t>(middle * count / static_cast<double>(total));
    shards[std::min(shard, shards.size() - 1)].push_back(image);
    before += work[image];
  }
  for (std::vector<size_t>& shard : shards) {
    std::ranges::sort(shard);
  }
  return shards;
}

}  // namespace tsar
