// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/result_writer.h"

#include "colmap_tsar/base/stopwatch.h"
#include "colmap_tsar/run/store/image_maps.h"
#include "colmap_tsar/run/store/write_back.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>

namespace tsar {
namespace {

// Adds the pixel counts of the maps to the image's counts.
void CountPixels(const RefinedMaps& maps,
                 std::map<std::string, int64_t>* counts) {
  std::array<int64_t, 256> histogram = {};
  for (const uint8_t provenance : maps.provenance) {
    ++histogram[provenance];
  }
  (*counts)["pixels"] = static_cast<int64_t>(maps.depth.NumPixels());
  (*counts)["depth_after"] =
      std::ranges::count_if(maps.depth, [](float z) { return z > 0.f; });
  for (size_t provenance = 1; provenance < kProvenanceNames.size();
       ++provenance) {
    std::string name = kProvenanceNames[provenance];
    std::ranges::replace(name, ' ', '_');
    (*counts)[name] = histogram[provenance];
  }
}

}  // namespace

void WriteResult(const Workspace& workspace,
                 int image,
                 RefinedMaps maps,
                 ImageRecord record,
                 ImageReport* report) {
  ClearMaskedPixels(
      workspace.ReadMask(image, {maps.depth.Width(), maps.depth.Height()}),
      &maps);
  CountPixels(maps, &report->counts);
  if (report->prior.verdict != PriorVerdict::kNone) {
    report->counts[report->prior.IsDropped() ? kPriorsDropped : kPriorsUsed] =
        1;
  }
  record.note = Describe(report->prior);
  record.counts = report->counts;
  record.seconds = report->seconds;
  const Stopwatch writing;
  WriteBack write_back(workspace, image, std::move(record));
  write_back.PrepareFiles(maps);
  write_back.Commit();
  report->seconds["write"] = writing.Seconds();
  report->outcome = ImageReport::Outcome::kDone;
}

void KeepOriginals(const Workspace& workspace,
                   int image,
                   const std::string& reason,
                   const std::string& options_hash,
                   ImageReport* report) {
  report->outcome = ImageReport::Outcome::kKept;
  report->reason = reason;
  ImageRecord record;
  record.options_hash = options_hash;
  record.note = reason;
  record.counts = report->counts;
  KeepImage(workspace, image, std::move(record));
}

}  // namespace tsar
