// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/printable.h"
#include "colmap_tsar/cli/commands.h"
#include "colmap_tsar/cli/device_arguments.h"
#include "colmap_tsar/cli/interruption.h"
#include "colmap_tsar/cli/option_set.h"
#include "colmap_tsar/cli/print_summary.h"
#include "colmap_tsar/stereo/stereo_workspace.h"

#include <cstdio>
#include <iostream>
#include <string>

#include <unistd.h>

namespace tsar {
namespace {

constexpr const char* kSummary =
    "Makes the depth and normal maps of a dense workspace from its images, as "
    "patch_match_stereo does, on NVIDIA GPUs and also without any. It needs "
    "the undistorted images and the sparse model, and writes photometric maps "
    "(all depths), geometric maps (those that other images confirm, and "
    "between "
    "them what a planar prior fills) and their matching costs. Run it after "
    "image_undistorter, and tsar_refine or "
    "stereo_fusion after it. It can be interrupted at any time: the same "
    "command goes on where it stopped.";

struct StereoCommand {
  std::string workspace_path;
  std::string workspace_format = "COLMAP";
  bool overwrite = false;
  DeviceArguments devices;
  StereoOptions stereo;
};

void AddRunOptions(StereoCommand* command, OptionSet* options) {
  options->AddRequired("workspace_path",
                       &command->workspace_path,
                       "The dense workspace, as image_undistorter makes it.");
  options->AddChoice("workspace_format",
                     &command->workspace_format,
                     {"COLMAP"},
                     "The layout of the workspace.");
  options->Add("overwrite",
               &command->overwrite,
               "Replace maps that another program made, or that were made with "
               "other options or from images that have changed since.");
  AddDeviceArguments("TsarStereo.", &command->devices, options);
  options->Add("TsarStereo.num_threads",
               &command->devices.num_threads,
               "Number of CPU threads; -1: one for each core.",
               {-1, 4096});
}

void AddStereoOptions(StereoOptions* stereo, OptionSet* options) {
  const std::string group = "TsarStereo.";
  options->Add(group + "max_image_size",
               &stereo->max_image_size,
               "Longer side of the maps, in pixels; larger images are reduced. "
               "-1: the size of the images.",
               {-1, 1e6});
  options->Add(group + "depth_min",
               &stereo->depth_min,
               "Smallest depth to look for, in units of the model; -1: from "
               "the sparse points of each image.",
               {-1, 1e30});
  options->Add(group + "depth_max",
               &stereo->depth_max,
               "Largest depth to look for; -1: from the sparse points.",
               {-1, 1e30});
  options->Add(group + "num_sources",
               &stereo->num_sources,
               "Source images of each image at most: the first of those that "
               "stereo/patch-match.cfg gives.",
               {1, 1e6});
  options->Add(group + "window_radius",
               &stereo->window_radius,
               "Half the width of the matching window, in pixels.",
               {1, 50});
  options->Add(group + "num_iterations",
               &stereo->num_iterations,
               "Rounds of propagation and refinement in the photometric pass.",
               {1, 100});
  options->Add(group + "num_levels",
               &stereo->num_levels,
               "Sizes at which an image is matched, from the smallest to its "
               "own, each twice as large as the one before; small sizes find "
               "surfaces of little texture.",
               {1, 10});
  options->Add(group + "geom_consistency",
               &stereo->geom_consistency,
               "Also make geometric maps, for which depths are improved with "
               "regard to those of the source images, and filtered.");
  options->Add(group + "num_geometric_passes",
               &stereo->num_geometric_passes,
               "Passes over all images by which depths are improved so.",
               {1, 20});
  options->Add(group + "planar_prior",
               &stereo->planar_prior,
               "Fill pixels without a depth, in one more pass after the "
               "geometric ones that expects surfaces between reliable depths "
               "to be flat: for maps that are fused as they are. Measured "
               "depths stay as they are. The costs of filled ones are 2, no "
               "evidence: tsar_refine, which knows more about planes, takes "
               "them for missing. Has no effect without geom_consistency.");
  options->Add(group + "smooth_normals",
               &stereo->smooth_normals,
               "Average the normals of the geometric maps with those of the "
               "same surface around them.");
  options->Add(group + "filter_min_ncc",
               &stereo->filter_min_ncc,
               "Smallest correlation with a source that confirms a depth.",
               {-1, 1});
  options->Add(group + "filter_min_triangulation_angle",
               &stereo->filter_min_triangulation_angle,
               "Smallest angle between the rays of an image and a source that "
               "confirms its depth, in degrees.",
               {0, 180});
  options->Add(group + "filter_min_num_consistent",
               &stereo->filter_min_num_consistent,
               "Sources that have to confirm a depth.",
               {0, 1e6});
  options->Add(group + "filter_geom_consistency_max_cost",
               &stereo->filter_geom_consistency_max_cost,
               "Largest distance, in pixels, between a pixel and where a "
               "source's depth leads back to.",
               {0, 1e6});
}

void Print(const StereoSummary& summary, const StereoOptions& options) {
  std::cout << summary.num_images << " images on " << summary.device;
  if (summary.num_skipped > 0) {
    std::cout << ", " << summary.num_skipped << " done before";
  }
  char seconds[32];
  std::snprintf(seconds, sizeof(seconds), "%.1f", summary.wall_seconds);
  std::cout << ": " << seconds << " s\n";
  for (const std::string& name : summary.without_sources) {
    std::cout << "  " << Printable(name)
              << " has no maps: no other image shares enough of its sparse "
                 "points\n";
  }
  PrintPeakMemory(summary.peak_gpu_memory, std::cout);
  std::cout << "Next: tsar_refine --workspace_path "
            << ShellWord(Printable(summary.workspace_path.string()))
            << ", or stereo_fusion with --input_type "
            << (options.geom_consistency ? "geometric" : "photometric") << "\n";
}

}  // namespace

int RunTsarStereo(int argc, char** argv) {
  StereoCommand command;
  OptionSet options(
      "tsar_stereo", kSummary, "tsar_stereo --workspace_path dense");
  AddRunOptions(&command, &options);
  AddStereoOptions(&command.stereo, &options);
  if (!options.Parse(argc, argv)) {
    return 0;
  }
  Progress progress(std::cerr, isatty(STDERR_FILENO) != 0);
  const Interruption interruption;
  Print(MatchWorkspace(command.workspace_path,
                       command.devices.Parse(),
                       command.stereo,
                       command.overwrite,
                       progress,
                       [&] { return interruption.Requested(); }),
        command.stereo);
  return 0;
}

}  // namespace tsar
