// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/controllers/shard.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <numeric>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

namespace tsar {
namespace {

constexpr int kMaxShards = 100000;

constexpr std::array kPassNames = {
    std::pair(RefinePass::kAll, "all"),
    std::pair(RefinePass::kObserve, "observe"),
    std::pair(RefinePass::kCompose, "compose"),
    std::pair(RefinePass::kMerge, "merge"),
};

std::optional<int> ParseCount(std::string_view text) {
  int value = 0;
  const auto result =
      std::from_chars(text.data(), text.data() + text.size(), value);
  if (result.ec != std::errc() || result.ptr != text.data() + text.size() ||
      value < 0) {
    return std::nullopt;
  }
  return value;
}

Error Refused(const std::string& what) {
  return Error(ErrorCode::kBadOption,
               OptionName("shard") + ": " + what +
                   "; give i/n with i from 0 to n - 1, such as 0/4 for the "
                   "first of four parts");
}

// For each image of the run, those that it reads or that read it.
std::vector<std::vector<size_t>> FindNeighbours(const Workspace& workspace) {
  const std::vector<StereoProblem>& problems = workspace.Problems();
  std::vector<int> index_of(workspace.Model().images.size(), -1);
  for (size_t i = 0; i < problems.size(); ++i) {
    index_of[static_cast<size_t>(problems[i].reference)] = static_cast<int>(i);
  }
  std::vector<std::vector<size_t>> neighbours(problems.size());
  for (size_t i = 0; i < problems.size(); ++i) {
    for (const int source : problems[i].sources) {
      const int other = index_of[static_cast<size_t>(source)];
      if (other >= 0 && other != static_cast<int>(i)) {
        neighbours[i].push_back(static_cast<size_t>(other));
        neighbours[static_cast<size_t>(other)].push_back(i);
      }
    }
  }
  for (std::vector<size_t>& images : neighbours) {
    std::sort(images.begin(), images.end());
    images.erase(std::unique(images.begin(), images.end()), images.end());
  }
  return neighbours;
}

// What an image takes: each source is compared with all its pixels.
std::vector<int64_t> FindWork(const Workspace& workspace) {
  std::vector<int64_t> work;
  for (const StereoProblem& problem : workspace.Problems()) {
    const Camera& camera =
        workspace.Model().images[static_cast<size_t>(problem.reference)].camera;
    work.push_back(static_cast<int64_t>(camera.width) * camera.height *
                   static_cast<int64_t>(problem.sources.size() + 1));
  }
  return work;
}

// An order of images in which neighbours are close to each other: that of
// Cuthill and McKee, in which images far from the first come late and those
// with few neighbours before others.
class NeighbourOrder {
 public:
  explicit NeighbourOrder(const Workspace& workspace)
      : neighbours_(FindNeighbours(workspace)),
        is_taken_(neighbours_.size(), false) {
    for (const StereoProblem& problem : workspace.Problems()) {
      names_.push_back(workspace.Model()
                           .images[static_cast<size_t>(problem.reference)]
                           .name);
    }
  }

  std::vector<size_t> Find() {
    std::vector<size_t> by_name(neighbours_.size());
    for (size_t i = 0; i < by_name.size(); ++i) {
      by_name[i] = i;
    }
    std::sort(by_name.begin(), by_name.end(), [&](size_t a, size_t b) {
      return names_[a] < names_[b];
    });
    std::vector<size_t> order;
    for (const size_t image : by_name) {
      if (!is_taken_[image]) {
        const std::vector<size_t> component = Walk(FindEnd(image));
        order.insert(order.end(), component.begin(), component.end());
        for (const size_t taken : component) {
          is_taken_[taken] = true;
        }
      }
    }
    return order;
  }

 private:
  // All images that can be reached, the nearest first.
  std::vector<size_t> Walk(size_t start) const {
    std::vector<bool> is_seen = is_taken_;
    std::vector<size_t> order = {start};
    is_seen[start] = true;
    for (size_t i = 0; i < order.size(); ++i) {
      const size_t first_new = order.size();
      for (const size_t other : neighbours_[order[i]]) {
        if (!is_seen[other]) {
          is_seen[other] = true;
          order.push_back(other);
        }
      }
      std::sort(order.begin() + static_cast<std::ptrdiff_t>(first_new),
                order.end(),
                [&](size_t a, size_t b) {
                  return std::pair(neighbours_[a].size(), names_[a]) <
                         std::pair(neighbours_[b].size(), names_[b]);
                });
    }
    return order;
  }

  // An image at one end of all that can be reached: the farthest from the one
  // that is farthest from any.
  size_t FindEnd(size_t image) const { return Walk(Walk(image).back()).back(); }

  const std::vector<std::vector<size_t>> neighbours_;
  std::vector<std::string> names_;
  std::vector<bool> is_taken_;
};

}  // namespace

std::string ToString(const Shard& shard) {
  return std::to_string(shard.index) + " of " + std::to_string(shard.count);
}

Shard ParseShard(const std::string& text) {
  if (text.empty()) {
    return {};
  }
  const std::string_view view = text;
  const size_t slash = view.find('/');
  const std::optional<int> index = ParseCount(view.substr(0, slash));
  const std::optional<int> count = slash == std::string_view::npos
                                       ? std::nullopt
                                       : ParseCount(view.substr(slash + 1));
  if (!index || !count) {
    throw Refused("'" + text + "' is not a part of the images");
  }
  const Shard shard = {*index, *count};
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

std::string ToString(RefinePass pass) {
  return kPassNames[static_cast<size_t>(pass)].second;
}

RefinePass ParsePass(const std::string& text) {
  for (const auto& [pass, name] : kPassNames) {
    if (text == name) {
      return pass;
    }
  }
  throw Error(ErrorCode::kBadOption,
              OptionName("pass") + ": '" + text +
                  "' is not known; give all, observe, compose or merge");
}

std::vector<std::vector<size_t>> SplitImages(const Workspace& workspace,
                                             int count) {
  if (count == 1) {
    // The order of neighbours is that of the images again, once sorted.
    std::vector<size_t> all(workspace.Problems().size());
    std::iota(all.begin(), all.end(), size_t{0});
    return {std::move(all)};
  }
  const std::vector<int64_t> work = FindWork(workspace);
  int64_t total = 0;
  for (const int64_t value : work) {
    total += value;
  }
  std::vector<std::vector<size_t>> shards(static_cast<size_t>(count));
  int64_t before = 0;
  for (const size_t image : NeighbourOrder(workspace).Find()) {
    // The part in which the middle of the image's work lies.
    const double middle =
        static_cast<double>(before) + 0.5 * static_cast<double>(work[image]);
    const auto shard =
        static_cast<size_t>(middle * count / static_cast<double>(total));
    shards[std::min(shard, shards.size() - 1)].push_back(image);
    before += work[image];
  }
  for (std::vector<size_t>& shard : shards) {
    std::sort(shard.begin(), shard.end());
  }
  return shards;
}

}  // namespace tsar
