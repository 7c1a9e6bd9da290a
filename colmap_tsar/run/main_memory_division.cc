// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/main_memory_division.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/text_stream.h"
#include "colmap_tsar/base/warning.h"

#include <algorithm>
#include <cmath>

namespace tsar {
namespace {

constexpr double kBytesPerGigabyte = 1e9;
// The usable share of the machine's memory; the rest is for the system, its
// file cache, and everything that the plan does not count.
constexpr double kUsableShare = 0.8;

double Gigabytes(int64_t num_bytes) {
  return static_cast<double>(num_bytes) / kBytesPerGigabyte;
}

// Rounds up to a tenth of a gigabyte.
std::string GigabytesText(int64_t num_bytes) {
  TextStream text;
  text << std::ceil(Gigabytes(num_bytes) * 10) / 10 << " GB";
  return text.str();
}

std::string WhatNeeds(int num_sources, int64_t needed) {
  return "an image of this workspace with its " + std::to_string(num_sources) +
         " source images, beside the results of the images at work, needs " +
         GigabytesText(needed) + " of main memory at a time";
}

}  // namespace

MemoryBudget::MemoryBudget(double cache_size, int64_t machine_bytes)
    : cache_size_(cache_size),
      machine_bytes_(machine_bytes),
      num_bytes_(static_cast<int64_t>(
          std::min(cache_size * kBytesPerGigabyte,
                   kUsableShare * static_cast<double>(machine_bytes)))) {}

std::string MemoryBudget::Describe() const {
  TextStream text;
  if (kUsableShare * static_cast<double>(machine_bytes_) <
      cache_size_ * kBytesPerGigabyte) {
    text << "four fifths of the " << GigabytesText(machine_bytes_)
         << " that this machine gives";
  } else {
    text << OptionName("cache_size") + " " << cache_size_;
  }
  return text.str();
}

MainMemoryDivision::MainMemoryDivision(const MemoryPlanner& planner,
                                       const WorkspaceOverview& overview,
                                       int num_images,
                                       bool on_cpu)
    : planner_(planner),
      overview_(overview),
      plan_(planner(overview)),
      num_images_(num_images),
      on_cpu_(on_cpu) {}

int MainMemoryDivision::NumCpuWorkers(const MemoryBudget& budget,
                                      int max_num_workers) const {
  int num_workers = max_num_workers;
  while (num_workers > 1 &&
         BytesBesideViews(plan_, num_workers, MakeSizes(1, num_workers)) +
                 num_workers * BytesForViews(plan_) >
             budget.NumBytes()) {
    --num_workers;
  }
  return num_workers;
}

MainMemoryDivision::Sizes MainMemoryDivision::Divide(
    const MemoryBudget& budget, int num_workers, int max_num_loaders) const {
  Sizes result;
  int64_t rest = 0;
  for (int num_threads = max_num_loaders; num_threads > 0; --num_threads) {
    result.pipeline = MakeSizes(num_threads, num_workers);
    rest = budget.NumBytes() -
           BytesBesideViews(plan_, num_workers, result.pipeline);
    if (rest >= BytesForViews(plan_)) {
      break;
    }
  }
  result.view_bytes = static_cast<size_t>(std::max<int64_t>(rest, 0));
  const int64_t needed = budget.NumBytes() + BytesForViews(plan_) - rest;
  if (needed > budget.MachineBytes()) {
    throw Error(ErrorCode::kOutOfMemory,
                WhatNeeds(plan_.num_sources, needed) +
                    ", and this machine gives " +
                    GigabytesText(budget.MachineBytes()) +
                    "; run patch_match_stereo with fewer source images or a "
                    "smaller --PatchMatchStereo.max_image_size" +
                    WhatFits(budget.MachineBytes(), needed, num_workers));
  }
  if (needed > budget.NumBytes()) {
    Warn(WhatNeeds(plan_.num_sources, needed) + ", more than " +
         budget.Describe() +
         "; the run takes that much. If it is not there, run "
         "patch_match_stereo with fewer source images or a smaller "
         "--PatchMatchStereo.max_image_size");
  }
  return result;
}

PipelineSizes MainMemoryDivision::MakeSizes(int num_loaders,
                                            int num_workers) const {
  if (on_cpu_) {
    return {num_loaders, num_loaders, 1, 1};
  }
  // Reading threads also find the scene, which takes longer than writing.
  const int num_writers = std::max(1, num_loaders * 4 / 5);
  return {num_loaders,
          num_writers,
          static_cast<size_t>(num_workers),
          static_cast<size_t>(num_writers)};
}

int64_t MainMemoryDivision::ReadingAndResultBytes(
    const MemoryPlan& plan, int num_workers, const PipelineSizes& sizes) const {
  const auto num_results =
      std::min<int64_t>(num_images_,
                        num_workers + static_cast<int64_t>(sizes.max_finished) +
                            sizes.num_writers);
  return sizes.num_loaders * plan.load + num_results * plan.result;
}

int64_t MainMemoryDivision::BytesBesideViews(const MemoryPlan& plan,
                                             int num_workers,
                                             const PipelineSizes& sizes) const {
  // Evidence is made in a pass of its own, before planes are searched for.
  const int64_t making_evidence = sizes.num_writers * plan.make_evidence;
  const int64_t computing = on_cpu_ ? DeviceBytes(plan, num_workers) : 0;
  // The number of images whose neighbors' evidence is in use.
  const size_t num_scenes =
      static_cast<size_t>(num_workers) +
      (on_cpu_ ? 0 : static_cast<size_t>(sizes.num_loaders) + sizes.max_ready);
  return computing + ReadingAndResultBytes(plan, num_workers, sizes) +
         std::max(making_evidence, EvidenceBytes(plan, num_scenes));
}

std::string MainMemoryDivision::WhatFits(int64_t machine_bytes,
                                         int64_t needed,
                                         int num_workers) const {
  constexpr int64_t kMegapixel = 1000000;
  // An upper bound: some memory does not grow with the maps.
  auto megapixels = static_cast<int64_t>(
      Gigabytes(machine_bytes) / Gigabytes(needed) *
      static_cast<double>(overview_.max_num_pixels / kMegapixel));
  for (; megapixels > 0; --megapixels) {
    WorkspaceOverview smaller = overview_;
    smaller.max_num_pixels = megapixels * kMegapixel;
    const MemoryPlan plan = planner_(smaller);
    if (BytesBesideViews(plan, num_workers, MakeSizes(1, num_workers)) +
            BytesForViews(plan) <=
        machine_bytes) {
      return " (maps of " + std::to_string(megapixels) + " megapixels fit)";
    }
  }
  return "";
}

}  // namespace tsar
