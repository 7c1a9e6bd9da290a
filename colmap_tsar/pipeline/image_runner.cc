// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/image_runner.h"

#include "colmap_tsar/pipeline/refine_option_list.h"
#include "colmap_tsar/workspace/write_back.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace tsar {
namespace {

using Clock = std::chrono::steady_clock;

double SecondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

int64_t CountDepths(const Image<float>& depth) {
  return std::count_if(
      depth.begin(), depth.end(), [](float z) { return z > 0.f; });
}

std::map<std::string, int64_t> CountPixels(const ViewData& view,
                                           const RefinedMaps& maps) {
  const auto from = [&](Provenance provenance) -> int64_t {
    return std::count(maps.provenance.begin(),
                      maps.provenance.end(),
                      static_cast<uint8_t>(provenance));
  };
  return {{"pixels", static_cast<int64_t>(maps.depth.NumPixels())},
          {"depth_before", view.num_depths_to_refine},
          {"depth_after", CountDepths(maps.depth)},
          {"measured", from(Provenance::kMeasured)},
          {"superpixel_plane", from(Provenance::kSuperpixelPlane)},
          {"interpolated", from(Provenance::kInterpolated)},
          {"region_plane", from(Provenance::kRegionPlane)},
          {"other_views", from(Provenance::kOtherViews)},
          {"not_finite", view.num_not_finite}};
}

}  // namespace

uint32_t HashImageName(const std::string& name) {
  uint32_t hash = 2166136261u;
  for (const char character : name) {
    hash = (hash ^ static_cast<unsigned char>(character)) * 16777619u;
  }
  return hash;
}

ImageRunner::ImageRunner(const Workspace& workspace,
                         std::vector<bool> has_maps,
                         const RefineOptions& options,
                         size_t cache_num_bytes,
                         const std::function<bool()>& should_stop)
    : workspace_(workspace),
      has_maps_(std::move(has_maps)),
      options_(options),
      options_hash_(HashRefineOptions(options)),
      should_stop_(should_stop),
      file_mutexes_(workspace.Model().images.size()),
      cache_(cache_num_bytes, [this](int image) {
        const std::lock_guard<std::mutex> lock(
            file_mutexes_[static_cast<size_t>(image)]);
        return LoadView(workspace_, image);
      }) {}

ImageReport ImageRunner::Run(const StereoProblem& problem, Device& device) {
  ImageReport report;
  if (should_stop_()) {
    return report;
  }
  const int image = problem.reference;
  const std::string type = ToString(workspace_.Type());
  if (!HasMaps(image)) {
    return Keep(
        image,
        std::move(report),
        "it has no " + type + " maps; run patch_match_stereo for this image");
  }
  if (IsDone(workspace_, image, options_hash_)) {
    report.outcome = ImageReport::Outcome::kSkipped;
    return report;
  }
  if (problem.sources.empty()) {
    return Keep(image,
                std::move(report),
                "no other image shares enough of its sparse points");
  }
  if (std::none_of(problem.sources.begin(),
                   problem.sources.end(),
                   [&](int source) { return HasMaps(source); })) {
    return Keep(image,
                std::move(report),
                "none of its source images has " + type + " maps");
  }
  return Refine(problem, std::move(report), device);
}

ImageReport ImageRunner::Refine(const StereoProblem& problem,
                                ImageReport report,
                                Device& device) {
  const Clock::time_point read_start = Clock::now();
  const int image = problem.reference;
  const ViewCache::View reference = cache_.Get(image);
  report.counts["not_finite"] = reference->num_not_finite;
  if (CountDepths(reference->depth) == 0) {
    return Keep(image, std::move(report), "its depth map holds no valid depth");
  }
  std::vector<ViewCache::View> held;
  std::vector<const ViewData*> sources;
  for (const int source : problem.sources) {
    if (HasMaps(source)) {
      sources.push_back(held.emplace_back(cache_.Get(source)).get());
    } else {
      ++report.num_sources_without_maps;
    }
  }
  const double read_seconds = SecondsSince(read_start);

  RefineResult result = RefineImage(
      *reference, sources, HashImageName(Name(image)), options_, device);
  if (should_stop_()) {
    return report;
  }
  if (!result.reason_to_keep.empty()) {
    return Keep(image, std::move(report), result.reason_to_keep);
  }
  report.counts = CountPixels(*reference, result.maps);
  report.seconds = std::move(result.seconds);
  report.seconds["read"] = read_seconds;
  ImageRecord record;
  record.options_hash = options_hash_;
  record.counts = report.counts;
  record.seconds = report.seconds;
  const Clock::time_point write_start = Clock::now();
  {
    const std::lock_guard<std::mutex> lock(
        file_mutexes_[static_cast<size_t>(image)]);
    WriteRefined(workspace_, image, result.maps, std::move(record));
  }
  report.seconds["write"] = SecondsSince(write_start);
  report.outcome = ImageReport::Outcome::kRefined;
  return report;
}

ImageReport ImageRunner::Keep(int image,
                              ImageReport report,
                              const std::string& reason) {
  report.outcome = ImageReport::Outcome::kKept;
  report.reason = reason;
  ImageRecord record;
  record.options_hash = options_hash_;
  record.note = reason;
  record.counts = report.counts;
  const std::lock_guard<std::mutex> lock(
      file_mutexes_[static_cast<size_t>(image)]);
  KeepImage(workspace_, image, std::move(record));
  return report;
}

bool ImageRunner::HasMaps(int image) const {
  return has_maps_[static_cast<size_t>(image)];
}

const std::string& ImageRunner::Name(int image) const {
  return workspace_.Model().images[static_cast<size_t>(image)].name;
}

}  // namespace tsar
