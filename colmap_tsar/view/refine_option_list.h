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

// One member of RefineOptions, with what a user needs to know about it.
struct RefineField {
  std::string name;
  std::variant<bool*, int*, double*> value;
  std::string description;
  // The values that make sense, both ends included; not for bools.
  double min = 0.0;
  double max = 1.0;
  // Whether it is an option of the command, which users choose better than we;
  // all others are set by its option "experiment".
  bool is_option = false;
  // What the presets set it to, where that is not the default: the published
  // method as this project reads it, and its equations as printed, which
  // otherwise have the values of the first.
  std::optional<double> paper = std::nullopt;
  std::optional<double> paper_strict = std::nullopt;

  // The member's present value, as text that keeps every bit.
  std::string Text() const;
};

// All members of RefineOptions, in the order of the help. The one list that the
// command line, Python, the presets, the checks, the manifest, the options' hash
// and the ablation of benchmarks/suite are made from.
std::vector<RefineField> ListRefineFields(RefineOptions* options);

// The columns of that list.
enum class RefinePreset { kDefault, kPaper, kPaperStrict };

// All members with the values of a preset. Lengths of kPaperStrict are metres,
// as on ETH3D; docs/method.md lists where it follows the print.
RefineOptions PresetOptions(RefinePreset preset);

// Name and value of every member.
std::map<std::string, std::string> RefineOptionsText(
    const RefineOptions& options);

// A fingerprint of the program's version and of all values: what a result
// depends on beside the workspace.
std::string HashRefineOptions(const RefineOptions& options);

}  // namespace tsar
