// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/view/refine_options.h"

#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace tsar {

// One member of RefineOptions with its documentation.
struct RefineField {
  std::string name;
  std::variant<bool*, int*, double*> value;
  std::string description;
  // The range of valid values, both ends included; unused for bools.
  double min = 0.0;
  double max = 1.0;
  // Whether users may have reason to change it, so that --help lists it; all
  // others are for experiments.
  bool is_option = false;
  // The value of the preset `paper`, the published method as this project
  // interprets it, where that differs from the default.
  std::optional<double> paper = std::nullopt;

  // The member's present value, as text that keeps every bit.
  std::string Text() const;
};

// All members of RefineOptions, in the order of the help. The command line,
// Python, the presets, the checks, the manifest, the options' hash and the
// ablation of benchmarks/suite are generated from this list.
std::vector<RefineField> ListRefineFields(RefineOptions* options);

// The presets, which are the columns of that list.
enum class RefinePreset { kDefault, kPaper };

// All members with the values of a preset.
RefineOptions PresetOptions(RefinePreset preset);

// Name and value of every member.
std::map<std::string, std::string> RefineOptionsText(
    const RefineOptions& options);

// A hash of the program's version and of all values: what a result depends on
// besides the workspace.
std::string HashRefineOptions(const RefineOptions& options);

}  // namespace tsar
