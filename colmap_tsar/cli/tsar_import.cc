// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/cli/commands.h"
#include "colmap_tsar/cli/option_set.h"
#include "colmap_tsar/cli/print_summary.h"
#include "colmap_tsar/cli/restore_options.h"
#include "colmap_tsar/import/import_workspace.h"
#include "colmap_tsar/import/undo_import.h"
#include "colmap_tsar/store/workspace_lock.h"

#include <iostream>
#include <string>

#include <unistd.h>

namespace tsar {
namespace {

constexpr const char* kSummary =
    "Brings depth and normal maps of other programs and sensors into a dense "
    "workspace, so that tsar_refine and stereo_fusion can use them: maps of "
    "ACMH, ACMM, ACMP, ACMMP and Gipuma (acm), of APD (apd), of OpenMVS "
    "(openmvs), and depth images of any origin (depth). The workspace needs "
    "images/ and a sparse model in sparse/; the maps must have been made from "
    "both. Everything is checked before the first file is written. Maps that "
    "were there are kept in stereo/tsar_import, and --restore 1 puts them "
    "back.";

struct ImportCommand {
  std::string workspace_path;
  std::string input_path;
  std::string format;
  std::string normal_path;
  std::string output_type = ToString(MapType::kGeometric);
  std::string index_order = "image_id";
  std::string image_list;
  std::string normal_frame = "auto";
  bool restore = false;
  std::string restore_conflicts = "report";
  ImportOptions import;
};

void AddInputOptions(ImportCommand* command, OptionSet* options) {
  options->AddRequired("workspace_path",
                       &command->workspace_path,
                       "The dense workspace to import into.");
  options->Add("input_path",
               &command->input_path,
               "The folder with the other program's maps; for acm and apd also "
               "the one above it, which holds cams/.");
  options->AddChoice("format",
                     &command->format,
                     {"acm", "apd", "openmvs", "depth"},
                     "Whose maps they are; depth: PNG of 16 bits, EXR, TIFF, "
                     "PFM or NPY, called as the images are.");
  options->Add("normal_path",
               &command->normal_path,
               "For depth: a folder with normal maps (EXR, TIFF, PFM or NPY of "
               "three channels, x right, y down, z forward). If empty, normals "
               "are computed from depth.");
  options->AddChoice(
      "output_type",
      &command->output_type,
      {ToString(MapType::kGeometric), ToString(MapType::kPhotometric)},
      "The type of maps to write; for acm also which of its depth maps is "
      "taken.");
  options->AddChoice("index_order",
                     &command->index_order,
                     {"image_id", "name"},
                     "Which images acm's and apd's numbers mean: ordered by "
                     "COLMAP's image id, as colmap2mvsnet does, or by name.");
  options->Add("image_list",
               &command->image_list,
               "A file with one image name per line, for the numbers 0, 1, 2, "
               "... in the names of the maps. For openmvs and depth, numbers "
               "count instead of names then.");
}

void AddConversionOptions(ImportCommand* command, OptionSet* options) {
  options->Add("depth_scale",
               &command->import.depth_scale,
               "Units of the sparse model per stored unit of depth. 0: 0.001 "
               "for depth images of integers (millimetres), otherwise 1.",
               {0.0, 1e12});
  options->Add("scale_to_sparse",
               &command->import.scale_to_sparse,
               "Give the depths of each image a scale of their own, by the "
               "sparse points that it sees, as depth from one image needs.");
  options->Add("check_scale",
               &command->import.check_scale,
               "Refuse depths that are off those of the sparse points by over "
               "20 % in all images alike.");
  options->AddChoice("normal_frame",
                     &command->normal_frame,
                     {"auto", "world", "camera"},
                     "The frame of the other program's normals; auto: world "
                     "for acm and apd, camera for the others.");
  options->Add("import_costs",
               &command->import.import_costs,
               "Take acm's costs over instead of letting tsar_refine compute "
               "its own. They are noise where the image has no texture.");
  options->Add("overwrite",
               &command->import.overwrite,
               "Replace maps of this type that another program wrote. They are "
               "kept for --restore 1.");
  options->Add("restore",
               &command->restore,
               "Undo all imports: put the former maps back, remove what was "
               "imported, and do nothing else. What others wrote in its place "
               "since is never removed.");
  AddRestoreConflicts(&command->restore_conflicts, options);
}

int UndoImports(const ImportCommand& command) {
  if (!command.input_path.empty() || !command.format.empty()) {
    throw Error(
        ErrorCode::kBadOption,
        "--restore undoes imports; leave --input_path and --format out");
  }
  const WorkspaceLock lock(command.workspace_path);
  const UndoResult result = UndoImport(
      command.workspace_path, ParseRestoreConflicts(command.restore_conflicts));
  std::cout << "Undid the import of " << result.num_images
            << (result.num_images == 1 ? " image" : " images") << ".\n";
  ReportRestored(result.kept, result.superseded, result.conflicts);
  return 0;
}

ExternalFormat ToFormat(const std::string& text) {
  return text == "acm"       ? ExternalFormat::kAcm
         : text == "apd"     ? ExternalFormat::kApd
         : text == "openmvs" ? ExternalFormat::kOpenMvs
                             : ExternalFormat::kDepth;
}

void RequireGiven(const std::string& name, const std::string& value) {
  if (value.empty()) {
    throw Error(
        ErrorCode::kBadOption,
        "--" + name + " is missing; give it, or see tsar_import --help");
  }
}

}  // namespace

int RunTsarImport(int argc, char** argv) {
  ImportCommand command;
  OptionSet options("tsar_import",
                    kSummary,
                    "tsar_import --format acm --input_path scene "
                    "--workspace_path dense");
  AddInputOptions(&command, &options);
  AddConversionOptions(&command, &options);
  if (!options.Parse(argc, argv)) {
    return 0;
  }
  if (command.restore) {
    return UndoImports(command);
  }
  RequireGiven("format", command.format);
  RequireGiven("input_path", command.input_path);
  if (!command.normal_path.empty() && command.format != "depth") {
    throw Error(ErrorCode::kBadOption,
                "--normal_path is for --format depth; the other formats have "
                "their normals beside their depth");
  }
  ImportOptions& import = command.import;
  import.workspace_path = command.workspace_path;
  import.match.format = ToFormat(command.format);
  import.match.input_path = command.input_path;
  import.match.normal_path = command.normal_path;
  import.match.type = command.output_type == ToString(MapType::kGeometric)
                          ? MapType::kGeometric
                          : MapType::kPhotometric;
  import.match.index_order =
      command.index_order == "name" ? IndexOrder::kName : IndexOrder::kImageId;
  import.match.image_list = command.image_list;
  import.normal_frame = command.normal_frame == "world" ? NormalFrame::kWorld
                        : command.normal_frame == "camera"
                            ? NormalFrame::kCamera
                            : NormalFrame::kAuto;
  Progress progress(std::cerr, isatty(STDERR_FILENO) != 0);
  PrintSummary(ImportWorkspace(import, progress), std::cout);
  return 0;
}

}  // namespace tsar
