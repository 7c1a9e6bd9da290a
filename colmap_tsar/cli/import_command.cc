// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/cli/import_command.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/cli/commands.h"
#include "colmap_tsar/cli/interruption.h"
#include "colmap_tsar/cli/print_summary.h"
#include "colmap_tsar/cli/shared_options.h"
#include "colmap_tsar/run/store/workspace_lock.h"
#include "colmap_tsar/tools/import/import_store.h"

#include <filesystem>
#include <functional>
#include <iostream>

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
  if (!command.options.match.input_path.empty() || !command.format.empty()) {
    throw Error(
        ErrorCode::kBadOption,
        "--restore undoes imports; leave --input_path and --format out");
  }
  const std::filesystem::path& root = command.options.workspace_path;
  const WorkspaceLock lock(root);
  const RestoreResult result = UndoImport(root);
  std::cout << "Undid the import of " << Counted(result.num_restored, "image")
            << ".\n";
  ReportRestored(result);
  return 0;
}

void AddInputOptions(ImportCommand* command, OptionSet* set) {
  set->AddRequired("workspace_path",
                   &command->options.workspace_path,
                   "The dense workspace to import into.");
  set->Add("input_path",
           &command->options.match.input_path,
           "The folder with the other program's maps; for acm and apd also "
           "the one above it, which holds cams/.");
  set->AddChoice("format",
                 &command->format,
                 {"acm", "apd", "openmvs", "depth"},
                 "Whose maps they are; depth: PNG of 16 bits, EXR, TIFF, "
                 "PFM or NPY, called as the images are.");
  set->Add("normal_path",
           &command->options.match.normal_path,
           "For depth: a folder with normal maps (EXR, TIFF, PFM or NPY of "
           "three channels, x right, y down, z forward). If empty, normals "
           "are computed from depth.");
  AddMapType(
      "output_type",
      &command->output_type,
      "The type of maps to write; for acm also which of its depth maps is "
      "taken.",
      set);
  set->AddChoice("index_order",
                 &command->index_order,
                 {"image_id", "name"},
                 "Which images acm's and apd's numbers mean: ordered by "
                 "COLMAP's image id, as colmap2mvsnet does, or by name.");
  set->Add("image_list",
           &command->options.match.image_list,
           "A file with one image name per line, for the numbers 0, 1, 2, "
           "... in the names of the maps. For openmvs and depth, numbers "
           "count instead of names then.");
}

void AddConversionOptions(ImportCommand* command, OptionSet* set) {
  set->Add("depth_scale",
           &command->options.depth_scale,
           "Units of the sparse model per stored unit of depth. 0: 0.001 "
           "for depth images of integers (millimeters), otherwise 1.",
           {0.0, 1e12});
  set->Add("scale_to_sparse",
           &command->options.scale_to_sparse,
           "Give the depths of each image a scale of their own, by the "
           "sparse points that it sees, as depth from one image needs.");
  set->Add("check_scale",
           &command->options.check_scale,
           "Refuse depths that are off those of the sparse points by over "
           "20 % in all images alike.");
  set->AddChoice("normal_frame",
                 &command->normal_frame,
                 {"auto", "world", "camera"},
                 "The frame of the other program's normals; auto: world "
                 "for acm and apd, camera for the others.");
  set->Add("import_costs",
           &command->options.import_costs,
           "Take acm's costs over instead of letting tsar_refine compute "
           "its own. They are noise where the image has no texture.");
  set->Add("overwrite",
           &command->options.overwrite,
           "Replace maps of this type that another program wrote. They are "
           "kept for --restore 1.");
  set->Add("restore",
           &command->restore,
           "Undo all imports: put the former maps back, remove what was "
           "imported, and do nothing else. What others wrote in its place "
           "since is never removed.");
}

ExternalFormat ToFormat(const std::string& text) {
  return text == "acm"       ? ExternalFormat::kAcm
         : text == "apd"     ? ExternalFormat::kApd
         : text == "openmvs" ? ExternalFormat::kOpenMvs
                             : ExternalFormat::kDepth;
}

void RequireGiven(const std::string& name, bool is_given) {
  if (!is_given) {
    throw Error(ErrorCode::kBadOption,
                OptionName(name) + " is missing; give it");
  }
}

}  // namespace

void ImportCommand::AddTo(OptionSet* set) {
  AddInputOptions(this, set);
  AddConversionOptions(this, set);
}

ImportSummary ImportCommand::Run(
    Progress& progress, const std::function<bool()>& should_stop) const {
  RequireGiven("format", !format.empty());
  RequireGiven("input_path", !options.match.input_path.empty());
  if (!options.match.normal_path.empty() && format != "depth") {
    throw Error(ErrorCode::kBadOption,
                OptionName("normal_path") + " is for " + OptionName("format") +
                    " depth; the other formats have their normals beside "
                    "their depth");
  }
  ImportOptions parsed = options;
  parsed.match.format = ToFormat(format);
  parsed.match.type = *ParseMapType(output_type);
  parsed.match.index_order =
      index_order == "name" ? IndexOrder::kName : IndexOrder::kImageId;
  parsed.normal_frame = normal_frame == "world"    ? NormalFrame::kWorld
                        : normal_frame == "camera" ? NormalFrame::kCamera
                                                   : NormalFrame::kAuto;
  return ImportWorkspace(parsed, progress, should_stop);
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
  PrintSummary(RunInterruptibly(std::bind_front(&ImportCommand::Run, &command)),
               std::cout);
  return 0;
}

}  // namespace tsar
