// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/cli/option_set.h"
#include "colmap_tsar/io/map_paths.h"
#include "colmap_tsar/run/device_options.h"

#include <filesystem>
#include <functional>
#include <string>

namespace tsar {

// Options that several commands have, and checks of their values.

// Adds the options for the devices and the memory of a command. group: the
// prefix of their names, such as "TsarRefine.".
void AddDeviceOptions(const std::string& group,
                      DeviceOptions* devices,
                      OptionSet* options);

// Adds a number of CPU threads. remark: sentences after its description, each
// after a space, or empty.
void AddNumThreads(const std::string& name,
                   int* value,
                   OptionSet* options,
                   const std::string& remark = "");

// Adds --input_type. value: a MapType, or an optional one.
template <typename Value>
void AddInputType(Value* value,
                  const std::string& description,
                  OptionSet* options) {
  options->AddEnum<MapType>("input_type",
                            value,
                            {MapType::kGeometric, MapType::kPhotometric},
                            description);
}

// Adds --mask_path. effect: what a mask changes, in sentences.
void AddMaskPath(std::filesystem::path* value,
                 const std::string& effect,
                 OptionSet* options);

// Checks, before the work is done, whether a command may write a file to a path
// that an option gives. Throws Error kNotFound where its folder is missing,
// kUnsupported where it lies among the inputs of a workspace, where anything
// but a file of the kind is there, and where one exists and is not to be
// overwritten. kind: its name, "picture"; is_of_kind: whether a file that is
// not empty begins, in its first 1000 bytes, as one of the kind.
using IsOfKind = std::function<bool(const std::string& begin)>;
void RequireWritableOutput(const std::filesystem::path& workspace_path,
                           const std::filesystem::path& output_path,
                           const std::string& kind,
                           const IsOfKind& is_of_kind,
                           bool overwrite,
                           const std::string& option_key = "output_path");

}  // namespace tsar
