// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/cli/print_summary.h"

#include "colmap_tsar/base/printable.h"

#include <algorithm>
#include <cstdio>
#include <utility>

namespace tsar {
namespace {

constexpr size_t kMaxKeptListed = 10;

std::string Fixed(double value, int num_digits) {
  char text[64];
  std::snprintf(text, sizeof(text), "%.*f", num_digits, value);
  return text;
}

std::string Percent(int64_t count, int64_t total) {
  return Fixed(100.0 * static_cast<double>(count) /
                   static_cast<double>(std::max<int64_t>(total, 1)),
               1) +
         " %";
}

int64_t Count(const RunSummary& summary, const std::string& name) {
  const auto found = summary.counts.find(name);
  return found == summary.counts.end() ? 0 : found->second;
}

std::string Quoted(const std::filesystem::path& path) {
  return ShellWord(Printable(path.string()));
}

std::string Images(int64_t count) {
  return std::to_string(count) + (count == 1 ? " image" : " images");
}

void PrintImages(const RunSummary& summary, std::ostream& out) {
  if (summary.pass == RefinePass::kObserve) {
    out << "Shard " << ToString(summary.shard) << ", "
        << Images(summary.num_images) << ": " << summary.num_observed
        << " observed, " << summary.num_skipped
        << " observed before or not to be observed\n";
    return;
  }
  if (summary.pass == RefinePass::kCompose) {
    out << "Shard " << ToString(summary.shard) << ", ";
  }
  out << Images(summary.num_images) << ": " << summary.num_refined
      << " refined";
  if (summary.num_skipped > 0) {
    out << ", " << summary.num_skipped << " done before with the same options";
  }
  if (!summary.kept.empty()) {
    out << ", " << summary.kept.size() << " kept as they were";
  }
  out << "\n";
  for (size_t i = 0; i < std::min(summary.kept.size(), kMaxKeptListed); ++i) {
    out << "  kept "
        << Printable(summary.kept[i].name + ": " + summary.kept[i].reason)
        << "\n";
  }
  if (summary.kept.size() > kMaxKeptListed) {
    out << "  and " << summary.kept.size() - kMaxKeptListed
        << " more; stereo/tsar/manifest.json lists all\n";
  }
  if (summary.num_sources_without_maps > 0) {
    out << "  source images left out because they have no maps: "
        << summary.num_sources_without_maps << "\n";
  }
}

void PrintPixels(const RunSummary& summary, std::ostream& out) {
  const int64_t num_pixels = Count(summary, "pixels");
  out << "Pixels with depth: "
      << Percent(Count(summary, "depth_before"), num_pixels) << " before, "
      << Percent(Count(summary, "depth_after"), num_pixels) << " after\n";
  for (const auto& [name, label] :
       {std::pair("measured", "measured"),
        std::pair("superpixel_plane", "from planes of superpixels"),
        std::pair("region_plane", "from planes of regions"),
        std::pair("interpolated", "interpolated"),
        std::pair("other_views", "from other views")}) {
    if (Count(summary, name) > 0) {
      out << "  " << Percent(Count(summary, name), num_pixels) << " " << label
          << "\n";
    }
  }
  if (Count(summary, "not_finite") > 0) {
    out << "  " << Count(summary, "not_finite")
        << " values that were not finite were taken as missing\n";
  }
}

void PrintTimes(const RunSummary& summary, std::ostream& out) {
  out << "Time: " << Fixed(summary.wall_seconds, 1) << " s on "
      << Printable(summary.device);
  if (summary.num_workers > 1) {
    out << ", " << Images(summary.num_workers) << " at a time";
  }
  if (summary.wall_seconds > 0.0) {
    out << "; " << Fixed(summary.num_refined / summary.wall_seconds, 2)
        << " images per second";
  }
  out << "\n";
  std::vector<std::pair<double, std::string>> stages;
  for (const auto& [stage, seconds] : summary.seconds) {
    stages.emplace_back(-seconds, stage);
  }
  std::sort(stages.begin(), stages.end());
  out << "  seconds per image:";
  const char* separator = " ";
  for (const auto& [negative_seconds, stage] : stages) {
    out << separator << Printable(stage) << " "
        << Fixed(-negative_seconds / summary.num_refined, 3);
    separator = ", ";
  }
  out << "\n";
  for (const RunSummary::GpuMemory& peak : summary.peak_gpu_memory) {
    out << "  " << peak.gpu << ": at most "
        << Fixed(static_cast<double>(peak.num_bytes) / 1e9, 2)
        << " GB of its memory held\n";
  }
}

}  // namespace

void PrintSummary(const RunSummary& summary, std::ostream& out) {
  PrintImages(summary, out);
  if (summary.num_refined > 0) {
    PrintPixels(summary, out);
  }
  if (summary.num_refined > 0 && summary.pass != RefinePass::kMerge) {
    PrintTimes(summary, out);
  }
  if (summary.pass == RefinePass::kObserve ||
      summary.pass == RefinePass::kCompose) {
    const bool has_observed = summary.pass == RefinePass::kObserve;
    out << "Next, when all shards have been "
        << (has_observed ? "observed: --TsarRefine.pass compose"
                         : "composed: --TsarRefine.pass merge")
        << std::endl;
    return;
  }
  out << "Next: colmap stereo_fusion --workspace_path "
      << Quoted(summary.workspace_path) << " --input_type "
      << ToString(summary.type) << " --output_path "
      << Quoted(summary.workspace_path / "fused.ply") << std::endl;
}

}  // namespace tsar
