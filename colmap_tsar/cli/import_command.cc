// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/cli/import_command.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/cli/restore_options.h"

namespace tsar {
namespace {

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
  options.match.type = output_type == ToString(MapType::kGeometric)
                           ? MapType::kGeometric
                           : MapType::kPhotometric;
  options.match.index_order =
      index_order == "name" ? IndexOrder::kName : IndexOrder::kImageId;
  options.match.image_list = image_list;
  options.normal_frame = normal_frame == "world"    ? NormalFrame::kWorld
                         : normal_frame == "camera" ? NormalFrame::kCamera
                                                    : NormalFrame::kAuto;
  return options;
}

}  // namespace tsar
