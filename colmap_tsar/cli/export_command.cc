// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/cli/export_command.h"

#include "colmap_tsar/base/printable.h"
#include "colmap_tsar/cli/commands.h"
#include "colmap_tsar/cli/interruption.h"
#include "colmap_tsar/cli/print_summary.h"
#include "colmap_tsar/cli/shared_options.h"
#include "colmap_tsar/run/store/image_maps.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/tools/export/export_format.h"

#include <functional>
#include <iostream>
#include <optional>

namespace tsar {
namespace {

constexpr const char* kSummary =
    "Exports the maps of a dense workspace, refined or not, for other "
    "programs: "
    "depth, normals and, where tsar_refine wrote them, confidence, sigma, "
    "provenance and planes as arrays of NumPy (npy), as OpenEXR (exr) or in 16 "
    "bits (png16); or depth with the images and cameras as a folder to train "
    "on, for nerfstudio (transforms.json, with normals) or for the trainer of "
    "3D Gaussian splatting (3dgs: inverse depth, depth_params.json). "
    "manifest.json tells "
    "the camera and the pose of each map, and what its values mean. Depth is z "
    "in the camera's frame, in units of the sparse model; 0 is no depth.";

void PrintSummary(const ExportSummary& summary, const ExportCommand& command) {
  std::cout << "Exported " << Counted(summary.num_images, "image") << " to "
            << Printable(command.options.output_path.string())
            << "\n  with depth: " << Counted(summary.num_with_depth, "image")
            << ", "
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

void ExportCommand::AddTo(OptionSet* set) {
  set->AddRequired("workspace_path", &workspace_path, "The dense workspace.");
  set->AddRequired("output_path",
                   &options.output_path,
                   "The folder to write. It must not be there, or be "
                   "empty, or hold an earlier export (--overwrite 1).");
  set->AddChoice(
      "format", &format, ExportFormatNames(), "What to write; must be given.");
  AddMapType(
      "input_type",
      &input_type,
      "The maps to export. If not given: geometric, or photometric where only "
      "those were refined or are there.",
      set);
  AddMaskPath(&options.mask_path,
              "Where a mask is black (0), no depth is exported; nerfstudio "
              "gets the masks as well.",
              set);
  set->Add("cloud_path",
           &options.cloud_path,
           "For nerfstudio: a cloud of tsar_fuse or stereo_fusion (PLY), which "
           "becomes ply_file_path, the points that its methods start from.");
  set->Add("depth_scale",
           &options.depth_scale,
           "For png16: units of the sparse model per step of depth; 0.001 "
           "makes millimeters of meters. Depths of more than 65535 steps, "
           "and of less than half a step, are left out.",
           {1e-12, 1e12});
  set->Add("overwrite",
           &options.overwrite,
           "Replace an earlier export. A folder with anything else in it "
           "is never touched.");
  AddNumThreads("num_threads",
                &options.num_threads,
                set,
                " Fewer where the images are too large for the main memory.");
}

ExportSummary ExportCommand::Run(
    Progress& progress, const std::function<bool()>& should_stop) const {
  ExportOptions parsed = options;
  parsed.format = ParseExportFormat(format);
  const Workspace workspace =
      OpenWorkspaceWithMaps(workspace_path, ParseMapType(input_type));
  return ExportWorkspace(workspace, parsed, progress, should_stop);
}

std::string ExportCommand::TrainingCommand() const {
  const std::string folder = ShellWord(options.output_path.string());
  switch (ParseExportFormat(format)) {
    case ExportFormat::kNerfstudio:
      return "ns-train depth-nerfacto --data " + folder;
    case ExportFormat::kGaussianSplatting:
      return "python train.py -s " + folder + " -d depths";
    default:
      return "";
  }
}

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
  PrintSummary(RunInterruptibly(std::bind_front(&ExportCommand::Run, &command)),
               command);
  return 0;
}

}  // namespace tsar
