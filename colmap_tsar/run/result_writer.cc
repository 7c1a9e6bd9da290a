// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/result_writer.h"

#include "colmap_tsar/base/stopwatch.h"
#include "colmap_tsar/run/store/write_back.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <utility>

namespace tsar {
namespace {

int64_t CountDepths(const Image<float>& depth) {
  return std::count_if(
      depth.begin(), depth.end(), [](float z) { return z > 0.f; });
}

// Adds the pixel counts of the maps to the image's counts.
void CountPixels(const RefinedMaps& maps,
                 std::map<std::string, int64_t>* counts) {
  std::array<int64_t, 256> histogram = {};
  for (const uint8_t provenance : maps.provenance) {
    ++histogram[provenance];
  }
  const auto from = [&](Provenance provenance) {
    return histogram[static_cast<size_t>(provenance)];
  };
  (*counts)["pixels"] = static_cast<int64_t>(maps.depth.NumPixels());
  (*counts)["depth_after"] = CountDepths(maps.depth);
  (*counts)["measured"] = from(Provenance::kMeasured);
  (*counts)["superpixel_plane"] = from(Provenance::kSuperpixelPlane);
  (*counts)["interpolated"] = from(Provenance::kInterpolated);
  (*counts)["region_plane"] = from(Provenance::kRegionPlane);
  (*counts)["other_views"] = from(Provenance::kOtherViews);
  (*counts)["guessed"] = from(Provenance::kGuessed);
  (*counts)["prior"] = from(Provenance::kPrior);
}

void ClearMasked(const Image<uint8_t>& mask, RefinedMaps* maps) {
  ClearMasked(mask, &maps->depth);
  ClearMasked(mask, &maps->normal);
  ClearMasked(mask, &maps->confidence);
  ClearMasked(mask, &maps->provenance);
  ClearMasked(mask, &maps->planes);
  ClearMasked(mask, &maps->sigma);
}

}  // namespace

ResultWriter::ResultWriter(const Workspace& workspace,
                           InputFingerprints& inputs,
                           ViewLoader& loader,
                           std::string options_hash,
                           std::string planes)
    : workspace_(workspace),
      inputs_(inputs),
      loader_(loader),
      options_hash_(std::move(options_hash)),
      planes_(std::move(planes)) {}

void ResultWriter::Write(int image, RefinedMaps maps, ImageReport* report) {
  ClearMasked(
      workspace_.ReadMask(image, {maps.depth.Width(), maps.depth.Height()}),
      &maps);
  CountPixels(maps, &report->counts);
  if (report->prior.verdict != PriorVerdict::kNone) {
    report->counts[report->prior.IsDropped() ? kPriorsDropped : kPriorsUsed] =
        1;
  }
  ImageRecord record;
  record.note = Describe(report->prior);
  record.options_hash = options_hash_;
  record.inputs = inputs_.OfResult(image, planes_);
  record.counts = report->counts;
  record.seconds = report->seconds;
  const Stopwatch writing;
  WriteBack write_back(workspace_, image, std::move(record));
  write_back.PrepareFiles(maps);
  {
    const std::unique_lock<std::mutex> lock = loader_.Lock(image);
    write_back.Commit();
  }
  report->seconds["write"] = writing.Seconds();
  report->outcome = ImageReport::Outcome::kDone;
}

void ResultWriter::Keep(int image,
                        const std::string& reason,
                        ImageReport* report) {
  report->outcome = ImageReport::Outcome::kKept;
  report->reason = reason;
  ImageRecord record;
  record.options_hash = options_hash_;
  record.note = reason;
  record.counts = report->counts;
  const std::unique_lock<std::mutex> lock = loader_.Lock(image);
  KeepImage(workspace_, image, std::move(record));
}

}  // namespace tsar
