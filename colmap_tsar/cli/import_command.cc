// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/cli/import_command.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/cli/commands.h"
#include "colmap_tsar/cli/interruption.h"
#include "colmap_tsar/cli/print_summary.h"
#include "colmap_tsar/cli/shared_options.h"

#include <functional>
#include <iostream>

namespace tsar {
namespace {

constexpr const char* kSummary =
    "Makes a dense workspace of depth and normal maps of other programs and "
    "sensors, for tsar_refine and stereo_fusion: maps of ACMH, ACMM, ACMP, "
    "ACMMP and Gipuma (acm), of APD (apd), of OpenMVS (openmvs), and depth "
    "images of any origin (depth). Photos and sparse model are those of the "
    "workspace that is given, from which the maps must have been made; nothing "
    "in it is changed. Everything is checked before the first map is written. "
    "acm's and apd's geometric maps are filtered: depths stay that the photos "
    "and maps of two other images confirm.";

}  // namespace

void ImportCommand::AddTo(OptionSet* set) {
  set->AddRequired("workspace_path",
                   &options.workspace_path,
                   "The dense workspace with images/ and sparse/.");
  set->AddRequired("input_path",
                   &options.match.input_path,
                   "The folder with the other program's maps; for acm and apd "
                   "also the one above it, which holds cams/.");
  set->AddRequired("output_path",
                   &options.output_path,
                   "The workspace to make. It must not be there, or be empty, "
                   "or hold an earlier import (--overwrite 1).");
  set->Add("format",
           &format,
           "Whose maps they are, must be given; depth: PNG of 16 bits, "
           "EXR, TIFF, PFM or NPY, called as the images are.")
      .choices = {"acm", "apd", "openmvs", "depth"};
  set->Add("normal_path",
           &options.match.normal_path,
           "For depth: a folder with normal maps (EXR, TIFF, PFM or NPY of "
           "three channels, x right, y down, z forward). If empty, normals "
           "are computed from depth.");
  set->AddEnum<MapType>(
      "output_type",
      &options.match.type,
      {MapType::kGeometric, MapType::kPhotometric},
      "The type of maps to write; for acm also which of its depth maps is "
      "taken. Photometric maps are not filtered.");
  set->Add("image_list",
           &options.match.image_list,
           "A file with one image name per line, for the numbers 0, 1, 2, ... "
           "in the names of the maps. If empty, acm's and apd's numbers follow "
           "COLMAP's image ids. For openmvs and depth, numbers count instead "
           "of names then.");
  set->Add("depth_scale",
           &options.depth_scale,
           "Units of the sparse model per stored unit of depth. 0: 0.001 "
           "for depth images of integers (millimeters), otherwise 1.",
           {0.0, 1e12});
  set->Add("scale_to_sparse",
           &options.scale_to_sparse,
           "Give the depths of each image a scale of their own, by the "
           "sparse points that it sees, as depth from one image needs.");
  set->Add("check_scale",
           &options.check_scale,
           "Refuse depths that are off those of the sparse points by over "
           "20 % in all images alike.");
  set->Add("overwrite",
           &options.overwrite,
           "Replace an earlier import. A folder with anything else in it, such "
           "as what tsar_refine writes, is never touched.");
  AddDeviceOptions("TsarImport.", &options.device, set);
}

ImportSummary ImportCommand::Run(Progress& progress) const {
  if (format.empty()) {
    throw Error(ErrorCode::kBadOption,
                OptionName("format") + " is missing; give it");
  }
  if (!options.match.normal_path.empty() && format != "depth") {
    throw Error(ErrorCode::kBadOption,
                OptionName("normal_path") + " is for " + OptionName("format") +
                    " depth; the other formats have their normals beside "
                    "their depth");
  }
  ImportOptions parsed = options;
  parsed.match.format = format == "acm"       ? ExternalFormat::kAcm
                        : format == "apd"     ? ExternalFormat::kApd
                        : format == "openmvs" ? ExternalFormat::kOpenMvs
                                              : ExternalFormat::kDepth;
  parsed.device.Check();
  return ImportWorkspace(parsed, progress);
}

int RunTsarImport(int argc, char** argv) {
  ImportCommand command;
  OptionSet options("tsar_import",
                    kSummary,
                    "tsar_import --format acm --input_path scene "
                    "--workspace_path dense --output_path acm");
  command.AddTo(&options);
  if (!options.Parse(argc, argv)) {
    return 0;
  }
  PrintSummary(RunInterruptibly(std::bind_front(&ImportCommand::Run, &command)),
               std::cout);
  return 0;
}

}  // namespace tsar
