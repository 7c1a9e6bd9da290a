// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/printable.h"
#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/cli/commands.h"
#include "colmap_tsar/cli/export_command.h"
#include "colmap_tsar/cli/interruption.h"
#include "colmap_tsar/cli/option_set.h"
#include "colmap_tsar/cli/print_summary.h"

#include <iostream>
#include <string>

#include <unistd.h>

namespace tsar {
namespace {

constexpr const char* kSummary =
    "Exports the maps of a dense workspace, refined or not, for other "
    "programs: "
    "depth, normals and, where tsar_refine wrote them, confidence, sigma, "
    "provenance and planes as arrays of NumPy (npy), as OpenEXR (exr) or in 16 "
    "bits (png16); or depth with the images and cameras as a folder to train "
    "on, for nerfstudio (transforms.json) or for the trainer of 3D Gaussian "
    "splatting (3dgs: inverse depth, depth_params.json). manifest.json tells "
    "the camera and the pose of each map, and what its values mean. Depth is z "
    "in the camera's frame, in units of the sparse model; 0 is no depth.";

void PrintSummary(const ExportSummary& summary, const ExportCommand& command) {
  std::cout << "Exported " << summary.num_images
            << (summary.num_images == 1 ? " image" : " images") << " to "
            << Printable(command.output_path)
            << "\n  with depth: " << summary.num_with_depth
            << (summary.num_with_depth == 1 ? " image, " : " images, ")
            << 100.0 * static_cast<double>(summary.num_depths) /
                   static_cast<double>(summary.num_pixels)
            << " % of all pixels\n";
  PrintMasks(summary.num_masks, summary.num_images, std::cout);
  if (const std::string training = command.TrainingCommand();
      !training.empty()) {
    std::cout << "Train with: " << Printable(training) << "\n";
  }
  std::cout << std::flush;
}

}  // namespace

int RunTsarExport(int argc, char** argv) {
  ExportCommand command;
  OptionSet options("tsar_export",
                    kSummary,
                    "tsar_export --workspace_path dense --format npy "
                    "--output_path exported");
  command.AddTo(&options);
  if (!options.Parse(argc, argv)) {
    return 0;
  }
  Progress progress(std::cerr, isatty(STDERR_FILENO) != 0);
  const Interruption interruption;
  const ExportSummary summary =
      command.Run(progress, [&] { return interruption.Requested(); });
  PrintSummary(summary, command);
  return 0;
}

}  // namespace tsar
