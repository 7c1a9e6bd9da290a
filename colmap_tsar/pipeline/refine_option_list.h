// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/pipeline/refine_options.h"

#include <map>
#include <string>
#include <variant>
#include <vector>

namespace tsar {

// One member of RefineOptions, with what a user needs to know about it.
struct RefineField {
  std::string name;  // Of the member, and of the option on the command line.
  std::variant<bool*, int*, double*> value;
  std::string description;
  // The values that make sense, both ends included; not for bools.
  double min = 0.0;
  double max = 0.0;
};

// All members of RefineOptions, in the order of the help. The one list that the
// command line, the checks, the manifest and the options' hash are made from.
std::vector<RefineField> ListRefineFields(RefineOptions* options);

// An option that had another name before. The former name still works, and a
// warning says how the option is called now.
struct RenamedOption {
  std::string former_name;
  std::string name;
};

// The former names of members of RefineOptions.
const std::vector<RenamedOption>& RenamedRefineOptions();

// Name and value of every member, as text that keeps every bit.
std::map<std::string, std::string> RefineOptionsText(
    const RefineOptions& options);

// A fingerprint of the program's version and of all values: what a result
// depends on beside the workspace. It takes former names, so that a new name
// alone does not make results outdated.
std::string HashRefineOptions(const RefineOptions& options);

}  // namespace tsar
