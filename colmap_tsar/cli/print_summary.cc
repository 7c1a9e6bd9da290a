// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/cli/print_summary.h"

#include "colmap_tsar/base/printable.h"
#include "colmap_tsar/base/text_stream.h"
#include "colmap_tsar/fusion/fuse_workspace.h"
#include "colmap_tsar/run/store/restore.h"
#include "colmap_tsar/tools/import/import_workspace.h"
#include "colmap_tsar/tools/stereo/stereo_workspace.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <boost/algorithm/string/replace.hpp>

namespace tsar {
namespace {

constexpr size_t kMaxListed = 10;

std::string Fixed(double value, int num_digits) {
  return Formatted("%.*f", num_digits, value);
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

// The path as one word of a shell, quoted if necessary.
std::string Quoted(const std::filesystem::path& path) {
  const std::string text = Printable(path.string());
  constexpr const char* kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789%+,-./"
      ":=@_";
  if (text.find_first_not_of(kPlain) == std::string::npos) {
    return text;
  }
  // A quotation mark ends the quotation and is escaped by a backslash.
  return "'" + boost::replace_all_copy(text, "'", "'\\''") + "'";
}

// ", 3 WHAT" where there are any.
std::string More(int64_t count, const std::string& what) {
  return count > 0 ? ", " + std::to_string(count) + " " + what : "";
}

// Prints the first lines, and how many more there are.
template <typename List, typename LineOf>
void PrintFirst(const List& list,
                const LineOf& line_of,
                std::ostream& out,
                const std::string& where = "") {
  for (size_t i = 0; i < std::min(list.size(), kMaxListed); ++i) {
    out << "  " << Printable(line_of(list[i])) << "\n";
  }
  if (list.size() > kMaxListed) {
    out << "  and " << list.size() - kMaxListed << " more" << where << "\n";
  }
}

void PrintMasks(const std::optional<int64_t>& num_masks,
                int num_images,
                std::ostream& out) {
  if (num_masks) {
    out << "  masks for " << *num_masks << " of "
        << Counted(num_images, "image") << "\n";
  }
}

void PrintPeakMemory(const std::vector<RunSummary::GpuMemory>& peaks,
                     std::ostream& out) {
  for (const RunSummary::GpuMemory& peak : peaks) {
    out << "  " << peak.gpu << ": at most "
        << Fixed(static_cast<double>(peak.num_bytes) / 1e9, 2)
        << " GB of its memory held\n";
  }
}

void PrintMasksAndPriors(const RunSummary& summary, std::ostream& out) {
  PrintMasks(summary.num_masks, summary.num_images, out);
  if (const int64_t count = Count(summary, kMaskedAway); count > 0) {
    out << "  all depths masked: " << Counted(count, "image")
        << " (black in a mask is what is left out)\n";
  }
  if (const int64_t count = Count(summary, kBlackBorders); count > 0) {
    out << "  black borders without a mask: " << Counted(count, "image")
        << "; what lies outside of undistorted pictures gets depth unless it "
           "is black in masks, --mask_path\n";
  }
  if (summary.num_priors) {
    const int64_t num_dropped = Count(summary, kPriorsDropped);
    out << "  depth priors for " << *summary.num_priors << " of "
        << Counted(summary.num_images, "image")
        << More(num_dropped, "of them not used")
        << (num_dropped > 0 ? " (stereo/tsar/manifest.json says why)" : "")
        << "\n";
  }
}

void PrintImages(const RunSummary& summary, std::ostream& out) {
  const std::string images = Counted(summary.num_images, "image");
  const bool observes = summary.pass == RefinePass::kObserve;
  if (summary.pass == RefinePass::kModel) {
    out << images << ": the planes of the scene have been found\n";
    return;
  }
  if (observes || summary.pass == RefinePass::kCompose) {
    out << "Shard " << ToString(summary.shard) << ", ";
  }
  out << images << ": ";
  if (observes) {
    out << summary.num_observed << " observed, " << summary.num_skipped
        << " observed before or not to be observed\n";
  } else {
    out << summary.num_refined << " refined"
        << More(summary.num_skipped, "done before with the same options")
        << More(static_cast<int64_t>(summary.kept.size()), "kept as they were")
        << More(summary.num_not_listed, "not in the list") << "\n";
  }
  PrintMasksAndPriors(summary, out);
  if (observes) {
    return;
  }
  PrintFirst(
      summary.kept,
      [](const auto& image) {
        return "kept " + image.name + ": " + image.reason;
      },
      out,
      "; stereo/tsar/manifest.json lists all");
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
        std::pair("other_views", "from other views"),
        std::pair("guessed", "guessed"),
        std::pair("prior", "from depth priors")}) {
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
    out << ", " << Counted(summary.num_workers, "image") << " at a time";
  }
  out << "; stereo/tsar/manifest.json has that of each stage\n";
  PrintPeakMemory(summary.peak_gpu_memory, out);
}

// Prints how to go on with the refined maps.
void PrintFusion(const RunSummary& summary, std::ostream& out) {
  if (summary.model_folder != summary.workspace_path / "sparse") {
    out << "stereo_fusion looks for the sparse model in "
        << Quoted(summary.workspace_path / "sparse")
        << " itself: first copy there what is in "
        << Quoted(summary.model_folder) << "\n";
  }
  for (const std::string& obstacle : summary.fusion_obstacles) {
    out << "Before fusion: " << Printable(obstacle) << "\n";
  }
  out << "Next: colmap stereo_fusion --workspace_path "
      << Quoted(summary.workspace_path) << " --input_type "
      << ToString(summary.type) << " --output_path "
      << Quoted(summary.workspace_path / "fused.ply") << "\n";
}

}  // namespace

void PrintNext(const RunSummary& summary, std::ostream& out) {
  if (summary.pass == RefinePass::kObserve) {
    out << "Next, when all shards have been observed: --TsarRefine.pass "
           "model\n";
  } else if (summary.pass == RefinePass::kModel) {
    out << "Next, for each shard: --TsarRefine.pass compose\n";
  } else if (summary.pass == RefinePass::kCompose) {
    out << "Next, when all shards have been composed: --TsarRefine.pass "
           "merge\n";
  } else if (!summary.RefinedNone()) {
    PrintFusion(summary, out);
  }
  out << std::flush;
}

std::string Counted(int64_t count, const std::string& noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

void PrintSummary(const RunSummary& summary, std::ostream& out) {
  if (summary.pass == RefinePass::kAll && summary.num_refined == 0 &&
      summary.kept.empty()) {
    out << Counted(summary.num_images, "image") << ": nothing to do, "
        << summary.num_skipped << " done before with the same options"
        << More(summary.num_not_listed, "not in the list") << std::endl;
    return;
  }
  PrintImages(summary, out);
  if (summary.num_refined > 0) {
    PrintPixels(summary, out);
    if (summary.pass != RefinePass::kMerge) {
      PrintTimes(summary, out);
    }
  }
  out << std::flush;
}

void PrintSummary(const RestoreResult& result, std::ostream& out) {
  out << "Put the original maps of " << Counted(result.num_restored, "image")
      << " back.\n";
  for (const auto& [title, paths] :
       {std::pair("Left these maps as they are, which were written since; the "
                  "originals before them are now in stereo/tsar/superseded:",
                  &result.kept),
        std::pair("What had to make room is now here, and is never touched "
                  "again:",
                  &result.superseded),
        std::pair("Left these refined maps, whose originals are gone:",
                  &result.lost)}) {
    if (!paths->empty()) {
      out << title << "\n";
      PrintFirst(
          *paths, [](const auto& path) { return path.string(); }, out);
    }
  }
  out << std::flush;
}

void PrintSummary(const StereoSummary& summary, std::ostream& out) {
  out << summary.num_images << " images on " << summary.device
      << More(summary.num_skipped, "done before") << ": "
      << Fixed(summary.wall_seconds, 1) << " s\n";
  PrintMasks(summary.num_masks, summary.num_images, out);
  for (const RunSummary::KeptImage& image : summary.without_sources) {
    out << "  " << Printable(image.name) << " has no maps: " << image.reason
        << "\n";
  }
  PrintPeakMemory(summary.peak_gpu_memory, out);
}

void PrintNext(const StereoSummary& summary, std::ostream& out) {
  out << "Next: tsar_refine --workspace_path " << Quoted(summary.workspace_path)
      << ", or stereo_fusion with --input_type " << ToString(summary.type)
      << "\n";
}

void PrintSummary(const FuseSummary& summary,
                  const std::filesystem::path& cloud_path,
                  std::ostream& out) {
  out << "Fused " << Counted(summary.num_images, "image") << " into "
      << summary.num_points << " points: " << Printable(cloud_path.string())
      << "\n";
  PrintMasks(summary.num_masks, summary.num_images, out);
  out << "Time: " << Fixed(summary.seconds, 1) << " s on "
      << Printable(summary.devices) << "\n";
  PrintPeakMemory(summary.gpu_memory, out);
  if (summary.num_points == 0) {
    out << "No point was kept: see that the maps are geometric ones, the poses "
           "right, several images used and the bounding box around them, or "
           "lower --TsarFuse.min_num_views\n";
  }
  out << std::flush;
}

void PrintSummary(const ImportSummary& summary, std::ostream& out) {
  out << summary.num_images << " images: " << summary.num_imported
      << " imported, " << summary.num_images - summary.num_imported
      << " without a map\n";
  if (summary.num_without_image > 0) {
    out << summary.num_without_image
        << " maps are of images that are not in the workspace\n";
  }
  out << "Normals came with " << summary.num_with_normals
      << " of them, and are computed from depth otherwise\n";
  out << "Pixels with depth: "
      << Percent(summary.num_with_depth, summary.num_pixels);
  if (summary.num_kept < summary.num_with_depth) {
    out << "; " << Percent(summary.num_kept, summary.num_pixels)
        << " after the filter";
  }
  out << "\n";
  if (summary.scale.num_images > 0) {
    out << (summary.has_own_scales
                ? "Before scaling, depth over that of the sparse points: "
                  "median "
                : "Depth over that of the sparse points: median ")
        << Fixed(summary.scale.median, 3) << " ("
        << Fixed(summary.scale.smallest, 3) << " to "
        << Fixed(summary.scale.largest, 3) << " over "
        << summary.scale.num_images << " images)\n";
  }
  PrintFirst(
      summary.warnings,
      [](const std::string& warning) { return "WARNING: " + warning; },
      out);
  out << "Next: colmap_tsar tsar_refine --workspace_path "
      << Quoted(summary.output_path) << " --input_type "
      << ToString(summary.type) << "\n";
}

}  // namespace tsar
