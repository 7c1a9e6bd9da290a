// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/cli/stereo_command.h"

#include "colmap_tsar/cli/commands.h"
#include "colmap_tsar/cli/interruption.h"
#include "colmap_tsar/cli/print_summary.h"
#include "colmap_tsar/cli/shared_options.h"
#include "colmap_tsar/matching/patch_match.h"

#include <functional>
#include <iostream>

namespace tsar {
namespace {

constexpr const char* kSummary =
    "Makes the depth and normal maps of a dense workspace from its images, as "
    "patch_match_stereo does, on NVIDIA GPUs and also without any: photometric "
    "maps (all depths), geometric maps (those that other images confirm) and "
    "their matching costs. Run it after image_undistorter, and tsar_refine or "
    "stereo_fusion after it. It "
    "can be interrupted at any time: the same command goes on where it "
    "stopped.";

void AddRunOptions(StereoCommand* command, OptionSet* options) {
  options->AddRequired("workspace_path",
                       &command->workspace_path,
                       "The dense workspace, as image_undistorter makes it.");
  options->Add("image_list_path",
               &command->files.image_list_path,
               "A text file with one image name per line: make the maps of "
               "these alone, the same as among all. If empty, all.");
  AddMaskPath(&command->files.mask_path,
              "Where a mask is black (0), no depth is made.",
              options);
  options->Add("overwrite",
               &command->overwrite,
               "Replace maps that another program made (they are not kept), or "
               "that were made with other options or from other inputs.");
  AddDeviceOptions("TsarStereo.", &command->devices, options);
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
  options->Add(group + "geom_consistency",
               &stereo->geom_consistency,
               "Also make geometric maps, for which depths are improved with "
               "regard to those of the source images, and filtered.");
  const auto add = [&](const std::string& name,
                       OptionTarget target,
                       const std::string& description,
                       const OptionRange& range = {}) {
    options->Add(group + name, target, description, range).is_advanced = true;
  };
  add("num_sources",
      &stereo->num_sources,
      "Source images of each image at most: the first of those that "
      "stereo/patch-match.cfg gives.",
      {1, kMaxMatchedSources});
  add("window_radius",
      &stereo->window_radius,
      "Half the width of the matching window, in pixels.",
      {1, 50});
  add("num_iterations",
      &stereo->num_iterations,
      "Rounds of propagation and refinement in the photometric pass.",
      {1, 100});
  add("num_levels",
      &stereo->num_levels,
      "Sizes at which an image is matched, from the smallest to its own, each "
      "twice the one before; small sizes find surfaces of little texture.",
      {1, 10});
  add("num_geometric_passes",
      &stereo->num_geometric_passes,
      "Passes over all images by which depths are improved with regard to "
      "those of the source images.",
      {1, 20});
  add("smooth_normals",
      &stereo->smooth_normals,
      "Average the normals of the geometric maps with those of the same "
      "surface around them.");
  add("filter_min_ncc",
      &stereo->filter_min_ncc,
      "Smallest correlation with a source that confirms a depth.",
      {-1, 1});
  add("filter_min_triangulation_angle",
      &stereo->filter_min_triangulation_angle,
      "Smallest angle between the rays of an image and a source that confirms "
      "its depth, in degrees.",
      {0, 180});
  add("filter_min_num_consistent",
      &stereo->filter_min_num_consistent,
      "Sources that have to confirm a depth.",
      {0, 1e6});
  add("filter_geom_consistency_max_cost",
      &stereo->filter_geom_consistency_max_cost,
      "Largest distance, in pixels, between a pixel and where a source's depth "
      "leads back to.",
      {0, 1e6});
}

}  // namespace

void StereoCommand::AddTo(OptionSet* options) {
  AddRunOptions(this, options);
  AddStereoOptions(&stereo, options);
}

StereoSummary StereoCommand::Run(Progress& progress) const {
  return MatchWorkspace(
      workspace_path, devices, stereo, overwrite, progress, files);
}

int RunTsarStereo(int argc, char** argv) {
  StereoCommand command;
  OptionSet options(
      "tsar_stereo", kSummary, "tsar_stereo --workspace_path dense");
  command.AddTo(&options);
  if (!options.Parse(argc, argv)) {
    return 0;
  }
  const StereoSummary summary =
      RunInterruptibly(std::bind_front(&StereoCommand::Run, &command));
  PrintSummary(summary, std::cout);
  PrintNext(summary, std::cout);
  return 0;
}

}  // namespace tsar
