// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/cli/fuse_command.h"

#include "colmap_tsar/cli/commands.h"
#include "colmap_tsar/cli/interruption.h"
#include "colmap_tsar/cli/print_summary.h"
#include "colmap_tsar/cli/shared_options.h"
#include "colmap_tsar/run/store/image_maps.h"

#include <functional>
#include <iostream>
#include <tuple>

namespace tsar {
namespace {

constexpr const char* kSummary =
    "Fuses the depth maps of a dense workspace into one point cloud, as "
    "stereo_fusion does, on NVIDIA GPUs and also without any. It knows what "
    "tsar_refine knows of each depth: how precise it is and how certain; "
    "points that other images see through are left out. "
    "Writes fused.ply, with normals and colors, and fused.ply.vis, the images "
    "that see each point, for poisson_mesher and delaunay_mesher.";

// A scan has no normals, and a mesh has faces.
bool IsPointCloud(const std::string& begin) {
  return begin.starts_with("ply") &&
         begin.find("property float nx") != std::string::npos &&
         begin.find("element face") == std::string::npos;
}

// It begins with the number of points.
bool IsVisibility(const std::string& begin) {
  constexpr size_t kNumBytes = 8;
  return begin.size() >= kNumBytes && begin.compare(5, 3, "\0\0\0", 3) == 0;
}

}  // namespace

void FuseCommand::AddTo(OptionSet* set) {
  set->AddRequired("workspace_path",
                   &workspace_path,
                   "The dense workspace, refined or not.");
  set->AddRequired("output_path",
                   &options.output_path,
                   "The PLY file to write; beside it, with .vis behind its "
                   "name, the images that see each point.");
  AddInputType(
      &input_type,
      "The maps to fuse. If not given: geometric, or photometric where "
      "only those were refined or are there.",
      set);
  set->Add("image_list_path",
           &options.image_list_path,
           "A text file with one image name per line: the pixels of these "
           "alone become points; all others are asked about them.");
  AddMaskPath(&options.mask_path,
              "Where a mask is black (0), depths count as missing.",
              set);
  set->Add("bounding_box_path",
           &bounding_box_path,
           "A text file with the smallest x, y and z of the points to keep, "
           "then the largest, as for stereo_fusion. If empty, all are kept.");
  set->Add("overwrite", &overwrite, "Replace a cloud that is there.");
  const std::string group = "TsarFuse.";
  set->Add(group + "preset",
           &preset,
           "default: depths weighted by precision and confidence; paper: "
           "the thresholds of the TSAR-MVS paper, three views and the "
           "mean of what agrees. The options below come on top.")
      .choices = FusionPresetNames();
  FusionOptions* const fusion = &options.fusion;
  set->Add(group + "min_num_views",
           &fusion->min_num_views,
           "Images that have to agree on a point, its own included.",
           {1, kMaxFusionSources + 1});
  set->Add(group + "max_reproj_error",
           &fusion->max_reproj_error,
           "How far a pixel may lie from where another image's depth leads "
           "back to, in pixels.",
           {0, 1e6});
  set->Add(group + "max_depth_error",
           &fusion->max_depth_error,
           "How far depths may differ, as a share of the depth.",
           {0, 0.25});
  set->Add(group + "max_normal_error",
           &fusion->max_normal_error,
           "How far normals may differ, in degrees.",
           {0, 90});
  set->Add(group + "check_num_images",
           &fusion->check_num_images,
           "Other images that are asked about the points of an image: those "
           "that share most sparse points with it, then its sources.",
           {1, kMaxFusionSources});
  set->Add(group + "point_spacing",
           &fusion->point_spacing,
           "Of each square of so many pixels of an image, the one in the "
           "middle becomes a point; 1 gives the densest cloud.",
           {1, kMaxPointSpacing});
  AddDeviceOptions(group, &options.devices, set);
}

void FuseCommand::UsePreset() { options.fusion = PresetFusionOptions(preset); }

FuseSummary FuseCommand::Run(Progress& progress) const {
  FuseWorkspaceOptions parsed = options;
  parsed.devices.Check();
  if (!bounding_box_path.empty()) {
    parsed.bounding_box = ReadBoundingBox(bounding_box_path);
  }
  CheckOutput();
  return FuseWorkspace(
      OpenWorkspaceWithMaps(workspace_path, input_type), parsed, progress);
}

void FuseCommand::CheckOutput() const {
  std::filesystem::path visibility_path = options.output_path;
  visibility_path += ".vis";
  for (const auto& [path, kind, is_of_kind] :
       {std::tuple(options.output_path, "point cloud", &IsPointCloud),
        std::tuple(
            visibility_path, "list of a cloud's images", &IsVisibility)}) {
    RequireWritableOutput(workspace_path, path, kind, is_of_kind, overwrite);
  }
}

int RunTsarFuse(int argc, char** argv) {
  FuseCommand command;
  OptionSet options("tsar_fuse",
                    kSummary,
                    "tsar_fuse --workspace_path dense --output_path "
                    "dense/fused.ply");
  command.AddTo(&options);
  if (!options.Parse(argc, argv)) {
    return 0;
  }
  command.UsePreset();
  options.Parse(argc, argv);
  PrintSummary(RunInterruptibly(std::bind_front(&FuseCommand::Run, &command)),
               command.options.output_path,
               std::cout);
  return 0;
}

}  // namespace tsar
