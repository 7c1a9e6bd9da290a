// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/fusion/fusion_options.h"
#include "colmap_tsar/run/device_options.h"
#include "colmap_tsar/run/run_summary.h"
#include "colmap_tsar/run/store/workspace.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

namespace tsar {

struct FuseWorkspaceOptions {
  FusionOptions fusion;
  DeviceOptions devices;
  // The PLY file; the visibility of its points is written beside it.
  std::filesystem::path output_path;
  // A file of image names, see io/image_lists.h: only their pixels become
  // points, and all images serve as sources. Empty: all images.
  std::filesystem::path image_list_path;
  // See io/image_masks.h; empty: none.
  std::filesystem::path mask_path;
  // A box in the world frame; points outside of it are left out.
  std::optional<Eigen::AlignedBox3d> bounding_box;
};

struct FuseSummary {
  int num_images = 0;
  std::optional<int64_t> num_masks;  // See RunSummary.
  int64_t num_points = 0;
  double seconds = 0.0;
  std::string devices;  // "2 CPU threads", or the GPUs' names.
  std::vector<RunSummary::GpuMemory> gpu_memory;
};

// Reads the corners of a box in COLMAP's bounding_box_path: the smallest x, y
// and z, then the largest. Throws Error: kNotFound, kIo, kCorrupt.
Eigen::AlignedBox3d ReadBoundingBox(const std::filesystem::path& path);

// Fuses the maps of a dense workspace, refined or not, into one cloud; see
// FuseView and FusedCloudWriter. The same inputs and options give the same
// bytes, whatever the devices, threads and memory.
//
// Like COLMAP, leaves out images that stereo/fusion.cfg does not list, if that
// file exists. For memory see FuseImages.
//
// Throws Error: kNotFound (no image has maps), kInterrupted where the user
// asked to stop, and what Workspace::UseMasks, ReadImageList, WorkspaceLock
// (shared), FusionOptions::Check, FuseImages and FusedCloudWriter throw.
FuseSummary FuseWorkspace(Workspace workspace,
                          const FuseWorkspaceOptions& options,
                          Progress& progress);

}  // namespace tsar
