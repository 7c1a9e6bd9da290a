// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/cli/option_set.h"
#include "colmap_tsar/io/map_paths.h"
#include "colmap_tsar/run/device_options.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace tsar {

// Options that several commands have.

// DeviceOptions as a user types them.
struct DeviceArguments {
  std::string device = ToString(DeviceOptions().choice);
  std::string gpu_index = GpuIndicesText(DeviceOptions().gpu_indices);
  int num_threads = DeviceOptions().num_threads;
  double cache_size = DeviceOptions().cache_size;

  // Throws kBadOption.
  DeviceOptions Parse() const;
};

// Adds the options for the devices and the memory of a command, but for
// num_threads, which each command describes itself. group: the prefix of their
// names, such as "TsarRefine.".
void AddDeviceArguments(const std::string& group,
                        DeviceArguments* arguments,
                        OptionSet* options);

// Adds a choice of maps, such as --input_type. description: "The maps to ...".
void AddMapType(const std::string& name,
                std::string* value,
                const std::string& description,
                OptionSet* options);

// Adds --prior_path and --prior_type. use: sentences after the description of
// the files, each after a space, or empty.
void AddPriorOptions(const std::string& use,
                     std::string* prior_path,
                     std::string* prior_type,
                     OptionSet* options);

// The map type of a value; nothing where that is empty.
std::optional<MapType> ParseMapType(const std::string& value);

// Adds --restore_conflicts.
void AddRestoreConflicts(std::string* value, OptionSet* options);

// Prints which maps were kept and the new paths of superseded ones. Then throws
// Error kMismatch where images are left that the user has to decide about.
void ReportRestored(const std::vector<std::filesystem::path>& kept,
                    const std::vector<std::filesystem::path>& superseded,
                    const std::vector<std::filesystem::path>& conflicts);

// Throws Error kMismatch where refined maps have lost their originals.
void RequireNoneLost(const std::vector<std::filesystem::path>& lost);

}  // namespace tsar
