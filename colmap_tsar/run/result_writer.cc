// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/result_writer.h"

#include "colmap_tsar/base/stopwatch.h"
#include "colmap_tsar/run/store/write_back.h"
#include "colmap_tsar/view/refine_option_list.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
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

void ClearMasked(const Image<uint8_t>& mask, RefinedMaps* maps) {
  ClearMasked(mask, &maps->depth);
  ClearMasked(mask, &maps->normal);
  ClearMasked(mask, &maps->confidence);
  ClearMasked(mask, &maps->provenance);
  ClearMasked(mask, &maps->planes);
  ClearMasked(mask, &maps->sigma);
}

}  // namespace

ResultWriter::ResultWriter(const RefineRun& run)
    : run_(run),
      options_hash_(HashRefineOptions(run.refine_options)),
      planes_(run.HasScenePlanes() ? run.model.PlanesFingerprint() : "") {}

void ResultWriter::Write(int image, RefinedMaps maps, ImageReport* report) {
  ClearMasked(
      run_.workspace.ReadMask(image, {maps.depth.Width(), maps.depth.Height()}),
      &maps);
  CountPixels(maps, &report->counts);
  if (report->prior.verdict != PriorVerdict::kNone) {
    report->counts[report->prior.IsDropped() ? kPriorsDropped : kPriorsUsed] =
        1;
  }
  ImageRecord record;
  record.note = Describe(report->prior);
  record.options_hash = options_hash_;
  record.inputs = run_.inputs.OfRun();
  record.planes = planes_;
  record.counts = report->counts;
  record.seconds = report->seconds;
  const Stopwatch writing;
  WriteBack write_back(run_.workspace, image, std::move(record));
  write_back.PrepareFiles(maps);
  {
    const std::unique_lock<std::mutex> lock = run_.loader.Lock(image);
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
  const std::unique_lock<std::mutex> lock = run_.loader.Lock(image);
  KeepImage(run_.workspace, image, std::move(record));
}

}  // namespace tsar
