// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/cli/commands.h"
#include "colmap_tsar/cli/interruption.h"
#include "colmap_tsar/cli/option_set.h"
#include "colmap_tsar/cli/print_summary.h"
#include "colmap_tsar/cli/stereo_command.h"

#include <iostream>

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

}  // namespace

int RunTsarStereo(int argc, char** argv) {
  StereoCommand command;
  OptionSet options(
      "tsar_stereo", kSummary, "tsar_stereo --workspace_path dense");
  command.AddTo(&options);
  if (!options.Parse(argc, argv)) {
    return 0;
  }
  Progress progress(std::cerr, isatty(STDERR_FILENO) != 0);
  const Interruption interruption;
  PrintSummary(command.Run(progress, [&] { return interruption.Requested(); }),
               std::cout);
  return 0;
}

}  // namespace tsar
