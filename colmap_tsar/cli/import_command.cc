// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/cli/import_command.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/cli/commands.h"
#include "colmap_tsar/cli/interruption.h"
#include "colmap_tsar/cli/print_summary.h"
#include "colmap_tsar/cli/shared_options.h"
#include "colmap_tsar/run/store/workspace_lock.h"
#include "colmap_tsar/tools/import/undo_import.h"

#include <iostream>

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
  AddMapType(
      "output_type",
      &command->output_type,
      "The type of maps to write; for acm also which of its depth maps is "
      "taken.",
      options);
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
               "for depth images of integers (millimeters), otherwise 1.",
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

ExternalFormat ToFormat(const std::string& text) {
  return text == "acm"       ? ExternalFormat::kAcm
         : text == "apd"     ? ExternalFormat::kApd
         : text == "openmvs" ? ExternalFormat::kOpenMvs
                             : ExternalFormat::kDepth;
}

void RequireGiven(const std::string& name, const std::string& value) {
  if (value.empty()) {
    throw Error(ErrorCode::kBadOption,
                OptionName(name) + " is missing; give it");
  }
}

}  // namespace

void ImportCommand::AddTo(OptionSet* options) {
  AddInputOptions(this, options);
  AddConversionOptions(this, options);
}

ImportOptions ImportCommand::Parse() const {
  RequireGiven("format", format);
  RequireGiven("input_path", input_path);
  if (!normal_path.empty() && format != "depth") {
    throw Error(ErrorCode::kBadOption,
                OptionName("normal_path") + " is for " + OptionName("format") +
                    " depth; the other formats have their normals beside "
                    "their depth");
  }
  ImportOptions options = import;
  options.workspace_path = workspace_path;
  options.match.format = ToFormat(format);
  options.match.input_path = input_path;
  options.match.normal_path = normal_path;
  options.match.type = *ParseMapType(output_type);
  options.match.index_order =
      index_order == "name" ? IndexOrder::kName : IndexOrder::kImageId;
  options.match.image_list = image_list;
  options.normal_frame = normal_frame == "world"    ? NormalFrame::kWorld
                         : normal_frame == "camera" ? NormalFrame::kCamera
                                                    : NormalFrame::kAuto;
  return options;
}

int RunTsarImport(int argc, char** argv) {
  ImportCommand command;
  OptionSet options("tsar_import",
                    kSummary,
                    "tsar_import --format acm --input_path scene "
                    "--workspace_path dense");
  command.AddTo(&options);
  if (!options.Parse(argc, argv)) {
    return 0;
  }
  if (command.restore) {
    return UndoImports(command);
  }
  const ImportOptions import = command.Parse();
  Progress progress(std::cerr, isatty(STDERR_FILENO) != 0);
  const Interruption interruption;
  PrintSummary(ImportWorkspace(
                   import, progress, [&] { return interruption.Requested(); }),
               std::cout);
  return 0;
}

}  // namespace tsar
