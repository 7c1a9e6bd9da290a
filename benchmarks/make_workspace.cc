// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

// Draws a dense workspace of any size to measure speed on:
//
//   tsar_make_workspace --workspace_path /dev/shm/room --num_images 12

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/cli/commands.h"
#include "colmap_tsar/cli/option_set.h"

#include <filesystem>
#include <iostream>
#include <string>

#include "benchmarks/scene/room_workspace.h"

namespace tsar {
namespace {

int Main(int argc, char** argv) {
  std::filesystem::path workspace_path;
  int seed = 1;
  int num_threads = -1;
  RoomWorkspaceOptions scene;
  OptionSet options("tsar_make_workspace",
                    "Renders a furnished room as a dense workspace of COLMAP, "
                    "with ground truth and with depth and normal maps that "
                    "have the faults of patch_match_stereo's.",
                    "tsar_make_workspace --workspace_path /dev/shm/room");
  options.AddRequired("workspace_path",
                      &workspace_path,
                      "The folder to make; it must not exist or be empty.");
  options.Add("width", &scene.width, "Of images and maps.", {16, 100000});
  options.Add("height", &scene.height, "Of images and maps.", {16, 100000});
  options.Add(
      "num_images", &scene.num_images, "Views of the room.", {3, 99999});
  options.Add("num_sources",
              &scene.num_sources,
              "Source images of each image: the nearest cameras.",
              {1, 99999});
  options.Add("seed", &seed, "Another seed, another texture.", {0, 1000000});
  options.Add("num_threads",
              &num_threads,
              "Number of CPU threads; -1: one for each core.",
              {-1, 4096});
  if (!options.Parse(argc, argv)) {
    return 0;
  }
  scene.seed = static_cast<uint32_t>(seed);
  std::error_code error;
  if (std::filesystem::exists(workspace_path, error) &&
      !std::filesystem::is_empty(workspace_path, error)) {
    throw Error(ErrorCode::kBadOption,
                "--workspace_path: " + workspace_path.string() +
                    " is there already; remove it or give another folder");
  }
  ThreadPool threads(num_threads);
  Progress progress(std::cerr, false);
  progress.Start(scene.num_images);
  WriteRoomWorkspace(
      workspace_path, scene, threads, [&] { progress.Advance(true); });
  progress.Finish();
  return 0;
}

}  // namespace
}  // namespace tsar

int main(int argc, char** argv) {
  return tsar::RunCommand(&tsar::Main, argc, argv);
}
