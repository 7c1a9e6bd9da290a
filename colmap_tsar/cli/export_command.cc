// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/cli/export_command.h"

#include "colmap_tsar/base/printable.h"
#include "colmap_tsar/export/export_format.h"
#include "colmap_tsar/store/workspace.h"

#include <optional>

namespace tsar {
namespace {

std::optional<MapType> TypeOf(const std::string& name) {
  if (name.empty()) {
    return std::nullopt;
  }
  return name == ToString(MapType::kPhotometric) ? MapType::kPhotometric
                                                 : MapType::kGeometric;
}

}  // namespace

void ExportCommand::AddTo(OptionSet* set) {
  set->AddRequired("workspace_path", &workspace_path, "The dense workspace.");
  set->AddRequired("output_path",
                   &output_path,
                   "The folder to write. It must not be there, or be "
                   "empty, or hold an earlier export (--overwrite 1).");
  set->AddChoice(
      "format", &format, ExportFormatNames(), "What to write; must be given.");
  set->AddChoice(
      "input_type",
      &input_type,
      {ToString(MapType::kGeometric), ToString(MapType::kPhotometric)},
      "The maps to export. If not given: geometric, or photometric where only "
      "those were refined or are there.");
  set->Add("mask_path",
           &mask_path,
           "The folder with masks of the undistorted images, named as for "
           "COLMAP: a.jpg.png for a.jpg. Where a mask is black (0), no "
           "depth is exported; nerfstudio gets the masks as well.");
  set->Add("depth_scale",
           &options.depth_scale,
           "For png16: units of the sparse model per step of depth; 0.001 "
           "makes millimetres of metres. Depths of more than 65535 steps, "
           "and of less than half a step, are left out.",
           {1e-12, 1e12});
  set->Add("overwrite",
           &options.overwrite,
           "Replace an earlier export. A folder with anything else in it "
           "is never touched.");
  set->Add("num_threads",
           &options.num_threads,
           "Number of CPU threads; -1: one for each core. Fewer where the "
           "images are too large for the main memory.",
           {-1, 4096});
}

ExportSummary ExportCommand::Run(
    Progress& progress, const std::function<bool()>& should_stop) const {
  ExportOptions all = options;
  all.format = ParseExportFormat(format);
  all.output_path = output_path;
  all.mask_path = mask_path;
  const Workspace workspace =
      OpenWorkspaceToExport(workspace_path, TypeOf(input_type));
  return ExportWorkspace(workspace, all, progress, should_stop);
}

std::string ExportCommand::TrainingCommand() const {
  const std::string folder = ShellWord(output_path);
  switch (ParseExportFormat(format)) {
    case ExportFormat::kNerfstudio:
      return "ns-train depth-nerfacto --data " + folder;
    case ExportFormat::kGaussianSplatting:
      return "python train.py -s " + folder + " -d depths";
    default:
      return "";
  }
}

}  // namespace tsar
